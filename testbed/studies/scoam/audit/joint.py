"""Do the printed numbers a reading meets one by one also hold together, for one set of inputs within their rounding?

Each row is linear enough in the few last digits of its inputs for a sequence of linear programs: find the inputs within half a unit
that bring all rows within the smallest common multiple of their printed tolerances. A multiple of 1 or less means one encounter
explains them all.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from testbed.studies.scoam.audit.case import Case, numbers
from testbed.studies.scoam.audit.readings import Reading
from testbed.studies.scoam.audit.row import Row
from vosc.vec import FloatArray


class Together(NamedTuple):
    """Some rows under one reading, and the smallest common multiple of their tolerances."""

    reading: str
    what: str
    quantities: tuple[str, ...]
    multiple: float


PROGRAMS = 8
DIFFERENCE = 0.02


def together(reading: Reading, rows: Sequence[Row]) -> float:
    """Smallest multiple of the printed tolerances within which all ``rows`` (printed numbers, not relations) hold at once."""
    given = numbers(reading)
    centre = {key: number.value for key, number in given.items()}

    def values(unit: FloatArray) -> tuple[FloatArray, set[str]]:
        case = Case({**centre, **{key: centre[key] + u * given[key].half_ulp for key, u in zip(axes, unit, strict=True)}}, reading.switches)
        return np.array([row.formula(case) for row in rows]), case.used

    axes: list[str] = []
    axes = [key for key in sorted(values(np.zeros(0))[1]) if given[key].half_ulp > 0.0]
    middle = np.array([0.5 * (row.low + row.high) for row in rows])
    tolerance = np.array([0.5 * (row.high - row.low) for row in rows])
    unit, best = np.zeros(len(axes)), np.inf
    for step in range(PROGRAMS):
        miss = (values(unit)[0] - middle) / tolerance
        best = min(best, float(np.abs(miss).max()))
        slopes = np.empty((len(rows), len(axes)))
        for i in range(len(axes)):
            moved = unit.copy()
            moved[i] += DIFFERENCE if unit[i] <= 0.0 else -DIFFERENCE
            slopes[:, i] = ((values(moved)[0] - middle) / tolerance - miss) / (moved[i] - unit[i])
        reach = 2.0 * 0.7**step
        one = np.ones((len(rows), 1))
        found = linprog(
            np.append(np.zeros(len(axes)), 1.0),
            A_ub=np.block([[slopes, -one], [-slopes, -one]]),
            b_ub=np.concatenate([slopes @ unit - miss, miss - slopes @ unit]),
            bounds=[(max(-1.0, u - reach), min(1.0, u + reach)) for u in unit] + [(0.0, None)],
        )
        if found.x is None:
            break
        unit = np.asarray(found.x[:-1])
    return min(best, float(np.abs((values(unit)[0] - middle) / tolerance).max()))
