"""The one door from the truth to watch, planner and way back: what a sensor is told once, what it must do, what it answers."""

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from testbed.flight.plants.base import State
from testbed.flight.traffic.track import Body, Traffic

Seen = Body
"""An obstacle as a sensor has it: what it is called, the sphere's radius, where it was and how it moved at ``time_s``, which a sensor
that is late says honestly. ``at(time_s)`` is where it is at another time if it goes straight on."""
NOTHING: tuple[Seen, ...] = ()


@dataclass(frozen=True)
class SensorContext:
    """What a sensor is told before a flight."""

    range_m: float
    planner_hz: int  # looks a second
    random: np.random.Generator
    """The sensor's own stream, the same for every method, plant and aircraft. Draw as many numbers whatever is in sight, so that what
    is compared meets the same noise."""


class Sensor(Protocol):
    """A sensor of one flight, made by ``factory(**options)``. It looks at the planner's rate; its memory goes in and comes out.

    It may also have a static method ``reach_m(range_m, radius_m, **options)``, from how far to the centre a sphere is seen: one that is
    entered before is then refused; and ``amiss(options, planner_hz, tracked)``, options by name that do not go with these, and why.
    """

    def start(self, context: SensorContext) -> Any:
        """Fresh memory."""

    def sense(self, memory: Any, time_s: float, own: State, traffic: Traffic) -> tuple[Any, tuple[Seen, ...]]:
        """What is seen now. ``traffic.at(time_s)`` is the truth, now or before; who asks for later gets a ``ValueError`` (``own.py``)."""
