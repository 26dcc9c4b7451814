"""One sentence of evidence for each row, made from its figures and from what else the printed numbers imply (``audit.implied``)."""

import math
from collections.abc import Mapping

from testbed.studies.scoam.audit.implied import note, text
from testbed.studies.scoam.audit.row import Row

Figures = Mapping[str, tuple[float, float]]


def sentence(row: Row, figures: Figures, met_by: tuple[str, ...], verdict: str) -> str:
    """What the figures say, and the note that belongs to the row."""
    value, half_width = figures["as_printed"]
    unit = f" {row.unit}" if row.unit else ""
    decimals = row.decimals + 1

    def shown(pair: tuple[float, float]) -> str:
        return f"{text(pair[0], decimals)} ± {text(pair[1], decimals)}{unit}"

    said = f"The printed numbers give {shown((value, half_width))}" if row.kind == "check" else f"As printed: {shown((value, half_width))}"
    if row.kind == "choice":
        said = "K may be any point of the critical boundary, and its y is the coordinate taken as chosen"
    elif verdict == "reproduced_with_reading":
        first = met_by[0]
        said += f", but {shown(figures[first])} with {first}" + (f" (also {', '.join(met_by[1:])})" if len(met_by) > 1 else "")
    elif verdict == "inconsistent":
        said += f"; the nearest any reading comes is {text(_gap(row, figures), decimals)}{unit} short of the print"
    more = note(row.key)
    return said + (f"; {more}" if more else "") + "."


def _gap(row: Row, figures: Figures) -> float:
    """Least distance between the printed interval and a computed one."""
    gaps = [max(value - half - row.high, row.low - value - half) for value, half in figures.values() if math.isfinite(value)]
    return min(gaps)
