"""From a threat to a new path: detection -> threat test -> method -> insertion point -> PH paths. The one place that calls ``avoid``.

One new path per new threat (policy ``once``); every decision is an event with its inputs and its result, whatever it was. The paper
applies the avoidance direction at the insertion point only (``answer: insertion_point``), so the S-turn before it is not covered by
what a velocity obstacle promises; ``answer: direct`` flies the direction at once, from where the aircraft is. How the flight comes back
is in ``rejoin.py``.

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

import math
from time import perf_counter
from typing import NamedTuple

from testbed.campaign.words.settings import FlightPlan
from testbed.core import registry
from testbed.core.chain import Chain
from testbed.core.frames import Vec3, vec3
from testbed.core.seeds import stream
from testbed.flight.path import ActivePath
from testbed.flight.planning.decision import Sighting, carried, make_event
from testbed.flight.planning.rejoin import Rejoin, joined, miss_along, ray
from testbed.flight.planning.watch import Watch
from testbed.flight.plants.base import State
from testbed.flight.record import Decision, ReplanEvent
from testbed.flight.scene import Scene
from testbed.flight.sensing.truth import detect
from testbed.flight.traffic.track import Track
from vosc import Insertion, Own, insertion_point
from vosc.methods import Avoidance, Status, avoid
from vosc.vec import add, norm, sub

STILL: Vec3 = (0.0, 0.0, 0.0)


class Memory(NamedTuple):
    """The planner's memory: names of the threats that have been answered, and from which arc length of the active path on the
    flight holds the avoidance direction until it is clear (infinite when it does not).
    """

    handled: frozenset[str] = frozenset()
    hold_from_s_m: float = math.inf


class Planner:
    """The planner of one flight; its memory goes in and comes out."""

    def __init__(self, plan: FlightPlan, scene: Scene) -> None:
        self._plan, self._scene = plan, scene
        self._method = registry.part("method", plan.method.kind, plan.plugins)
        self._rejoin = Rejoin(plan, scene)
        self._watch = Watch(scene.tracks, plan.sensor.range_m, plan.replan.swell_m)
        self._error = _wind_error(plan)
        self.slowest_s = 0.0  # wall-clock seconds of the slowest answer, from the threats to the new path

    def wind_known(self, time_s: float, pos: Vec3) -> Vec3:
        """The mean wind at a place as this planner has it."""
        settings = self._plan.replan
        if settings.vo_frame == "ground_naive" or settings.wind_known == "none":
            return STILL
        return add(self._scene.air.mean(time_s, pos), self._error)

    def step(
        self, memory: Memory, time_s: float, state: State, path: Chain, s_m: float
    ) -> tuple[Memory, ActivePath | None, ReplanEvent | None]:
        """One tick of a flight that is at ``s_m`` of ``path``: the new path, if there is one, and the event, if something was decided."""
        holding, alarmed = s_m >= memory.hold_from_s_m, self._watch.alarmed(memory.handled, time_s, state)
        if not (holding or alarmed):
            return memory, None, None
        seen = detect(self._plan.sensor, self._scene.tracks, time_s, (state.x, state.y, state.z))
        if alarmed:
            threats = self._threats(time_s, state, seen)
            if any(sighting.track.name not in memory.handled for sighting in threats):
                return self._answer(memory, time_s, state, threats, path, s_m)
        if holding:
            known = [track for track in self._scene.tracks if track.name in memory.handled or any(track is other for other, _ in seen)]
            return self._back(memory, time_s, state, known)
        return memory, None, None

    def _own(self, time_s: float, state: State) -> tuple[Own, Vec3]:
        """The aircraft in the planner's frame, and the wind that this frame moves with."""
        pos = (state.x, state.y, state.z)
        wind = self.wind_known(time_s, pos)
        return Own(pos, sub((state.vx, state.vy, state.vz), wind)), wind

    def _threats(self, time_s: float, state: State, seen: list[tuple[Track, Vec3]]) -> list[Sighting]:
        """The threats among what is seen."""
        own, wind = self._own(time_s, state)
        sightings = [Sighting.of(track, centre, own, wind, self._plan.replan) for track, centre in seen]
        return [sighting for sighting in sightings if sighting.threat.is_threat]

    def _answer(
        self, memory: Memory, time_s: float, state: State, threats: list[Sighting], path: Chain, s_m: float
    ) -> tuple[Memory, ActivePath | None, ReplanEvent]:
        """Decide on the avoidance and plan the path that does it; all threats count, old and new."""
        began = perf_counter()
        settings, kind = self._plan.replan, self._plan.method.kind
        own, wind = self._own(time_s, state)
        major = min(threats, key=lambda sighting: time_of_collision(own, sighting))
        answer = avoid(self._method, own, [sighting.obstacle for sighting in threats], **self._plan.method.options)
        memory = memory._replace(handled=memory.handled | {sighting.track.name for sighting in threats})
        insertion, new, decision = None, None, Decision.NONE
        if kind != "none" and answer.status not in (Status.AVOIDED, Status.UNSAFE):
            decision = Decision(answer.status)
        elif kind != "none":
            direct = settings.answer == "direct"
            insertion = None if direct else insertion_point(own, major.obstacle, settings.k, settings.time_rule)
            new = self._path(own, answer, insertion, wind) if direct or insertion else None
            decision = Decision.REPLANNED if new else Decision.NO_PATH if direct or insertion else Decision.NO_INSERTION_POINT
        if new is not None:
            holds = insertion is None or settings.rejoin.when == "clear"
            memory = memory._replace(hold_from_s_m=new.starts_m[-1] if holds else math.inf)
        self.slowest_s = max(self.slowest_s, perf_counter() - began)
        passing = miss_along(path, s_m, norm(add(own.vel_mps, wind)), time_s, [sighting.track for sighting in threats])
        return memory, new, make_event(time_s, decision, kind, own, major, answer, insertion, new, wind, passing)

    def _path(self, own: Own, answer: Avoidance, insertion: Insertion | None, wind: Vec3) -> ActivePath | None:
        """PH from the present state to the insertion point with the avoidance direction there, and on; or that direction at once."""
        settings = self._plan.replan
        command = add(vec3(answer.velocity_mps), wind)
        try:
            if insertion is None:
                return ActivePath((ray(own.pos_m, command),))
            start, middle = own.pos_m, carried(insertion, wind)
            there = joined(start, add(own.vel_mps, wind), middle, command, settings.magnitude_chords)
            on = (ray(middle, command),) if settings.rejoin.when == "clear" else self._rejoin.curves(middle, command)
            return ActivePath((there, *on))
        except (ValueError, ZeroDivisionError):  # coincident points; a command that stands still over the ground
            return None

    def _back(
        self, memory: Memory, time_s: float, state: State, known: list[Track]
    ) -> tuple[Memory, ActivePath | None, ReplanEvent | None]:
        """The way back, once the flight is clear."""
        path = self._rejoin.when_clear(time_s, state, known)
        if path is None:
            return memory, None, None
        own, wind = self._own(time_s, state)
        nearest = min(known, key=lambda track: math.dist(own.pos_m, track.at(time_s)) - track.radius)
        sighting = Sighting.of(nearest, nearest.at(time_s), own, wind, self._plan.replan)
        passing = miss_along(path, 0.0, norm((state.vx, state.vy, state.vz)), time_s, known)
        event = make_event(time_s, Decision.REJOINED, self._plan.method.kind, own, sighting, None, None, path, wind, passing)
        return memory._replace(hold_from_s_m=math.inf), path, event


def _wind_error(plan: FlightPlan) -> Vec3:
    """Of an estimated wind: horizontal, the same for the whole flight and for every method, plant and aircraft of the seed."""
    if plan.replan.wind_known != "estimated":
        return STILL
    east, north = plan.replan.wind_estimate_sigma_mps * stream(plan.seed, plan.replicate, "wind_estimate").normal(size=2)
    return float(east), float(north), 0.0


def time_of_collision(own: Own, sighting: Sighting) -> float:
    """t_c = (d_0 - R) / |v_o| of section 4.3.2; the least one makes the major obstacle (a standing one comes last)."""
    distance = math.dist(own.pos_m, sighting.obstacle.pos_m)
    speed = math.hypot(*sighting.obstacle.vel_mps)
    return (distance - sighting.obstacle.radius_m) / speed if speed > 0.0 else math.inf
