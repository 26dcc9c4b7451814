"""From a threat to a new path: detection -> threat test -> method -> insertion point -> PH paths. The one place that calls ``avoid``.

One new path per new threat (policy ``once``); every decision is an event with its inputs and its result, whatever it was.

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
from typing import NamedTuple

from testbed.flight.path import ActivePath
from testbed.flight.plants.base import State
from testbed.flight.scene import Scene
from testbed.flight.sensor import detect
from testbed.flight.traffic import Track
from testbed.frames import Vec3, vec3
from testbed.seeds import stream
from testbed.spec.model import FlightPlan
from testbed.types import ReplanEvent
from vosc import Insertion, Obstacle, Own, Threat, cap, insertion_point, ph, threat
from vosc.methods import Avoidance, avoid

NAN = math.nan
NOWHERE: Vec3 = (NAN, NAN, NAN)
STILL: Vec3 = (0.0, 0.0, 0.0)
Handled = frozenset[str]
"""The planner's memory: names of the threats that have been answered."""


class Sighting(NamedTuple):
    """An obstacle in range that threatens."""

    track: Track
    obstacle: Obstacle  # its velocity is the one in the planner's frame
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
        self._error = _wind_error(plan)

    def wind_known(self, time_s: float, pos: Vec3) -> Vec3:
        """The mean wind at a place as this planner has it."""
        settings = self._plan.replan
        if settings.vo_frame == "ground_naive" or settings.wind_known == "none":
            return STILL
        return plus(self._scene.air.mean(time_s, pos), self._error)

    def step(self, handled: Handled, time_s: float, state: State) -> tuple[Handled, ActivePath | None, ReplanEvent | None]:
        """One tick: the new path, if there is one, and the event, if there was a new threat."""
        own_pos = (state.x, state.y, state.z)
        seen = detect(self._plan.sensor, self._scene.tracks, time_s, own_pos)
        if not any(track.name not in handled and may_threaten(state, track, centre) for track, centre in seen):
            return handled, None, None
        wind = self.wind_known(time_s, own_pos)
        own = Own(own_pos, minus((state.vx, state.vy, state.vz), wind))
        threats = []
        for track, centre in seen:
            obstacle = Obstacle(centre, minus(track.vel, wind), track.radius)
            found = threat(own, obstacle, self._plan.replan.horizon_s)
            if found.is_threat:
                threats.append(Sighting(track, obstacle, found))
        if all(sighting.track.name in handled for sighting in threats):
            return handled, None, None
        path, event = self._answer(time_s, own, threats, wind)
        return handled | {sighting.track.name for sighting in threats}, path, event

    def _answer(self, time_s: float, own: Own, threats: list[Sighting], wind: Vec3) -> tuple[ActivePath | None, ReplanEvent]:
        """Path and event; ``own`` and the obstacles are those of the planner's frame, which moves with ``wind``."""
        settings = self._plan.replan
        major = min(threats, key=lambda sighting: time_of_collision(own, sighting))
        answer = avoid(self._plan.method.kind, own, [sighting.obstacle for sighting in threats], **self._plan.method.options)
        insertion, path, decision = None, None, answer.status
        if self._plan.method.kind == "none":
            decision = "none"
        elif answer.status in ("avoided", "unsafe"):
            insertion = insertion_point(own, major.obstacle, settings.k, settings.time_rule)
            path = self._path(own, answer, insertion, wind) if insertion else None
            decision = "replanned" if path else ("no_path" if insertion else "no_insertion_point")
        return path, make_event(time_s, decision, self._plan.method.kind, own, major, answer, insertion, path, wind)

    def _path(self, own: Own, answer: Avoidance, insertion: Insertion, wind: Vec3) -> ActivePath | None:
        """PH from the present state to the insertion point with the avoidance direction there, and PH on to the goal."""
        chords = self._plan.replan.magnitude_chords
        start, middle, goal = own.pos_m, carried(insertion, wind), self._scene.goal
        now, command = plus(own.vel_mps, wind), plus(vec3(answer.velocity_mps), wind)
        first, second = chords * math.dist(start, middle), chords * math.dist(middle, goal)
        try:
            there = ph.hermite(start, resized(now, first), middle, resized(command, first))
            on = ph.hermite(middle, resized(command, second), goal, resized(self._scene.goal_tangent, second))
        except (ValueError, ZeroDivisionError):  # coincident points; a command that stands still over the ground
            return None
        return ActivePath((there, on))


def plus(a: Vec3, b: Vec3) -> Vec3:
    """Sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def minus(a: Vec3, b: Vec3) -> Vec3:
    """First vector less the second."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def carried(insertion: Insertion, wind: Vec3) -> Vec3:
    """The insertion point over the ground: where the wind has carried the one in the air when the aircraft is due there."""
    x, y, z = vec3(insertion.point_m)
    t = insertion.time_s
    return x + t * wind[0], y + t * wind[1], z + t * wind[2]


def _wind_error(plan: FlightPlan) -> Vec3:
    """Of an estimated wind: horizontal, the same for the whole flight and for every method, plant and aircraft of the seed."""
    if plan.replan.wind_known != "estimated":
        return STILL
    east, north = plan.replan.wind_estimate_sigma_mps * stream(plan.seed, plan.replicate, "wind_estimate").normal(size=2)
    return float(east), float(north), 0.0


def resized(vector: Vec3, size: float) -> Vec3:
    """The vector scaled to a length."""
    factor = size / math.hypot(*vector)
    return factor * vector[0], factor * vector[1], factor * vector[2]


def time_of_collision(own: Own, sighting: Sighting) -> float:
    """t_c = (d_0 - R) / |v_o| of section 4.3.2; the least one makes the major obstacle (a standing one comes last)."""
    distance = math.dist(own.pos_m, sighting.obstacle.pos_m)
    speed = math.hypot(*sighting.obstacle.vel_mps)
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
    wind: Vec3 = STILL,
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
        own_vel_enu_mps=plus(own.vel_mps, wind),
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
        command_enu_mps=plus(vec3(answer.velocity_mps), wind) if path else NOWHERE,
        deflection_rad=answer.deflection_rad if path else NAN,
        margin_rad=answer.margin_rad,
        insertion_enu_m=carried(insertion, wind) if insertion else NOWHERE,
        insertion_time_s=insertion.time_s if insertion else NAN,
        max_curvature_to_insertion_1pm=path.curves[0].max_curvature() if path else NAN,
        max_curvature_to_goal_1pm=path.curves[1].max_curvature() if path else NAN,
        planned_length_m=path.length_m if path else NAN,
        wind_known_enu_mps=wind,
    )
