"""The flights of an arena: who flew where, what became of it, and of which shape a method is."""

import inspect
import math
from collections.abc import Sequence
from typing import Any, Final, NamedTuple

from testbed.campaign.words.grid import PART
from testbed.campaign.words.planning import PlannerSpec
from testbed.campaign.words.settings import FlightPlan
from testbed.core import registry
from testbed.flight.record import AVOIDING, Decision, Outcome
from testbed.results.flight_row import keeps, value
from testbed.studies.arena.labels import FLOWN_BY, LEAD_S, METHOD, RUNG
from testbed.studies.study import Row, Run

CONTROL: Final = "control"
DIRECTION, PATH, LAW, PLANNER = "direction", "path", "law", "planner"
AIRCRAFT: Final = 2  # how much of flight there is in a place: 0 a point on rails, 1 a point mass, 2 an aircraft
MUCH: Final = {"kinematic": 0, "point_mass": 1}
ENDED: Final = (Outcome.CRASHED, Outcome.DIVERGED, Outcome.HIT_GROUND, Outcome.TRIM_FAILED)

UNNOTICED, ANSWERED, OTHER = "unnoticed", "answered", "hit_another"
"""Ways to come inside a radius: no decision was taken; it was answered, too late or by too little; another obstacle was in the way out."""


class Place(NamedTuple):
    """A rung and who flew it."""

    rung: str
    flown_by: str


class Encounter(NamedTuple):
    """Which encounter: the same for every method, lead and place."""

    population: str
    replicate: int


class Flight(NamedTuple):
    """A flight, as far as it is judged. NaN where a quantity does not exist."""

    method: str
    shape: str
    place: Place
    much: int
    lead_s: float
    encounter: Encounter
    kept: bool
    lost_by: str  # empty for a flight that kept every radius
    arrived: bool
    clearance_m: float
    deflection_deg: float
    length_m: float
    load_factor: float
    bank_deg: float
    roll_rate_dps: float
    answer_ms: float


def read(run: Run) -> list[Flight]:
    """All flights of a run, in plan order."""
    rows = zip(run.plans, run.rows, run.timings, strict=True)
    return [flight(plan, row, 1000.0 * spent.get("fly.answer", math.nan)) for plan, row, spent in rows]


def shape_of(plan: FlightPlan) -> str:
    """What a method hands over: a direction, a path, a command at every step; or it is a planner of its own."""
    if plan.planner.kind != PlannerSpec.model_fields["kind"].default:
        return PLANNER
    if plan.method.kind == "none":
        return CONTROL
    if inspect.isclass(registry.part("method", plan.method.kind, plan.plugins)):
        return LAW
    return PATH if plan.replan.answer == "insertion_point" else DIRECTION


def flight(plan: FlightPlan, row: Row, answer_ms: float) -> Flight:
    """One flight."""
    labels, kept = plan.labels, keeps(row)
    return Flight(
        labels[METHOD],
        shape_of(plan),
        Place(labels[RUNG], labels[FLOWN_BY]),
        MUCH.get(plan.plant.kind, AIRCRAFT),
        float(labels[LEAD_S]),
        Encounter(labels.get(PART, plan.campaign), plan.replicate),
        kept,
        "" if kept else lost_by(row),
        row["outcome"] == Outcome.REACHED,
        value(row, "least_clearance_m"),
        value(row, "peak_deflection_deg"),
        value(row, "path_length_m"),
        value(row, "max_load_factor"),
        value(row, "max_bank_deg"),
        value(row, "max_roll_rate_dps"),
        answer_ms,
    )


def lost_by(row: Row) -> str:
    """How a flight that did not keep every radius came to it: an outcome, what its planner decided, or what it left out."""
    if row["outcome"] in ENDED:
        return str(row["outcome"])
    decided: Sequence[dict[str, Any]] = [event for event in row["events"] if event["decision"] != Decision.REJOINED]
    hit = [event for event in decided if event["obstacle"] == row["nearest_obstacle"]]
    if not decided:
        return UNNOTICED
    if not any(event["decision"] in AVOIDING for event in decided):
        return str((hit or decided)[0]["decision"])
    if not hit:
        return OTHER
    return ANSWERED if hit[0]["decision"] in AVOIDING else str(hit[0]["decision"])
