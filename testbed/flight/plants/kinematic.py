"""The paper's aircraft: a point that moves along the planned curve at constant speed.

Bank and load factor are what a coordinated turn along the curve would need, so that the page can set them beside what the
aeroplane did. Nothing limits them. The mean wind sets its speed over the ground where airspeed is held; gusts and turbulence do not
move a point on rails: they show in its airspeed only.
"""

import math
from collections.abc import Sequence
from typing import Any

from testbed.core.frames import Vec3
from testbed.core.units import G0_MPS2
from testbed.flight.air import AirModel, ground_speed_along
from testbed.flight.plants.base import Command, Followable, PlantSetting, Start, State

NOT_THERE = (math.nan,) * 9  # alpha, beta, rates, controls


class KinematicPlant:
    """A point on rails. Time is an integer tick since the path changed, so that no sum of steps drifts."""

    def __init__(self, start: Start, air: AirModel, plant_hz: int, hold_airspeed: bool) -> None:
        self._air, self._steady, self._uniform = air, air.steady, air.uniform
        # without a mean wind, or when the ground speed is held, the place is a product and not a sum
        self._even = not hold_airspeed or air.uniform == (0.0, 0.0, 0.0)
        self._hz = plant_hz
        self._speed = start.speed if hold_airspeed else ground_speed_along(start.tangent, start.speed, start.wind)
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
        self._tick += 1
        if self._even:
            self._ticks_on_path += 1
        else:  # the ground speed changes along the curve: the midpoint rule
            half = self._from_s + 0.5 * self._ground_speed(self._from_s) / self._hz
            self._from_s += self._ground_speed(half) / self._hz

    def state(self, sample: Sequence[Any]) -> State:
        return State._make(sample)

    def touches_ground(self) -> bool:
        return False

    def air_rotation(self, sample: Sequence[Any]) -> tuple[float, float, float]:  # noqa: ARG002
        """A point has no wing that could feel it."""
        return math.nan, math.nan, math.nan

    def sample(self) -> Sequence[float]:
        assert self._path is not None, "follow() comes first"
        s = min(self._s(), self._path.length_m)
        (x, y, z), (tx, ty, tz), curvature = self._path.frame(s)
        v = self._ground_speed(s)
        air = self._steady if self._steady is not None else self._air.at(self._tick / self._hz, (x, y, z))
        velocity = (v * tx, v * ty, v * tz)
        bank, load_factor = coordinated(velocity, (v * v * curvature[0], v * v * curvature[1], v * v * curvature[2]))
        airspeed = math.dist(velocity, air)
        heading = math.atan2(velocity[0] - air[0], velocity[1] - air[1]) % math.tau
        pitch = math.asin(-1.0 if tz < -1.0 else 1.0 if tz > 1.0 else tz)  # a unit vector is one up to rounding
        return State(x, y, z, *velocity, bank, pitch, heading, load_factor, airspeed, *NOT_THERE, *air)

    def _s(self) -> float:
        return self._from_s + self._speed * self._ticks_on_path / self._hz

    def _ground_speed(self, s_m: float) -> float:
        """Of the set airspeed in the mean wind at an arc length."""
        if self._even:
            return self._speed
        assert self._path is not None
        point, tangent, _ = self._path.frame(s_m)
        mean = self._uniform if self._uniform is not None else self._air.mean(self._tick / self._hz, point)
        return ground_speed_along(tangent, self._speed, mean)


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


def make_plant(setting: PlantSetting) -> KinematicPlant:
    """The point for one flight; it has no limits, whatever the aircraft."""
    return KinematicPlant(setting.start, setting.air, setting.plant_hz, setting.hold_airspeed)
