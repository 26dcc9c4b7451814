"""Rows by what they are: part of the campaign, encounter, method, aircraft, rung, air. Nothing is judged here but a single flight.

A row is what ``rows.jsonl`` holds; its labels are in ``row["labels"]``, a label that is absent is "". Clearances in m.
"""

import math
from collections import defaultdict
from collections.abc import Iterable
from typing import Any, Final

from testbed.flight.record import TOUCH_M, Outcome
from testbed.results.rows import Row, keeps
from testbed.results.rows import value as number

MARGINAL_M: Final = 0.15  # three times what the flight loop's rate may change a least clearance by
SINGLE: Final = ("single_106", "single_106_10")  # readings of section 5.1 in which its obstacle is a threat
MULTI: Final = ("multi_as_printed", "multi_o2_up")
DROAM: Final = ("droam_hp", "droam_vp")
SIDES: Final = {"droam_hp": ("droam_hp_left", "droam_hp_right"), "droam_vp": ("droam_vp_up", "droam_vp_down")}
MAIN: Final = "gtm_t2"  # flies the geometry that the paper prints
AIR: Final = ("design", "wind_mps", "wind_from", "severity")
NEVER_FLEW: Final = (Outcome.CRASHED.value, Outcome.TRIM_FAILED.value)


def label(row: Row, name: str) -> str:
    """A label of the row, "" where it has none."""
    return str(row.get("labels", {}).get(name, ""))


def part_of(row: Row) -> str:
    """The part of the campaign; the draws of several encounters are parts of their own, and together one."""
    part = label(row, "part")
    return "robustness" if part.startswith("robustness_") else part


def clearance(row: Row | None) -> float:
    """Least clearance, m; a touch (less than a micrometre either way) is exactly 0."""
    value = number(row, "least_clearance_m")
    return 0.0 if abs(value) <= TOUCH_M else value


def flew(row: Row) -> bool:
    """Whether the flight says anything: a program that failed, a trim that was not found and a missing figure do not."""
    return row.get("outcome") not in NEVER_FLEW and not math.isnan(number(row, "least_clearance_m"))


def marginal(row: Row) -> bool:
    """Nearer to the radius than the method of measurement can tell; a touch is exact and no such case."""
    return 0.0 < abs(clearance(row)) < MARGINAL_M


def air_of(row: Row) -> tuple[str, ...]:
    """The labels of the air, "" for those that a part does not have."""
    return tuple(label(row, name) for name in AIR)


class Flights:
    """All rows, found by label. Flights that say nothing are left out here and counted in ``silent``.

    The rows are put in one order whatever the order in which the flights ended.
    """

    def __init__(self, rows: Iterable[Row]):
        self.all = tuple(sorted(rows, key=_order))
        self.silent = tuple(row for row in self.all if not flew(row))
        self._found: dict[tuple[str, str, str], list[Row]] = defaultdict(list)
        self._idle: dict[tuple[str, ...], Row] = {}
        for row in self.all:
            if flew(row):
                self._found[(part_of(row), label(row, "method"), label(row, "rung"))].append(row)
                if label(row, "method") == "none":
                    self._idle[_place(row)] = row

    def pick(self, part: str, method: str, rung: str, **labels: str) -> list[Row]:
        """The flights with these labels."""
        found = self._found.get((part, method, rung), [])
        return [row for row in found if all(label(row, name) == value for name, value in labels.items())]

    def one(self, part: str, method: str, rung: str, **labels: str) -> Row | None:
        """The only, or the first such flight."""
        found = self.pick(part, method, rung, **labels)
        return found[0] if found else None

    def values(self, part: str, name: str) -> list[str]:
        """The values of a label in a part, in the order of the rows."""
        return list(dict.fromkeys(label(row, name) for row in self.all if label(row, "part") == part))

    def idle(self, row: Row) -> Row | None:
        """The flight without planner in the same place and air."""
        return self._idle.get(_place(row))

    def is_threat(self, row: Row) -> bool:
        """Whether the flight without planner fails to keep a radius; taken to be so where that was not flown."""
        idle = self.idle(row)
        return idle is None or not keeps(idle)

    def on_rails(self, row: Row) -> Row | None:
        """The kinematic partner: the same encounter, method and aircraft; in wind in the same wind, in turbulence in calm air."""
        part = label(row, "part")
        labels = {name: label(row, name) for name in ("encounter", "flown_by", "design", "wind_mps", "wind_from")}
        if part == "turbulence":
            part, labels = "calm", {name: labels[name] for name in ("encounter", "flown_by")}
        found = self.pick(part, label(row, "method"), "kinematic", **labels)
        replicates = [other for other in found if other.get("replicate") == row.get("replicate")]
        return next(iter(replicates or (found if label(row, "part") == "turbulence" else [])), None)


def _order(row: Row) -> tuple[Any, ...]:
    """The aircraft of the paper's geometry first, weak air before strong; names otherwise."""
    aircraft, wind = label(row, "flown_by"), label(row, "wind_mps")
    speed = float(wind) if wind.replace(".", "", 1).isdigit() else math.inf
    names = tuple(label(row, name) for name in ("design", "wind_from", "severity", "method", "rung", "class"))
    who = (label(row, "part"), label(row, "encounter"), aircraft != MAIN, aircraft, speed)
    return (*who, *names, row.get("replicate") or 0, str(row.get("flight_id")))


def _place(row: Row) -> tuple[str, ...]:
    names = ("part", "encounter", "flown_by", "rung", "class")
    return (*(label(row, name) for name in names), str(row.get("replicate")), *air_of(row))
