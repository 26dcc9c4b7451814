"""From a threat to a new path: detection -> threat test -> method -> insertion point -> PH paths. The one place that calls ``avoid``.

One new path per new threat (policy ``once``); every decision is an event with its inputs and its result, whatever it was.
"""

import math
from typing import NamedTuple

from testbed.flight.path import ActivePath
from testbed.flight.plants.base import State
from testbed.flight.scene import Scene
from testbed.flight.sensor import detect
from testbed.flight.traffic import Track
from testbed.frames import Vec3, vec3
from testbed.spec.model import FlightPlan
from testbed.types import ReplanEvent
from vosc import Insertion, Obstacle, Own, Threat, cap, insertion_point, ph, threat
from vosc.methods import Avoidance, avoid

NAN = math.nan
NOWHERE: Vec3 = (NAN, NAN, NAN)
Handled = frozenset[str]
"""The planner's memory: names of the threats that have been answered."""


class Sighting(NamedTuple):
    """An obstacle in range that threatens."""

    track: Track
    obstacle: Obstacle
    threat: Threat


def may_threaten(state: State, track: Track, centre: Vec3) -> bool:
    """A necessary condition of the threat test in a microsecond, so that the test itself runs only where it may say yes."""
    px, py, pz = centre[0] - state.x, centre[1] - state.y, centre[2] - state.z
    wx, wy, wz = state.vx - track.vel[0], state.vy - track.vel[1], state.vz - track.vel[2]
    closing = px * wx + py * wy + pz * wz
    if closing <= 0.0:
        return False
    square = px * px + py * py + pz * pz
    # least distance of the straight lines, squared, against the radius; the allowance is for rounding only
    return square - closing * closing / (wx * wx + wy * wy + wz * wz) <= 1.000001 * track.radius * track.radius + 1e-9 * square


class Planner:
    """The planner of one flight; its memory goes in and comes out."""

    def __init__(self, plan: FlightPlan, scene: Scene) -> None:
        self._plan, self._scene = plan, scene

    def step(self, handled: Handled, time_s: float, state: State) -> tuple[Handled, ActivePath | None, ReplanEvent | None]:
        """One tick: the new path, if there is one, and the event, if there was a new threat."""
        own_pos = (state.x, state.y, state.z)
        seen = detect(self._plan.sensor, self._scene.tracks, time_s, own_pos)
        if not any(track.name not in handled and may_threaten(state, track, centre) for track, centre in seen):
            return handled, None, None
        own = Own(own_pos, (state.vx, state.vy, state.vz))
        threats = []
        for track, centre in seen:
            obstacle = Obstacle(centre, track.vel, track.radius)
            found = threat(own, obstacle, self._plan.replan.horizon_s)
            if found.is_threat:
                threats.append(Sighting(track, obstacle, found))
        if all(sighting.track.name in handled for sighting in threats):
            return handled, None, None
        path, event = self._answer(time_s, own, threats)
        return handled | {sighting.track.name for sighting in threats}, path, event

    def _answer(self, time_s: float, own: Own, threats: list[Sighting]) -> tuple[ActivePath | None, ReplanEvent]:
        settings = self._plan.replan
        major = min(threats, key=lambda sighting: time_of_collision(own, sighting))
        answer = avoid(self._plan.method.kind, own, [sighting.obstacle for sighting in threats], **self._plan.method.options)
        insertion, path, decision = None, None, answer.status
        if self._plan.method.kind == "none":
            decision = "none"
        elif answer.status in ("avoided", "unsafe"):
            insertion = insertion_point(own, major.obstacle, settings.k, settings.time_rule)
            path = self._path(own, answer, insertion) if insertion else None
            decision = "replanned" if path else ("no_path" if insertion else "no_insertion_point")
        return path, make_event(time_s, decision, self._plan.method.kind, own, major, answer, insertion, path)

    def _path(self, own: Own, answer: Avoidance, insertion: Insertion) -> ActivePath | None:
        """PH from the present state to the insertion point with the avoidance direction there, and PH on to the goal."""
        chords = self._plan.replan.magnitude_chords
        start, middle, goal = own.pos_m, vec3(insertion.point_m), self._scene.goal
        command = vec3(answer.velocity_mps)
        first, second = chords * math.dist(start, middle), chords * math.dist(middle, goal)
        try:
            there = ph.hermite(start, resized(own.vel_mps, first), middle, resized(command, first))
            on = ph.hermite(middle, resized(command, second), goal, resized(self._scene.goal_tangent, second))
        except ValueError:
            return None
        return ActivePath((there, on))


def resized(vector: Vec3, size: float) -> Vec3:
    """The vector scaled to a length."""
    factor = size / math.hypot(*vector)
    return factor * vector[0], factor * vector[1], factor * vector[2]


def time_of_collision(own: Own, sighting: Sighting) -> float:
    """t_c = (d_0 - R) / |v_o| of section 4.3.2; the least one makes the major obstacle (a standing one comes last)."""
    distance = math.dist(own.pos_m, sighting.obstacle.pos_m)
    speed = math.hypot(*sighting.track.vel)
    return (distance - sighting.track.radius) / speed if speed > 0.0 else math.inf


def make_event(
    time_s: float,
    decision: str,
    method: str,
    own: Own,
    major: Sighting,
    answer: Avoidance,
    insertion: Insertion | None,
    path: ActivePath | None,
) -> ReplanEvent:
    """Everything that went into a decision and came out of it."""
    g = cap(own, major.obstacle)
    return ReplanEvent(
        time_s=time_s,
        obstacle=major.track.name,
        decision=decision,
        method=method,
        status=answer.status,
        own_pos_enu_m=own.pos_m,
        own_vel_enu_mps=own.vel_mps,
        obstacle_pos_enu_m=major.obstacle.pos_m,
        obstacle_vel_enu_mps=major.track.vel,
        radius_m=major.track.radius,
        alpha_rad=major.threat.alpha_rad,
        alpha0_rad=major.threat.alpha0_rad,
        time_to_cpa_s=major.threat.time_to_cpa_s,
        miss_m=major.threat.miss_m,
        cap_radius_mps=g.radius_mps if g else NAN,
        cap_azimuth_rad=g.azimuth_rad if g else NAN,
        cap_elevation_rad=g.elevation_rad if g else NAN,
        cap_half_angle_rad=g.half_angle_rad if g else NAN,
        command_enu_mps=vec3(answer.velocity_mps) if path else NOWHERE,
        deflection_rad=answer.deflection_rad if path else NAN,
        margin_rad=answer.margin_rad,
        insertion_enu_m=vec3(insertion.point_m) if insertion else NOWHERE,
        insertion_time_s=insertion.time_s if insertion else NAN,
        max_curvature_to_insertion_1pm=path.curves[0].max_curvature() if path else NAN,
        max_curvature_to_goal_1pm=path.curves[1].max_curvature() if path else NAN,
        planned_length_m=path.length_m if path else NAN,
    )
