"""A tracker turns measurements, one after the other, into tracks: where an obstacle is now and how it moves.

Whose measurement is whose is known here: each carries its obstacle's name, and what is not there a name of its own. A tracker that has
to find that out itself would do worse.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, NamedTuple, Protocol

import numpy as np
from pydantic import Field

from testbed.core.frames import vec3
from testbed.flight.plants.base import State
from testbed.flight.sensing.base import Seen, Sensor, SensorContext
from testbed.flight.sensing.own import checked
from testbed.flight.traffic.track import Array, Covariance, Traffic

LATER_S = 1e-9  # a measurement that is later than the last by less is the same one
EXACT = 1e-6  # variance (m^2, m^2/s^2) that any measurement has at least: a filter divides by it

Looks = Annotated[int, Field(ge=1, le=1000)]
Seconds = Annotated[float, Field(ge=0, le=3600)]
Sigma = Annotated[float, Field(gt=0, le=10_000)]


class Tracker(Protocol):
    """A tracker of one flight, made by ``factory(**options)``. Asked at every look; its memory goes in and comes out."""

    def start(self) -> Any:
        """Fresh memory."""

    def track(self, memory: Any, time_s: float, seen: Sequence[Seen]) -> tuple[Any, tuple[Seen, ...]]:
        """``seen`` is what the sensor tells; a measurement that it has told before comes again until there is a newer one."""


class Untracked:
    """The planner is told what the sensor tells."""

    def start(self) -> None:
        return None

    def track(self, memory: None, time_s: float, seen: Sequence[Seen]) -> tuple[None, tuple[Seen, ...]]:  # noqa: ARG002
        return memory, tuple(seen)


class Measurement(NamedTuple):
    """Place and, where it was measured, velocity; the covariance of both."""

    values: Array  # (6,) or (3,)
    covariance: Array  # (6,6) or (3,3)


class Held(NamedTuple):
    """A track: whose, how large, when it was measured last and how often, and what the filter has of it."""

    name: str
    radius_m: float
    measured_s: float
    looks: int
    estimate: Any


class Filtered(ABC):
    """What the trackers here have in common: when a track begins, is shown and ends. A filter is three functions of an estimate.

    ``confirm_looks``: a track is shown from so many measurements on. ``coast_s``: it goes on straight for so long after the last.
    ``position_noise_m``, ``velocity_noise_mps``: what a measurement is taken to be off by, where the sensor does not say.
    """

    def __init__(
        self, confirm_looks: Looks = 3, coast_s: Seconds = 1.0, position_noise_m: Sigma = 3.0, velocity_noise_mps: Sigma = 1.0
    ) -> None:
        self._confirm, self._coast_s = confirm_looks, coast_s
        self._unsaid = np.diag(np.repeat([position_noise_m**2, velocity_noise_mps**2], 3))

    @abstractmethod
    def begin(self, measured: Measurement) -> Any:
        """The estimate after the first measurement."""

    @abstractmethod
    def measured(self, estimate: Any, elapsed_s: float, measured: Measurement) -> Any:
        """The estimate with another measurement, so long after the last."""

    @abstractmethod
    def predicted(self, estimate: Any, elapsed_s: float) -> tuple[Array, Array | None]:
        """Place and velocity (6,) so long after the last measurement, and their covariance (6,6) where the filter has one."""

    def start(self) -> Mapping[str, Held]:
        return {}

    def track(self, memory: Mapping[str, Held], time_s: float, seen: Sequence[Seen]) -> tuple[Mapping[str, Held], tuple[Seen, ...]]:
        if not seen and not memory:
            return memory, ()
        tracks = {name: held for name, held in memory.items() if time_s - held.measured_s <= self._coast_s + LATER_S}
        for one in seen:
            held = tracks.get(one.name)
            if held is None:
                if time_s - one.time_s <= self._coast_s + LATER_S:
                    tracks[one.name] = Held(one.name, one.radius_m, one.time_s, 1, self.begin(self._of(one)))
            elif (elapsed_s := one.time_s - held.measured_s) > LATER_S:
                estimate = self.measured(held.estimate, elapsed_s, self._of(one))
                tracks[one.name] = Held(one.name, one.radius_m, one.time_s, held.looks + 1, estimate)
        return tracks, tuple(self._shown(held, time_s) for held in tracks.values() if held.looks >= self._confirm)

    def _of(self, one: Seen) -> Measurement:
        """A velocity of infinite variance was not measured."""
        covariance = self._unsaid if one.covariance is None else np.array(one.covariance) + EXACT * np.eye(6)
        values = np.array((*one.pos, *one.vel))
        return Measurement(values, covariance) if np.isfinite(covariance[3, 3]) else Measurement(values[:3], covariance[:3, :3])

    def _shown(self, held: Held, time_s: float) -> Seen:
        values, covariance = self.predicted(held.estimate, time_s - held.measured_s)
        return Seen(held.name, held.radius_m, vec3(values[:3]), vec3(values[3:]), time_s, None if covariance is None else _rows(covariance))


def _rows(matrix: Array) -> Covariance:
    return tuple(map(tuple, matrix.tolist()))


class Tracked:
    """A sensor with a tracker behind it: what the loop and the planner take for the sensor."""

    def __init__(self, sensor: Sensor, kind: str, tracker: Tracker, is_ours: bool) -> None:
        self._sensor, self._kind, self._tracker, self._is_ours = sensor, kind, tracker, is_ours

    def start(self, context: SensorContext) -> tuple[Any, Any]:
        return self._sensor.start(context), self._tracker.start()

    def sense(self, memory: tuple[Any, Any], time_s: float, own: State, traffic: Traffic) -> tuple[tuple[Any, Any], tuple[Seen, ...]]:
        sensed, seen = self._sensor.sense(memory[0], time_s, own, traffic)
        answer = self._tracker.track(memory[1], time_s, seen)
        tracked, shown = answer if self._is_ours else checked(f"the tracker {self._kind}", answer, time_s)
        return (sensed, tracked), shown
