"""The paper's aircraft: a point that moves along the planned curve at constant speed.

Bank and load factor are what a coordinated turn along the curve would need, so that the page can set them beside what the
aeroplane did. Nothing limits them.
"""

import math
from collections.abc import Sequence
from typing import Any

from testbed.flight.air import Wind, ground_speed_along
from testbed.flight.plants.base import Command, Followable, Start, State
from testbed.frames import Vec3
from testbed.units import G0_MPS2

NAN = math.nan


class KinematicPlant:
    """A point on rails. Time is an integer tick since the path changed, so that no sum of steps drifts."""

    def __init__(self, start: Start, wind: Wind, plant_hz: int, hold_airspeed: bool) -> None:
        self._wind = wind
        self._hz = plant_hz
        self._speed = start.speed
        self._hold_airspeed = hold_airspeed
        self._tick = 0
        self._ticks_on_path = 0
        self._from_s = 0.0
        self._path: Followable | None = None

    def follow(self, path: Followable, s_m: float) -> None:
        self._path, self._from_s, self._ticks_on_path = path, s_m, 0

    def command(self, state: State, command: Command) -> bool:  # noqa: ARG002
        """A point on rails takes no commands, and has no stops."""
        return False

    def step(self) -> None:
        air = self._wind(self._tick / self._hz, (0.0, 0.0, 0.0))
        self._tick += 1
        if self._hold_airspeed and any(air):  # the ground speed changes along the curve: here a sum cannot be avoided
            self._from_s += self._ground_speed(self._from_s, air) / self._hz
        else:
            self._ticks_on_path += 1

    def state(self, sample: Sequence[Any]) -> State:
        return State._make(sample)

    def sample(self) -> Sequence[float]:
        assert self._path is not None, "follow() comes first"
        air = self._wind(self._tick / self._hz, (0.0, 0.0, 0.0))
        s = min(self._s(), self._path.length_m)
        (x, y, z), (tx, ty, tz), curvature = self._path.frame(s)
        v = self._ground_speed(s, air)
        velocity = (v * tx, v * ty, v * tz)
        bank, load_factor = coordinated(velocity, (v * v * curvature[0], v * v * curvature[1], v * v * curvature[2]))
        airspeed = math.dist(velocity, air)
        heading = math.atan2(velocity[0] - air[0], velocity[1] - air[1]) % math.tau
        pitch = math.asin(tz)
        return State(x, y, z, *velocity, bank, pitch, heading, load_factor, airspeed, *[NAN] * 9)

    def _s(self) -> float:
        return self._from_s + self._speed * self._ticks_on_path / self._hz

    def _ground_speed(self, s_m: float, air: Vec3) -> float:
        if not self._hold_airspeed or not any(air):
            return self._speed
        assert self._path is not None
        return ground_speed_along(self._path.frame(s_m)[1], self._speed, air)


def coordinated(velocity: Vec3, acceleration: Vec3) -> tuple[float, float]:
    """Bank (right positive, rad) and load factor of a coordinated flight with that ENU acceleration normal to the velocity."""
    vx, vy, vz = velocity
    flat = math.hypot(vx, vy)
    speed = math.hypot(flat, vz)
    if flat < 1e-9 * speed or speed == 0.0:  # straight up or down: no horizon to bank against
        return 0.0, math.hypot(*acceleration) / G0_MPS2
    ax, ay, az = acceleration
    left = (-vy * ax + vx * ay) / flat
    up = (-vx * vz * ax - vy * vz * ay) / (flat * speed) + az * flat / speed + G0_MPS2 * flat / speed
    return math.atan2(-left, up), math.hypot(left, up) / G0_MPS2
