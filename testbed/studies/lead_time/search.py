"""One search: the least lead at which a method keeps the radius, and every longer one of the grid; beside it that of the best manoeuvre."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from testbed.campaign.words.settings import FlightPlan
from testbed.core.units import DEG
from testbed.flight.fly import fly
from testbed.flight.planning.decided import Decided
from testbed.flight.record import Outcome, inside
from testbed.results.quantities import closest_approach
from testbed.studies.lead_time.open_loop import best_lead, manoeuvres
from testbed.studies.lead_time.options import LeadTime
from testbed.studies.lead_time.searched_encounter import Encounter, at_lead, drawn

LOST_OR_UNTRIMMED = (Outcome.DIVERGED, Outcome.HIT_GROUND, Outcome.TRIM_FAILED)


@dataclass(frozen=True)
class Found:
    """The result of a search. A lead that no time of the grid satisfies is infinite."""

    lead_s: float  # tau_m
    best_s: float  # tau*, of the best open-loop manoeuvre on the same plant in the same mean wind
    fails_again: int  # 1 when the method keeps the radius at some lead and fails at a longer one of the grid
    grid_clearance_m: list[float]  # least clearance at each lead of the grid, until clear
    radius_m: float
    obstacle_speed_mps: float
    closing_mps: float
    miss_m: float
    crossing_deg: float  # between the two velocities, over the ground: 180 is head on
    entry_s: float  # straight flight enters the sphere so long before the closest approach
    range_m: float  # how far the obstacle must be seen for lead_s
    flights: int


def search(plan: FlightPlan) -> Found:
    """Fly the encounter of a plan with as many leads as it takes."""
    study = LeadTime.of(plan)
    encounter = drawn(plan)
    flown: dict[float, float] = {}

    def clearance(lead_s: float) -> float:
        if lead_s not in flown:
            flown[lead_s] = clearance_at(plan, encounter, lead_s)
        return flown[lead_s]

    lead = least_lead(lambda lead_s: not inside(clearance(lead_s)), study.leads_s, study.tolerance_s, encounter.entry_s)
    grid = [clearance(lead_s) for lead_s in study.leads_s]
    kept = [not inside(value) for value in grid]
    own = encounter.obstacle_vel_mps + encounter.closing_mps
    speed = float(np.linalg.norm(encounter.obstacle_vel_mps))
    cross = float(encounter.obstacle_vel_mps @ own) / (speed * float(np.linalg.norm(own))) if speed > 0.0 else math.nan
    return Found(
        lead_s=lead,
        best_s=best_lead(manoeuvres(plan), encounter, study.leads_s[-1], study.tolerance_s),
        fails_again=int(any(kept[k] and not all(kept[k:]) for k in range(len(kept)))),
        grid_clearance_m=grid,
        radius_m=encounter.radius_m,
        obstacle_speed_mps=speed,
        closing_mps=encounter.closing_speed_mps,
        miss_m=float(np.linalg.norm(encounter.miss_m)),
        crossing_deg=math.acos(max(-1.0, min(1.0, cross))) / DEG if speed > 0.0 else math.nan,
        entry_s=encounter.entry_s,
        range_m=encounter.range_m(lead) if math.isfinite(lead) else math.inf,
        flights=len(flown),
    )


def clearance_at(plan: FlightPlan, encounter: Encounter, lead_s: float) -> float:
    """Least clearance (m) until the flight is clear. A trigger inside of the sphere has that of straight flight and is not
    flown; a flight that is lost (trim, ground, divergence) has minus the radius.
    """
    if lead_s <= encounter.entry_s:
        return float(np.linalg.norm(encounter.miss_m)) - encounter.radius_m
    record = fly(at_lead(plan, encounter, lead_s), Decided)
    if record.outcome in LOST_OR_UNTRIMMED or not len(record.columns["time_s"]):
        return -encounter.radius_m
    return closest_approach(record).clearance_m


def least_lead(keeps: Callable[[float], bool], leads_s: Sequence[float], tolerance_s: float, low_s: float = 0.0) -> float:
    """The least lead that suffices: above the last failure of the grid, bisected; infinite when the longest fails.

    ``low_s`` is a lead that is known to fail.
    """
    kept = [keeps(lead_s) for lead_s in leads_s]
    if not kept[-1]:
        return math.inf
    first = next(k for k in range(len(kept)) if all(kept[k:]))
    high, low = leads_s[first], max(low_s, leads_s[first - 1] if first else 0.0)
    while high - low > tolerance_s:
        middle = 0.5 * (low + high)
        if keeps(middle):
            high = middle
        else:
            low = middle
    return high
