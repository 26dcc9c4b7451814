"""What a decision of the planner is remembered by: its inputs and its result, whatever it was."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from testbed.campaign.words.planning import Replan
from testbed.core.frames import Vec3, vec3
from testbed.flight.planning.rejoin import miss_along
from testbed.flight.record import Decision, PathFault, ReplanEvent, inside
from testbed.flight.route.path import ActivePath
from testbed.flight.sensing.base import Seen
from vosc import Insertion, Obstacle, Own, Threat, cap, threat
from vosc.methods import Avoidance, Status
from vosc.vec import add, along, angle, norm, sub

NAN = math.nan
NO_POINT: Vec3 = (NAN, NAN, NAN)
LOOKED_AT = np.linspace(0.0, 1.0, 33)  # shares of the piece to the insertion point
RIGHT_ANGLE = 0.5 * math.pi


class Sighting(NamedTuple):
    """An obstacle that the planner knows, and how it threatens."""

    seen: Seen
    obstacle: Obstacle  # its velocity is the one in the planner's frame
    threat: Threat

    @classmethod
    def of(cls, seen: Seen, time_s: float, own: Own, wind: Vec3, settings: Replan) -> "Sighting":
        """Where it is at a time, from the frame that moves with ``wind``, as large as the planner takes it to be, and marked."""
        obstacle = Obstacle(seen.at(time_s), sub(seen.vel, wind), seen.radius_m + settings.swell_m)
        told = threat(own, obstacle, settings.horizon_s)
        return cls(seen, replace(obstacle, is_threat=told.is_threat), told)


def carried(insertion: Insertion, wind: Vec3) -> Vec3:
    """The insertion point over the ground: where the wind has carried the one in the air when the aircraft is due there."""
    return along(vec3(insertion.point_m), insertion.time_s, wind)


def make_event(
    time_s: float,
    decision: Decision,
    method: str,
    own: Own,
    major: Sighting,
    answer: Avoidance | None,
    insertion: Insertion | None,
    path: ActivePath | None,
    wind: Vec3,
    route_miss_m: float,
    status: str = "clear",
    reason: str = "",
) -> ReplanEvent:
    """Everything that went into a decision and came out of it; ``own`` and the obstacle are those of the planner's frame.

    The way back, a law that steers and a planner of somebody's own have no answer of a method, but a ``status`` of their own.
    """
    g = cap(own, major.obstacle)
    commanded = answer if path else None
    turns = [curve.max_curvature() for curve in path.curves] if path else []
    there, on = (turns[0], max(turns[1:], default=NAN)) if insertion and turns else (NAN, max(turns, default=NAN))
    return ReplanEvent(
        time_s=time_s,
        obstacle=major.seen.name,
        decision=decision,
        method=method,
        status=status if answer is None else decision if answer.status == Status.AVOIDED and path is None else answer.status,
        own_pos_enu_m=own.pos_m,
        own_vel_enu_mps=add(own.vel_mps, wind),
        obstacle_pos_enu_m=major.obstacle.pos_m,
        obstacle_vel_enu_mps=major.seen.vel,
        radius_m=major.obstacle.radius_m,
        alpha_rad=major.threat.alpha_rad,
        alpha0_rad=major.threat.alpha0_rad,
        time_to_cpa_s=major.threat.time_to_cpa_s,
        miss_m=major.threat.miss_m,
        route_miss_m=route_miss_m,
        cap_radius_mps=g.radius_mps if g else NAN,
        cap_azimuth_rad=g.azimuth_rad if g else NAN,
        cap_elevation_rad=g.elevation_rad if g else NAN,
        cap_half_angle_rad=g.half_angle_rad if g else NAN,
        command_enu_mps=add(vec3(commanded.velocity_mps), wind) if commanded else NO_POINT,
        deflection_rad=commanded.deflection_rad if commanded else NAN,
        margin_rad=answer.margin_rad if answer else NAN,
        insertion_enu_m=carried(insertion, wind) if insertion else NO_POINT,
        insertion_time_s=insertion.time_s if insertion else NAN,
        max_curvature_to_insertion_1pm=there,
        max_curvature_to_goal_1pm=on,
        planned_length_m=path.length_m if path else NAN,
        wind_known_enu_mps=wind,
        reason=reason,
    )


def judged(event: ReplanEvent, path: ActivePath, seen: Sequence[Seen]) -> ReplanEvent:
    """The event of a new path with what the path is worth, flown at the present speed over the ground.

    The direction may be free and the path to it not: then the event says so, and not that the threat is avoided.
    """
    speed = norm(event.own_vel_enu_mps)
    clearance = min(miss_along(path, 0.0, speed, event.time_s, [one]) - one.radius_m for one in seen)
    first = path.curves[0]
    turns = max(angle(event.own_vel_enu_mps, vec3(t)) for t in first.tangents(LOOKED_AT * first.length_m))
    fault = PathFault.LEADS_THROUGH if inside(clearance) else PathFault.TURNS_BACK if turns > RIGHT_ANGLE else None
    said = fault if fault and event.status == Status.AVOIDED else event.status
    return replace(event, status=said, path_clearance_m=clearance, path_turns_rad=turns)
