"""One row of the audit: what is printed, and the formula that computes it."""

import math
from dataclasses import dataclass

from testbed.studies.scoam.audit.case import Formula
from testbed.studies.scoam.audit.printed import PRINTED


@dataclass(frozen=True)
class Row:
    """One printed result. ``printed`` is what the paper says, ``low`` to ``high`` the numbers its digits allow (NaN: it gives no number).

    ``kind``: ``value`` a printed number, ``judgement`` a printed comparison, ``check`` a relation between printed results that an
    equation demands, ``claim`` a sentence put as a number, ``choice`` a number the paper is free to choose.
    """

    key: str
    where: str
    quantity: str
    printed: str
    unit: str
    low: float
    high: float
    decimals: int
    formula: Formula
    assumptions: tuple[str, ...]
    kind: str = "value"


def value(key: str, where: str, quantity: str, unit: str, formula: Formula, assumptions: tuple[str, ...]) -> Row:
    """A row whose printed side is a number: its digits give the interval."""
    number = PRINTED[key]
    low, high = number.value - number.half_ulp, number.value + number.half_ulp
    return Row(key, where, quantity, number.text, unit, low, high, number.decimals, formula, assumptions)


def relation(
    key: str,
    where: str,
    quantity: str,
    printed: str,
    unit: str,
    formula: Formula,
    assumptions: tuple[str, ...],
    kind: str,
    decimals: int = 1,
) -> Row:
    """A row whose printed side is ``> 0``, an exact number, or a word that gives no number."""
    if printed == "> 0":
        low, high = 0.0, math.inf
    else:
        low = high = float(printed) if printed[0].isdigit() else math.nan
    return Row(key, where, quantity, printed, unit, low, high, decimals, formula, assumptions, kind)
