"""Two runs flight by flight: pairs of the same encounter, and what differs within them. Rows in, figures out; nothing is drawn.

A pair are two flights whose labels on the chosen axes and whose replicate are the same. Differences are the second run's less the first's.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any, Final

from testbed.campaign.words.grid import PART
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
CLEARANCE: Final = "least_clearance_m"
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
    avoids: bool = True
    """Whether a method of avoidance was flown."""


Swept = Mapping[str, Mapping[str, Set[str]]]
"""Part (an empty name without parts) to axis to its labels over all that is planned; an empty label where a flight is without the axis."""


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
    lost: int = 0
    """Of clearances: pairs that no longer keep every radius. No median makes up for those."""

    @property
    def tone(self) -> str:
        """What its interval shows: a change for better or worse, some change, or none."""
        low, high = (round(bound, self.column.digits) for bound in (self.effect.low, self.effect.high))  # as they are told
        if not low * high > 0.0:  # NaN too: too few pairs for an interval
            return SAME
        if not self.column.worse:
            return CHANGED
        if (self.effect.value < 0.0) == (self.column.worse == "low"):
            return WORSE
        return CHANGED if self.lost else BETTER


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
    lead: Cell
    """The pairs that a headline is told of: without those in which neither flight avoids, unless there are no others."""


def flight(row: Row, columns: Sequence[str]) -> Flight:
    """What is compared of a row. ``columns``: of the metrics; a row of a study that flies by itself has its own."""
    found = row.get(FOUND)
    values = {name: float(x) for name, x in found.items() if isinstance(x, int | float)} if found else {n: value(row, n) for n in columns}
    kept = keeps(row) if not found and met_obstacle(row) else None
    return Flight(row["flight_id"], row["labels"], int(row["replicate"]), row["outcome"], kept, values, row.get("method") != "none")


def swept(planned: Iterable[Mapping[str, str]]) -> Swept:
    """Axes and labels of each part, from the labels of all flights."""
    found: dict[str, dict[str, set[str]]] = {}
    flights: Counter[str] = Counter()
    with_axis: Counter[tuple[str, str]] = Counter()
    for labels in planned:
        part = labels.get(PART, "")
        flights[part] += 1
        for axis, label in labels.items():
            found.setdefault(part, {}).setdefault(axis, set()).add(label)
            with_axis[part, axis] += 1
    for (part, axis), n in with_axis.items():
        if n < flights[part]:
            found[part][axis].add("")
    return {part: found.get(part, {}) for part in flights}


def compare(
    first: Sequence[Flight],
    second: Sequence[Flight],
    on: Sequence[str] = (),
    by_cell: Sequence[str] = (),
    planned: tuple[Swept, Swept] | None = None,
) -> Compared:
    """The second run less the first. Raises ``NotComparableError``.

    ``on``: axes to pair by; default: of each part all that both have, but for those on which each run has one label, and they are not the
    same: that is what is compared. ``by_cell``: metrics that are told of each cell, where they were measured. ``planned``: what the runs
    sweep, flown yet or not; default: what the flights have.
    """
    by_part = _axes(*(planned or (swept(one.labels for one in first), swept(one.labels for one in second))), on)
    found = dict.fromkeys(axis for axes in by_part.values() for axis in axes)
    order = dict.fromkeys(axis for one in (*first, *second) for axis in one.labels)  # that of the campaign, which a plan does not keep
    axes = tuple(on) or (*(axis for axis in order if axis in found), *(axis for axis in found if axis not in order))
    sides = [_by_key(flights, axes, by_part, name) for flights, name in ((first, "first"), (second, "second"))]
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
        _cell({}, [pair for pair in pairs if pair.first.avoids or pair.second.avoids] or pairs, names),
    )


def _axes(first: Swept, second: Swept, on: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """Part to the axes by which its flights are paired; that of an empty name is for all parts that are not named."""
    one, other = _together(first), _together(second)
    both = [axis for axis in one if axis in other]
    if unknown := [axis for axis in on if axis not in both]:
        raise NotComparableError(f"'{unknown[0]}' is no axis of both runs; there are: {', '.join(both) or 'none'}")
    if on:
        return {"": tuple(on)}
    parts = [part for part in first if part and part in second]
    return {part: _of_both(first[part], second[part]) for part in parts} | {"": _of_both(one, other)}


def _together(parts: Swept) -> dict[str, set[str]]:
    """The labels of each axis over all parts."""
    every = dict.fromkeys(axis for axes in parts.values() for axis in axes)
    return {axis: set().union(*(axes.get(axis, {""}) for axes in parts.values())) for axis in every}


def _of_both(first: Mapping[str, Set[str]], second: Mapping[str, Set[str]]) -> tuple[str, ...]:
    """The axes that both have, without those that tell the runs apart, rather than flights of them."""
    return tuple(
        axis for axis in first if axis in second and not (len(first[axis]) == len(second[axis]) == 1 and first[axis] != second[axis])
    )


def _by_key(flights: Iterable[Flight], axes: Sequence[str], by_part: Mapping[str, Sequence[str]], which: str) -> dict[Key, Flight]:
    found: dict[Key, Flight] = {}
    for one in flights:
        own = by_part.get(one.labels.get(PART, ""), by_part[""])
        key = tuple(one.labels.get(axis, "") if axis in own else "" for axis in axes), one.replicate
        if (other := found.setdefault(key, one)) is not one:
            differ = [axis for axis in one.labels if one.labels.get(axis) != other.labels.get(axis)]
            named = ", ".join(f"{axis} {label}" for axis, label in zip(axes, key[0], strict=True) if label) or "the same replicate"
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
        up, down = sum(x > 0.0 for x in changes), sum(x < 0.0 for x in changes)
        lost = sum(bool(pair.first.kept) and pair.second.kept is False for pair in pairs) if name == CLEARANCE else 0
        found.append(Difference(column, first, second, effect, max(changes, key=abs), up, down, lost))
    return tuple(found)


_UNITS: Final = {"s": "s", "m": "m", "mps": "m/s", "deg": "deg"}


def _unit(name: str) -> str:
    return _UNITS.get(name.rpartition("_")[2], "")


def _heading(name: str) -> str:
    return read_aloud(name.rpartition("_")[0] if _unit(name) else name)


def _cell(labels: Mapping[str, str], pairs: Sequence[Pair], names: Iterable[str]) -> Cell:
    shares = [share for share in _shares(pairs) if share.name == "keeps every radius"]
    return Cell(labels, len(pairs), shares[0] if shares else None, _differences(pairs, names))
