"""Waterfalls: the clearance from the direction flown at once to turbulence, and what decides it."""

from collections.abc import Mapping
from typing import Final

import numpy as np

from testbed.results.statistics import NAN
from testbed.studies.scoam.claim import Step, Waterfall
from testbed.studies.scoam.labels import SIDES, Axis, Design, Part, Rung
from testbed.studies.scoam.verdict.flights import Flights, Row, clearance

LIMIT_RUNGS: Final = {
    "roll": (Rung.POINT_ROLL, Rung.POINT_NO_ROLL),
    "load factor": (Rung.POINT_LOAD, Rung.POINT_NO_LOAD),
    "speed": (Rung.POINT_SPEED, Rung.POINT_NO_SPEED),
}
"""A limit of the point mass: the rung on which it is the only one, and the rung on which it alone is missing."""

CHAIN: Final = (Rung.VO_INSTANT, Rung.KINEMATIC, Rung.POINT_IDEAL, Rung.POINT_LOAD, Rung.POINT_NO_ROLL, Rung.POINT_MASS, Rung.JSBSIM)
"""Calm rungs, each with one thing more: the insertion point, guidance, load factor, speed, roll, six degrees of freedom."""

INSERTION_POINT: Final = "insertion point"
DIRECTION: Final = "avoidance direction"  # what fails without any of the rest
SIX: Final = "six degrees of freedom"


def waterfall(flights: Flights, encounter: str, method: str, aircraft: str) -> Waterfall | None:
    """The waterfall of one method, or nothing where fewer than two rungs were flown."""
    where = {Axis.ENCOUNTER: encounter, Axis.FLOWN_BY: aircraft}
    rungs = {
        rung: clearance(flights.one(Part.CALM, method, rung, **where))
        for rung in {*CHAIN, *(r for both in LIMIT_RUNGS.values() for r in both)}
    }
    steps, before = [], NAN
    for rung in CHAIN:
        if np.isfinite(rungs[rung]):
            steps.append(Step(rung, rungs[rung], rungs[rung] - before))
            before = rungs[rung]
    if len(steps) < 2:
        return None
    for name, rows in ((Part.WIND, in_wind(flights, method, **where)), (Part.TURBULENCE, in_turbulence(flights, method, **where))):
        if rows:
            middle = float(np.median([clearance(row) for row in rows]))
            steps.append(Step(name, middle, middle - rungs[Rung.JSBSIM]))
    alone = {limit: rungs[Rung.POINT_IDEAL] - rungs[only] for limit, (only, _) in LIMIT_RUNGS.items()}
    last = {limit: rungs[without] - rungs[Rung.POINT_MASS] for limit, (_, without) in LIMIT_RUNGS.items()}
    return Waterfall(encounter, method, aircraft, tuple(steps), alone, last)


def in_wind(flights: Flights, method: str, rung: str = Rung.JSBSIM, design: str = Design.ANCHORED, **where: str) -> list[Row]:
    """Flights in steady wind of one design in which the flight without planner fails."""
    return [row for row in flights.pick(Part.WIND, method, rung, design=design, **where) if flights.is_threat(row)]


def in_turbulence(flights: Flights, method: str, rung: str = Rung.JSBSIM, **where: str) -> list[Row]:
    """Flights in turbulence in which the flight without planner fails."""
    return [row for row in flights.pick(Part.TURBULENCE, method, rung, **where) if flights.is_threat(row)]


def waterfalls(flights: Flights) -> tuple[Waterfall, ...]:
    """Of every encounter, method and aircraft of the calm part, in order of appearance."""
    names = [flights.values(Part.CALM, name) for name in (Axis.ENCOUNTER, Axis.FLOWN_BY, Axis.METHOD)]
    every = (waterfall(flights, e, m, a) for e in names[0] for a in names[1] for m in names[2])
    return tuple(found for found in every if found is not None)


def costs(found: Waterfall) -> dict[str, float]:
    """Clearance that each step after the flight on rails costs, m. A limit's: the mean of what it costs alone and as the last one."""
    at = {step.rung: step for step in found.steps}
    out = {limit: 0.5 * (found.alone_m[limit] + found.last_m[limit]) for limit in found.alone_m}
    if Rung.JSBSIM in at and Rung.POINT_MASS in at:
        out[SIX] = at[Rung.POINT_MASS].clearance_m - at[Rung.JSBSIM].clearance_m
    for air in (Part.WIND, Part.TURBULENCE):
        if air in at:
            out[air] = -at[air].change_m
    return {name: cost for name, cost in out.items() if np.isfinite(cost)}


def most_costly(found: Mapping[str, float]) -> tuple[str, float]:
    """The name and the cost of the step that costs most; "" and NaN where none costs anything. Ties: the first."""
    name = max(found, key=lambda key: found[key], default="")
    return (name, found[name]) if name and found[name] > 0.0 else ("", NAN)


def kinematic_cause(found: Waterfall | None) -> tuple[str, float]:
    """What a failure on rails is due to, and the clearance it costs, m: the greater of two.

    The avoidance direction, as far as the direction flown at once misses; the insertion point, the rest.
    """
    at = {} if found is None else {step.rung: step.clearance_m for step in found.steps}
    if Rung.VO_INSTANT not in at or Rung.KINEMATIC not in at or at[Rung.KINEMATIC] >= 0.0:
        return "", NAN
    return most_costly({INSERTION_POINT: at[Rung.VO_INSTANT] - at[Rung.KINEMATIC], DIRECTION: max(0.0, -at[Rung.VO_INSTANT])})


def lesser_side(flights: Flights, plane: str, encounter: str, aircraft: str) -> str:
    """The side of DROAM with the lesser commanded deflection on rails, in calm air; the plane itself where the sides were not flown."""
    found = {}
    for name in SIDES[plane]:
        row = flights.one(Part.CALM, name, Rung.KINEMATIC, encounter=encounter, flown_by=aircraft)
        if row is not None and np.isfinite(angle := float(row.get("deflection_deg") or NAN)):
            found[name] = angle
    return min(found, key=lambda name: found[name]) if found else plane
