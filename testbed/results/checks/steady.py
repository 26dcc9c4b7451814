"""Checks of steady flight: turns, and trims."""

import math
from collections.abc import Iterable, Sequence

import numpy as np

from testbed.campaign.words.check import SteadyTurn, Trims
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.record import FlightRecord
from testbed.results.checks.verdict import CheckResult, Evidence, Flown, flown_by, groups

Array = np.ndarray


def turn_flown(_check: SteadyTurn, record: FlightRecord) -> Evidence:
    """Of the third quarter: radius of the circle through the places, mean airspeed, mean tan of the bank about the velocity, sideslip."""
    n = len(record.columns["time_s"])
    steady = slice(n // 2, 3 * n // 4)  # the upset of the entry has died out, the end is not yet in sight
    column = {name: record.columns[name][steady] for name in ("own.pos_enu_m", "own.vel_enu_mps", "own.bank_rad", "own.pitch_rad")}
    climb = np.arcsin(column["own.vel_enu_mps"][:, 2] / np.linalg.norm(column["own.vel_enu_mps"], axis=1))
    # the wing's slope sin(bank) cos(pitch) seen square to the velocity, which lies below the nose by the angle of attack
    slope = np.sin(column["own.bank_rad"]) * np.cos(column["own.pitch_rad"]) / np.cos(climb)
    return {
        "radius_m": circle_through(column["own.pos_enu_m"][:, :2]),
        "airspeed_mps": float(record.columns["own.airspeed_mps"][steady].mean()),
        "tan_bank": float(np.mean(np.abs(slope) / np.sqrt(1.0 - slope**2))),
        "beta_rad": float(record.columns["own.beta_rad"][steady].mean()),
    }


def circle_through(points: Array) -> float:
    """Radius of the circle (least squares of Kasa, 1976) through points (n,2)."""
    centred = points - points.mean(axis=0)
    system = np.column_stack([2.0 * centred, np.ones(len(centred))])
    a, b, c = np.linalg.lstsq(system, (centred**2).sum(axis=1), rcond=None)[0]
    return math.sqrt(c + a * a + b * b)


def steady_turn(check: SteadyTurn, flights: Sequence[Flown]) -> Iterable[CheckResult]:
    """Radius V^2 / (g tan phi), and sideslip of those that can slip; one line of each per flight."""
    for name, mine in groups(flights, lambda plan: f"{flown_by(plan)}, {plan.cell}"):
        (flight,) = mine
        radius = flight["airspeed_mps"] ** 2 / (G0_MPS2 * flight["tan_bank"])
        yield CheckResult(f"{name}: radius", "m", radius, flight["radius_m"], check.radius_share_tolerance * radius)
        if flight.plan.plant.kind == "jsbsim":
            yield CheckResult(f"{name}: sideslip", "deg", 0.0, flight["beta_rad"] / DEG, check.sideslip_tolerance_deg)


def trim_flown(_check: Trims, record: FlightRecord) -> Evidence:
    """Angle of attack, throttle and climb angle at the start."""
    x, y, z = record.columns["own.vel_enu_mps"][0].tolist()
    return {
        "alpha_rad": float(record.columns["own.alpha_rad"][0]),
        "throttle": float(record.columns["own.throttle"][0]),
        "climb_rad": math.atan2(z, math.hypot(x, y)),
    }


def trims(check: Trims, flights: Sequence[Flown]) -> Iterable[CheckResult]:
    """Each flight against the published trim whose climb angle is nearest to the one flown."""
    for flight in flights:
        climb = flight["climb_rad"] / DEG
        known = min(check.published, key=lambda trim: abs(trim.climb_deg - climb))
        name = f"{flown_by(flight.plan)}, climb of {known.climb_deg:g} deg"
        yield CheckResult(f"{name}: climb flown", "deg", known.climb_deg, climb, check.alpha_tolerance_deg)
        yield CheckResult(f"{name}: angle of attack", "deg", known.alpha_deg, flight["alpha_rad"] / DEG, check.alpha_tolerance_deg)
        yield CheckResult(f"{name}: throttle", "", known.throttle, flight["throttle"], check.throttle_tolerance)
