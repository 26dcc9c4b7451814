"""A planner of somebody's own: ``step(memory, time_s, state, seen) -> (memory, path or None)``.

Its path may be PH curves (``vosc.ph``), one or a sequence of them joined end to end, a ``Chain``, or points (n,3) to fly through. It
begins where the aircraft is, or passes there; one of more than eight pieces begins there. Every new path is an event.
"""

import inspect
import math
from collections.abc import Sequence
from itertools import pairwise
from time import thread_time
from typing import Any

import numpy as np

from testbed.core.chain import FEW, Chain
from testbed.core.frames import Vec3, vec3
from testbed.flight.planning.context import Context, Planner, Step
from testbed.flight.planning.decision import NAN, NO_POINT, Sighting, make_event
from testbed.flight.planning.rejoin import joined, miss_along
from testbed.flight.plants.base import State
from testbed.flight.record import Decision, ReplanEvent
from testbed.flight.route.path import ActivePath, Path
from testbed.flight.sensing.base import Seen
from vosc import Own, ph
from vosc.vec import norm, sub

APART_M = 1e-6  # pieces that are farther apart are not joined
ASIDE_M = 20.0  # a path that passes the aircraft farther away than this was made for another place


class OwnPlanner:
    """A planner that is given what it sees, asked as the loop asks."""

    def __init__(self, kind: str, planner: Any) -> None:
        self._kind, self._planner = kind, planner
        self.slowest_s = 0.0

    def start(self, context: Context) -> Any:
        self._context = context
        return self._planner.start(context)

    def step(self, memory: Any, time_s: float, state: State, seen: Sequence[Seen], path: Path, s_m: float) -> Step:
        began = thread_time()
        answer = self._planner.step(memory, time_s, state, seen)
        if not (isinstance(answer, tuple) and len(answer) == 2):
            raise ValueError(f"the planner {self._kind} must return (memory, path or None), not {answer!r}")
        memory, found = answer
        if found is None:
            return Step(memory)
        new = path_of(found, state)
        self.slowest_s = max(self.slowest_s, thread_time() - began)
        return Step(memory, new, self._event(time_s, state, seen, new, miss_along(path, s_m, norm(state[3:6]), time_s, seen)))

    def _event(self, time_s: float, state: State, seen: Sequence[Seen], path: ActivePath, passing: float) -> ReplanEvent:
        """What is known of the decision: the aircraft, the nearest obstacle in sight, and the path."""
        pos, replan = (state.x, state.y, state.z), self._context.replan
        wind = self._context.wind_known(time_s, pos)
        own = Own(pos, sub((state.vx, state.vy, state.vz), wind))
        nearest = min(seen, key=lambda one: math.dist(pos, one.at(time_s)) - one.radius_m, default=None)
        if nearest is None:
            return _unprompted(time_s, self._kind, state, path, wind)
        sighting = Sighting.of(nearest, time_s, own, wind, replan)
        return make_event(time_s, Decision.PLANNED, self._kind, own, sighting, None, None, path, wind, passing, status=Decision.PLANNED)


def asked(kind: str, planner: Any) -> Planner:
    """A planner as the loop asks it: as it is when it asks for the active path itself, else behind ``OwnPlanner``."""
    takes = inspect.signature(planner.step).parameters
    made: Planner = planner if "s_m" in takes else OwnPlanner(kind, planner)
    return made


def path_of(answer: Any, state: State) -> ActivePath:
    """A planner's answer as a path on which the aircraft is at ``begin_s_m``. ``ValueError`` in words when it is none."""
    curves = answer.curves if isinstance(answer, Chain) else (answer,) if isinstance(answer, ph.Curve) else answer
    if not (isinstance(curves, Sequence) and curves and all(isinstance(curve, ph.Curve) for curve in curves)):
        curves = _through(answer, state)
    for before, after in pairwise(curves):
        if (gap := math.dist(before.frame(before.length_m)[0], after.frame(0.0)[0])) > APART_M:
            raise ValueError(f"the planner's path has a gap of {gap:.3g} m between two of its pieces")
    path = ActivePath(curves)
    if len(path.curves) <= FEW:
        s_m = float(path.nearest(np.array([state[:3]]))[0][0])
        path.begin_s_m = min(max(s_m, 0.0), path.length_m)
    if not (aside_m := math.dist(path.frame(path.begin_s_m)[0], state[:3])) <= ASIDE_M:
        where = (
            "begin where the aircraft is, or pass there" if len(path.curves) <= FEW else "begin where the aircraft is: it has many pieces"
        )
        raise ValueError(f"the planner's path must {where} (within {ASIDE_M:g} m), not {aside_m:.1f} m from it")
    return path


def _through(points: Any, state: State) -> tuple[ph.Curve, ...]:
    """PH curves through points (n,3), from the first to the last; along the velocity where the aircraft is at the first of them."""
    try:
        there = np.asarray(points, dtype=float)
    except (TypeError, ValueError):
        there = np.empty(0)
    if there.ndim != 2 or there.shape[1] != 3 or len(there) < 2 or not np.isfinite(there).all():
        raise ValueError("the planner's path must be PH curves or finite points (n,3), at least two")
    steps = np.diff(there, axis=0)
    if not np.linalg.norm(steps, axis=1).all():
        raise ValueError("the planner's path has the same point twice in a row")
    directions = np.vstack([steps[:1], steps[:-1] + steps[1:], steps[-1:]])
    if math.dist(there[0], state[:3]) < 1.0:
        directions[0] = state[3:6]
    ends = list(zip(map(vec3, there), map(vec3, directions), strict=True))
    return tuple(joined(a, along, b, on, 1.0) for (a, along), (b, on) in pairwise(ends))


def _unprompted(time_s: float, kind: str, state: State, path: ActivePath, wind: Vec3) -> ReplanEvent:
    """The event of a path that nothing in sight asked for."""
    return ReplanEvent(
        time_s=time_s,
        obstacle="",
        decision=Decision.PLANNED,
        method=kind,
        status=Decision.PLANNED,
        own_pos_enu_m=(state.x, state.y, state.z),
        own_vel_enu_mps=(state.vx, state.vy, state.vz),
        obstacle_pos_enu_m=NO_POINT,
        obstacle_vel_enu_mps=NO_POINT,
        radius_m=NAN,
        alpha_rad=NAN,
        alpha0_rad=NAN,
        time_to_cpa_s=NAN,
        miss_m=NAN,
        route_miss_m=NAN,
        cap_radius_mps=NAN,
        cap_azimuth_rad=NAN,
        cap_elevation_rad=NAN,
        cap_half_angle_rad=NAN,
        command_enu_mps=NO_POINT,
        deflection_rad=NAN,
        margin_rad=NAN,
        insertion_enu_m=NO_POINT,
        insertion_time_s=NAN,
        max_curvature_to_insertion_1pm=NAN,
        max_curvature_to_goal_1pm=max(curve.max_curvature() for curve in path.curves),
        planned_length_m=path.length_m,
        wind_known_enu_mps=wind,
    )
