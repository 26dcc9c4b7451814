"""What the page needs of the rows of a campaign, taken from each as it goes by. However many there are, no more is held than is shown:
counts, the few flights that are listed, and of the cells that are listed a few numbers a flight.
"""

import heapq
import math
from array import array
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from testbed.campaign.words.grid import PART
from testbed.flight.record import Outcome
from testbed.results.columns import BY_NAME
from testbed.results.flight_row import collided, keeps, met_obstacle, value
from testbed.show import words
from testbed.show.alike import Cells
from testbed.show.shown_columns import SHOWN_COLUMNS, SUMMARISED

Row = dict[str, Any]

KINEMATIC: Final = "kinematic"  # the plant that is a point on its path
MOST_FLIGHT_ROWS, MOST_DECISION_ROWS, MOST_CELL_ROWS, MOST_FAILURES = 10_000, 500, 2_000, 50
HEADLINES: Final = ("least_clearance_m", "cross_track_max_m", "max_bank_deg", "max_load_factor")
"""Columns whose worst value is told on top of the page."""
SAME_AS_AXES: Final = ("plant", "aircraft", "method")


def flyer(row: Row) -> str:
    """Who flew."""
    return words.flyer(str(row["plant"]), str(row["aircraft"]))


def method(row: Row) -> str:
    """The avoidance method, with those of its options that are swept."""
    return words.method_with(str(row["method"]), row["labels"])


@dataclass
class Group:
    """Flights that are counted together. ``first``: the first of them; ``kept``: those that kept every radius to their end."""

    first: Row
    n: int = 0
    hits: int = 0
    kept: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)

    def count(self, row: Row) -> None:
        self.n += 1
        self.hits += collided(row)
        self.kept += keeps(row)
        self.outcomes[str(row["outcome"])] += 1


@dataclass
class LedGroup(Group):
    """The same with the finite values of the one metric that the page leads with."""

    leading: "array[float]" = field(default_factory=lambda: array("d"))

    def lead(self, row: Row, name: str) -> None:
        self.count(row)
        if math.isfinite(amount := value(row, name)):
            self.leading.append(amount)


@dataclass
class CellGroup(Group):
    """The same of a cell, with the finite values of its summarised columns."""

    values: dict[str, "array[float]"] = field(default_factory=lambda: {column.name: array("d") for column in SUMMARISED})

    def count(self, row: Row) -> None:
        super().count(row)
        for name, known in self.values.items():
            if math.isfinite(amount := value(row, name)):
                known.append(amount)


@dataclass(frozen=True, slots=True)
class Listed:
    """What the table of flights needs of one of them. There are ten thousand of these: metrics as an array, labels shared by a cell."""

    told: tuple[Any, ...]
    metrics: "array[float]"

    def row(self) -> Row:
        """As a row again, of what is listed."""
        metrics = {column.name: amount for column, amount in zip(SHOWN_COLUMNS, self.metrics, strict=True)}
        return dict(zip(LISTED, self.told, strict=True)) | metrics


SHARED: Final = ("plant", "aircraft", "method", "alike", "air")  # mostly the same in many rows
LISTED: Final = ("flight_id", "labels", *SHARED, "replicate", "outcome", "geometry", "message", "recording")


@dataclass
class Gathered:
    """What was gathered. Rows that are kept are without their decisions, of which there can be hundreds a flight."""

    n: int = 0
    met: int = 0
    hits: int = 0
    flown: bool = False
    """Whether any flight was not that of the point."""
    replicated: bool = False
    outcomes: Counter[str] = field(default_factory=Counter)
    first: list[Listed] = field(default_factory=list)
    """The first flights, in plan order."""
    pictured: list[Row] = field(default_factory=list)
    """Those with curves."""
    decisions: list[tuple[Row, Row]] = field(default_factory=list)
    """The first flights' decisions: (flight, decision)."""
    decisions_in_all: int = 0
    failures: list[Row] = field(default_factory=list)
    cells: dict[str, CellGroup] = field(default_factory=dict)
    """The first cells."""
    cells_in_all: int = 0
    by_flyer: dict[str, dict[str, LedGroup]] = field(default_factory=dict)
    """Of flights that met an obstacle: by who flew and by method, with their least clearance."""
    astray: dict[str, dict[str, LedGroup]] = field(default_factory=dict)
    """Of flights that met none, with how far they were off their path."""
    compared: Cells = field(default_factory=Cells)
    """Of flights that met an obstacle: counts that may stand beside each other."""
    replicates: dict[str, int] = field(default_factory=dict)
    """Part (empty without parts) to its replicates."""
    worst: dict[tuple[bool, str], Row] = field(default_factory=dict)
    """Whether of a flight that was not the point's, and column, to the flight with the worst value."""
    _nearest: list[tuple[tuple[bool, float, int], Listed]] = field(default_factory=list)
    _axes: dict[str, None] = field(default_factory=dict)
    _differ: dict[str, set[str]] = field(default_factory=dict)
    _said: dict[str, dict[tuple[str, str, str], str]] = field(default_factory=dict)
    _telling: set[str] = field(default_factory=set)
    _last_cell: str | None = None
    _shared: dict[Any, Any] = field(default_factory=dict)

    def add(self, row: Row) -> None:
        """One more flight, in plan order. ``encounter`` and ``geometry`` are in it if it has curves; ``alike`` is what it
        shares with the flights that it may be paired with, ``air`` what it flew in, in words.
        """
        light = {**row, "events": ()}
        self.n += 1
        self.hits += collided(row)
        self.outcomes[str(row["outcome"])] += 1
        self.replicated |= bool(row["replicate"])
        if row.get("encounter") is not None:
            self.pictured.append(light)
        if row["outcome"] == Outcome.CRASHED and len(self.failures) < MOST_FAILURES:
            self.failures.append(light)
        self._add_decisions(row, light)
        self._add_axes(row)
        self._add_cell(row, light)
        self._add_listed(row)
        self._add_worst(row, light)
        part = str(row["labels"].get(PART, ""))
        self.replicates[part] = max(self.replicates.get(part, 0), int(row["replicate"]) + 1)
        if met_obstacle(row):
            self.met += 1
            self.compared.add(row)
        groups, name = (self.by_flyer, "least_clearance_m") if met_obstacle(row) else (self.astray, "cross_track_max_m")
        groups.setdefault(flyer(row), {}).setdefault(method(row), LedGroup(light)).lead(row, name)

    def _add_decisions(self, row: Row, light: Row) -> None:
        if row["method"] != "none":
            self.decisions_in_all += len(row["events"])
            self.decisions += [(light, event) for event in row["events"][: MOST_DECISION_ROWS - len(self.decisions)]]

    def _add_axes(self, row: Row) -> None:
        labels: Mapping[str, Any] = row["labels"]
        for key in SAME_AS_AXES:
            self._differ.setdefault(key, set()).update(axis for axis, label in labels.items() if label != str(row[key]))
        if labels.keys() <= self._telling:
            return
        said = (flyer(row), method(row), str(row.get("geometry")))
        for axis, label in labels.items():
            self._axes.setdefault(axis)
            if axis not in self._telling and self._said.setdefault(axis, {}).setdefault(said, str(label)) != str(label):
                self._telling.add(axis)

    def _add_cell(self, row: Row, light: Row) -> None:
        name = str(row["cell"])
        if name in self.cells or len(self.cells) < MOST_CELL_ROWS:
            self.cells_in_all += name not in self.cells
            self.cells.setdefault(name, CellGroup(light)).count(row)
        elif name != self._last_cell:  # in plan order the flights of a cell follow each other
            self.cells_in_all += 1
        self._last_cell = name

    def _listed(self, row: Row) -> Listed:
        """What is the same in many rows is kept once."""
        if len(self._shared) > MOST_FLIGHT_ROWS:
            self._shared.clear()
        labels = self._shared.setdefault(tuple(row["labels"].items()), row["labels"])
        told = {**{key: row.get(key) for key in LISTED}, "labels": labels}
        same = (self._shared.setdefault(told[key], told[key]) for key in SHARED)
        rest = (told[key] for key in LISTED[2 + len(SHARED) :])
        return Listed((told["flight_id"], labels, *same, *rest), array("d", (value(row, column.name) for column in SHOWN_COLUMNS)))

    def _add_listed(self, row: Row) -> None:
        clearance = value(row, "least_clearance_m")
        key = (not math.isnan(clearance), 0.0 if math.isnan(clearance) else -clearance, -self.n)  # the largest is the first to go
        if len(self.first) < MOST_FLIGHT_ROWS:
            self.first.append(self._listed(row))
            heapq.heappush(self._nearest, (key, self.first[-1]))
        elif key > self._nearest[0][0]:
            heapq.heapreplace(self._nearest, (key, self._listed(row)))

    def _add_worst(self, row: Row, light: Row) -> None:
        flown = row["plant"] != KINEMATIC
        self.flown |= flown
        for name in HEADLINES:
            amount = value(row, name)
            if math.isfinite(amount):
                sign = 1.0 if BY_NAME[name].worse == "low" else -1.0
                there = self.worst.get((flown, name))
                if there is None or sign * amount < sign * value(there, name):
                    self.worst[flown, name] = light

    @property
    def listed(self) -> list[Listed]:
        """The flights of the table: all of them in plan order, or of too many those with the least clearance, least first. Recorded ones
        come before the rest.
        """
        every = (
            [one for _, one in sorted(self._nearest, key=lambda item: item[0], reverse=True)] if self.n > MOST_FLIGHT_ROWS else self.first
        )
        return sorted(every, key=lambda one: not one.told[-1])

    @property
    def listed_axes(self) -> list[str]:
        """Sweep axes that are not just the plant, the aircraft or the method once more, in the flights that have the axis."""
        return [axis for axis in self._axes if all(axis in self._differ[key] for key in SAME_AS_AXES)]

    @property
    def telling_axes(self) -> list[str]:
        """Sweep axes that say more than flyer, method and geometry together do."""
        return [axis for axis in self._axes if axis in self._telling]


def gather(rows: Iterable[Row]) -> Gathered:
    """All of it, in one go."""
    gathered = Gathered()
    for row in rows:
        gathered.add(row)
    return gathered
