"""The readings of the method beside each other: what the verdict says of each, and the figures behind it."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from testbed.show import words
from testbed.show.words import DASH, named, number
from testbed.studies.scoam.claim import HOLDS_ONLY_IF, Claim
from testbed.studies.scoam.labels import MAIN, Axis, Part, Rung
from testbed.studies.scoam.page import paper_names, reference
from testbed.studies.scoam.page.detail import sortable

if TYPE_CHECKING:
    from testbed.studies.scoam.verdict.judged import ReadingCell, Verdict

POPULATION_RUNGS = (Rung.KINEMATIC, Rung.JSBSIM)
ENCOUNTERS = paper_names.LABEL_NAMES[Axis.ENCOUNTER]


def reading_rows(verdict: "Verdict") -> list[dict[str, Any]]:
    """One line a reading."""
    return [_row(claim, [cell for cell in verdict.reading_cells if claim.key.endswith(f".{cell.method}")]) for claim in verdict.readings]


def _row(claim: Claim, cells: "Sequence[ReadingCell]") -> dict[str, Any]:
    air = claim.flown_air
    of_class = {cell.rung: cell for cell in cells if cell.part == Part.READINGS_POPULATION and cell.aircraft == MAIN}
    return {
        "where": claim.where,
        "text": claim.text,
        "cells": [words.amount(value, claim.unit) for value in (claim.kinematic, claim.point_mass, claim.flown_calm)],
        "air": paper_names.spread(air, claim.unit),
        "population": [_kept(of_class.get(rung)) for rung in POPULATION_RUNGS],
        "no_path": _no_path(cells),
        "word": claim.word,
        "word_class": paper_names.WORD_CLASS[claim.word],
        "other": reference.other_word(claim),
        "condition": paper_names.typeset(claim.condition).rstrip(".") if claim.word == HOLDS_ONLY_IF else "",
        "lesser": False,
        "why": paper_names.typeset(claim.why),
    }


def _kept(cell: "ReadingCell | None") -> dict[str, str]:
    """How many keep every radius, the interval of the share, and how that compares with the paper's own reading."""
    if cell is None:
        return {"text": DASH, "note": ""}
    notes = [words.interval(cell.low, cell.high, "share")]
    notes += [paper_names.p_value(cell.mcnemar_p)] if cell.pairs else []
    return {"text": f"{cell.kept} of {cell.n}", "note": ", ".join(notes)}


def _no_path(cells: "Sequence[ReadingCell]") -> str:
    """On rails, in all encounters."""
    mine = [cell for cell in cells if cell.rung == Rung.KINEMATIC]
    return f"{sum(cell.no_path for cell in mine)} of {sum(cell.n for cell in mine)}" if mine else DASH


HEADINGS = (
    ("keep every radius", ""),
    ("least clearance", "m"),
    ("other clearance than the paper's own", ""),
    ("this less the paper's own", "m"),
    ("McNemar", ""),
    ("no path", ""),
)


def reading_table(cells: "Sequence[ReadingCell]") -> dict[str, Any]:
    """One line a reading, encounter, aircraft and rung."""
    return {"headings": HEADINGS, "rows": [_line(cell) for cell in cells]}


def _line(cell: "ReadingCell") -> dict[str, Any]:
    share = cell.kept / cell.n
    clearance, apart = cell.clearance, cell.difference
    figures = [
        (f"{cell.kept} of {cell.n}", words.interval(cell.low, cell.high, "share") if cell.n > 1 else "", share),
        (number(clearance.median, 1), words.interval(clearance.p05, clearance.p95, "m") if clearance.n > 1 else "", clearance.median),
        (f"{cell.other} of {cell.pairs}" if cell.pairs else DASH, "", cell.other / cell.pairs if cell.pairs else math.nan),
        (number(apart.value, 1), words.interval(apart.low, apart.high, "m") if math.isfinite(apart.low) else "", apart.value),
        (paper_names.p_value(cell.mcnemar_p), "", cell.mcnemar_p),
        (f"{cell.no_path}" if cell.no_path else DASH, cell.forbidden_by, float(cell.no_path)),
    ]
    encounter = named(ENCOUNTERS, cell.encounter)
    return {
        "names": [
            named(paper_names.METHOD_NAMES, cell.method),
            f"{encounter}{', in wind' if cell.part == Part.READINGS_WIND else ''}",
            named(paper_names.AIRCRAFT_NAMES, cell.aircraft),
            named(paper_names.RUNG_NAMES_IN_AIR if cell.part == Part.READINGS_WIND else paper_names.RUNG_NAMES, cell.rung),
        ],
        "cells": [{"text": text, "note": note, "sort": sortable(x)} for text, note, x in figures],
    }
