"""A metric over the axes of a sweep: every axis of numbers a curve, two of them a heat map, directions of the wind a polar plot.

Nothing is pooled but the replicates of a cell: a line is one method over one axis, a panel is all else that a cell is. Each point is a
median, or a share, with its 95 % interval. Drawn by ``over_axis_svg``; every number drawn stands in the table below the pictures.
"""

import math
from array import array
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Final

from testbed.results import statistics
from testbed.results.columns import BY_NAME
from testbed.results.flight_row import keeps, met_obstacle, value
from testbed.results.statistics import Effect
from testbed.show import words
from testbed.show.axis_words import KEPT, axis_title, metric_text, place_text
from testbed.show.gathered import KINEMATIC, Row, flyer

METRICS: Final = (KEPT, "least_clearance_m", "max_load_factor", "max_roll_rate_dps", "max_bank_deg", "cross_track_max_m")
"""The share that keeps every radius, and columns of the results of which the median is shown."""
WHO: Final = ("labels", "plant", "aircraft", "method")
MOST_CELLS = 2000  # are looked at, in plan order; a cell's numbers are kept until its median is known
MOST_AXES, MOST_PAIRS, MOST_PANELS = 4, 2, 4
COMPASS: Final = {name: 45.0 * k for k, name in enumerate(("N", "NE", "E", "SE", "S", "SW", "W", "NW"))}
FROM: Final = "from_deg"

Key = tuple[tuple[str, str], ...]


@dataclass
class Cell:
    """The flights of one cell. ``first``: who flew the first of them, as all the others."""

    first: Row
    n: int = 0
    met: int = 0
    kept: int = 0
    values: dict[str, "array[float]"] = field(default_factory=lambda: {name: array("d") for name in METRICS[1:]})

    def add(self, row: Row) -> None:
        self.n += 1
        if met_obstacle(row):
            self.met += 1
            self.kept += keeps(row)
        for name, known in self.values.items():
            known.append(value(row, name))

    @property
    def labels(self) -> Mapping[str, str]:
        return {axis: str(label) for axis, label in self.first["labels"].items()}

    @cached_property
    def effects(self) -> dict[str, Effect]:
        """Each metric with its interval; asked for when all flights are there."""
        found = {KEPT: statistics.share(KEPT, self.kept, self.met)}
        return found | {name: statistics.median(name, BY_NAME[name].unit, known) for name, known in self.values.items()}


@dataclass(frozen=True)
class Line:
    """One method along the axis: places on it, and the cells there."""

    method: str
    points: tuple[tuple[float, Cell], ...]


@dataclass(frozen=True)
class Panel:
    """Lines that share everything but the method."""

    title: str
    lines: tuple[Line, ...]


@dataclass(frozen=True)
class Curves:
    """An axis: its panels, and how many more there would be. ``round``: it is the direction that the wind comes from."""

    axis: str
    title: str
    round: bool
    panels: tuple[Panel, ...]
    left_out: int


@dataclass(frozen=True)
class Grid:
    """Two axes under one method: (place on the first, on the second) to the cell."""

    title: str
    cells: Mapping[tuple[float, float], Cell]

    def name(self, axis: str, which: int, place: float) -> str:
        """What stands at a place on its first (0) or second (1) axis: the label as the campaign wrote it."""
        return next(cell.labels[axis] for at, cell in self.cells.items() if at[which] == place).replace("-", words.MINUS)


@dataclass(frozen=True)
class HeatMap:
    """Two axes and their grids."""

    across: str
    upward: str
    grids: tuple[Grid, ...]
    left_out: int


class OverAxes:
    """Watches the rows of a campaign go by, and says afterwards what there is to draw."""

    def __init__(self, cells: Iterable[Cell] = (), metrics: Sequence[str] = METRICS) -> None:
        """To watch the rows; or with cells whose numbers, of such metrics, are there already."""
        self._cells = {str(k): cell for k, cell in enumerate(cells)}
        self._metrics = tuple(metrics)

    def watch(self, rows: Iterable[Row]) -> Iterator[Row]:
        """The same rows, each counted."""
        for row in rows:
            name = str(row["cell"])
            if name in self._cells or (len(self._cells) < MOST_CELLS and any(map(_is_place, row["labels"].values()))):
                self._cells.setdefault(name, Cell({key: row[key] for key in WHO})).add(row)
            yield row

    @cached_property
    def _places(self) -> dict[str, dict[str, float]]:
        """Axes of numbers, or of compass points, by label the place on it."""
        labels: dict[str, dict[str, None]] = {}
        for cell in self._cells.values():
            for axis, label in cell.labels.items():
                labels.setdefault(axis, {}).setdefault(label)
        found = {axis: {label: _place(label) for label in known} for axis, known in labels.items()}
        return {axis: places for axis, places in found.items() if None not in places.values() and len(places) > 1}  # type: ignore[misc]

    @cached_property
    def _of_method(self) -> frozenset[str]:
        """Axes that only say the method once more: those of its options that are no numbers, and any that goes with its name."""
        pairs: dict[str, set[tuple[str, str]]] = {}
        for cell in self._cells.values():
            for axis, label in cell.labels.items():
                pairs.setdefault(axis, set()).add((label, self.method(cell)))
        return frozenset(
            axis
            for axis, seen in pairs.items()
            if axis not in self._places
            and (axis.startswith(words.OF_THE_METHOD) or len(seen) == len({a for a, _ in seen}) == len({b for _, b in seen}) > 1)
        )

    def method(self, cell: Cell) -> str:
        """The method of a cell, with those of its options that are no axis of numbers."""
        return words.method_with(str(cell.first["method"]), {a: label for a, label in cell.labels.items() if a not in self._places})

    @cached_property
    def curves(self) -> tuple[Curves, ...]:
        """Of every axis along which some line has two points; most points first where there are too many panels, and aircraft first."""
        made = []
        for axis, places in self._places.items():
            panels: dict[tuple[str, Key], dict[str, list[tuple[float, Cell]]]] = {}
            for cell in self._cells.values():
                if axis in cell.labels:
                    key = (flyer(cell.first), self._rest(cell, axis))
                    panels.setdefault(key, {}).setdefault(self.method(cell), []).append((places[cell.labels[axis]], cell))
            there = {key: lines for key, lines in panels.items() if any(len({x for x, _ in line}) > 1 for line in lines.values())}
            if there:
                kept = sorted(there, key=lambda key: (-sum(map(len, there[key].values())), _is_point(there[key])))[:MOST_PANELS]
                titles = _titles(kept, list(there))
                drawn = tuple(
                    Panel(title, tuple(Line(name, tuple(sorted(line, key=lambda p: p[0]))) for name, line in there[key].items()))
                    for key, title in zip(kept, titles, strict=True)
                )
                made.append(Curves(axis, axis_title(axis), _is_round(axis, places), drawn, len(there) - len(kept)))
        return tuple(made[:MOST_AXES])

    @cached_property
    def heat_maps(self) -> tuple[HeatMap, ...]:
        """Of every two such axes that are crossed with each other; the one with more places across."""
        axes, made = [curve.axis for curve in self.curves], []
        for k, one in enumerate(axes):
            for other in axes[k + 1 :]:
                across, upward = sorted((one, other), key=lambda axis: -len(self._places[axis]))
                grids: dict[tuple[str, Key, str], dict[tuple[float, float], Cell]] = {}
                for cell in self._cells.values():
                    if {across, upward} <= cell.labels.keys():
                        place = self._places[across][cell.labels[across]], self._places[upward][cell.labels[upward]]
                        grids.setdefault((flyer(cell.first), self._rest(cell, across, upward), self.method(cell)), {})[place] = cell
                there = {key: grid for key, grid in grids.items() if all(len({place[k] for place in grid}) > 1 for k in (0, 1))}
                if there:
                    kept = sorted(there, key=lambda key: -len(there[key]))[:MOST_PANELS]
                    titles = _titles([key[:2] for key in kept], [key[:2] for key in there])
                    drawn = tuple(
                        Grid(", ".join(filter(None, (title, key[2]))), there[key]) for key, title in zip(kept, titles, strict=True)
                    )
                    made.append(HeatMap(across, upward, drawn, len(there) - len(kept)))
        return tuple(made[:MOST_PAIRS])

    def _rest(self, cell: Cell, *without: str) -> Key:
        """What a cell is apart from these axes, who flew and the method."""
        return tuple((axis, label) for axis, label in cell.labels.items() if axis not in without and axis not in self._of_method)

    def drawn(self) -> list[Cell]:
        """The cells whose numbers are in some picture, in plan order."""
        shown = {id(cell) for curve in self.curves for panel in curve.panels for line in panel.lines for _, cell in line.points}
        shown |= {id(cell) for pair in self.heat_maps for grid in pair.grids for cell in grid.cells.values()}
        return [cell for cell in self._cells.values() if id(cell) in shown]

    def metrics(self) -> list[str]:
        """Those of which there is a number to draw. The share of a single flight is none."""
        drawn = self.drawn()
        known = [name for name in self._metrics if any(math.isfinite(cell.effects[name].value) for cell in drawn)]
        return [name for name in known if name != KEPT or any(cell.met > 1 for cell in drawn)]

    def sentences(self) -> list[str]:
        """What each axis does, by the panel of an aircraft with the most lines: between what and what, and where."""
        told = []
        for curve in self.curves:
            panel = min(curve.panels, key=lambda one: (_is_point({line.method: list(line.points) for line in one.lines}), -len(one.lines)))
            name = KEPT if all(cell.met > 1 for line in panel.lines for _, cell in line.points) else "least_clearance_m"
            parts = [part for line in panel.lines if (part := _extremes(line, name))]
            if parts:
                what = "the share that keeps every radius" if name == KEPT else "the least clearance (median)"
                told.append(f"Over {curve.title}, {panel.title}: {what} is {'; '.join(parts)}.")
        return told


def _titles(keys: Sequence[tuple[str, Key]], among: Sequence[tuple[str, Key]]) -> list[str]:
    """Who flew, and the labels that are not the same in all panels there are and do not only say that once more."""
    flyers = {who for who, _ in among}
    differ = {axis for _, rest in among for axis, _ in rest if len({dict(other).get(axis) for _, other in among}) > 1}
    same_as_flyer = {axis for axis in differ if len({(who, dict(rest).get(axis)) for who, rest in among}) == len(flyers)}
    said = differ - same_as_flyer
    return [", ".join([who, *(words.circumstance(axis, label) for axis, label in rest if axis in said)]) for who, rest in keys]


def _is_point(lines: Mapping[str, Sequence[tuple[float, Cell]]]) -> bool:
    """Whether it is the point on rails that flew them: an aircraft says more."""
    return all(cell.first["plant"] == KINEMATIC for line in lines.values() for _, cell in line)


def _extremes(line: Line, name: str) -> str:
    known = [(cell.effects[name].value, x) for x, cell in line.points if math.isfinite(cell.effects[name].value)]
    if not known:
        return ""
    (low, at_low), (high, at_high) = min(known), max(known)
    ends = metric_text(name, low), metric_text(name, high)
    if ends[0] == ends[1]:
        return f"{ends[0]} throughout with {line.method}"
    return f"{ends[0]} (at {place_text(at_low)}) to {ends[1]} (at {place_text(at_high)}) with {line.method}"


def _place(label: str) -> float | None:
    """Where a label lies on its axis; None if it names something."""
    if label in COMPASS:
        return COMPASS[label]
    try:
        found = float(label)
    except ValueError:
        return None
    return found if math.isfinite(found) else None


def _is_place(label: Any) -> bool:
    return _place(str(label)) is not None


def _is_round(axis: str, places: Mapping[str, float]) -> bool:
    return axis.rpartition(".")[2] == FROM or all(label in COMPASS for label in places)
