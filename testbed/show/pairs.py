"""Pairs of flights that differ in who flew alone: a point that moves along its path, and an aircraft that has to fly it."""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from pydantic import ValidationError

from testbed.campaign.reading.blocks import resolved_parts
from testbed.campaign.words.air import Air
from testbed.campaign.words.grid import PART
from testbed.campaign.words.settings import Campaign
from testbed.results.flight_row import keeps, met_obstacle
from testbed.show import words
from testbed.show.gathered import KINEMATIC, Gathered, Row

AIR: Final = ("air",)
WHO_FLIES: Final = ("plant", "aircraft")
GOES_WITH_IT: Final = ("begin", "rates")
"""What an axis that says who flies may set besides: where on the route this one can begin, and how often it is computed."""


@dataclass(frozen=True)
class Pair:
    """The same encounter and decision rule, as a point and as an aircraft."""

    kinematic: Row
    flown: Row

    @property
    def known(self) -> bool:
        """Did both meet an obstacle?"""
        return met_obstacle(self.kinematic) and met_obstacle(self.flown)

    @property
    def met(self) -> bool:
        """Did either? Where neither did there is no clearance to speak of."""
        return met_obstacle(self.kinematic) or met_obstacle(self.flown)

    @property
    def verdict(self) -> str:
        """What became of the clearance: was every radius kept, to the end of the flight?"""
        if not self.known:
            return "not determined"
        if not keeps(self.kinematic):
            return "fails kinematically, kept when flown" if keeps(self.flown) else "fails kinematically"
        return "kept when flown" if keeps(self.flown) else "fails when flown"


class Alike:
    """Says of a row under ``alike`` what it has to share with another so that the two differ in who flew alone: part, method, and all that
    its labels set but the plant and the aircraft. Under ``air``, in words, what it flew in. The labels are those of the campaign, before
    anybody renames them.
    """

    def __init__(self, campaign: Campaign):
        self._air = campaign.air.model_dump()
        self._parts = resolved_parts(campaign)
        self._last: tuple[str, dict[str, str]] = "", {}  # in plan order the flights of a cell follow each other

    def __call__(self, row: Row) -> dict[str, str]:
        cell = json.dumps([row["method"], row["labels"]])
        if cell != self._last[0]:
            self._last = cell, {"alike": self._key(row), "air": self._air_of(row)}
        return self._last[1]

    def _air_of(self, row: Row) -> str:
        """Empty where the labels do not tell it: it is drawn, or the axis has whole sections as its values."""
        part = self._parts.get(str(row["labels"].get(PART, "")))
        if part is None or any(_is(path, AIR) for path in part.draw):
            return ""
        settings = list(part.set.items())
        for axis, label in row["labels"].items():
            levels = part.sweep.get(axis)
            settings += levels.get(str(label), {}).items() if isinstance(levels, Mapping) else [(axis, _number(label))]
        tree: dict[str, Any] = {"air": self._air}
        for path, value in settings:
            if _is(path, AIR):
                tree = _with(tree, path.split("."), value)
        try:
            return words.air_of(Air.model_validate(tree["air"]).model_dump())
        except ValidationError:
            return ""

    def _key(self, row: Row) -> str:
        labels: Mapping[str, str] = row["labels"]
        part = self._parts.get(str(labels.get(PART, "")))
        sweep = part.sweep if part else {}
        said: dict[str, Any] = {}
        for axis, label in labels.items():
            levels = sweep.get(axis)
            if isinstance(levels, Mapping):
                each = {name: dict(_flat(settings)) for name, settings in levels.items()}
                who = any(_is(path, WHO_FLIES) for settings in each.values() for path in settings)
                left_out = WHO_FLIES + GOES_WITH_IT if who else WHO_FLIES
                own = each.get(str(label), {axis: label})
                said |= {path: value for path, value in own.items() if not _is(path, left_out)}
            elif not _is(axis, WHO_FLIES):
                said[axis] = label
        return json.dumps([row["method"], labels.get(PART, ""), said], sort_keys=True, default=str)


def _number(label: str) -> object:
    try:
        return float(label)
    except ValueError:
        return label


def _with(tree: Any, path: Sequence[str], value: object) -> Any:
    """The tree with that value at that path."""
    if not path:
        return value
    below = tree if isinstance(tree, Mapping) else {}
    return {**below, path[0]: _with(below.get(path[0], {}), path[1:], value)}


def _is(path: str, sections: Sequence[str]) -> bool:
    return path.partition(".")[0] in sections


def _flat(settings: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted paths and their values, however deep they are written."""
    for name, value in settings.items():
        if isinstance(value, Mapping) and value:
            yield from _flat(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", value


def pairs(of: Gathered) -> tuple[list[Pair], int]:
    """Each flown flight, a point mass too, with the point that differs in who flew alone; and how many have no such point, where there are
    points at all. Of the first flights of the table, in plan order.
    """
    rows = [one.row() for one in of.first]
    points: dict[tuple[str, int], list[Row]] = {}
    for row in rows:
        if row["plant"] == KINEMATIC:
            points.setdefault(_key(row), []).append(row)
    if not points:
        return [], 0
    flown = [row for row in rows if row["plant"] != KINEMATIC]
    found = [Pair(_nearest(points[_key(row)], row), row) for row in flown if _key(row) in points]
    return found, len(flown) - len(found)


def _key(row: Row) -> tuple[str, int]:
    return str(row["alike"]), int(row["replicate"])


def _nearest(points: Iterable[Row], flown: Row) -> Row:
    """Of several points that do, the one of the same aircraft, and with most of the labels."""
    labels = flown["labels"].items()
    return max(points, key=lambda p: (p["aircraft"] == flown["aircraft"], sum(p["labels"].get(axis) == label for axis, label in labels)))
