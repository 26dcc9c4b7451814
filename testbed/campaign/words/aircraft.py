"""What an ``aircraft.yaml`` says: where its model is, its limits, lags and gains; validated and frozen."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from testbed.core import section
from testbed.core.section import Between, Section

MOST = 1e6
WHY = "nothing that flies has such a figure"
Number = Annotated[section.Number, Between(WHY, -MOST, MOST)]
NonNegative = Annotated[section.NonNegative, Between(WHY, most=MOST)]
Positive = Annotated[section.Positive, Between(WHY, 1.0 / MOST, MOST)]
"""Flight divides by these, and by their squares: what is too small for that is refused, not 0 alone."""
Airspeed = Annotated[section.Positive, Between("nothing flies as slowly", least=0.1), Between("nothing flies as fast", most=1000.0)]


class Model(Section):
    """Where JSBSim finds the aircraft: beside the yaml (``own``) or among those that its wheel ships (``wheel``)."""

    files: Literal["own", "wheel"]
    name: str
    start: Literal["trimmed", "settled"] = "trimmed"  # by JSBSim's own trim, or ours for engines that need time (plants/jsbsim_settled.py)
    gear_up: bool = True
    mixture: Annotated[Number, Field(ge=0, le=1)] = 0.9
    factors: dict[str, Positive] = {}  # noqa: RUF012 (pydantic copies it); scale derivatives and lags, see plants/jsbsim_model.py


class Limits(Section):
    """The envelope: what guidance may ask for, and between which airspeeds the figures here hold."""

    speed_min_mps: Airspeed  # 1.2 times the stall
    speed_max_mps: Airspeed  # fastest level trim, or 1.6 times the reference airspeed
    bank_deg: Positive
    load_factor_min: Number
    load_factor_max: Positive
    roll_rate_dps: Positive
    alpha_max_deg: Positive
    alpha_max_1g_mps: Airspeed  # airspeed at which 1 g takes alpha_max: slower than that there is less lift to ask for
    stall_mps: Airspeed


class GuidanceGains(Section):
    """The path-following law: a second-order error loop with an integral, and feed-forward of the curvature ahead."""

    bandwidth_rad_s: Positive
    damping: Positive
    integral_1ps: NonNegative
    bank_lead_s: NonNegative  # the lag from bank command to turn, made up for by looking ahead along the path
    load_factor_lead_s: NonNegative


class AutopilotGains(Section):
    """Inner loops at ``reference_mps``; surface gains scale with (reference / airspeed)^2."""

    reference_mps: Airspeed
    bank_1ps: Positive  # roll rate asked for per bank error
    aileron_per_roll_rate_s: Positive
    aileron_feed_forward_s: NonNegative  # steady aileron per roll rate
    elevator_per_load_factor: NonNegative  # feed-forward: steady elevator per g
    load_factor_lag_s: NonNegative = 0.0  # of the answer without the integral, which only sees what is left beside it
    elevator_p: NonNegative
    elevator_i_1ps: NonNegative
    elevator_per_pitch_rate_s: NonNegative
    rudder_per_aileron: Number  # feed-forward: takes out the yaw of the aileron, of rolling and of turning
    rudder_per_roll_rate_s: Number
    rudder_per_turn_rate_s: Number
    rudder_p: NonNegative  # against sideslip (1/rad), and against its integral
    rudder_i_1ps: NonNegative
    rudder_per_yaw_rate_s: NonNegative  # against the yaw rate beside that of a turn without sideslip
    throttle_per_mps: NonNegative
    throttle_integral_1ps: NonNegative
    throttle_per_accel_g: NonNegative  # throttle per g of longitudinal acceleration, climb included
    throttle_lag_s: NonNegative  # of the engine, made up for by looking ahead along the path


class PointMass(Section):
    """The aircraft as a point: lags of the closed inner loops, thrust and drag over weight at ``autopilot.reference_mps``."""

    bank_lag_s: Positive
    load_factor_lag_s: Positive
    load_factor_per_rad: NonNegative  # of angle of attack, surfaces held: what a gust adds at once; 0: a gust adds nothing
    gust_frequency_rad_s: Positive  # of the closed short period that takes it out again, and its damping
    gust_damping: Annotated[Positive, Field(lt=1)]
    gust_surge_s: NonNegative  # integral over time of a head-on gust's load, per load at once
    thrust_lag_s: Positive
    thrust_min: Number
    thrust_max: Number
    thrust_per_mps: NonNegative  # of the speed hold
    drag_zero: NonNegative  # D/W = drag_zero (V/Vr)^2 + drag_lift n^2 (Vr/V)^2
    drag_lift: NonNegative


class Aircraft(Section):
    """One aircraft: source, licence, limits, lags, gains."""

    title: str
    source: str
    licence: str
    model: Model
    limits: Limits
    command_lag_s: NonNegative  # actuator lag that the model itself lacks
    guidance: GuidanceGains
    autopilot: AutopilotGains
    point_mass: PointMass
    gains_found_by: str
    """Empty: nobody has tuned it yet, and nothing that needs its gains flies."""
    verified: bool = True
    """false: some lines of the verification were missed when its gains were accepted."""
    missed: tuple[str, ...] = ()
    """Those lines."""
    folder: Path = Path()
