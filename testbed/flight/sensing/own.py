"""A sensor of somebody's own: it cannot ask for what is still to come, and what it answers is looked at before a planner believes it."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from testbed.core.frames import Vec3
from testbed.flight.plants.base import State
from testbed.flight.sensing.base import Seen, Sensor, SensorContext
from testbed.flight.traffic.track import Array, Body, Track, Traffic

EARLY_S = 1e-9  # later than now by this much is rounding


class OwnSensor:
    """A sensor whose answers are checked at every look. ``ValueError`` in words, which name the sensor."""

    def __init__(self, kind: str, sensor: Sensor) -> None:
        self._kind, self._sensor = kind, sensor
        self._clock = _Clock()
        self._known: tuple[Traffic, Traffic] | None = None  # the traffic, and what the sensor is shown of it

    def start(self, context: SensorContext) -> Any:
        return self._sensor.start(context)

    def sense(self, memory: Any, time_s: float, own: State, traffic: Traffic) -> tuple[Any, tuple[Seen, ...]]:
        self._clock.now_s = time_s
        if self._known is None or self._known[0] is not traffic:
            self._known = traffic, Traffic(tuple(_SoFar(track, self._clock) for track in traffic.tracks))
        return checked(f"the sensor {self._kind}", self._sensor.sense(memory, time_s, own, self._known[1]), time_s)


def checked(who: str, answer: Any, time_s: float) -> tuple[Any, tuple[Seen, ...]]:
    """The answer of a sensor or a tracker of somebody's own at a look, as it has to be. ``ValueError`` in words, which say whose it is."""
    if not (isinstance(answer, tuple) and len(answer) == 2):
        raise _refused(who, repr(answer))
    memory, seen = answer
    if not isinstance(seen, Sequence) or isinstance(seen, str | Body):
        raise _refused(who, f"(memory, {seen!r})")
    for one in seen:
        if why := _fault(one, time_s):
            raise _refused(who, f"{one!r}: {why}")
    if len({one.name for one in seen}) < len(seen):
        raise _refused(who, f"two of the same name: {', '.join(one.name for one in seen)}")
    return memory, tuple(seen)


def _refused(who: str, what: str) -> ValueError:
    return ValueError(f"{who} must return (memory, tuple of Seen), not {what}")


class _Clock:
    """What time it is at the look that is being taken, s."""

    now_s = -math.inf


class _SoFar:
    """A track of which nobody can know how it goes on. Raises ``ValueError`` when asked for a time that is still to come."""

    def __init__(self, track: Track, clock: _Clock) -> None:
        self.name, self.radius_m = track.name, track.radius_m
        self._track, self._clock = track, clock

    def at(self, time_s: float) -> tuple[Vec3, Vec3] | None:
        self._check(time_s)
        return self._track.at(time_s)

    def sampled(self, time_s: Array) -> tuple[Array, Array]:
        self._check(float(np.max(time_s, initial=-math.inf)))
        return self._track.sampled(time_s)

    def _check(self, time_s: float) -> None:
        now_s = self._clock.now_s
        if not time_s <= now_s + EARLY_S:
            raise ValueError(f"a sensor asks where {self.name} is at {time_s:g} s, but it is {now_s:g} s: what is to come is not known")


def _fault(one: Any, now_s: float) -> str:
    """Why this is nothing that was seen; empty if it is."""
    if not isinstance(one, Body):
        return "it is no Seen"
    if not isinstance(one.name, str):
        return "its name is no text"
    if not _finite(one.pos, (3,)) or not _finite(one.vel, (3,)):
        return "pos and vel are three finite numbers each"
    if not _finite(one.radius_m, ()) or one.radius_m <= 0.0:
        return "radius_m is a number above 0"
    if one.covariance is not None and not _symmetrical(one.covariance):
        return "covariance is None, or the 6x6 numbers of a symmetrical matrix"
    return _mistimed(one.time_s, now_s)


def _mistimed(time_s: Any, now_s: float) -> str:
    if not _finite(time_s, ()):
        return "time_s is a finite number"
    return f"its time_s is later than now, {now_s:g} s" if time_s > now_s + EARLY_S else ""


def _finite(value: Any, shape: tuple[int, ...]) -> bool:
    try:
        numbers = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        return False
    return numbers.shape == shape and bool(np.isfinite(numbers).all())


def _symmetrical(rows: Any) -> bool:
    try:
        matrix = np.asarray(rows, dtype=float)
    except (TypeError, ValueError):
        return False
    return matrix.shape == (6, 6) and bool((matrix == matrix.T).all())
