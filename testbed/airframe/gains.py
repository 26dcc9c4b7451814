"""Gains of the inner loops, found on the linear model: a pattern search over the gains, the same for every aircraft.

Each loop gets the gains of the least step error (command and disturbance) among those whose greatest sensitivity stays below
``MOST_SENSITIVITY``. Gains move by fixed ratios and are rounded to three digits, so the result does not hang on the last bit.
"""

import math
from collections.abc import Callable, Mapping
from itertools import product

import numpy as np

from testbed.airframe.linearise import LinearModel, respond, roll_in_one_degree
from testbed.airframe.loops import ClosedLoop, elevator_per_load_factor, lateral, pitch, slip_per_rudder
from testbed.core.units import DEG
from testbed.flight.plants.aircraft import AutopilotGains

MOST_SENSITIVITY = 1.4  # gain margin 3.5, phase margin 42 deg at least
MOST_OVERSHOOT = 0.03
RATIOS = (2.0, 1.4, 1.15, 1.05, 1.02)  # of one step of the search, coarse to fine
STEP_S = 0.02
UPSET_WEIGHT = 0.3  # of an elevator out of trim by 1 g, beside a step of the command by 1 g
SLIP_S = 6.0  # over which sideslip and rudder are summed
RUDDER = ("rudder_p", "rudder_i_1ps", "rudder_per_yaw_rate_s")
Gains = dict[str, float]


def rounded(value: float) -> float:
    """Three significant digits."""
    return float(f"{value:.3g}")


def search(cost: Callable[[Gains], float], start: Gains) -> Gains:
    """Pattern search with multiplicative steps, from coarse to fine.

    Steps go along all diagonals too: the best gains lie on the bound of the sensitivity, where no single gain can move alone.
    """
    best, least = dict(start), cost(start)
    for ratio in RATIOS:
        moved = True
        while moved:
            moved = False
            for factors in product((ratio, 1.0, 1.0 / ratio), repeat=len(start)):
                tried = {name: rounded(value * factor) for (name, value), factor in zip(best.items(), factors, strict=True)}
                if (value := cost(tried)) < least * (1.0 - 1e-6):
                    best, least, moved = tried, value, True
    return best


def with_gains(gains: AutopilotGains, changes: Mapping[str, float]) -> AutopilotGains:
    """Gains with some of them replaced."""
    return gains.model_copy(update=dict(changes))


def _penalty(loop: ClosedLoop, response_peak: float) -> float:
    """Zero within the bounds; large and growing outside, so that a search finds its way in."""
    over = max(0.0, loop.sensitivity() - MOST_SENSITIVITY) + max(0.0, response_peak - 1.0 - MOST_OVERSHOOT)
    return 100.0 * over


def lateral_gains(model: LinearModel, gains: AutopilotGains, lags_s: tuple[float, ...]) -> AutopilotGains:
    """Aileron and rudder. The rudder's feed-forward keeps a turn and its entry free of sideslip, its feedback answers what upsets it."""
    time_constant, rate_per_aileron = roll_in_one_degree(model)
    _, per_roll_rate, per_yaw_rate, _ = model.a_lat[2]
    per_aileron, per_rudder = model.b_lat[2]
    slip = slip_per_rudder(model)
    gains = with_gains(
        gains,
        {
            "aileron_feed_forward_s": rounded(1.0 / rate_per_aileron),
            "aileron_per_roll_rate_s": rounded(0.2 / rate_per_aileron),
            "bank_1ps": rounded(0.5 / (time_constant + sum(lags_s))),
            "rudder_per_aileron": rounded(-per_aileron / per_rudder),  # these three: no yawing moment without sideslip
            "rudder_per_roll_rate_s": rounded(-per_roll_rate / per_rudder),
            "rudder_per_turn_rate_s": rounded(-per_yaw_rate / per_rudder),
            "rudder_p": rounded(0.5 / slip),
            "rudder_i_1ps": rounded(1.0 / slip),
            "rudder_per_yaw_rate_s": rounded(abs(per_yaw_rate / per_rudder)),
        },
    )
    seconds = 8.0 * (time_constant + sum(lags_s)) + 1.0

    def bank_cost(tried: Gains) -> float:
        loop = lateral(model, with_gains(gains, tried), lags_s)
        if not loop.stable:
            return math.inf
        response = loop.step(seconds, STEP_S)
        return float(((1.0 - response) ** 2).sum()) * STEP_S + _penalty(loop, float(response.max()))

    def rudder_cost(tried: Gains) -> float:
        return slip_cost(model, with_gains(gains, tried), lags_s)

    for _ in range(2):  # each of the two sees the other closed
        gains = with_gains(gains, search(rudder_cost, {name: getattr(gains, name) for name in RUDDER}))
        found = search(bank_cost, {name: getattr(gains, name) for name in ("bank_1ps", "aileron_per_roll_rate_s")})
        gains = with_gains(gains, found)
    return gains


def slip_cost(model: LinearModel, gains: AutopilotGains, lags_s: tuple[float, ...]) -> float:
    """Sideslip squared after the edge of a side gust and after an upset of the rudder's trim; the rudder spent on the gust counts
    by the sideslip that it would hold.
    """
    loop = lateral(model, gains, lags_s, "rudder")
    if not loop.stable:
        return math.inf
    time_s = np.arange(0.0, SLIP_S, STEP_S)
    still, gust = np.zeros(len(loop.a)), np.zeros(len(loop.a))
    gust[0] = model.speed_mps  # one radian
    after_gust, after_upset = respond(loop.a, still, gust, time_s), respond(loop.a, loop.disturbance, still, time_s)
    slips = np.concatenate([after_gust[:, 0], after_upset[:, 0]]) / model.speed_mps
    rudder = slip_per_rudder(model) * (after_gust @ loop.c)
    return float((slips**2).sum() + (rudder**2).sum()) * STEP_S + _penalty(loop, 1.0)


def pitch_gains(model: LinearModel, gains: AutopilotGains, lags_s: tuple[float, ...]) -> AutopilotGains:
    """Elevator: the feed-forward is that of a steady pull; feedback keeps the load factor against what upsets it."""
    forward = -elevator_per_load_factor(model)
    damping = -0.2 * float(model.a_long[2, 2] / model.b_long[2, 0])
    gains = with_gains(gains, {"elevator_per_load_factor": rounded(forward)})
    seconds = 4.0

    def cost(tried: Gains) -> float:
        loop = pitch(model, _with_own_lag(model, with_gains(gains, tried), lags_s), lags_s)
        if not loop.stable:
            return math.inf
        response, upset = loop.step(seconds, STEP_S), loop.step(seconds, STEP_S, disturbed=True)
        error = float(np.abs(1.0 - response).sum() + UPSET_WEIGHT * np.abs(upset).sum()) * STEP_S
        return error + _penalty(loop, float(response.max()))

    start = {"elevator_p": 0.2 * forward, "elevator_i_1ps": forward, "elevator_per_pitch_rate_s": abs(damping)}
    found = with_gains(gains, search(cost, {name: rounded(value) for name, value in start.items()}))
    return _with_own_lag(model, found, lags_s)


def _with_own_lag(model: LinearModel, gains: AutopilotGains, lags_s: tuple[float, ...]) -> AutopilotGains:
    """The reference of the load factor lags as the aircraft does with no integral."""
    bare = pitch(model, with_gains(gains, {"elevator_i_1ps": 0.0}), lags_s)
    response = bare.step(2.0, STEP_S)
    late = np.flatnonzero(response >= 1.0 - math.exp(-1.0))
    return with_gains(gains, {"load_factor_lag_s": rounded(STEP_S * float(late[0])) if len(late) else 2.0})


def roll_rate_limit(peak_rate_radps: float) -> float:
    """Nine tenths of what full aileron gives, in whole degrees per second: the rest is left to the loop."""
    return float(math.floor(0.9 * peak_rate_radps / DEG))
