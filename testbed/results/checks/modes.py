"""The check of lateral modes: equation-error regression (Klein and Morelli, "Aircraft System Identification", ch. 5) on a record.

Angular accelerations and the rate of sideslip are linear in the motion and the surfaces when both are small; least squares finds the
coefficients from what was flown, and the eigenvalues of their matrix are the modes. Nothing of the aircraft's model is used.
"""

import math
from collections.abc import Iterable, Sequence

import numpy as np

from testbed.campaign.words.check import Modes
from testbed.core.units import DEG
from testbed.flight.record import FlightRecord
from testbed.results.checks.verdict import CheckResult, Evidence, Flown, flown_by

Array = np.ndarray
STATES = ("beta", "p", "r", "bank")
BREAK_RADPS = 1.0 * DEG  # sideslip that moves by this between ticks, in rad per 1/120 s, is a gust's edge and not the aircraft's


def modes_flown(check: Modes, record: FlightRecord) -> Evidence:
    """Roll mode (time constant, s) and Dutch roll (rad/s, damping ratio); NaN for a mode that is not there."""
    hz = record.plan.rates.plant_hz
    column = record.columns
    rates = column["own.rates_body_radps"]
    motion = {"beta": column["own.beta_rad"], "p": rates[:, 0], "r": rates[:, 2], "bank": column["own.bank_rad"]}
    surfaces = [lagged(column[name], hz, check.servo_lag_s) for name in ("own.aileron", "own.rudder")]
    known = np.column_stack([*motion.values(), *surfaces, np.ones(len(rates))])[1:-1]
    smooth = _away_from_edges(motion["beta"], hz)
    matrix = np.zeros((4, 4))
    for row, name in enumerate(("beta", "p", "r")):
        signal = motion[name]
        slope = 0.5 * hz * (signal[2:] - signal[:-2]) if name == "beta" else accelerations(signal, hz)[1:]
        matrix[row] = np.linalg.lstsq(known[smooth], slope[smooth], rcond=None)[0][:4]
    matrix[3] = [0.0, 1.0, math.tan(float(column["own.pitch_rad"].mean())), 0.0]
    roots = np.linalg.eigvals(matrix)
    pair = max(roots, key=lambda root: root.imag)
    real = [root.real for root in roots if abs(root.imag) < 1e-9]
    oscillates = pair.imag > 0.0
    return {
        "roll_mode_s": -1.0 / min(real) if real else math.nan,
        "dutch_roll_radps": float(abs(pair)) if oscillates else math.nan,
        "dutch_roll_damping": float(-pair.real / abs(pair)) if oscillates else math.nan,
    }


def accelerations(rate: Array, hz: int) -> Array:
    """What made a rate (n,) move, at every tick but the last (n - 1,).

    JSBSim's Adams-Bashforth rule solved for it: over a tick the rate moves by 3/2 of the acceleration at the tick's start less half
    of the one before.
    """
    moved = hz * np.diff(rate)
    out = np.empty_like(moved)
    out[0] = moved[0]
    for k in range(1, len(moved)):
        out[k] = (2.0 * moved[k] + out[k - 1]) / 3.0
    return out


def lagged(command: Array, hz: int, lag_s: float) -> Array:
    """A first-order lag (trapezoidal rule) of a command; at rest at the start."""
    if lag_s == 0.0:
        return command
    keep = math.exp(-1.0 / (hz * lag_s))
    out = np.empty_like(command)
    out[0] = command[0]
    for k in range(1, len(command)):
        out[k] = keep * out[k - 1] + (1.0 - keep) * 0.5 * (command[k] + command[k - 1])
    return out


def _away_from_edges(beta: Array, hz: int) -> Array:
    """Inner ticks (n - 2,) whose central difference does not straddle the edge of a gust."""
    jump = np.abs(np.diff(beta)) * hz / 120.0 > BREAK_RADPS
    return ~(jump[1:] | jump[:-1])


def modes(check: Modes, flights: Sequence[Flown]) -> Iterable[CheckResult]:
    """Three numbers per flight."""
    for flight in flights:
        for quantity, unit in (("roll_mode_s", "s"), ("dutch_roll_radps", "rad/s"), ("dutch_roll_damping", "")):
            truth = getattr(check, quantity)
            words = quantity.removesuffix("_s").removesuffix("_radps").replace("_", " ")
            name = f"{flown_by(flight.plan)}, {flight.plan.cell}: {words}"
            yield CheckResult(name, unit, truth, flight[quantity], check.share_tolerance * truth)
