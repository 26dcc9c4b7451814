"""What whoever steps a flight is shown: own state, route and what the sensor has, as arrays with units in their names.

It is what a planner may know, not the truth: obstacles as the sensor has them, the wind as ``replan.wind_known`` has it.
"""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from testbed.core.frames import Vec3
from testbed.flight.planning.context import STILL, Context
from testbed.flight.planning.outside import abeam
from testbed.flight.plants.base import State
from testbed.flight.record import FlightRecord, Outcome
from testbed.flight.sensing.base import Seen
from vosc.vec import dot, sub

Array = np.ndarray
Observation = dict[str, Array]


class Shown(NamedTuple):
    """An entry of an observation: its numbers, what their sizes are at most, and what it means."""

    name: str
    size: int
    most: float
    definition: str


FAR_M, FAST_MPS = 1e6, 1e4
SHOWN: Final = (
    Shown("time_s", 1, 1e5, "time since the start of the flight"),
    Shown("own_pos_enu_m", 3, FAR_M, "where the aircraft is: east, north, up"),
    Shown("own_vel_enu_mps", 3, FAST_MPS, "its velocity over the ground"),
    Shown("own_attitude_rad", 3, math.tau, "bank (right wing down is positive), pitch, compass heading of the nose"),
    Shown("own_load_factor", 1, 1e3, "load factor, 1 in level flight"),
    Shown("own_airspeed_mps", 1, FAST_MPS, "true airspeed"),
    Shown("wind_known_enu_mps", 3, FAST_MPS, "velocity of the air over the ground, as the planner has it"),
    Shown("route_remaining_m", 1, FAR_M, "how far the route's goal is along the route"),
    Shown("route_error_m", 2, FAR_M, "how far the aircraft is off the route: to the left of it, above it"),
    Shown("route_direction_enu", 3, 1.0, "unit vector along the route there"),
)
"""And ``obstacles``, a row each, the nearest surface first; rows of zeros are of none."""
OBSTACLE: Final = (
    Shown("seen", 1, 1.0, "1 where the row is of an obstacle in sight, 0 where it is empty"),
    Shown("relative_pos_enu_m", 3, FAR_M, "from the aircraft to its centre"),
    Shown("vel_enu_mps", 3, FAST_MPS, "its velocity over the ground"),
    Shown("radius_m", 1, FAR_M, "its radius"),
)


def _sizes(of: Sequence[Shown]) -> Array:
    return np.concatenate([np.full(one.size, one.most) for one in of])


_MOST, MOST_OF_A_ROW = _sizes(SHOWN), _sizes(OBSTACLE)
_ENDS = np.cumsum([one.size for one in SHOWN]).tolist()
_PARTS = [(one.name, slice(end - one.size, end)) for one, end in zip(SHOWN, _ENDS, strict=True)]


class Observer:
    """Observations of one flight. What is not finite is shown as 0, and what is beyond the bounds as the bound."""

    def __init__(self, context: Context, rows: int) -> None:
        self._context, self._rows = context, rows
        self._s_m = self._left_s_m = context.begin_s_m

    def look(self, time_s: float, state: State, seen: Sequence[Seen], left_s_m: float) -> Observation:
        """What is to be seen then; called in the order of time. ``left_s_m``: where the flight last left the route."""
        if left_s_m != self._left_s_m:  # it flew on along the route meanwhile, and nobody looked
            self._left_s_m, self._s_m = left_s_m, max(self._s_m, left_s_m)
        pos, route = (state.x, state.y, state.z), self._context.route
        finite = all(map(math.isfinite, pos))
        if finite:
            self._s_m = abeam(route, self._s_m, pos)
        point, tangent, _ = route.frame(self._s_m)
        shown = (
            time_s,
            *state[:9],  # place, velocity, attitude
            state.load_factor,
            state.airspeed,
            *(self._context.wind_known(time_s, pos) if finite else STILL),
            route.length_m - self._s_m,
            *_aside(sub(pos, point), tangent),
            *tangent,
        )
        return _named(_bounded(shown, _MOST)) | {"obstacles": self._obstacles(time_s, pos, seen)}

    def end(self, record: FlightRecord, seen: Sequence[Seen], left_s_m: float) -> Observation:
        """The last instant of a flight; obstacles as they were last seen, carried straight on."""
        columns = record.columns
        if not len(columns["time_s"]):
            return nothing_to_see(self._rows)
        last = {name: column[-1].tolist() for name, column in columns.items()}
        angles = [last[f"own.{name}"] for name in ("bank_rad", "pitch_rad", "heading_rad", "load_factor", "airspeed_mps")]
        known = [*last["own.pos_enu_m"], *last["own.vel_enu_mps"], *angles]
        state = State._make(known + [math.nan] * (len(State._fields) - len(known)))
        at_goal = record.outcome is Outcome.REACHED
        return self.look(last["time_s"], state, seen, self._context.route.length_m if at_goal else left_s_m)

    def _obstacles(self, time_s: float, pos: Vec3, seen: Sequence[Seen]) -> Array:
        rows = np.zeros((self._rows, MOST_OF_A_ROW.size))
        near = sorted(seen, key=lambda one: math.dist(pos, one.at(time_s)) - one.radius_m)
        for row, one in zip(rows, near, strict=False):
            row[:] = (1.0, *sub(one.at(time_s), pos), *one.vel, one.radius_m)
        return _bounded(rows, MOST_OF_A_ROW)


def nothing_to_see(rows: int) -> Observation:
    """Of a flight that never began."""
    return _named(np.zeros(_MOST.size)) | {"obstacles": np.zeros((rows, MOST_OF_A_ROW.size))}


def _named(numbers: Array) -> Observation:
    """What is shown beside the obstacles, by name."""
    return {name: numbers[part] for name, part in _PARTS}


def _aside(off: Vec3, tangent: Vec3) -> tuple[float, float]:
    """The parts of an offset to the left of a direction and above it."""
    x, y, z = tangent
    flat = math.hypot(x, y)
    left = (-y / flat, x / flat, 0.0) if flat > 0.0 else (0.0, 1.0, 0.0)
    return dot(off, left), dot(off, (-z * left[1], z * left[0], flat))


def _bounded(values: Sequence[float] | Array, most: Array) -> Array:
    numbers = np.array(values, dtype=np.float64)
    numbers[np.isnan(numbers)] = 0.0
    return np.minimum(np.maximum(numbers, -most), most)
