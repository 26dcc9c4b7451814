"""From a threat to a new path: detection -> threat test -> method -> insertion point -> PH paths. The one place that calls ``avoid``.

One new path per new threat (policy ``once``), or another when ``again.py`` asks for it; every decision is an event with its inputs and
its result, whatever it was. The paper applies the avoidance direction at the insertion point only (``answer: insertion_point``), so the
S-turn before it is not covered by what a velocity obstacle promises; ``answer: direct`` flies the direction at once, from where the
aircraft is. How the flight comes back is in ``rejoin.py``. A method that is a law over time steers instead, from the first threat until
the flight is clear (``steering.py``).

A method is given everything in sight, marked as a threat or not; what is out of sight is taken to go straight on from where it was
last seen, and counts for the way back.

In a wind (``vo_frame: air``) the decision is made in the frame that moves with the air as the planner knows it and that coincides
with the ground's at the instant of the decision. There the aircraft flies at its airspeed whatever its direction, which is what a
velocity obstacle on a sphere of that radius presumes. Positions are the same; velocities are those over the ground less the wind W.
Threat, closest approach and cone depend on relative velocities only and are the same in both frames; the sphere, the cap, the
avoidance direction and the insertion point are not:

    own straight flight to Q at airspeed V for a time t:          |Q - P| = V t         Q ahead of the obstacle in the air
    the same, seen from the ground:                               Q_g = Q + W t         the air has carried the point along
    velocity commanded there:                                     v_g = v + W           |v| = V

The straight line from P to Q in the air is the straight line from P to Q_g over the ground, flown in the same t, so nothing of the
insertion rule is lost. The curves are then PH over the ground, from v_g now through Q_g with v_g to the goal. ``ground_naive`` does
all this with the velocities over the ground, as if the present ground speed could be kept in any direction: W = 0 in the above.
"""

import inspect
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from time import thread_time
from typing import Any, NamedTuple

from testbed.campaign.words.planning import completed
from testbed.core.chain import FEW
from testbed.core.frames import Vec3, vec3
from testbed.flight.impossible import NoWayError
from testbed.flight.planning.again import Again, Past
from testbed.flight.planning.context import STILL, Answer, Context, Pending, Step
from testbed.flight.planning.decision import Sighting, carried, judged, make_event
from testbed.flight.planning.flyable_way import flyable_way
from testbed.flight.planning.rejoin import Rejoin, Way, joined, miss_along, ray
from testbed.flight.planning.steering import SteeringLaw, steered
from testbed.flight.planning.watch import Watch
from testbed.flight.plants.base import State
from testbed.flight.record import ANSWERED, Decision, inside
from testbed.flight.route.path import ActivePath, Path
from testbed.flight.sensing.base import Seen
from vosc import Insertion, Own, insertion_point, ph
from vosc.methods import Avoidance, Status, avoid
from vosc.vec import add, dot, norm, scale, sub

HELD_ON_S = 1.0  # so long before its end a path that is held is left, whatever the way back
AGAIN_S = 0.5  # after so long a way back to a route of many pieces is looked for again: the search takes long
NO_ONE: Mapping[str, Seen] = {}


class Memory(NamedTuple):
    """The planner's memory: names of the threats that have been answered; from which arc length of the active path on the flight
    looks for the way back (infinite when it does not, and from anywhere while a law steers); every obstacle as it was last seen, for
    flights that look for one; the memory of the law that steers, in a tuple (None when none does); what the arc length of the route is
    more than that of the active path (NaN while it is elsewhere); the arc length at which the flight left the route; the time before
    which no way back is looked for again; and what the last decision foretold, where threats are answered again.
    """

    handled: frozenset[str] = frozenset()
    hold_from_s_m: float = math.inf
    known: Mapping[str, Seen] = NO_ONE
    law: tuple[Any] | None = None
    ahead_m: float = 0.0
    left_s_m: float = 0.0
    not_before_s: float = -math.inf
    past: Past | None = None


class Avoided(NamedTuple):
    """What came of a threat: the decision, the method's answer, the insertion point, the way through it; why there is no way."""

    decision: Decision
    answer: Avoidance | None = None
    insertion: Insertion | None = None
    way: Way | None = None
    reason: str = ""


class Replanner:
    """The planner of one flight. ``start`` tells it which; what it remembers goes in and comes out."""

    def __init__(self) -> None:
        self.slowest_s = 0.0  # processor seconds of the slowest answer, from the threats to the new path, or of a law's slowest step

    def start(self, context: Context) -> Memory:
        self._context, self._settings = context, context.replan
        part, options = context.method.part, context.method.options
        law: Any = part(**options) if inspect.isclass(part) else None
        self._law: SteeringLaw | None = law
        self._comes_back = law is not None or self._settings.answer == "direct" or self._settings.rejoin.when == "clear"
        self._again = Again(context.replan) if context.replan.policy != "once" else None
        self._comes_back = self._comes_back or self._again is not None
        self._again_s = AGAIN_S if len(context.route.curves) > FEW else 0.0
        self._rejoin, self._alarmed = Rejoin(context), Watch(context.replan.swell_m).alarmed
        return Memory()

    def step(self, memory: Memory, time_s: float, state: State, seen: Sequence[Seen], path: Path, s_m: float) -> Answer:
        """One look of a flight that is at ``s_m`` of ``path``: the new path, if there is one, and the event, if something was decided."""
        holds = s_m >= memory.hold_from_s_m
        if not (seen or holds):
            return memory, None, None
        handled = memory.handled
        if self._comes_back and seen and handled:
            memory = memory._replace(known={**memory.known, **{one.name: one for one in seen}})
        if memory.law is not None:
            return self._steered(memory, time_s, state, seen, s_m)
        if self._alarmed(handled, time_s, state, seen):
            own, wind = self._own(time_s, state)
            sightings = [Sighting.of(one, time_s, own, wind, self._settings) for one in seen]
            if any(sighting.obstacle.is_threat and sighting.seen.name not in memory.handled for sighting in sightings):
                return self._noted(self._answer(memory, time_s, state, sightings, path, s_m), time_s, state, seen, path, s_m)
        if self._again and memory.past and seen:
            past, why = self._again.asked(memory.past, time_s, state, seen, path, s_m)
            memory = memory._replace(past=past)
            if why:
                return self._noted(self._changed(memory, time_s, state, seen, path, s_m, why), time_s, state, seen, path, s_m)
        ends = path.lasting and s_m >= path.length_m - HELD_ON_S * norm((state.vx, state.vy, state.vz))
        return self._noted(self._back(memory, time_s, state, seen, ends), time_s, state, seen, path, s_m) if holds else (memory, None, None)

    def _own(self, time_s: float, state: State) -> tuple[Own, Vec3]:
        """The aircraft in the planner's frame, and the wind that this frame moves with."""
        pos = (state.x, state.y, state.z)
        wind = STILL if self._settings.vo_frame == "ground_naive" else self._context.wind_known(time_s, pos)
        return Own(pos, sub((state.vx, state.vy, state.vz), wind)), wind

    def _noted(self, step: Step, time_s: float, state: State, seen: Sequence[Seen], path: Path, s_m: float) -> Step:
        """The step, with what its decision foretells where threats are answered again. A law that steers is asked all the time."""
        memory: Memory = step.memory
        if self._again is None or step.event is None or memory.law is not None or isinstance(step.path, Pending):
            return step
        on, from_m = (path, s_m) if step.path is None else (step.path, step.path.begin_s_m)
        past, not_before_s = self._again.past(time_s, state, seen, on, from_m), time_s + self._settings.again.hold_s
        return step._replace(memory=memory._replace(past=past, not_before_s=max(memory.not_before_s, not_before_s)))

    def _changed(self, memory: Memory, time_s: float, state: State, seen: Sequence[Seen], path: Path, s_m: float, why: str) -> Step:
        """Decide anew. Where straight on is no threat and the path ahead is one: straight on, until the way back is clear."""
        own, wind = self._own(time_s, state)
        sightings = [Sighting.of(one, time_s, own, wind, self._settings) for one in seen]
        if any(sighting.obstacle.is_threat for sighting in sightings):
            return self._answer(memory, time_s, state, sightings, path, s_m, why)
        velocity, kind = (state.vx, state.vy, state.vz), self._context.method.kind
        kept = [miss_along(path, s_m, norm(velocity), time_s, [one.seen]) - one.obstacle.radius_m for one in sightings]
        clearance_m, major = min(zip(kept, sightings, strict=True), key=lambda one: one[0])
        passing = clearance_m + major.obstacle.radius_m
        if not inside(clearance_m):
            event = make_event(time_s, Decision.KEPT, kind, own, major, None, None, None, wind, passing, Decision.KEPT, why)
            return Step(memory, None, event)
        new = ActivePath((ray(own.pos_m, velocity),))
        event = make_event(time_s, Decision.HELD, kind, own, major, None, None, new, wind, passing, Decision.HELD, why)
        known = {**memory.known, **{one.name: one for one in seen}}
        handled, left_s_m = memory.handled | {major.seen.name}, self._left(memory, s_m)
        memory = memory._replace(handled=handled, known=known, left_s_m=left_s_m, hold_from_s_m=0.0, ahead_m=math.nan)
        return Step(memory, new, replace(event, command_enu_mps=velocity, deflection_rad=0.0))

    def _left(self, memory: Memory, s_m: float) -> float:
        """Arc length at which a flight leaves the route that leaves its path at ``s_m``."""
        left_s_m = memory.left_s_m if math.isnan(memory.ahead_m) else max(memory.left_s_m, s_m + memory.ahead_m)
        return min(left_s_m, self._context.route.length_m)

    def _answer(
        self, memory: Memory, time_s: float, state: State, sightings: Sequence[Sighting], path: Path, s_m: float, again: str = ""
    ) -> Step:
        """Decide on the avoidance and plan the path that does it; all threats count, old and new. ``again``: why another time."""
        began = thread_time()
        own, wind = self._own(time_s, state)
        threats = [sighting for sighting in sightings if sighting.obstacle.is_threat]
        major = min(threats, key=lambda sighting: time_of_collision(own, sighting))
        known = {**memory.known, **{sighting.seen.name: sighting.seen for sighting in sightings}}
        handled = memory.handled | {sighting.seen.name for sighting in threats}
        memory = memory._replace(handled=handled, known=known, left_s_m=self._left(memory, s_m))
        passing = miss_along(path, s_m, norm(add(own.vel_mps, wind)), time_s, [sighting.seen for sighting in threats])
        kind, did, new = self._context.method.kind, Avoided(Decision.STEERED), None
        if self._law is not None:
            memory = memory._replace(law=(self._law.start(self._context),), hold_from_s_m=-math.inf, ahead_m=math.nan)
        else:
            did = self._avoided(own, wind, state.bank, sightings, major, (memory.left_s_m, path.frame(s_m)[2]))
            new = ActivePath(did.way.curves) if did.way else None
            if new and again and self._again and not self._again.better(time_s, state, [one.seen for one in sightings], path, s_m, new):
                new, did = None, did._replace(decision=Decision.KEPT, way=None, reason="another path is no better")
            if did.way and new:
                holds = did.insertion is None or self._settings.rejoin.when == "clear"
                memory = memory._replace(hold_from_s_m=new.starts_m[-1] if holds else math.inf, ahead_m=did.way.ahead_m)
        self.slowest_s = max(self.slowest_s, thread_time() - began)
        decision, reason = did.decision, did.reason
        if again:
            decision = decision if decision in ANSWERED else Decision.KEPT
            reason = f"{again}; {reason}" if reason else again
        event = make_event(
            time_s,
            decision,
            kind,
            own,
            major,
            did.answer,
            did.insertion,
            new,
            wind,
            passing,
            status=Decision.STEERED,
            reason=reason,
        )
        if new is not None:
            event = judged(event, new, [sighting.seen for sighting in sightings])
        if memory.law is not None:
            return self._steer(memory, time_s, state, [sighting.seen for sighting in sightings], s_m)._replace(event=event)
        return Step(memory, new, event)

    def _avoided(
        self, own: Own, wind: Vec3, bank_rad: float, sightings: Sequence[Sighting], major: Sighting, path_now: tuple[float, Vec3]
    ) -> "Avoided":
        """``path_now``: the arc length at which the flight left the route, and the curvature vector of the path that it is on, 1/m."""
        settings, (kind, method, given) = self._settings, self._context.method
        goal = partial(heading_for, sub(self._context.goal, own.pos_m), norm(own.vel_mps), wind)
        answer = avoid(method, own, [sighting.obstacle for sighting in sightings], **completed(given, goal, bank_rad))
        if kind == "none" or answer.status not in (Status.AVOIDED, Status.UNSAFE):
            return Avoided(Decision.NONE if kind == "none" else Decision(answer.status), answer)
        left_s_m, bend = path_now
        insertion, there = None, None
        try:
            if settings.answer == "insertion_point":
                rule = (settings.k, settings.time_rule, settings.insertion_side, settings.arrival_root)
                insertion = insertion_point(own, major.obstacle, *rule)
                if insertion is None:
                    return Avoided(Decision.NO_INSERTION_POINT, answer)
                if settings.path == "flyable":
                    threats = [sighting.obstacle for sighting in sightings if sighting.obstacle.is_threat]
                    limits = self._context.limits
                    there, answer, insertion = flyable_way(own, answer, threats, major.obstacle, wind, bend, limits, settings.search, rule)
            return Avoided(Decision.REPLANNED, answer, insertion, self._way(own, answer, insertion, there, wind, left_s_m))
        except NoWayError as error:  # coincident points; a command that stands still over the ground; nothing flyable
            return Avoided(Decision.NO_PATH, answer, insertion, reason=str(error))

    def _way(self, own: Own, answer: Avoidance, insertion: Insertion | None, there: ph.Curve | None, wind: Vec3, left_s_m: float) -> Way:
        """PH from the present state to the insertion point with the avoidance direction there (``there``, where it is found already), and
        on; or that direction at once. Raises ``NoWayError``.
        """
        settings = self._settings
        command = add(vec3(answer.velocity_mps), wind)
        if insertion is None:
            return Way((ray(own.pos_m, command),))
        start, middle = own.pos_m, carried(insertion, wind)
        there = there or joined(start, add(own.vel_mps, wind), middle, command, settings.magnitude_chords)
        if settings.rejoin.when == "clear":
            return Way((there, ray(middle, command)))
        on = self._rejoin.way(middle, command, left_s_m, now=True)
        return Way((there, *on.curves), on.ahead_m - there.length_m)

    def _steered(self, memory: Memory, time_s: float, state: State, seen: Sequence[Seen], s_m: float) -> Step:
        """The way back, once the flight is clear; until then what the law says."""
        back = self._back(memory, time_s, state, seen, ends=False)
        if back.path is None or isinstance(back.path, Pending):
            return self._steer(memory, time_s, state, seen, s_m)
        return self._noted(back, time_s, state, seen, back.path, 0.0)

    def _steer(self, memory: Memory, time_s: float, state: State, seen: Sequence[Seen], s_m: float) -> Step:
        """The path for one step."""
        assert self._law is not None
        assert memory.law is not None
        began = thread_time()
        answer = self._law.steer(memory.law[0], time_s, state, seen)
        self.slowest_s = max(self.slowest_s, thread_time() - began)
        if not (isinstance(answer, tuple) and len(answer) == 2):
            raise ValueError(f"a law must return (memory, Steer), not {answer!r}")
        return Step(memory._replace(law=answer[:1]), steered(answer[1], state, s_m))

    def _back(self, memory: Memory, time_s: float, state: State, seen: Sequence[Seen], ends: bool) -> Step:
        """The way back, once the flight is clear of what was answered and of what is in sight. ``ends``: the path that is held does."""
        in_sight = {one.name for one in seen}
        known = [one for name, one in memory.known.items() if name in memory.handled or name in in_sight]
        if time_s < memory.not_before_s:
            return Step(memory)
        try:
            way = self._rejoin.when_clear(time_s, state, known, memory.left_s_m, ends)
        except NoWayError:
            return Step(memory._replace(not_before_s=time_s + self._again_s))
        if way is None:
            return Step(memory)
        path = ActivePath(way.curves)
        own, wind = self._own(time_s, state)
        nearest = min(known, key=lambda one: math.dist(own.pos_m, one.at(time_s)) - one.radius_m)
        sighting = Sighting.of(nearest, time_s, own, wind, self._settings)
        passing = miss_along(path, 0.0, norm((state.vx, state.vy, state.vz)), time_s, known)
        event = make_event(time_s, Decision.REJOINED, self._context.method.kind, own, sighting, None, None, path, wind, passing)
        return Step(memory._replace(hold_from_s_m=math.inf, law=None, ahead_m=way.ahead_m), path, event)


def heading_for(way: Vec3, airspeed_mps: float, wind: Vec3) -> Vec3:
    """The direction through the air that leads over the ground along ``way``; ``way`` itself where the wind is too strong for that."""
    size = norm(way)
    if size == 0.0 or not airspeed_mps > 0.0:
        return way if size > 0.0 else (0.0, 0.0, 1.0)
    on = scale(1.0 / size, way)
    with_it = dot(on, wind)
    left = airspeed_mps**2 - dot(wind, wind) + with_it**2
    return sub(scale(with_it + math.sqrt(left), on), wind) if left > 0.0 else on


def time_of_collision(own: Own, sighting: Sighting) -> float:
    """t_c = (d_0 - R) / |v_o| of section 4.3.2; the least one makes the major obstacle (a standing one comes last)."""
    distance = math.dist(own.pos_m, sighting.obstacle.pos_m)
    speed = math.hypot(*sighting.obstacle.vel_mps)
    return (distance - sighting.obstacle.radius_m) / speed if speed > 0.0 else math.inf
