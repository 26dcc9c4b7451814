"""The contract of what plans or steers over time, tried in flights: a planner with memory, and a method that is a law.

Whether it keeps the radius is no promise: what became of the encounters is told as a note.
"""

from collections.abc import Callable, Mapping
from itertools import product
from typing import Any

import numpy as np

from testbed.campaign.words.settings import FlightPlan
from testbed.contracts.promise import Promise, first_broken
from testbed.flight.fly import fly
from testbed.flight.record import AVOIDING, FlightRecord, Outcome
from testbed.flight.traffic.track import least_clearance

PLANTS_TRIED = ("kinematic", "point_mass")
ROUTE = {"start_enu_m": [0, 0, 0], "goal_enu_m": [900, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}


def _sphere(name: str, radius_m: float, pos: list[float], speed_mps: float, direction_deg: list[float]) -> dict[str, Any]:
    """An obstacle that is there some 6 s after the start, when the aircraft is due at (300, 0, 0)."""
    motion = {"position_enu_m": pos, "speed_mps": speed_mps, "direction_deg": direction_deg, "when": {"time_s": 6}}
    return {"name": name, "radius_m": radius_m, **motion}


ENCOUNTERS = {
    "crossing": [_sphere("O", 25, [300, 8, 3], 40, [100, 5])],
    "head-on": [_sphere("O", 25, [300, 0, 0], 30, [180, 0])],
    "two at once": [_sphere("A", 20, [300, 15, 0], 30, [150, 0]), _sphere("B", 20, [320, -20, 5], 20, [60, 0])],
    "out of the way": [_sphere("O", 25, [300, 400, 0], 0, [0, 0])],
    "nothing": [],
}
ENDED = (Outcome.REACHED, Outcome.COLLIDED, Outcome.NO_PATH)


def promises_of_planner(kind: str, _part: Any, options: Mapping[str, Any]) -> list[Promise]:
    """Everything that a planner with memory promises."""
    return _promises({"planner": {"kind": kind, "options": dict(options)}})


def promises_of_law(kind: str, _part: Any, options: Mapping[str, Any]) -> list[Promise]:
    """Everything that a method promises that steers from a threat until the flight is clear."""
    return _promises({"method": {"kind": kind, "options": dict(options)}})


def _promises(parts: dict[str, Any]) -> list[Promise]:
    cases = [(f"{encounter}, {plant}", _plan(parts, encounter, plant)) for encounter, plant in product(ENCOUNTERS, PLANTS_TRIED)]
    records: dict[str, FlightRecord] = {}

    def flown(name: str, plan: FlightPlan) -> str:
        records[name] = fly(plan)
        return ""

    def again(name: str, plan: FlightPlan) -> str:
        first, second = records[name].columns, fly(plan).columns
        differing = [column for column in first if not np.array_equal(first[column], second[column], equal_nan=True)]
        return f"'{differing[0]}' differs: is something random, or kept outside of its memory?" if differing else ""

    def comes_home(name: str) -> str:
        record = records[name]
        return "" if record.outcome in ENDED else f"{record.outcome}: {record.message}"

    works = first_broken("answers at every look, in every encounter", _each(cases, flown))
    if works.broken:
        return [works]
    kept = sum(_clearance(record) >= 0.0 for record in records.values())
    acted = sum(any(event.decision in AVOIDING for event in record.events) for record in records.values())
    return [
        Promise(works.what, note=f"of {len(records)} flights it acted in {acted}; {kept} kept every radius"),
        first_broken("flies the same flight again", _each(cases, again)),
        first_broken("brings the flight to its goal", [(name, lambda name=name: comes_home(name)) for name, _ in cases]),  # type: ignore[misc]
    ]


def _each(cases: list[tuple[str, FlightPlan]], tried: Callable[[str, FlightPlan], str]) -> list[tuple[str, Callable[[], str]]]:
    return [(name, lambda name=name, plan=plan: tried(name, plan)) for name, plan in cases]  # type: ignore[misc]


def _plan(parts: dict[str, Any], encounter: str, plant: str) -> FlightPlan:
    who = {"flight_id": "", "campaign": "contract", "cell": "", "labels": {}, "replicate": 0, "seed": 0}
    scene = {"route": ROUTE, "obstacles": ENCOUNTERS[encounter], "sensor": {"range_m": 200}, "plant": {"kind": plant}}
    return FlightPlan.model_validate(who | scene | parts)


def _clearance(record: FlightRecord) -> float:
    """Least clearance (m) of all obstacles; infinite without any."""
    time_s, pos, found = record.columns["time_s"], record.columns["own.pos_enu_m"], [np.inf]
    for spec in record.plan.obstacles:
        found.append(least_clearance(time_s, pos, record.columns[f"obstacle.{spec.name}.pos_enu_m"], spec.radius_m).clearance_m)
    return float(min(found))
