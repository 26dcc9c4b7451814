"""Counts of flights that may stand beside each other: who kept every radius, counted only where each of those compared was flown.

Circumstances are the part of the campaign and all labels but those that say who is compared.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Final

from testbed.campaign.words.grid import PART
from testbed.results.flight_row import keeps, value
from testbed.results.statistics import share_interval
from testbed.show import words

ENOUGH_FOR_INTERVAL: Final = 10  # flights below which an interval says no more than the two counts
MOST_PARTS: Final = 6
NO_AVOIDANCE: Final = words.method("none")
BY_NAME: Final[Mapping[str, tuple[str, ...]]] = {"flyer": ("plant.kind", "aircraft"), "method": ("method.kind",)}
"""Axes that say who is compared whatever their labels are."""


@dataclass
class Share:
    """How many flights kept every radius, of how many. ``drawn``: whether in each cell something was drawn, so that no two are the same."""

    n: int = 0
    kept: int = 0
    drawn: bool = True

    def more(self, other: "Share") -> None:
        """Those of another cell too."""
        self.n += other.n
        self.kept += other.kept
        self.drawn &= other.drawn

    def told(self, noun: str = "") -> str:
        """``12 of 40``, with an interval if these are a sample: cells that were flown once, or always alike, are none."""
        text = f"{self.kept} of {words.counted(self.n, noun) if noun else self.n}"
        if self.n >= ENOUGH_FOR_INTERVAL and self.drawn:
            text += f" (95 % interval {words.interval(*share_interval(self.kept, self.n), 'share')})"
        return text


@dataclass
class _Cell:
    """The flights of one cell."""

    n: int = 0
    kept: int = 0
    low_m: float = float("inf")
    high_m: float = float("-inf")

    def count(self, row: Mapping[str, Any]) -> None:
        clearance_m = value(row, "least_clearance_m")
        self.n += 1
        self.kept += keeps(row)
        self.low_m, self.high_m = min(self.low_m, clearance_m), max(self.high_m, clearance_m)

    @property
    def share(self) -> Share:
        return Share(self.n, self.kept, self.low_m < self.high_m)


@dataclass(frozen=True)
class Who:
    """Of which flights a cell is."""

    flyer: str
    method: str
    labels: tuple[tuple[str, str], ...]

    @property
    def part(self) -> str:
        """Empty without parts."""
        return dict(self.labels).get(PART, "")

    @property
    def avoids(self) -> bool:
        return self.method != NO_AVOIDANCE


def everybody(_: Who) -> bool:
    """Leaves nobody out."""
    return True


def _is_in(part: str, which: Callable[[Who], bool], who: Who) -> bool:
    return who.part == part and which(who)


def listed_parts(told: list[str]) -> str:
    """What is said of each part, of very many of the first ones."""
    left = len(told) - MOST_PARTS
    return "; ".join([*told[:MOST_PARTS], *([f"and so on in {words.counted(left, 'more part')}"] if left > 0 else [])])


@dataclass(frozen=True)
class InPart:
    """Methods that are told together. ``part`` is empty if it is all parts together; ``note``: on what the counts rest."""

    part: str
    shares: Mapping[str, Share]
    note: str = ""


@dataclass
class _Same:
    """Axes that are just what is compared once more: each label goes with one name, and each name with one label."""

    names: dict[tuple[str, str], str] = field(default_factory=dict)
    labels: dict[tuple[str, str], str] = field(default_factory=dict)
    others: set[str] = field(default_factory=set)

    def watch(self, name: str, labels: Iterable[tuple[str, str]]) -> None:
        for axis, label in labels:
            if self.names.setdefault((axis, label), name) != name or self.labels.setdefault((axis, name), label) != label:
                self.others.add(axis)


class Cells:
    """Flights that met an obstacle, counted by cell."""

    def __init__(self) -> None:
        self._cells: dict[Who, _Cell] = {}
        self._same = {"flyer": _Same(), "method": _Same()}

    def add(self, row: Mapping[str, Any]) -> None:
        """One more flight."""
        labels = tuple((axis, str(label)) for axis, label in row["labels"].items())
        who = Who(words.flyer(str(row["plant"]), str(row["aircraft"])), words.method_with(str(row["method"]), row["labels"]), labels)
        cell = self._cells.get(who)
        if cell is None:
            cell = self._cells[who] = _Cell()
            self._same["flyer"].watch(who.flyer, labels)
            self._same["method"].watch(who.method, labels)
        cell.count(row)

    def parts(self, which: Callable[[Who], bool] = everybody) -> list[str]:
        """Parts of the campaign in which they were flown."""
        return list(dict.fromkeys(who.part for who in self._cells if which(who)))

    def names(self, what: str, which: Callable[[Who], bool] = everybody) -> list[str]:
        """Flyers, or methods."""
        return list(dict.fromkeys(str(getattr(who, what)) for who in self._cells if which(who)))

    def counted(self, what: str, which: Callable[[Who], bool] = everybody) -> dict[str, Share]:
        """Each flyer's, or method's, flights, whatever the circumstances: these do not stand beside each other."""
        found: dict[str, Share] = {}
        for who, cell in self._cells.items():
            if which(who):
                found.setdefault(str(getattr(who, what)), Share()).more(cell.share)
        return found

    def alike(self, *compared: str, which: Callable[[Who], bool] = everybody) -> dict[tuple[str, ...], Share]:
        """By ``flyer``, ``method`` or both the flights in circumstances in which each was flown; empty if there are no such ones."""
        there: dict[Any, dict[tuple[str, ...], Share]] = {}
        everyone: dict[tuple[str, ...], None] = {}
        for who, cell in self._cells.items():
            if which(who):
                name = tuple(str(getattr(who, what)) for what in compared)
                everyone.setdefault(name)
                there.setdefault(self._circumstances(who, compared), {}).setdefault(name, Share()).more(cell.share)
        found: dict[tuple[str, ...], Share] = {}
        for shares in there.values():
            if len(shares) == len(everyone):
                for name in everyone:
                    found.setdefault(name, Share()).more(shares[name])
        return found

    def by_method(self, which: Callable[[Who], bool] = everybody) -> list[InPart]:
        """Methods where each was flown in the same circumstances. Where there are no such ones, part for part."""
        if shares := self.alike("method", which=which):
            return [self._in_part("", shares, which)]
        found = []
        for part in self.parts(which):
            here = partial(_is_in, part, which)
            if shares := self.alike("method", which=here):
                found.append(self._in_part(part, shares, here))
            else:
                found.append(InPart(part, self.counted("method", here), ", which were not flown in the same circumstances"))
        return found

    def _in_part(self, part: str, shares: Mapping[tuple[str, ...], Share], which: Callable[[Who], bool]) -> InPart:
        return InPart(part, {method: share for (method,), share in shares.items()}, self.note(shares, which))

    def note(self, shares: Mapping[tuple[str, ...], Share], which: Callable[[Who], bool]) -> str:
        """Of how many flights the shares are, where there are others in circumstances that not all have met."""
        n, every = (sum(share.n for share in some.values()) for some in (shares, self.counted("flyer", which)))
        return f" (counted where each of them was flown, in {n} of {words.counted(every, 'flight')})" if n < every else ""

    def _circumstances(self, who: Who, compared: tuple[str, ...]) -> tuple[Any, ...]:
        labels = tuple((axis, label) for axis, label in who.labels if axis == PART or not any(self._says(axis, what) for what in compared))
        return (*(getattr(who, what) for what in BY_NAME if what not in compared), frozenset(labels))

    def _says(self, axis: str, what: str) -> bool:
        """Whether an axis says who is compared, and nothing else."""
        named = axis in BY_NAME[what] or (what == "method" and axis.startswith(words.OF_THE_METHOD))
        return named or axis not in self._same[what].others
