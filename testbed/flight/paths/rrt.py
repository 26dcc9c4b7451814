"""Rapidly exploring random trees over place, direction and time, by the Open Motion Planning Library (the extra ``rrt``).

LaValle and Kuffner (2001): the kinodynamic tree, whose states carry the time at which they are reached, so that a state is free or not
where the spheres are then. The geometric RRT* asks about places without the way that led there, and its rewiring changes when a place
is reached, so that t = s/V has no meaning in it; instead several trees are grown one after the other and the best path of all is taken
(Ferguson and Stentz 2006). States of a tree's path become waypoints of PH curves.
"""

import math
from collections.abc import Callable
from itertools import combinations
from typing import Annotated, Any, NamedTuple

import numpy as np
from pydantic import Field

from testbed.core.units import G0_MPS2
from testbed.flight.paths.course import Course, Found, better
from testbed.flight.paths.planner import Climb, PathPlanner, Share, Spare
from testbed.flight.paths.validity import FORBIDS, Ability
from vosc.vec import FloatArray

STEP_S = 0.2  # of a tree's states
STEPS = (1, 6)  # so many of them with one control
GENTLER = 0.9  # a tree turns with so much of what a path may: curves through its states turn tighter here and there
GOAL_BIAS = 0.15
WITHIN_M = 40.0  # the end of a tree lies so near to the present path again
LATER = 1.5  # a tree takes at most so much longer than the present path
AT_MOST = 10  # so many states of a tree's path are tried as waypoints
MISSING = "the planner rrt needs a package that is not installed: pip install 'vosc-testbed[rrt]'"


class RandomTree(PathPlanner):
    """``trees`` are grown, each until it comes back to the present path or ``states`` states have been looked at."""

    name = "rrt"

    def __init__(
        self,
        trees: Annotated[int, Field(ge=1, le=1000)] = 10,
        states: Annotated[int, Field(ge=10, le=1_000_000)] = 4000,
        spare_m: Spare = 5.0,
        limits_share: Share = 0.9,
        climb_at_most_deg: Climb = 20.0,
    ) -> None:
        super().__init__(spare_m, limits_share, climb_at_most_deg)
        library()
        self._trees, self._states = trees, states

    def search(self, course: Course, random: np.random.Generator) -> Found:
        """The best path through states of any of the trees."""
        found = Found(None, np.full(len(FORBIDS), math.inf), 0)
        for seed in random.integers(1, 2**31, self._trees).tolist():
            states, looked = grown(course, seed, self._states)
            through = _through(course, states) if len(states) else found
            found = better(found, through)._replace(looked=found.looked + looked)
        return found


def library() -> tuple[Any, Any, Any]:
    """``ompl.base``, ``ompl.control``, ``ompl.util``. Raises ``ValueError`` in words where the package is not installed."""
    try:
        from ompl import base, control, util
    except ImportError:
        raise ValueError(MISSING) from None
    util.setLogLevel(util.LOG_NONE)
    return base, control, util


class Turns(NamedTuple):
    """How a tree may turn: rates of heading and of climb, rad/s, and the climb, rad."""

    heading: float
    climb_rate: float
    climb: float

    @classmethod
    def of(cls, ability: Ability, speed_mps: float) -> "Turns":
        sideways = min(math.tan(min(ability.bank, 1.5)), math.sqrt(max(ability.load_max**2 - 1.0, 0.0)))
        upwards = min(ability.load_max - 1.0, 1.0 - ability.load_min)
        most = GENTLER * G0_MPS2 / speed_mps
        return cls(most * sideways, most * max(upwards, 0.05), ability.climb)


def grown(course: Course, seed: int, budget: int) -> tuple[FloatArray, int]:
    """The states (n,6) of one tree's path, x, y, z, heading, climb, time, without the first; none where it found none. And how many were
    looked at.
    """
    base, control, util = library()
    util.RNG.setSeed(seed)
    speed = course.pace.speed_mps
    turns, looked = Turns.of(course.ability, speed), 0
    free = _free(course)

    def is_free(state: Any) -> bool:
        nonlocal looked
        looked += 1
        return abs(state[4]) <= turns.climb and free(state[0], state[1], state[2], state[5])

    space = base.RealVectorStateSpace(6)
    low, high = _box(course)
    space.setBounds(_bounds(base, low, high))
    controls = control.RealVectorControlSpace(space, 2)
    most = np.array([turns.heading, turns.climb_rate])
    controls.setBounds(_bounds(base, -most, most))
    setup = control.SimpleSetup(controls)
    information = setup.getSpaceInformation()
    information.setPropagationStepSize(STEP_S)
    information.setMinMaxControlDuration(*STEPS)
    setup.setStatePropagator(_moved(course))
    setup.setStateValidityChecker(is_free)
    begin, end = space.allocState(), space.allocState()
    for state, values in ((begin, _state(course.point, course.tangent, 0.0)), (end, _end(course))):
        for k, value in enumerate(values):
            state[k] = value
    setup.setStartAndGoalStates(begin, end, WITHIN_M)
    planner = control.RRT(information)
    planner.setGoalBias(GOAL_BIAS)
    setup.setPlanner(planner)
    setup.solve(base.PlannerTerminationCondition(lambda: looked >= budget))
    if not setup.haveExactSolutionPath():
        return np.empty((0, 6)), looked
    path = setup.getSolutionPath()
    return np.array([[path.getState(i)[k] for k in range(6)] for i in range(1, path.getStateCount())]), looked


def _bounds(base: Any, low: FloatArray, high: FloatArray) -> Any:
    bounds = base.RealVectorBounds(len(low))
    for k, (least, most) in enumerate(zip(low.tolist(), high.tolist(), strict=True)):
        bounds.setLow(k, least)
        bounds.setHigh(k, most)
    return bounds


def _state(point: FloatArray, tangent: FloatArray, time_s: float) -> list[float]:
    x, y, z = tangent.tolist()
    return [*point.tolist(), math.atan2(y, x), math.asin(max(-1.0, min(1.0, z))), time_s]


def _end(course: Course) -> list[float]:
    """A place of the present path as far ahead as waypoints go, when the flight would be there; its heading counted from the start's."""
    points, tangents, _, _ = course.frames(np.array([course.reach_m]))
    state = _state(points[0], tangents[0], course.reach_m / float(course.pace.over_ground(course.tangent)))
    began = math.atan2(course.tangent[1], course.tangent[0])
    state[3] = began + math.remainder(state[3] - began, 2.0 * math.pi)
    return state


def _box(course: Course) -> tuple[FloatArray, FloatArray]:
    """Least and greatest state: all that is not too far aside of the present path."""
    points = np.vstack([course.frames(np.linspace(0.0, course.reach_m, 33))[0], course.point])
    began, lasts = math.atan2(course.tangent[1], course.tangent[0]), LATER * _end(course)[5]
    low = np.array([*(points.min(axis=0) - course.aside_m), began - math.pi, -course.ability.climb, 0.0])
    high = np.array([*(points.max(axis=0) + course.aside_m), began + math.pi, course.ability.climb, lasts])
    return low, high


def _free(course: Course) -> Callable[[float, float, float, float], bool]:
    """Is a place outside of every sphere at a time?"""
    spheres = [(*c, *v, r * r) for c, v, r in zip(*(x.tolist() for x in course.spheres), strict=True)]

    def free(x: float, y: float, z: float, time_s: float) -> bool:
        for cx, cy, cz, vx, vy, vz, square in spheres:
            dx, dy, dz = x - cx - vx * time_s, y - cy - vy * time_s, z - cz - vz * time_s
            if dx * dx + dy * dy + dz * dz < square:
                return False
        return True

    return free


def _moved(course: Course) -> Callable[[Any, Any, float, Any], None]:
    """From a state by a control for a time: rates of heading and climb are held, the place moves with the direction in the middle."""
    speed, (wx, wy, wz) = course.pace.speed_mps, course.pace.wind

    def moved(state: Any, control: Any, lasts_s: float, after: Any) -> None:
        heading, climb = state[3] + 0.5 * lasts_s * control[0], state[4] + 0.5 * lasts_s * control[1]
        flat = math.cos(climb)
        tx, ty, tz = flat * math.cos(heading), flat * math.sin(heading), math.sin(climb)
        along = tx * wx + ty * wy + tz * wz
        over_ground = along + math.sqrt(max(speed * speed - (wx * wx + wy * wy + wz * wz - along * along), 0.0))
        step = lasts_s * over_ground
        after[0], after[1], after[2] = state[0] + step * tx, state[1] + step * ty, state[2] + step * tz
        after[3], after[4], after[5] = state[3] + lasts_s * control[0], state[4] + lasts_s * control[1], state[5] + lasts_s

    return moved


def _through(course: Course, states: FloatArray) -> Found:
    """The best path through one, two or three of the states."""
    states = states[np.unique(np.linspace(0, len(states) - 1, min(len(states), AT_MOST)).round().astype(int))]
    flat = np.cos(states[:, 4])
    tangents = np.stack([flat * np.cos(states[:, 3]), flat * np.sin(states[:, 3]), np.sin(states[:, 4])], axis=1)
    found = Found(None, np.full(len(FORBIDS), math.inf), 0)
    for count in (1, 2):
        chosen = np.array(list(combinations(range(len(states)), count)), dtype=int)
        if not len(chosen):
            continue
        for ease in (0.0, 1.0):
            pieces = course.joined(states[chosen, :3], tangents[chosen], np.full((len(chosen), count + 1), ease))
            found = better(found, course.best(pieces, course.cost(pieces)[0], 0))
    return found
