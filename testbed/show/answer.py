"""What came of a run, in three lines and a small picture: for the end of `testbed run`, and for the list of runs.

It is taken from the rows as they go by, and kept in the run's ``answer.json``, so that a list of runs reads a small file of each.
"""

import math
from array import array
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Final

from testbed.flight.record import Outcome
from testbed.results.checks import CheckResult
from testbed.results.columns import WEIGHT
from testbed.results.flight_row import collided, keeps, met_obstacle, value
from testbed.results.statistics import spread
from testbed.show import words
from testbed.show.alike import Cells, Share, Who, listed_parts
from testbed.show.hero import UNWEIGHED, check_answer

Row = dict[str, Any]

MOST_BARS: Final = 6
MOST_NAMED: Final = 3
"""Methods, or flyers, that a line tells of one by one; of more the best and the worst."""
KEPT, BAD, UNSURE = "good", "bad", "warn"
TONES: Final = (KEPT, BAD, UNSURE, "")


@dataclass(frozen=True)
class Bar:
    """A line of the small picture. Of clearances: 5th percentile, median, 95th percentile. Of a count: ``median`` is the count."""

    name: str
    low: float
    median: float
    high: float
    n: int
    tone: str


@dataclass(frozen=True)
class Answer:
    """What came out. ``flight``: the one to look at first, empty if none."""

    lines: tuple[str, ...]
    bars: tuple[Bar, ...] = ()
    of: str = "clearance"
    """What the bars are: ``clearance`` in metres or ``count``."""
    flight: str = ""

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)


def read(said: Any) -> Answer | None:
    """An answer that was stored, by whomever; None if it is none."""
    try:
        answer = Answer(tuple(said["lines"]), tuple(Bar(**bar) for bar in said["bars"]), said["of"], said["flight"])
        return answer if isinstance(said["lines"], list) and _is_sound(answer) else None
    except (TypeError, KeyError, OverflowError):
        return None


def _is_sound(answer: Answer) -> bool:
    numbers = [number for bar in answer.bars for number in (bar.low, bar.median, bar.high, bar.n)]
    return (
        all(isinstance(text, str) for text in (*answer.lines, answer.of, answer.flight, *(bar.name for bar in answer.bars)))
        and all(isinstance(number, int | float) and math.isfinite(number) for number in numbers)
        and all(bar.tone in TONES for bar in answer.bars)
    )


@dataclass
class _Group:
    """Flights of one flyer with one method."""

    n: int = 0
    kept: int = 0
    clearances: "array[float]" = field(default_factory=lambda: array("d"))

    def count(self, row: Row) -> None:
        self.n += 1
        self.kept += keeps(row)
        self.clearances.append(value(row, "least_clearance_m"))


class Tally:
    """Counts that an answer is made of."""

    def __init__(self) -> None:
        self._cells = Cells()
        self._bars: dict[str, _Group] = {}
        self._nearest: tuple[float, Row] | None = None
        self._farthest: tuple[float, Row] | None = None
        self._outcomes: Counter[str] = Counter()
        self._weighted = False

    def add(self, row: Row) -> None:
        """One more flight."""
        self._weighted |= row.get(WEIGHT.name, 1.0) != 1.0
        self._outcomes[row["outcome"]] += 1
        off = value(row, "cross_track_max_m")
        if math.isfinite(off) and (self._farthest is None or off > self._farthest[0]):
            self._farthest = off, row
        if not met_obstacle(row):
            return
        flyer, method = words.flyer(row["plant"], row["aircraft"]), words.method_with(row["method"], row["labels"])
        self._cells.add(row)
        self._bars.setdefault(f"{flyer}, {method}", _Group()).count(row)
        clearance = value(row, "least_clearance_m")
        if row["method"] != "none" and (self._nearest is None or clearance < self._nearest[0]):
            self._nearest = clearance, row

    def answer(self, checks: Sequence[CheckResult] = ()) -> Answer:
        """What came out; of a check whether it passed."""
        lines = [check_answer(checks)] if checks else []
        if failed := self._outcomes[Outcome.CRASHED.value]:
            lines.append(_failed(failed, self._outcomes.total()))
        if self._bars:
            alike = f" {UNWEIGHED}" if self._weighted else ""
            lines.append(f"Every radius was kept {_by_method(self._cells)}.{alike}")
        avoiding = self._cells.alike("flyer", which=_avoids)
        flyers = {name: share for (name,), share in avoiding.items()}
        if len(flyers) > 1 and len(self._cells.names("method")) > 1:
            lines.append(f"With avoidance it was kept {_each(flyers, 'by ')}{self._cells.note(avoiding, _avoids)}.")
        chosen = self._nearest or self._farthest
        if chosen is not None:
            lines.append(_looked_at(*chosen, met=self._nearest is not None))
        if not lines and self._outcomes:
            lines.append(f"Nothing could be measured: {words.outcomes(self._outcomes)}.")
        bars = tuple(_bar(name, group) for name, group in list(self._bars.items())[:MOST_BARS])
        return Answer(tuple(lines[:3]), bars, flight=chosen[1]["flight_id"] if chosen else "")


def _avoids(who: Who) -> bool:
    return who.avoids


def _by_method(cells: Cells) -> str:
    told = [f"{f'in {one.part} ' if one.part else ''}{_each(one.shares, 'with ')}{one.note}" for one in cells.by_method()]
    return listed_parts(told)


def _each(groups: Mapping[str, Share], before: str) -> str:
    """``with SCOAM in 1 of 2 flights and with no avoidance in 0 of 2``; of many the best and the worst."""
    named = list(groups.items())
    if len(named) <= MOST_NAMED:
        return words.listed([f"{before}{name} in {group.told()}" for name, group in named])
    ranked = sorted(named, key=lambda item: item[1].kept / item[1].n)
    (worst, least), (best, most) = ranked[0], ranked[-1]
    return f"most often {before}{best}, in {most.told()}, and least often {before}{worst}, in {least.told()} ({len(named)} compared)"


def _failed(failed: int, flights: int) -> str:
    """How many have no result, which the counts after it are without."""
    if failed < flights:
        return f"{failed} of {flights} flights failed to run."
    who = {1: "Its only flight", 2: "Both flights"}.get(flights, f"All {flights} flights")
    return f"{who} failed to run."


def _looked_at(amount: float, row: Row, met: bool) -> str:
    who = f"{words.flyer(row['plant'], row['aircraft'])}, {words.method_with(row['method'], row['labels'])}"
    if not met:
        return f"Farthest from its path: {words.number(amount, 2, 'm')} ({who}; flight {row['flight_id']})."
    where = f"{words.number(-amount, 2, 'm')} inside" if collided(row) else f"{words.number(amount, 2, 'm')} clear"
    return f"Closest with avoidance: {where} ({who}; flight {row['flight_id']})."


def _bar(name: str, group: _Group) -> Bar:
    of = spread(group.clearances)
    tone = KEPT if group.kept == group.n else BAD if group.kept == 0 else UNSURE
    return Bar(name, of.p05, of.median, of.p95, of.n, tone)


def counted_bars(counts: Iterable[tuple[str, int, str]]) -> tuple[Bar, ...]:
    """Bars of counts: (name, count, tone) of each."""
    return tuple(Bar(name, 0.0, float(count), 0.0, count, tone) for name, count, tone in counts)
