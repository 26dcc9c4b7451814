"""What comes out of a flight: outcome, record, re-plans, metrics. Frozen values; arrays are never written to again."""

import math
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np

from testbed.campaign.words.settings import FlightPlan
from testbed.core.chain import Chain
from testbed.core.frames import Vec3
from vosc import ph

Array = np.ndarray


class Outcome(Enum):
    """How a flight ended, in order of precedence: the first that applies is reported."""

    CRASHED = "crashed"  # the program failed (a bug); the traceback is stored with the plan
    DIVERGED = "diverged"  # a state became non-finite or left the envelope of the model
    HIT_GROUND = "hit_ground"  # a wheel, a wing or the centre of gravity came down
    COLLIDED = "collided"  # came closer than the radius of an obstacle (the flight goes on)
    TRIM_FAILED = "trim_failed"
    NO_PATH = "no_path"  # no path could be planned from the present state
    TIMED_OUT = "timed_out"  # three times the planned time
    REACHED = "reached"  # crossed the goal's plane within 20 m
    STOPPED = "stopped"  # whoever had it flown had seen enough


TOUCH_M = 1e-6
"""A velocity on the edge of a velocity obstacle passes at the radius exactly: up to so far inside is rounding and no collision."""


def inside(clearance_m: Any) -> Any:
    """Does a clearance (a float or an array) mean a collision? NaN does not."""
    return clearance_m < -TOUCH_M


AVOIDING = ("replanned", "steered", "planned")
"""Decisions by which a flight left the path that it was on."""


@dataclass(frozen=True)
class PlannedPath:
    """A path that guidance was told to follow, from ``from_time_s`` on: PH pieces joined end to end."""

    from_time_s: float
    chain: Chain

    @property
    def curves(self) -> tuple[ph.Curve, ...]:
        return self.chain.curves

    @property
    def length_m(self) -> float:
        return self.chain.length_m


@dataclass(frozen=True)
class ReplanEvent:
    """One decision of the planner, with its inputs and its result. Vectors are ENU; unknown quantities are NaN.

    ``decision`` is ``replanned`` (the path avoids), ``steered`` (from here on a law steers, until the flight is clear), ``planned`` (a
    planner of somebody's own has another path), ``rejoined`` (the path leads back), or why the path did not change: ``none``,
    ``no_insertion_point``, ``no_free_direction``, ``inside``, ``undefined``, ``no_path``.
    """

    time_s: float
    obstacle: str
    decision: str
    method: str
    status: str  # of the method, see vosc.methods; ``steered`` or ``planned`` where there is no answer of a method
    own_pos_enu_m: Vec3
    own_vel_enu_mps: Vec3
    obstacle_pos_enu_m: Vec3
    obstacle_vel_enu_mps: Vec3
    radius_m: float  # as the planner takes it to be
    alpha_rad: float  # angle of the relative velocity from the line of sight (section 2, step 2)
    alpha0_rad: float  # half-angle of the collision cone (section 2, step 1)
    time_to_cpa_s: float
    miss_m: float  # least distance of the straight lines to the centre (the paper's threat test)
    route_miss_m: float  # least distance to a threat's centre along the path of that moment (rejoined: along the way back)
    cap_radius_mps: float  # G = (r, psi_r, theta_r, gamma), eq. 24-28
    cap_azimuth_rad: float
    cap_elevation_rad: float
    cap_half_angle_rad: float
    command_enu_mps: Vec3  # the avoidance velocity
    deflection_rad: float
    margin_rad: float
    insertion_enu_m: Vec3  # Q_avo, eq. 34-35; NaN where the direction is flown at once
    insertion_time_s: float  # after time_s
    max_curvature_to_insertion_1pm: float
    max_curvature_to_goal_1pm: float
    planned_length_m: float  # of the new path
    wind_known_enu_mps: Vec3 = (0.0, 0.0, 0.0)  # what the planner took for the wind; cap, command's size, deflection and insertion
    # rule are those of the velocities less this wind, while the velocities here are over the ground


@dataclass(frozen=True)
class FlightRecord:
    """Everything that happened, one row per plant tick.

    ``columns``: ``time_s`` (n,); ``own.pos_enu_m`` ``own.vel_enu_mps`` (n,3); ``own.quat_enu_from_body_xyzw`` (n,4);
    ``own.bank_rad`` ``own.pitch_rad`` ``own.heading_rad`` ``own.load_factor`` ``own.airspeed_mps`` ``own.alpha_rad``
    ``own.beta_rad`` (n,); ``own.rates_body_radps`` (n,3); ``own.throttle`` ``own.elevator`` ``own.aileron`` ``own.rudder`` (n,) commands;
    ``air.wind_enu_mps`` (n,3) velocity of the air over the ground at the aircraft, gusts included: airspeed = |velocity - wind|;
    ``air.rotation_body_radps`` (n,3) angular velocity of the air about the wing in body axes, which the aerodynamics feel taken off the
    aircraft's rates: 0 in calm air, NaN for a point;
    ``guidance.s_m`` ``guidance.bank_cmd_rad`` ``guidance.load_factor_cmd`` (n,), ``guidance.saturated`` (n,) 0 or 1,
    and why: ``guidance.limited`` (n,) 1 for bank plus 2 for load factor, ``own.at_stop`` (n,) 1 when a surface is at its stop;
    ``path.index`` (n,) which of ``paths`` was active; ``path.leg`` (n,) piece of that path;
    ``path.s_m`` (n,) arc length of its nearest point, ``path.cross_track_m`` (n,) 3-D distance to it, both exact;
    ``obstacle.<name>.pos_enu_m`` ``obstacle.<name>.vel_enu_mps`` (n,3); ``obstacle.<name>.clearance_m`` (n,),
    as it truly was, NaN while it was not there. While a law steers, ``path.*`` compare with the path that it left.
    What a plant does not have (control deflections of a point) is NaN.
    """

    plan: FlightPlan
    outcome: Outcome
    columns: dict[str, Array]
    events: tuple[ReplanEvent, ...]
    paths: tuple[PlannedPath, ...]
    message: str = ""  # one sentence about an outcome that is not REACHED
    longest_s: float = math.inf  # how long the flight was allowed to take
    timings: tuple[tuple[str, float], ...] = ()  # wall-clock seconds per stage; not part of the result


@dataclass(frozen=True)
class FlightMetrics:
    """One row of results.csv, apart from who the flight is. NaN where a quantity does not exist for this flight."""

    outcome: str
    least_clearance_m: float
    time_at_least_clearance_s: float
    nearest_obstacle: str
    replans: int
    trigger_time_s: float
    deflection_deg: float
    path_length_m: float
    flight_time_s: float
    cross_track_rms_m: float
    cross_track_max_m: float
    schedule_error_s: float
    max_bank_deg: float
    max_load_factor: float
    min_load_factor: float
    max_roll_rate_dps: float
    min_airspeed_mps: float
    max_airspeed_mps: float
    max_alpha_deg: float
    planned_length_m: float
    planned_min_radius_m: float
    planned_clearance_m: float  # of a point that keeps to the planned paths and their schedule
    schedule_part_m: float  # what being early or late on the path added to it; with the next one the sum is least_clearance_m
    cross_track_part_m: float  # what being off the path added
    saturated_share: float
    limits_hit: str  # bank load_factor roll_rate surface thrust, those that were reached
    airspeed_rms_error_mps: float  # from the set speed
    wind_along_std_mps: float  # standard deviation of the air's velocity along the flight
    begin_s_m: float
    route_miss_m: float  # least distance to the threat's centre along the path flown at the first decision
    deflection_ground_deg: float  # commanded, over the ground; deflection_deg is the planner's, through the air that it knows
    flown_deflection_deg: float  # of the velocity over the ground at the closest passage of the insertion point
    flown_deflection_air_deg: float  # the same, of the velocity through the air
    peak_deflection_deg: float  # largest before the flight is clear, over the ground
    peak_deflection_air_deg: float
    avoidance_time_s: float  # trigger to the closest passage of the insertion point
    insertion_miss_m: float  # distance there
    clear_time_s: float  # trigger to clear: every obstacle opens, and the rest of the flight keeps every radius
    rejoin_time_s: float  # trigger to back on the route for good (within 5 m)
    rejoin_length_m: float  # ground arc until then
