"""Checks of the numbers themselves: convergence with the plant's step, and clearance between samples."""

import math
from collections.abc import Iterable, Sequence

import numpy as np

from testbed.campaign.words.check import Clearance, Convergence
from testbed.core.frames import unit_from_direction
from testbed.flight.record import FlightRecord
from testbed.results.checks.verdict import CheckResult, Evidence, Flown, flown_by, groups

Array = np.ndarray
PLACES_HZ = 10  # divides every rate of a plant


def places_flown(_check: Convergence, record: FlightRecord) -> Evidence:
    """Where the aircraft was every tenth of a second."""
    every = record.plan.rates.plant_hz // PLACES_HZ
    return {"place_enu_m": record.columns["own.pos_enu_m"][::every].tolist()}


def convergence(check: Convergence, flights: Sequence[Flown]) -> Iterable[CheckResult]:
    """Each plant needs three flights or more that differ in ``rates.plant_hz`` alone, each rate twice the one before."""
    for name, mine in groups(flights, flown_by):
        by_rate = sorted(mine, key=lambda flight: flight.plan.rates.plant_hz)
        if len(by_rate) < 3:
            continue
        finest = by_rate[-1]
        for flight in by_rate[:-1]:
            hz = f"{name}: {flight.plan.rates.plant_hz} Hz"
            expected, found = (float(f.row["least_clearance_m"]) for f in (finest, flight))
            yield CheckResult(f"{hz}: least clearance", "m", expected, found, check.clearance_tolerance_m)
            yield CheckResult(f"{hz}: path off by", "m", 0.0, _apart(flight, finest), check.place_tolerance_m)
        coarse, middle, fine = by_rate[-3:]
        first, second = _apart(coarse, middle), _apart(middle, fine)
        left = second / first if first > check.rounding_m else 0.0
        yield CheckResult(f"{name}: what doubling the rate leaves of the error", "of it", 0.0, left, 0.5**check.least_order)


def _apart(one: Flown, other: Flown) -> float:
    """Greatest distance between the places at equal times, m."""
    a, b = np.array(one["place_enu_m"]), np.array(other["place_enu_m"])
    n = min(len(a), len(b))
    return float(np.linalg.norm(a[:n] - b[:n], axis=1).max())


def clearance(check: Clearance, flights: Sequence[Flown]) -> Iterable[CheckResult]:
    """Least clearance and its time against two bodies in straight, even motion; one line of each per flight."""
    for flight in flights:
        distance, at = closest_of_lines(flight)
        name = f"{flown_by(flight.plan)}, {flight.plan.cell}"
        row = flight.row
        yield CheckResult(f"{name}: least clearance", "m", distance, float(row["least_clearance_m"]), check.clearance_tolerance_m)
        yield CheckResult(f"{name}: its time", "s", at, float(row["time_at_least_clearance_s"]), check.time_tolerance_s)


def closest_of_lines(flight: Flown) -> tuple[float, float]:
    """Clearance (m) and time (s) of the closest approach, from the plan alone: positions at time 0 and velocities."""
    plan = flight.plan
    (obstacle,) = plan.obstacles
    if obstacle.when.time_s is None or obstacle.position_enu_m is None or obstacle.speed_mps is None or obstacle.direction_deg is None:
        return math.nan, math.nan
    velocity = obstacle.speed_mps * np.array(unit_from_direction(*obstacle.direction_deg))
    own_velocity = plan.speed_mps * np.array(unit_from_direction(*plan.route.start_direction_deg))
    apart = np.array(obstacle.position_enu_m) - obstacle.when.time_s * velocity - np.array(plan.route.start_enu_m)
    closing = velocity - own_velocity
    at = -float(apart @ closing) / float(closing @ closing)
    return float(np.linalg.norm(apart + at * closing)) - obstacle.radius_m, at
