"""The planner that all searches in space and time share: when it is asked, what the search is told, what is done with its answer.

It is asked once for each new threat, as the paper's re-planning is (``replan.horizon_s``), unless the present path passes that threat
anyway, and plans past everything in sight. A path within all limits is flown; where the search finds none the flight stays on the path
that it is on, and the event ``no_path`` says which limit forbids the nearest candidate.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from time import thread_time
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from testbed.core.frames import Vec3
from testbed.core.units import DEG
from testbed.flight.paths.course import Course, Found, Tail
from testbed.flight.paths.validity import Ability, Pace, Spheres, asked
from testbed.flight.planning.context import STILL, Context, Step
from testbed.flight.planning.decision import Sighting, judged, make_event
from testbed.flight.planning.rejoin import miss_along
from testbed.flight.planning.replan import time_of_collision
from testbed.flight.planning.watch import Watch
from testbed.flight.plants.base import State
from testbed.flight.record import Decision, ReplanEvent
from testbed.flight.route.path import ActivePath, Path
from testbed.flight.sensing.base import Seen
from vosc import Own
from vosc.vec import norm, sub

BEYOND_S = 4.0  # waypoints lie up to so long behind the last threat ...
AGAIN_S = 8.0  # ... and a path to the route comes back to it so long behind
SHARE_AHEAD = 0.95  # of the way to the end of the path
ASIDE_RADII = 2.5  # so many times the largest distance that is kept is the farthest aside
SHORTEST_S = 1.0  # an end that is nearer is no place to plan to
STEEPER = 1e-6  # rounding of what the present state asks for

Spare = Annotated[float, Field(ge=0, le=100)]
Share = Annotated[float, Field(gt=0, le=1)]
Climb = Annotated[float, Field(gt=0, le=80)]


class Memory(NamedTuple):
    """Names of the obstacles that have been answered, or that the path was made for."""

    handled: frozenset[str] = frozenset()


class PathPlanner(ABC):
    """``spare_m`` is kept beyond each radius. A path asks for no more than ``limits_share`` of the aircraft's turn and roll rate, and
    climbs no steeper than ``climb_at_most_deg``, or than the flight does at its start or has to at its end.
    """

    name: str

    def __init__(self, spare_m: float, limits_share: float, climb_at_most_deg: float) -> None:
        self._spare_m, self._share, self._climb_deg = spare_m, limits_share, climb_at_most_deg
        self.slowest_s = 0.0

    @abstractmethod
    def search(self, course: Course, random: np.random.Generator) -> Found:
        """The best path that is found within the budget."""

    def start(self, context: Context) -> Memory:
        """Fresh memory."""
        self._context, self._settings = context, context.replan
        self._alarmed = Watch(context.replan.swell_m).alarmed
        return Memory()

    def step(self, memory: Memory, time_s: float, state: State, seen: Sequence[Seen], path: Path, s_m: float) -> Step:
        """One look of a flight that is at ``s_m`` of ``path``."""
        if not seen or norm(state[3:6]) == 0.0 or not self._alarmed(memory.handled, time_s, state, seen):
            return Step(memory)
        wind = self._context.wind_known(time_s, state[:3])
        own = Own(state[:3], sub(state[3:6], wind))
        sightings = [Sighting.of(one, time_s, own, wind, self._settings) for one in seen]
        threats = [one for one in sightings if one.obstacle.is_threat]
        new = [one for one in threats if one.seen.name not in memory.handled]
        if not any(_in_the_way(one, path, s_m, norm(state[3:6]), time_s) for one in new):
            return Step(memory)
        assert isinstance(path, ActivePath)
        return self._answered(memory, time_s, state, own, wind, sightings, path, s_m)

    def _answered(
        self, memory: Memory, time_s: float, state: State, own: Own, wind: Vec3, sightings: Sequence[Sighting], path: ActivePath, s_m: float
    ) -> Step:
        began = thread_time()
        threats = [one for one in sightings if one.obstacle.is_threat]
        course = self.course(time_s, state, sightings, path, s_m)
        found = self.search(course, self._context.random) if course else None
        new = ActivePath((*found.curves, *course.tail.curves)) if course and found and found.curves and found.keeps else None
        self.slowest_s = max(self.slowest_s, thread_time() - began)
        passing = miss_along(path, s_m, norm(state[3:6]), time_s, [one.seen for one in threats])
        major = min(threats, key=lambda one: time_of_collision(own, one))
        done = threats if new is None else sightings
        memory = Memory(memory.handled | {one.seen.name for one in done})
        reason = "" if new else found.why_not() if found else "the end of the path is too near to plan to"
        event = self._event(time_s, own, wind, major, new, passing, reason)
        return Step(memory, new, event if new is None else judged(event, new, [one.seen for one in sightings]))

    def _event(
        self, time_s: float, own: Own, wind: Vec3, major: Sighting, path: ActivePath | None, passing_m: float, reason: str
    ) -> ReplanEvent:
        decision = Decision.PLANNED if path else Decision.NO_PATH
        return make_event(time_s, decision, self.name, own, major, None, None, path, wind, passing_m, status=decision, reason=reason)

    def course(self, time_s: float, state: State, sightings: Sequence[Sighting], path: ActivePath, s_m: float) -> Course | None:
        """What the search is told; None where the end of the path is too near."""
        context, ground = self._context, norm(state[3:6])
        wind = context.wind_known(time_s, state[:3]) if context.airspeed_held else STILL
        pace = Pace(norm(sub(state[3:6], wind)), wind)
        last_s = max(one.threat.time_to_cpa_s for one in sightings if one.obstacle.is_threat)
        end_s_m = path.length_m
        if self._settings.rejoin.to == "route":
            end_s_m = min(end_s_m, s_m + ground * (last_s + AGAIN_S))
        if end_s_m - s_m < ground * SHORTEST_S:
            return None
        tail = _tail(context, path, end_s_m)
        point, tangent = np.array(state[:3]), np.array(state[3:6]) / ground
        bend = np.array(path.frame(s_m)[2])
        now = asked(tangent[None, None], bend[None, None], pace.over_ground(tangent[None, None]))
        spheres = self._spheres(point, sightings)
        steepest = max(self._climb_deg * DEG, abs(math.asin(max(-1.0, min(1.0, float(tail.tangent[2])))))) + STEEPER
        ability = Ability.of(context.limits, self._share, steepest / DEG).granting(now)
        loose = ability._replace(**{key: getattr(ability, key) * (1.0 + STEEPER) for key in ("load_max", "bank", "climb")})
        return Course(
            point,
            tangent,
            bend,
            tail,
            path,
            s_m,
            min(SHARE_AHEAD * (end_s_m - s_m), ground * (last_s + BEYOND_S)),
            ASIDE_RADII * float(spheres.kept.max()),
            pace,
            spheres,
            loose,
        )

    def _spheres(self, point: np.ndarray, sightings: Sequence[Sighting]) -> Spheres:
        """Everything in sight. Of one that is nearer already than what is to be kept, no more than the present distance can be."""
        centres = np.array([one.obstacle.pos_m for one in sightings])
        wanted = np.array([one.obstacle.radius_m + self._spare_m for one in sightings])
        kept = np.minimum(wanted, np.linalg.norm(centres - point, axis=1) * (1.0 - STEEPER))
        return Spheres(centres, np.array([one.seen.vel for one in sightings]), np.maximum(kept, STEEPER))


def _in_the_way(one: Sighting, path: Path, s_m: float, speed_mps: float, time_s: float) -> bool:
    """Does the path that the flight is on, flown on, lead into it? What threatens a straight flight may be passed already."""
    return miss_along(path, s_m, speed_mps, time_s, [one.seen]) < one.obstacle.radius_m


def _tail(context: Context, path: ActivePath, end_s_m: float) -> Tail:
    """The end of the search: the goal, or a place of the path that the flight is on and the rest of it from there on."""
    if end_s_m < path.length_m:
        point, tangent, _ = path.frame(end_s_m)
        return Tail(np.array(point), np.array(tangent), path.tail(end_s_m))
    return Tail(np.array(context.goal), np.array(context.goal_tangent))
