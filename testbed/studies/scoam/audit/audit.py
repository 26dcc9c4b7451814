"""The audit: every printed result computed under every reading, and judged.

How the verdict follows from the figures (the rounded ones, so that anybody can repeat it from ``audit.csv``): a figure *meets* the
print when the printed number with half a unit in its last place, and the computed one with what the rounding of its inputs can
change, have a point in common.

==========================  ========================================================================================================
``reproduced``              the figure as printed meets the print
``reproduced_with_reading`` a reading's does
``inconsistent``            none does, and nothing the paper leaves out could help
``not_determined``          the paper does not print what would be needed: see ``UNPRINTED`` and ``UNREAD``; or it is free to choose
==========================  ========================================================================================================

Figures have two decimals more than the print and half-widths are rounded up, far coarser than what compilers and libraries
may change; no -0. A test keeps them away from ties.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

from testbed.studies.scoam.audit.case import Case, evaluate, numbers
from testbed.studies.scoam.audit.evidence import sentence
from testbed.studies.scoam.audit.formulae import rows
from testbed.studies.scoam.audit.joint import Together, together
from testbed.studies.scoam.audit.printed import PRINTED
from testbed.studies.scoam.audit.readings import AS_PRINTED, READINGS, UNPRINTED, UNREAD, Reading
from testbed.studies.scoam.audit.row import Row

MORE_DECIMALS: Final = 2
ALL_READINGS: Final = (AS_PRINTED, *READINGS)


@dataclass(frozen=True)
class Figure:
    """A computed number, what the rounding of its inputs can change it by, and whether it meets the print (NaN: no solution)."""

    value: float
    half_width: float
    meets: bool
    exact_value: float
    exact_half_width: float


@dataclass(frozen=True)
class AuditRow:
    """One printed result and what became of it; ``figures`` by reading, ``as_printed`` first."""

    key: str
    where: str
    quantity: str
    kind: str
    printed: str
    unit: str
    tolerance: float
    decimals: int
    figures: Mapping[str, Figure]
    verdict: str
    met_by: tuple[str, ...]
    assumptions: tuple[str, ...]
    evidence: str


@cache
def audit() -> tuple[AuditRow, ...]:
    """All rows, in the order of the paper; worked out once in a process, which takes some seconds."""
    return tuple(_audited(row) for row in rows())


def joint_tests(audited: Sequence[AuditRow]) -> list[Together]:
    """The numbers of the single encounter that each reading of its direction meets one by one, taken together."""
    by_key = {row.key: row for row in rows()}
    out = []
    for reading in READINGS:
        if not any(key.startswith("o.") for key in reading.replaced):
            continue
        met = [row for row in audited if row.kind == "value" and row.verdict == "reproduced_with_reading" and reading.name in row.met_by]
        for what, sections in (
            ("cap and direction", ("Table 1", "Section 5.1")),
            ("deflections and time", ("Table 2",)),
            ("all", ("Table 1", "Section 5.1", "Table 2")),
        ):
            chosen = [row for row in met if row.where in sections]
            multiple = together(reading, [by_key[row.key] for row in chosen])
            out.append(Together(reading.name, what, tuple(row.quantity for row in chosen), multiple))
    return out


def _audited(row: Row) -> AuditRow:
    figures = _figures(row)
    met_by = tuple(name for name, figure in figures.items() if figure.meets)
    verdict = _verdict(row, met_by)
    number = PRINTED.get(row.key)
    return AuditRow(
        key=row.key,
        where=row.where,
        quantity=row.quantity,
        kind=row.kind,
        printed=row.printed,
        unit=row.unit,
        tolerance=number.half_ulp if number else 0.0,
        decimals=row.decimals + MORE_DECIMALS,
        figures=figures,
        verdict=verdict,
        met_by=met_by,
        assumptions=row.assumptions,
        evidence=sentence(row, {name: (f.value, f.half_width) for name, f in figures.items()}, met_by, verdict),
    )


def _figures(row: Row) -> dict[str, Figure]:
    """The row under every reading; a reading that touches nothing the formula looked at leaves the figure as it is."""
    value, spread, case = evaluate(row.formula, AS_PRINTED)
    out = {AS_PRINTED.name: _figure(row, value, spread)}
    for reading in READINGS:
        touched = _touches(reading, case)
        out[reading.name] = _figure(row, *evaluate(row.formula, reading)[:2]) if touched else out[AS_PRINTED.name]
    return out


def _touches(reading: Reading, case: Case) -> bool:
    changed = {key for key, number in numbers(reading).items() if number != PRINTED[key]}
    return bool(changed & case.used or reading.switches & case.asked)


def _figure(row: Row, value: float, spread: float) -> Figure:
    if not math.isfinite(value):
        return Figure(math.nan, math.nan, False, value, spread)
    unit = 10.0 ** -(row.decimals + MORE_DECIMALS)
    rounded = round(value, row.decimals + MORE_DECIMALS) + 0.0  # + 0.0: no negative zero
    half_width = round(math.ceil(spread / unit - 1e-6) * unit, row.decimals + MORE_DECIMALS) + 0.0
    slack = 1e-9
    meets = rounded - half_width <= row.high + slack and rounded + half_width >= row.low - slack
    return Figure(rounded, half_width, meets, value, spread)


def _verdict(row: Row, met_by: tuple[str, ...]) -> str:
    if row.kind == "choice" or UNPRINTED.intersection(row.assumptions):
        return "not_determined"
    if met_by:
        return "reproduced" if AS_PRINTED.name in met_by else "reproduced_with_reading"
    return "not_determined" if UNREAD.intersection(row.assumptions) else "inconsistent"
