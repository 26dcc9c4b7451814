"""The paper's aircraft: a point that moves along the planned curve at constant speed.

Bank and load factor are what a coordinated turn along the curve would need, so that the page can set them beside what the
aeroplane did. Nothing limits them. The mean wind sets its speed over the ground where airspeed is held; gusts and turbulence do not
move a point on rails: they show in its airspeed only.

Where a point on rails will be is known as soon as its path is: its samples are worked out many at a time, to the last bit what they
would be one by one.
"""

import math
from collections.abc import Iterable, Sequence
from itertools import repeat
from typing import Any

import numpy as np

from testbed.core.chain import Chain
from testbed.core.frames import Vec3
from testbed.core.units import G0_MPS2
from testbed.flight.air import AirModel, ground_speed_along
from testbed.flight.plants.base import Command, Followable, PlantSetting, Start, State, make

Array = np.ndarray
Sample = Sequence[float]
NOT_THERE = (math.nan,) * 9  # alpha, beta, rates, controls
STANDING_MPS = 1e-9  # slower than that there is no direction
BLOCK = 500  # samples that are worked out at once, at most; those after a change of path were for nothing ...
DRIVEN_BLOCK = 120  # ... and are dearer where the speed over the ground changes along the path


class KinematicPlant:
    """A point on rails. Time is an integer tick since the path changed, so that no sum of steps drifts."""

    def __init__(self, start: Start, air: AirModel, plant_hz: int, hold_airspeed: bool) -> None:
        self._air, self._steady, self._uniform = air, air.steady, air.uniform
        # without a mean wind, or when the ground speed is held, the place is a product and not a sum
        self._even = not hold_airspeed or air.uniform == (0.0, 0.0, 0.0)
        self._hz = plant_hz
        self._speed = start.speed if hold_airspeed else ground_speed_along(start.tangent, start.speed, start.wind)
        self._path: Followable | None = None
        self._from_s = 0.0
        self._changed = 0  # tick of the flight when the path changed
        self._ticks = 0  # since then
        self._first, self._samples = 0, list[Sample]()  # from which of these ticks on the samples are there
        self._driven = 0, 0.0  # one of these ticks, and the arc length then, of a speed that changes along the path

    def follow(self, path: Followable, s_m: float) -> None:
        self._changed += self._ticks
        self._path, self._from_s, self._ticks, self._driven = path, s_m, 0, (0, s_m)
        self._first, self._samples = 0, []

    def command(self, state: State, command: Command) -> bool:  # noqa: ARG002
        """A point on rails takes no commands, and has no stops."""
        return False

    def step(self) -> None:
        self._ticks += 1

    def state(self, sample: Sequence[Any]) -> State:
        return make(State, sample)

    def touches_ground(self) -> bool:
        return False

    def air_rotation(self, sample: Sequence[Any]) -> tuple[float, float, float]:  # noqa: ARG002
        """A point has no wing that could feel it."""
        return math.nan, math.nan, math.nan

    def sample(self) -> Sample:
        index = self._ticks - self._first
        if index >= len(self._samples):
            self._first, index = self._ticks, 0
            self._samples = list(self._from_now_on())
        return self._samples[index]

    def _from_now_on(self) -> Iterable[Sample]:
        """The samples from now on, as many as are likely to be needed: two of a path that lasts for one step, which is no chain."""
        path, now, speed = self._path, self._ticks, self._speed
        assert path is not None, "follow() comes first"
        s_m: Array
        if self._even:
            s_m = self._from_s + speed * np.arange(now, now + self._count(path, BLOCK)) / self._hz
        else:
            places, speeds = self._drive(path, now)
            s_m, speed = np.array(places), np.array(speeds)  # type: ignore[assignment]
        s_m = np.minimum(s_m, path.length_m)
        if isinstance(path, Chain) and s_m[0] >= 0.0:
            place, tangent, bend = path.frames(s_m)
        else:
            frames = zip(*(path.frame(s) for s in s_m.tolist()), strict=True)
            place, tangent, bend = (np.array(rows).T for rows in frames)  # type: ignore[assignment]
        return self._rows(place, tangent, bend, speed)

    def _count(self, path: Followable, most: int) -> int:
        """How many samples to work out at once; past its end a path goes nowhere."""
        if not isinstance(path, Chain):
            return 2
        left_m = path.length_m - self._from_s - self._speed * self._ticks / self._hz
        return max(2, int(min(most, left_m * self._hz / max(self._speed, 1.0) + 3.0)))

    def _drive(self, path: Followable, now: int) -> tuple[list[float], list[float]]:
        """Arc lengths from tick ``now`` on, by the midpoint rule, and the speeds over the ground there."""
        (tick, s), hz, length = self._driven, self._hz, path.length_m
        last = now + self._count(path, DRIVEN_BLOCK) - 1
        places, speeds = [], []
        while True:
            here = self._ground_speed(path, s, tick)
            if tick >= now:
                places.append(s)
                speeds.append(here if s <= length else self._ground_speed(path, length, tick))
            if tick == last:
                break
            tick += 1
            if self._uniform is None:
                here = self._ground_speed(path, s, tick)
            s += self._ground_speed(path, s + 0.5 * here / hz, tick) / hz
        self._driven = tick, s
        return places, speeds

    def _ground_speed(self, path: Followable, s_m: float, tick: int) -> float:
        """Of the set airspeed in the mean wind at an arc length, at a tick since the path changed."""
        if self._uniform is not None:
            tangent = path.tangent(s_m) if isinstance(path, Chain) else path.frame(s_m)[1]
            return ground_speed_along(tangent, self._speed, self._uniform)
        point, tangent, _ = path.frame(s_m)
        return ground_speed_along(tangent, self._speed, self._air.mean((self._changed + tick) / self._hz, point))

    def _rows(self, place: Sequence[Array], tangent: Sequence[Array], bend: Sequence[Array], speed: Any) -> Iterable[Sample]:
        """Samples from now on, of columns (n,); ``speed`` over the ground is one for all or (n,)."""
        places, velocity = [each.tolist() for each in place], [speed * each for each in tangent]
        square = speed * speed
        banks, load_factors = coordinated_columns(velocity, [square * each for each in bend])
        vx, vy, vz = (each.tolist() for each in velocity)
        count = len(vx)
        if self._steady is not None:
            air = [self._steady] * count
        else:
            first, hz, at = self._changed + self._ticks, self._hz, self._air.at
            air = [at((first + k) / hz, where) for k, where in enumerate(zip(*places, strict=True))]
        winds = list(zip(*air, strict=True))
        headings = [math.atan2(x - wx, y - wy) % math.tau for x, y, wx, wy in zip(vx, vy, winds[0], winds[1], strict=True)]
        airspeeds = map(math.dist, zip(vx, vy, vz, strict=True), air)
        pitches = map(math.asin, np.clip(tangent[2], -1.0, 1.0).tolist())  # a unit vector is one up to rounding
        nothing = [repeat(nan, count) for nan in NOT_THERE]
        return zip(*places, vx, vy, vz, banks, pitches, headings, load_factors, airspeeds, *nothing, *winds, strict=True)


def coordinated(velocity: Vec3, acceleration: Vec3) -> tuple[float, float]:
    """Bank (right positive, rad) and load factor of a coordinated flight with that ENU acceleration normal to the velocity."""
    vx, vy, vz = velocity
    flat = math.hypot(vx, vy)
    speed = math.hypot(flat, vz)
    if flat < 1e-9 * speed or speed < STANDING_MPS:  # straight up or down: no horizon to bank against
        return 0.0, math.hypot(*acceleration) / G0_MPS2
    left, up = _lift(velocity, acceleration, flat, speed)
    return math.atan2(-left, up), math.hypot(left, up) / G0_MPS2


def _lift(velocity: Sequence[Any], acceleration: Sequence[Any], flat: Any, speed: Any) -> tuple[Any, Any]:
    """What the lift has to do, to the left and up, m/s^2; of floats or of columns."""
    (vx, vy, vz), (ax, ay, az) = velocity, acceleration
    left = (-vy * ax + vx * ay) / flat
    return left, (-vx * vz * ax - vy * vz * ay) / (flat * speed) + az * flat / speed + G0_MPS2 * flat / speed


def coordinated_columns(velocity: Sequence[Array], acceleration: Sequence[Array]) -> tuple[list[float], list[float]]:
    """``coordinated`` of columns (n,), to the last bit."""
    vx, vy, vz = (each.tolist() for each in velocity)
    flat = list(map(math.hypot, vx, vy))
    speed = np.array(list(map(math.hypot, flat, vz)))
    level = np.array(flat)
    if (level < 1e-9 * speed).any() or (speed < STANDING_MPS).any():
        each = [
            coordinated(*both)
            for both in zip(zip(vx, vy, vz, strict=True), zip(*(a.tolist() for a in acceleration), strict=True), strict=True)
        ]
        return [bank for bank, _ in each], [load_factor for _, load_factor in each]
    left, up = (each.tolist() for each in _lift(velocity, acceleration, level, speed))
    return [math.atan2(-aside, above) for aside, above in zip(left, up, strict=True)], [
        lift / G0_MPS2 for lift in map(math.hypot, left, up)
    ]


def make_plant(setting: PlantSetting) -> KinematicPlant:
    """The point for one flight; it has no limits, whatever the aircraft."""
    return KinematicPlant(setting.start, setting.air, setting.plant_hz, setting.hold_airspeed)
