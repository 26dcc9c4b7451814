"""The audit on disk: ``audit.csv`` and a small page that needs nothing else."""

import csv
import io
import math
import re
from collections import Counter
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from testbed.show.assets import environment
from testbed.studies.scoam.audit.audit import ALL_READINGS, AuditRow, Figure, audit, joint_tests
from testbed.studies.scoam.audit.readings import AS_PRINTED, ASSUMPTIONS, READINGS

HYPHEN_AS_MINUS = re.compile(r"(?<![\w.])-(?=\d)")  # a minus, not the dash of "eq. 34-35"
VERDICTS = {
    "reproduced": "the printed numbers give it",
    "reproduced_with_reading": "another reading of the paper gives it",
    "inconsistent": "no reading gives it",
    "not_determined": "the paper does not print what it needs",
}


def write_audit(out: Path) -> list[Path]:
    """Write ``audit.csv`` and ``audit.html`` into the folder ``out``; the same bytes on every machine."""
    rows = audit()
    out.mkdir(parents=True, exist_ok=True)
    written = []
    for name, text in (("audit.csv", csv_text(rows)), ("audit.html", page_text(rows))):
        path = out / name
        path.write_text(text, encoding="utf-8", newline="\n")
        written.append(path)
    return written


def csv_text(rows: Sequence[AuditRow]) -> str:
    """One line a row; each figure is followed by its half-width (``_pm``). Figures as ``testbed.studies.scoam.audit.audit`` rounds them."""
    sink = io.StringIO()
    write = csv.writer(sink, lineterminator="\n").writerow
    figures = [column for reading in ALL_READINGS for column in (reading.name, f"{reading.name}_pm")]
    write(["where", "quantity", "kind", "printed", "unit", "tolerance", *figures, "verdict", "reproduced_by", "assumptions", "evidence"])
    for row in rows:
        numbers = [text for f in row.figures.values() for text in (_plain(f.value, row.decimals), _plain(f.half_width, row.decimals))]
        by = "; ".join(row.met_by) if row.verdict.startswith("reproduced") else ""
        tolerance = f"{row.tolerance:.{row.decimals - 1}f}" if row.kind in ("value", "choice") else ""
        write(
            [
                row.where,
                row.quantity,
                row.kind,
                row.printed,
                row.unit,
                tolerance,
                *numbers,
                row.verdict,
                by,
                "; ".join(row.assumptions),
                row.evidence,
            ]
        )
    return sink.getvalue()


def _plain(x: float, decimals: int) -> str:
    return f"{x:.{decimals}f}" if math.isfinite(x) else ""


def page_text(rows: Sequence[AuditRow]) -> str:
    """The page: counts, every row with its figures and its sentence, the readings and the assumptions."""
    counts = Counter(row.verdict for row in rows)
    return (
        environment(__package__)
        .get_template("audit.html.j2")
        .render(
            total=len(rows),
            counts=[{"verdict": verdict, "number": counts[verdict], "meaning": VERDICTS[verdict]} for verdict in VERDICTS],
            readings=[AS_PRINTED, *READINGS],
            assumptions=ASSUMPTIONS,
            joint=joint_tests(rows),
            groups=[{"where": where, "rows": [_shown(row) for row in group]} for where, group in groupby(rows, key=lambda row: row.where)],
            columns=["as printed", *(reading.name.replace("_", " ") for reading in READINGS)],
        )
        + "\n"
    )


def _shown(row: AuditRow) -> dict[str, Any]:
    """A row as the page writes it: one decimal less than the file."""
    decimals = row.decimals - 1
    first = row.figures[AS_PRINTED.name]
    decided = row.verdict.startswith("reproduced")
    cells = [
        {
            "label": name.replace("_", " "),
            "text": _minus(figure.value, decimals),
            "half_width": _minus(figure.half_width, decimals),
            "same": name != AS_PRINTED.name and _same(figure, first),
            "meets": figure.meets and decided,
        }
        for name, figure in row.figures.items()
    ]
    return {
        "quantity": row.quantity,
        "printed": row.printed.replace("-", "\N{MINUS SIGN}"),
        "unit": row.unit,
        "tolerance": f"{row.tolerance:.{decimals}f}" if row.kind in ("value", "choice") else "",
        "cells": cells,
        "verdict": row.verdict,
        "evidence": HYPHEN_AS_MINUS.sub("\N{MINUS SIGN}", row.evidence),
        "assumptions": row.assumptions,
    }


def _same(figure: Figure, other: Figure) -> bool:
    return (figure.value, figure.half_width) == (other.value, other.half_width)


def _minus(x: float, decimals: int) -> str:
    return f"{round(x, decimals) + 0.0:.{decimals}f}".replace("-", "\N{MINUS SIGN}") if math.isfinite(x) else "none"
