"""One evaluation: the numbers in force and the definitions chosen, with a note of which of them a formula looked at."""

import math
from collections.abc import Callable, Mapping

from testbed.studies.scoam.audit.printed import PRINTED, Number
from testbed.studies.scoam.audit.readings import Reading

Formula = Callable[["Case"], float]


class Case:
    """Values by key (degrees, m, m/s, s) under one reading; ``used`` and ``asked`` record the keys and switches a formula consulted."""

    def __init__(self, values: Mapping[str, float], switches: frozenset[str]) -> None:
        self._values = values
        self._switches = switches
        self.used: set[str] = set()
        self.asked: set[str] = set()

    def __getitem__(self, key: str) -> float:
        self.used.add(key)
        return self._values[key]

    def has(self, switch: str) -> bool:
        self.asked.add(switch)
        return switch in self._switches


def numbers(reading: Reading) -> dict[str, Number]:
    """All printed numbers with the replacements of ``reading``."""
    return {**PRINTED, **reading.replaced}


def evaluate(formula: Formula, reading: Reading) -> tuple[float, float, Case]:
    """Value of ``formula`` under ``reading``, the largest change the rounding of its inputs can make, and the case it was computed in.

    The extremes of a smooth function over a small box are at corners. The search for them starts at the corner the differences
    along each axis point to and moves along edges while that helps: deterministic, and exact for anything monotonic in each input.
    """
    given = numbers(reading)
    centre = {key: number.value for key, number in given.items()}
    case = Case(centre, reading.switches)
    value = formula(case)
    if not math.isfinite(value):
        return math.nan, math.nan, case
    axes = [key for key in sorted(case.used) if given[key].half_ulp > 0.0]

    def at(signs: Mapping[str, int]) -> float:
        moved = {key: centre[key] + sign * given[key].half_ulp for key, sign in signs.items()}
        return formula(Case({**centre, **moved}, reading.switches))

    rise = {key: at({key: 1}) - at({key: -1}) for key in axes}
    spread = 0.0
    for side in (1.0, -1.0):
        signs = {key: 1 if side * rise[key] >= 0.0 else -1 for key in axes}
        best = _or(at(signs), value)
        for key in axes:
            flipped = {**signs, key: -signs[key]}
            found = _or(at(flipped), value)
            if side * found > side * best:
                signs, best = flipped, found
        spread = max(spread, side * (best - value))
    return value, spread, case


def _or(value: float, otherwise: float) -> float:
    return value if math.isfinite(value) else otherwise
