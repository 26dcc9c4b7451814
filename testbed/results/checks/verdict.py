"""What a check is made of: evidence that a record leaves behind, flights to judge, and the lines of a judgement."""

import csv
import io
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from testbed.campaign.words.settings import FlightPlan
from testbed.flight.record import FlightRecord

Evidence = dict[str, Any]
"""What a check needs of one record: numbers and lists of numbers, small enough for a line of rows.jsonl."""


@dataclass(frozen=True)
class Flown:
    """A flight to be judged: its plan, and its row, which holds the evidence."""

    plan: FlightPlan
    row: Mapping[str, Any]

    def __getitem__(self, name: str) -> Any:
        """A piece of evidence."""
        return self.row["evidence"][name]


@dataclass(frozen=True)
class CheckResult:
    """One line of a judgement."""

    quantity: str
    unit: str
    truth: float
    measured: float
    tolerance: float

    @property
    def passed(self) -> bool:
        return self.off <= self.tolerance  # false for NaN

    @property
    def off(self) -> float:
        return abs(self.measured - self.truth)

    @property
    def word(self) -> str:
        return "passed" if self.passed else "missed"


@dataclass(frozen=True)
class Judge:
    """``gather`` runs where the flight was flown, ``judge`` on all flights together and without any record."""

    gather: Callable[[Any, FlightRecord], Evidence]
    judge: Callable[[Any, Sequence[Flown]], Iterable[CheckResult]]


def nothing(_check: Any, _record: FlightRecord) -> Evidence:
    """For a check that finds what it needs in the row itself."""
    return {}


def flown_by(plan: FlightPlan) -> str:
    """Plant, and the aircraft where there is one."""
    return plan.plant.kind if plan.plant.kind == "kinematic" else f"{plan.plant.kind} {plan.aircraft}"


def groups(flights: Sequence[Flown], key: Callable[[FlightPlan], str]) -> Iterable[tuple[str, list[Flown]]]:
    """Flights of equal key, keys in the order of their first flight."""
    order = list(dict.fromkeys(key(flight.plan) for flight in flights))
    return ((name, [flight for flight in flights if key(flight.plan) == name]) for name in order)


def worst(results: Sequence[CheckResult]) -> CheckResult:
    """The one that is off most; NaN counts as most."""
    return max(results, key=lambda r: math.inf if math.isnan(r.off) else r.off / r.tolerance)


def csv_bytes(kind: str, results: Iterable[CheckResult]) -> bytes:
    """The lines as CSV; a float is written with the fewest digits that read back as the same float, NaN as nothing."""
    out = io.StringIO(newline="")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["check", "quantity", "unit", "truth", "measured", "tolerance", "verdict"])
    for line in results:
        numbers = ("" if math.isnan(value) else repr(value) for value in (line.truth, line.measured, line.tolerance))
        writer.writerow([kind, line.quantity, line.unit, *numbers, line.word])
    return out.getvalue().encode()
