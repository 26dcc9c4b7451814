"""Two runs flight by flight: pairs of the same encounter, and what differs within them. Rows in, figures out; nothing is drawn.

A pair are two flights whose labels on the chosen axes and whose replicate are the same. Differences are the second run's less the first's.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from testbed.flight.record import Outcome
from testbed.results import statistics
from testbed.results.columns import BY_NAME, Column, Kind, read_aloud
from testbed.results.flight_row import keeps, met_obstacle, value
from testbed.results.statistics import Effect

Row = Mapping[str, Any]
Key = tuple[tuple[str, ...], int]
"""Labels on the chosen axes, and the replicate."""

MOST_BY_CELL: Final = 4
BETTER, WORSE, CHANGED, SAME = "better", "worse", "changed", "same"
FOUND: Final = "found"
"""Key of a row in which a study that flies by itself has put its figures."""


class NotComparableError(ValueError):
    """Two runs cannot be compared; str() says why."""


@dataclass(frozen=True)
class Flight:
    """What is compared of a flight."""

    flight_id: str
    labels: Mapping[str, str]
    replicate: int
    outcome: str
    kept: bool | None
    """None: there was nothing to keep clear of."""
    values: Mapping[str, float]


@dataclass(frozen=True)
class Pair:
    """The same flight in both runs."""

    key: Key
    first: Flight
    second: Flight


@dataclass(frozen=True)
class Difference:
    """A metric over the pairs in which both runs have it: medians of either, and the median of the differences with its interval."""

    column: Column
    first: float
    second: float
    effect: Effect
    largest: float
    """Of all differences, either side."""
    up: int
    down: int
    """Pairs in which it is more, and less, in the second run."""

    @property
    def tone(self) -> str:
        """What its interval shows: a change for better or worse, some change, or none."""
        if not self.effect.low * self.effect.high > 0.0:  # NaN too: too few pairs for an interval
            return SAME
        if not self.column.worse:
            return CHANGED
        return WORSE if (self.effect.value < 0.0) == (self.column.worse == "low") else BETTER


@dataclass(frozen=True)
class ShareDifference:
    """In how many pairs something holds in either run, and in just one of them."""

    name: str
    first: int
    second: int
    only_first: int
    only_second: int
    effect: Effect
    p: float

    @property
    def tone(self) -> str:
        """As of ``Difference``; more is better."""
        if not self.effect.low * self.effect.high > 0.0:
            return SAME
        return BETTER if self.effect.value > 0.0 else WORSE


@dataclass(frozen=True)
class Cell:
    """The pairs of one cell."""

    labels: Mapping[str, str]
    n: int
    kept: ShareDifference | None
    differences: tuple[Difference, ...]


@dataclass(frozen=True)
class Compared:
    """What differs between two runs."""

    axes: tuple[str, ...]
    """By which they were paired, beside the replicate."""
    pairs: tuple[Pair, ...]
    only_first: int
    only_second: int
    shares: tuple[ShareDifference, ...]
    differences: tuple[Difference, ...]
    outcomes: Mapping[tuple[str, str], int]
    cells: tuple[Cell, ...]


def flight(row: Row, columns: Sequence[str]) -> Flight:
    """What is compared of a row. ``columns``: of the metrics; a row of a study that flies by itself has its own."""
    found = row.get(FOUND)
    values = {name: float(x) for name, x in found.items() if isinstance(x, int | float)} if found else {n: value(row, n) for n in columns}
    kept = keeps(row) if not found and met_obstacle(row) else None
    return Flight(row["flight_id"], row["labels"], int(row["replicate"]), row["outcome"], kept, values)


def compare(first: Sequence[Flight], second: Sequence[Flight], on: Sequence[str] = (), by_cell: Sequence[str] = ()) -> Compared:
    """The second run less the first. Raises ``NotComparableError``.

    ``on``: axes to pair by; default: all that both have, but for those on which each run has one label, and they are not the same: that
    is what is compared. ``by_cell``: metrics that are told of each cell, where they were measured.
    """
    axes = _axes(first, second, on)
    sides = [_by_key(flights, axes, name) for flights, name in ((first, "first"), (second, "second"))]
    pairs = tuple(Pair(key, one, sides[1][key]) for key, one in sides[0].items() if key in sides[1])
    if not pairs:
        raise NotComparableError(_no_pairs(first, second, axes))
    cells: dict[tuple[str, ...], list[Pair]] = {}
    for pair in pairs:
        cells.setdefault(pair.key[0], []).append(pair)
    names = list(dict.fromkeys(name for pair in pairs for name in pair.first.values if name in pair.second.values))
    if not names:
        raise NotComparableError("the two runs measured nothing alike: one is of flights, the other of a study's searches")
    told = [name for name in by_cell if name in names] or names[:MOST_BY_CELL]
    return Compared(
        axes,
        pairs,
        len(sides[0]) - len(pairs),
        len(sides[1]) - len(pairs),
        _shares(pairs),
        _differences(pairs, names),
        Counter((pair.first.outcome, pair.second.outcome) for pair in pairs),
        tuple(_cell(dict(zip(axes, labels, strict=True)), members, told) for labels, members in cells.items()),
    )


def _axes(first: Sequence[Flight], second: Sequence[Flight], on: Sequence[str]) -> tuple[str, ...]:
    there = [list(dict.fromkeys(axis for one in flights for axis in one.labels)) for flights in (first, second)]
    both = [axis for axis in there[0] if axis in there[1]]
    if unknown := [axis for axis in on if axis not in both]:
        raise NotComparableError(f"'{unknown[0]}' is no axis of both runs; there are: {', '.join(both) or 'none'}")
    return tuple(on or (axis for axis in both if not _is_compared(axis, first, second)))


def _is_compared(axis: str, first: Sequence[Flight], second: Sequence[Flight]) -> bool:
    """Whether an axis tells the runs apart, rather than flights of them."""
    mine, theirs = ({one.labels.get(axis, "") for one in flights} for flights in (first, second))
    return len(mine) == len(theirs) == 1 and mine != theirs


def _by_key(flights: Iterable[Flight], axes: Sequence[str], which: str) -> dict[Key, Flight]:
    found: dict[Key, Flight] = {}
    for one in flights:
        key = tuple(one.labels.get(axis, "") for axis in axes), one.replicate
        if (other := found.setdefault(key, one)) is not one:
            differ = [axis for axis in one.labels if one.labels.get(axis) != other.labels.get(axis)]
            named = ", ".join(f"{axis} {label}" for axis, label in zip(axes, key[0], strict=True)) or "the same replicate"
            raise NotComparableError(
                f"several flights of the {which} run have {named}; they differ in {', '.join(differ) or 'nothing'}, "
                "so that it is open which is to be paired: pair by axes that tell them apart (--on)"
            )
    return found


def _no_pairs(first: Sequence[Flight], second: Sequence[Flight], axes: Sequence[str]) -> str:
    for axis in axes:
        mine, theirs = ({one.labels.get(axis, "") for one in flights} for flights in (first, second))
        if not mine & theirs:
            return (
                f"no flight of one run has a partner in the other: on the axis {axis} one has {_few(mine)}, the other {_few(theirs)}; "
                "to pair by other axes: --on AXIS"
            )
    return "no flight of one run has a partner in the other"


def _few(labels: Iterable[str]) -> str:
    every = sorted(labels)
    return ", ".join(every[:4]) + (", ..." if len(every) > 4 else "")


def _shares(pairs: Sequence[Pair]) -> tuple[ShareDifference, ...]:
    known = [pair for pair in pairs if pair.first.kept is not None and pair.second.kept is not None]
    kept = [_share("keeps every radius", known, lambda one: bool(one.kept))] if known else []
    if any(_reaches(one) for pair in pairs for one in (pair.first, pair.second)):
        kept.append(_share("reaches the goal", pairs, _reaches))
    return tuple(kept)


def _reaches(one: Flight) -> bool:
    return one.outcome == Outcome.REACHED


def _share(name: str, pairs: Sequence[Pair], holds: Callable[[Flight], bool]) -> ShareDifference:
    count = Counter((holds(pair.first), holds(pair.second)) for pair in pairs)
    only_first, only_second = count[True, False], count[False, True]
    effect = statistics.share_difference(name, only_first, only_second, len(pairs))
    both = count[True, True]
    return ShareDifference(
        name, both + only_first, both + only_second, only_first, only_second, effect, statistics.mcnemar(only_first, only_second)
    )


def _differences(pairs: Sequence[Pair], names: Iterable[str]) -> tuple[Difference, ...]:
    found = []
    for name in names:
        both = [
            (pair.first.values[name], pair.second.values[name])
            for pair in pairs
            if name in pair.first.values and name in pair.second.values
        ]
        known = [(a, b) for a, b in both if math.isfinite(a) and math.isfinite(b)]
        if not known:
            continue
        column = BY_NAME.get(name) or Column(name, Kind.NUMBER, _unit(name), _heading(name), 2, "", "")
        changes = [b - a for a, b in known]
        first, second = (statistics.spread(side).median for side in zip(*known, strict=True))
        effect = statistics.median(name, column.unit, changes)
        found.append(
            Difference(column, first, second, effect, max(changes, key=abs), sum(x > 0.0 for x in changes), sum(x < 0.0 for x in changes))
        )
    return tuple(found)


_UNITS: Final = {"s": "s", "m": "m", "mps": "m/s", "deg": "deg"}


def _unit(name: str) -> str:
    return _UNITS.get(name.rpartition("_")[2], "")


def _heading(name: str) -> str:
    return read_aloud(name.rpartition("_")[0] if _unit(name) else name)


def _cell(labels: Mapping[str, str], pairs: Sequence[Pair], names: Iterable[str]) -> Cell:
    shares = [share for share in _shares(pairs) if share.name == "keeps every radius"]
    return Cell(labels, len(pairs), shares[0] if shares else None, _differences(pairs, names))
