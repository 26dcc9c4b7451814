"""One line of ``lead_time.csv``: who was searched in which encounter, and what was found."""

import csv
import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

from testbed.campaign.words.grid import PART
from testbed.campaign.words.settings import FlightPlan
from testbed.flight.record import inside
from testbed.studies.lead_time.options import LeadTime
from testbed.studies.lead_time.search import Found

ONLY = {
    frozenset(): "point_mass",
    frozenset({"roll"}): "point_no_roll",
    frozenset({"load_factor"}): "point_no_load",
    frozenset({"speed"}): "point_no_speed",
    frozenset({"load_factor", "speed"}): "point_roll",
    frozenset({"roll", "speed"}): "point_load",
    frozenset({"roll", "load_factor"}): "point_speed",
    frozenset({"roll", "load_factor", "speed"}): "point_ideal",
}
"""Limits of the point mass that are off, to the name of the rung; its gust load apart."""


def rung_of(ideal: Sequence[str]) -> str:
    """The rung of a point mass. Its gust load goes with its load factor; switched off alone, it has a name of its own."""
    name = ONLY[frozenset(ideal) - {"gust"}]
    return f"{name}_no_gust" if "gust" in ideal and "load_factor" not in ideal else name


@dataclass(frozen=True)
class Line:
    """A search.

    ``study``: the part of the campaign; ``rung``: the plant, and which limits of the point are on; ``aircraft``: empty for a point on
    rails, which is of none.
    """

    study: str
    rung: str
    answer: str  # insertion_point, flyable (a path to one within the aircraft's limits) or direct
    aircraft: str
    method: str
    swell_m: float
    wind_mps: float
    wind_from_deg: float  # NaN in calm air
    turbulence: str
    encounter: int
    leads_s: tuple[float, ...]
    run_up_s: float
    tolerance_s: float
    found: Found

    @property
    def waste_s(self) -> float:
        """What the method takes longer than the best manoeuvre; infinite where it never suffices, NaN where neither does."""
        return self.found.lead_s - self.found.best_s

    @property
    def kept(self) -> tuple[bool, ...]:
        """Was the radius kept, at each lead of the grid?"""
        return tuple(not inside(value) for value in self.found.grid_clearance_m)


@dataclass(frozen=True)
class Searches:
    """A run: its question, its lines in plan order, and where they come from."""

    question: str
    seed: int
    lines: tuple[Line, ...]
    provenance: dict[str, Any]


def line_of(plan: FlightPlan, row: Mapping[str, Any]) -> Line:
    """A row of the journal, with what its plan says."""
    study = LeadTime.of(plan)
    wind, turbulence = plan.air.wind, plan.air.turbulence
    kinematic = plan.plant.kind == "kinematic"
    answer = "flyable" if plan.replan.path == "flyable" else plan.replan.answer
    rung = ("vo_instant" if answer == "direct" else "kinematic") if kinematic else plan.plant.kind
    return Line(
        study=plan.labels.get(PART, plan.campaign),
        rung=rung_of(plan.plant.ideal) if plan.plant.kind == "point_mass" else rung,
        answer=answer,
        aircraft="" if kinematic else plan.aircraft,
        method=plan.method.kind,
        swell_m=plan.replan.swell_m,
        wind_mps=wind.speed_mps if wind.kind == "steady" else 0.0,
        wind_from_deg=wind.from_deg if wind.kind == "steady" else math.nan,
        turbulence="none" if turbulence.kind == "none" else turbulence.severity,
        encounter=plan.replicate,
        leads_s=study.leads_s,
        run_up_s=study.run_up_s,
        tolerance_s=study.tolerance_s,
        found=Found(**row["found"]),
    )


WHO = ("study", "rung", "answer", "aircraft", "method", "swell_m", "wind_mps", "wind_from_deg", "turbulence", "encounter")
FIGURES = tuple(field.name for field in fields(Found) if field.name != "grid_clearance_m")


def csv_text(lines: Sequence[Line]) -> str:
    """One line a search; six significant digits. The last column has ``lead:clearance`` for each lead of the grid."""
    sink = io.StringIO(newline="")
    write = csv.writer(sink, lineterminator="\n").writerow
    write([*WHO, "waste_s", *FIGURES, "grid_clearance_m"])
    for line in lines:
        grid = " ".join(f"{lead:g}:{clear + 0.0:.3f}" for lead, clear in zip(line.leads_s, line.found.grid_clearance_m, strict=True))
        figures = [getattr(line.found, name) for name in FIGURES]
        write([*(_text(getattr(line, name)) for name in WHO), _text(line.waste_s), *map(_text, figures), grid])
    return sink.getvalue()


def _text(value: str | float) -> str:
    if isinstance(value, str):
        return value
    return "" if math.isnan(value) else f"{value:.6g}"
