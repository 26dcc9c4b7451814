"""``testbed tune``: find an aircraft's gains, prove them in steps and on a course, write them into its aircraft.yaml.

The same procedure for every aircraft, at its reference airspeed; no number in it belongs to one of them:

1. trim and linearise; measure what linearising does not see (servo, sampling, engine, full-aileron roll);
2. gains of the inner loops on the linear model: least step error below a greatest sensitivity (``gains.py``);
3. step the closed loops of the real plant and autopilot; what each is late is the look-ahead of guidance;
4. give guidance the bandwidth at which its own loop, closed through those measured responses, reaches its greatest sensitivity;
5. verify: step responses within bounds, and a course of bends near the turn limit.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from pydantic import ValidationError

from testbed.airframe.gains import lateral_gains, pitch_gains, roll_rate_limit, rounded
from testbed.airframe.gains_file import changes, write_gains
from testbed.airframe.identify import (
    StepResponse,
    bank_step,
    full_control,
    gust_answer,
    load_factor_step,
    surface_lags,
    thrust_lag_s,
    turn_response,
)
from testbed.airframe.linearise import LinearModel, linearise, load_factor_per_rad
from testbed.airframe.trim import fastest_level, lift_curve, stall_speed, steepest_climb, trim
from testbed.airframe.verify import Check, line, verify
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.plants.aircraft import Aircraft, load_aircraft
from testbed.flight.plants.base import TrimFailedError
from testbed.flight.plants.rig import Rig

Array = np.ndarray
MOST_SENSITIVITY = 1.5  # of the guidance loop: gain margin 3, phase margin 39 deg at least
MOST_TURN_SENSITIVITY = 2.0  # the same with the rudder's side force, which comes before the turn: gain margin 2, phase margin 29 deg
DAMPING = 0.8  # of the error from the path
INTEGRAL_SHARE = 0.25  # the integral of guidance answers four times as slowly as the error loop, that of the throttle as its loop
SPEED_LOOP_LAGS = 0.5  # crossover of the speed loop times the lag of the engine
SPEED_LOOP_SHARE = 0.5  # and no faster than this share of the guidance bandwidth
FASTEST_SPEED_LOOP_RAD_S = 1.0
LEAST_LAG_S = 0.01  # an engine whose thrust simply follows the throttle, a loop that is as quick as its command
CLIMB_SHARE = 0.8  # of the steepest climb: the power of climbing is taken between there and level flight
SLOWEST_STALLS, FASTEST_SHARE = 1.2, 1.6  # the envelope's airspeeds: stalls, and times the reference airspeed
SLOWEST_BANDWIDTH_RAD_S = 0.05
PACES = (1.0, 0.8, 0.6, 0.4)  # of the inner loops and of guidance: one after the other, until the verification passes
PACED = ("bank_1ps", "aileron_per_roll_rate_s", "elevator_p", "elevator_i_1ps")
CONTROL_RAD_S = np.geomspace(0.2, 15.0, 120)


class TuneFailedError(RuntimeError):
    """The gains found do not pass their own check; the report says which."""


def tune(name: str, write: bool, accept: bool = False) -> str:
    """Find the gains of an aircraft and report on them; write them into its aircraft.yaml if asked.

    Gains that miss their verification are tried slower; ``accept``: if none pass, those that miss least are taken, and the file says
    what was missed. Raises ``TuneFailedError``.
    """
    before = load_aircraft(name)
    try:
        after, checks = _best(before)
        after = sound(after)
    except (RuntimeError, np.linalg.LinAlgError, ArithmeticError, LookupError, ValueError) as error:
        reason = error.args[0] if isinstance(error, KeyError) and error.args else error
        raise TuneFailedError(f"{name}: no gains were found at {before.autopilot.reference_mps:g} m/s: {reason}") from error
    missed = tuple(" ".join(line(check).split()) for check in checks if not check.passed)
    found = changes(name, after) | _verdict(before, missed)
    report = _report(name, before, after, found, checks)
    if missed and not accept:
        raise TuneFailedError(f"{report}\nnothing was written; --accept writes the gains with what they missed")
    if write:
        write_gains(before, found)
    return report


def _best(aircraft: Aircraft) -> tuple[Aircraft, list[Check]]:
    """The fastest that passes its verification; where none does, the one that exceeds its bounds by the smallest factor."""
    base = with_inner_loops(aircraft)
    tried: list[tuple[float, Aircraft, list[Check]]] = []
    for pace in PACES:
        after = identified(base, pace)
        checks = verify(after)
        if all(check.passed for check in checks):
            return after, checks
        tried.append((max(check.value / check.bound if math.isfinite(check.value) else math.inf for check in checks), after, checks))
    _, after, checks = min(tried, key=lambda one: one[0])
    return after, checks


def sound(aircraft: Aircraft) -> Aircraft:
    """The same aircraft, its numbers looked at: a quantity that could not be measured is no number. Raises ``ValueError`` in words."""
    try:
        return Aircraft.model_validate(aircraft.model_dump())
    except ValidationError as error:
        wrong = ", ".join(".".join(map(str, item["loc"])) for item in error.errors())
        raise ValueError(f"these could not be measured: {wrong}") from error


def _verdict(before: Aircraft, missed: tuple[str, ...]) -> dict[str, Any]:
    """What the file is to say of the verification; nothing where all passed and the file never said otherwise."""
    if missed:
        return {"verified": False, "missed": list(missed)}
    return {"verified": True, "missed": None} if not before.verified or before.missed else {}


class InnerLoops(NamedTuple):
    """An aircraft with measured limits and gains of its inner loops, its linear model, and what its engine does for it."""

    aircraft: Aircraft
    model: LinearModel
    power: "Power"


def find_gains(aircraft: Aircraft) -> Aircraft:
    """The aircraft with measured limits, gains of the inner loops and identified lags."""
    return identified(with_inner_loops(aircraft), 1.0)


def with_inner_loops(aircraft: Aircraft) -> InnerLoops:
    """Limits measured, and gains of the inner loops found."""
    speed = aircraft.autopilot.reference_mps
    model = linearise(Rig(aircraft, speed))
    lags = surface_lags(aircraft, model)
    gains = pitch_gains(model, lateral_gains(model, aircraft.autopilot, lags), lags)
    power = _power(aircraft, speed)
    return InnerLoops(_changed(_measured(aircraft, speed), autopilot=gains.model_dump() | throttle_gains(power, math.inf)), model, power)


def identified(inner: InnerLoops, pace: float) -> Aircraft:
    """The aircraft with inner loops that many times as fast as they were found, lags as they are flown then, and guidance to fit."""
    aircraft, model, power = inner
    speed = aircraft.autopilot.reference_mps
    if pace != 1.0:
        slower = {key: rounded(pace * getattr(aircraft.autopilot, key)) for key in PACED}
        aircraft = _changed(aircraft, autopilot=slower)
    (bank, flown), (lift, _) = bank_step(aircraft, speed), load_factor_step(aircraft, speed)
    turn = turn_response(flown)
    bandwidth = max(SLOWEST_BANDWIDTH_RAD_S, round(pace * guidance_bandwidth(bank, lift, turn), 2))
    ahead = {"bank_lead_s": rounded(max(0.0, turn.lag_s(bandwidth))), "load_factor_lead_s": rounded(max(0.0, lift.lag_s(bandwidth)))}
    integral = rounded(INTEGRAL_SHARE * bandwidth)
    aircraft = _changed(aircraft, guidance={"bandwidth_rad_s": bandwidth, "damping": DAMPING, "integral_1ps": integral, **ahead})
    aircraft = _changed(aircraft, autopilot=throttle_gains(power, bandwidth))
    point = _as_point(aircraft, power, turn.lag_s(bandwidth), lift.lag_s(bandwidth)) | _in_gusts(aircraft, model)
    return _changed(aircraft, point_mass=point)


def _measured(aircraft: Aircraft, speed: float) -> Aircraft:
    """Limits that are facts of the aircraft rather than choices."""
    stall = stall_speed(aircraft, speed)
    lift = lift_curve(aircraft, speed).lift_at(aircraft.limits.alpha_max_deg * DEG)
    return _changed(
        aircraft,
        limits={
            "roll_rate_dps": roll_rate_limit(full_control(aircraft, speed).peak_rate_radps),
            "alpha_max_1g_mps": rounded(speed / math.sqrt(lift)),
            "stall_mps": rounded(stall),
            "speed_min_mps": rounded(SLOWEST_STALLS * stall),
            "speed_max_mps": fastest_level(aircraft, speed, FASTEST_SHARE * speed),
        },
    )


class Power(NamedTuple):
    """What the engine does for the aircraft: steepest climb (rad), throttle per g along the path, lag of the thrust (s)."""

    climb_rad: float
    throttle_per_g: float
    lag_s: float


def _power(aircraft: Aircraft, speed: float) -> Power:
    steepest = steepest_climb(aircraft, speed)
    climb = CLIMB_SHARE * steepest
    if not climb > 0.0:
        raise TrimFailedError("it has no power left to climb there; take a slower reference_mps")
    level, climbing = trim(aircraft, speed), trim(aircraft, speed, climb)
    assert level is not None
    assert climbing is not None
    per_g = (climbing.throttle - level.throttle) / math.sin(climb)
    return Power(steepest, per_g, max(LEAST_LAG_S, thrust_lag_s(aircraft, speed)))


def throttle_gains(power: Power, bandwidth: float) -> dict[str, float]:
    """Feed-forward from the trims, PI with a crossover that the lag of the engine and the guidance bandwidth (rad/s) allow."""
    crossover = min(SPEED_LOOP_LAGS / power.lag_s, SPEED_LOOP_SHARE * bandwidth, FASTEST_SPEED_LOOP_RAD_S)
    return {
        "throttle_per_mps": rounded(crossover * power.throttle_per_g / G0_MPS2),
        "throttle_integral_1ps": rounded(INTEGRAL_SHARE * crossover * crossover * power.throttle_per_g / G0_MPS2),
        "throttle_per_accel_g": rounded(power.throttle_per_g),
        "throttle_lag_s": rounded(power.lag_s),
    }


def guidance_bandwidth(bank: StepResponse, lift: StepResponse, turn: StepResponse) -> float:
    """The highest bandwidth (rad/s, in steps of 0.05) that keeps the path loop, closed through each response, in its bound."""
    answers = [
        (response.transfer(CONTROL_RAD_S), most)
        for response, most in ((bank, MOST_SENSITIVITY), (lift, MOST_SENSITIVITY), (turn, MOST_TURN_SENSITIVITY))
    ]
    best = SLOWEST_BANDWIDTH_RAD_S
    for bandwidth in np.arange(0.1, 5.0, 0.05):
        law = path_law(float(bandwidth))
        if any(float(np.max(1.0 / np.abs(1.0 + law * answer))) > most for answer, most in answers):
            break
        best = round(float(bandwidth), 2)
    return best


def path_law(bandwidth: float) -> Array:
    """From error to acceleration and back to error by two integrations, at ``CONTROL_RAD_S``."""
    s = 1j * CONTROL_RAD_S
    stiffness = bandwidth * bandwidth
    return np.asarray((2.0 * DAMPING * bandwidth * s + stiffness + INTEGRAL_SHARE * bandwidth * stiffness / s) / (s * s))


def _as_point(aircraft: Aircraft, power: Power, bank_lag_s: float, lift_lag_s: float) -> dict[str, float]:
    """Lags, thrust and drag over weight for the point mass that stands in for this aircraft."""
    curve = lift_curve(aircraft, aircraft.autopilot.reference_mps)
    usable = curve.lift_factor <= aircraft.limits.load_factor_max
    lift_part, zero_part = np.polyfit(curve.lift_factor[usable] ** 2, curve.drag_factor[usable], 1)
    level = float(zero_part + lift_part)
    return {
        "bank_lag_s": rounded(max(LEAST_LAG_S, bank_lag_s)),
        "load_factor_lag_s": rounded(max(LEAST_LAG_S, lift_lag_s)),
        "thrust_lag_s": rounded(power.lag_s),
        "thrust_max": rounded(level + math.sin(power.climb_rad)),
        "drag_zero": rounded(float(zero_part)),
        "drag_lift": rounded(float(lift_part)),
    }


def _in_gusts(aircraft: Aircraft, model: LinearModel) -> dict[str, float]:
    """What a gust adds to the load factor of that point mass, and how the closed loops take it out again."""
    per_rad = load_factor_per_rad(model)
    answer = gust_answer(aircraft, model.speed_mps, per_rad)
    return {
        "load_factor_per_rad": rounded(per_rad),
        "gust_frequency_rad_s": rounded(answer.frequency_rad_s),
        "gust_damping": rounded(answer.damping),
        "gust_surge_s": rounded(max(0.0, answer.surge_s)),
    }


def _changed(aircraft: Aircraft, **sections: Mapping[str, float]) -> Aircraft:
    """The aircraft with some values of some sections replaced."""
    return aircraft.model_copy(update={name: getattr(aircraft, name).model_copy(update=dict(new)) for name, new in sections.items()})


def _report(name: str, before: Aircraft, after: Aircraft, changes: Mapping[str, Any], checks: list[Check]) -> str:
    lines = [f"{name}: {after.title}", f"at {after.autopilot.reference_mps:g} m/s, 150 m above sea level", ""]
    for section, values in changes.items():
        if isinstance(values, Mapping):
            lines.append(section)
            for key, value in values.items():
                old = getattr(getattr(before, section), key)
                lines.append(f"  {key:26} {value:<10g}" + (f" was {old:g}" if old != value else ""))
    lines += ["", "verified in steps"]
    return "\n".join([*lines, *(f"  {line(check)} {'ok' if check.passed else 'FAILED'}" for check in checks)])
