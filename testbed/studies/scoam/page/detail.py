"""The tables behind the verdict: controls, the ranking of the methods, and the flights in wind, one table a design."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from testbed.flight.record import inside
from testbed.results.statistics import Spread
from testbed.show import words
from testbed.show.words import DASH, named, number
from testbed.studies.scoam.claim import Control, Rank, Waterfall
from testbed.studies.scoam.labels import Design, Method, Part, Rung
from testbed.studies.scoam.page import paper_names
from testbed.studies.scoam.page.paper_names import AIRCRAFT_NAMES, LIMIT_NAMES, METHOD_NAMES, READING_NAMES, RUNG_NAMES, RUNG_NAMES_IN_AIR

if TYPE_CHECKING:
    from testbed.studies.scoam.verdict.judged import AirCell, Case

DESIGNS = {
    Design.ANCHORED: (
        "Anchored: the same encounter in every wind",
        "The obstacle is placed so that without avoidance it comes as near, at the same time and closing speed, as in calm air. "
        "What differs is what the wind does to the avoidance.",
    ),
    Design.GROUND_FIXED: (
        "Ground-fixed: the obstacle as printed",
        "The obstacle flies over the ground as the paper prints it, and the wind changes the encounter itself: it need not be a threat.",
    ),
    Part.TURBULENCE: (
        "Turbulence",
        "The obstacle as in the anchored design; flights differ in their gusts only, which are the same for every method.",
    ),
}


def control_rows(controls: Sequence[Control]) -> list[dict[str, Any]]:
    """One line a control."""
    return [
        {
            "name": control.name,
            "expected": control.expected,
            "count": f"{control.met} of {control.n}" if control.n else "not flown",
            "tone": "warn" if not control.n else "good" if control.met == control.n else "bad",
            "exceptions": paper_names.HYPHEN_AS_MINUS.sub("\N{MINUS SIGN}", control.exceptions) or DASH,
        }
        for control in controls
    ]


def rank_groups(ranks: Sequence[Rank]) -> list[dict[str, Any]]:
    """A table a rung: methods in the order of the verdict, with what to sort by."""
    return [
        {
            "rung": named(RUNG_NAMES, rung),
            "ranks": (mine := [rank for rank in ranks if rank.rung == rung]),
            "rows": [_rank(r) for r in mine],
        }
        for rung in dict.fromkeys(rank.rung for rank in ranks)
    ]


def _rank(rank: Rank) -> dict[str, Any]:
    share = rank.safe / rank.n if rank.n else math.nan
    versus, own = rank.versus_scoam, rank.method == Method.SCOAM
    cells = [
        (f"{rank.n}", "", float(rank.n)),
        (words.percent(share), words.interval(rank.safe_low, rank.safe_high, "share"), share),
        *(
            (*_three(told, unit), told.median)
            for told, unit in (
                (rank.clearance, "m"),
                (rank.deflection, "deg"),
                (rank.extra_length, "m"),
                (rank.clear_time, "s"),
                (rank.load_factor, ""),
            )
        ),
        (DASH, "", math.nan)
        if own
        else (words.amount(versus.value, versus.unit), words.interval(versus.low, versus.high, versus.unit), versus.value),
        (DASH, "", math.nan) if own else (paper_names.p_value(rank.mcnemar_p), "", rank.mcnemar_p),
    ]
    return {
        "method": named(METHOD_NAMES, rank.method),
        "cells": [{"text": text, "note": note, "sort": sortable(x)} for text, note, x in cells],
    }


def sortable(amount: float) -> str:
    """What a column is sorted by; nothing for what does not exist."""
    return f"{amount:.6g}" if math.isfinite(amount) else ""


def _three(told: Spread, unit: str) -> tuple[str, str]:
    """Median, and 5th to 95th percentile."""
    if not told.n:
        return DASH, ""
    digits = words.UNIT_DIGITS.get(unit, 2)
    return number(told.median, digits), words.interval(told.p05, told.p95, "", digits)


def air_tables(cells: "Sequence[AirCell]") -> list[dict[str, Any]]:
    """Each design of steady wind, and turbulence, each in a table of its own: the designs are never pooled."""
    tables = []
    for design, (title, intro) in DESIGNS.items():
        mine = [cell for cell in cells if cell.design == design]
        if mine:
            tables.append(_air_table(mine) | {"title": title, "intro": intro})
    return tables


def _air_table(cells: "Sequence[AirCell]") -> dict[str, Any]:
    """One line for encounter, aircraft, rung and method; one column for each strength of the air."""
    strengths = list(dict.fromkeys(cell.strength for cell in cells))
    grouped: dict[tuple[str, str, str, str], dict[str, AirCell]] = {}
    for cell in cells:
        grouped.setdefault((cell.encounter, cell.aircraft, cell.rung, cell.method), {})[cell.strength] = cell
    vocabularies = (READING_NAMES, AIRCRAFT_NAMES, RUNG_NAMES_IN_AIR, METHOD_NAMES)
    return {
        "headings": [f"{strength} m/s" if strength.isdigit() else strength for strength in strengths],
        "rows": [
            {
                "names": [named(known, label) for known, label in zip(vocabularies, labels, strict=True)],
                "cells": [_air_cell(by_strength.get(strength)) for strength in strengths],
            }
            for labels, by_strength in grouped.items()
        ],
    }


def _air_cell(cell: "AirCell | None") -> dict[str, str]:
    """Threats in which the radius was kept, their interval and clearance."""
    if cell is None or not cell.flights:
        return {"text": DASH, "note": "", "sort": ""}
    if not cell.threats:
        return {"text": DASH, "note": f"no threat in {cell.flights} flights", "sort": ""}
    notes = [f"{words.interval(cell.low, cell.high, 'share')}; median {words.amount(cell.clearance.median, 'm')}"]
    notes += [f"a threat in {cell.threats} of {cell.flights}"] if cell.threats < cell.flights else []
    notes += [f"{cell.fail_on_rails} fail kinematically"] if cell.fail_on_rails else []
    return {"text": f"{cell.kept} of {cell.threats}", "note": "; ".join(notes), "sort": sortable(cell.kept / cell.threats)}


def waterfall_table(falls: Sequence[Waterfall]) -> dict[str, Any]:
    """Every waterfall: clearance on each rung, and what each limit of the point mass costs alone and gives back at last."""
    rungs = list(dict.fromkeys(step.rung for fall in falls for step in fall.steps))
    limits = list(dict.fromkeys(limit for fall in falls for limit in (*fall.alone_m, *fall.last_m)))
    rows = []
    for fall in falls:
        at = {step.rung: step.clearance_m for step in fall.steps}
        figures = [at.get(rung, math.nan) for rung in rungs]
        figures += [part.get(limit, math.nan) for limit in limits for part in (fall.alone_m, fall.last_m)]
        rows.append(
            {
                "names": [named(READING_NAMES, fall.encounter), named(AIRCRAFT_NAMES, fall.aircraft), named(METHOD_NAMES, fall.method)],
                "cells": [
                    {"text": number(x, 1), "sort": sortable(x), "bad": k < len(rungs) and bool(inside(x))} for k, x in enumerate(figures)
                ],
            }
        )
    headings = [named(RUNG_NAMES, rung) for rung in rungs]
    headings += [f"{named(LIMIT_NAMES, limit)} {what}" for limit in limits for what in ("alone costs", "taken away gives back")]
    return {"headings": headings, "rows": rows}


CASE_COLUMNS = (
    ("clearance_m", "least clearance", "m"),
    ("deflection_deg", "deflection (a) commanded", "deg"),
    ("flown_deflection_deg", "(b) flown, at the insertion point", "deg"),
    ("peak_deflection_deg", "(c) largest until clear", "deg"),
    ("path_length_m", "path length", "m"),
    ("avoidance_time_s", "time (a) to the insertion point", "s"),
    ("clear_time_s", "(b) until clear", "s"),
    ("bank_deg", "bank", "deg"),
    ("load_factor", "load factor", ""),
    ("roll_rate_dps", "roll rate", "deg/s"),
    ("cross_track_m", "off the path, at most", "m"),
)
CASE_RUNGS = (Rung.KINEMATIC, Rung.JSBSIM)


def case_table(cases: "Sequence[Case]") -> dict[str, Any]:
    """What each method did in calm air, as a point and flown, under every definition of the tables' quantities."""
    return {
        "headings": [(heading, unit) for _, heading, unit in CASE_COLUMNS],
        "rows": [
            {
                "names": [
                    named(READING_NAMES, c.encounter),
                    named(AIRCRAFT_NAMES, c.aircraft),
                    named(RUNG_NAMES, c.rung),
                    named(METHOD_NAMES, c.method),
                ],
                "cells": [
                    {
                        "text": number(x, words.UNIT_DIGITS.get(unit, 2)),
                        "sort": sortable(x),
                        "bad": key == "clearance_m" and bool(inside(x)),
                    }
                    for key, _, unit in CASE_COLUMNS
                    for x in (getattr(c, key),)
                ],
            }
            for c in cases
            if c.rung in CASE_RUNGS
        ],
    }
