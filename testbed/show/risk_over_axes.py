"""Ratios of risk over the axes of numbers of a sweep, and from where on they are accepted: the pictures are those of ``over_axis``."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Final

from testbed.campaign.words.daa import SPHERE, Daa
from testbed.results.daa.columns import title
from testbed.results.daa.risk import Labels, Ratio, Risk
from testbed.results.statistics import Effect
from testbed.show import words
from testbed.show.axis_words import RATIO, place_text
from testbed.show.over_axis import Cell, Line, OverAxes
from testbed.show.over_axis_svg import pictures

MOST_VOLUMES: Final = 6
"""So many can be chosen from: the style sheet knows no more."""


@dataclass
class RiskCell(Cell):
    """A method in some circumstances; its numbers are ratios."""

    ratios: dict[str, Effect] = field(default_factory=dict)

    @cached_property
    def effects(self) -> dict[str, Effect]:
        return self.ratios


def ratios_over_axes(risk: Risk, daa: Daa) -> OverAxes:
    """The volumes that somebody entered, what the campaign wants kept first."""
    own = [name for name in (daa.needed_by, SPHERE, *daa.volumes) if name in (SPHERE, *daa.all_volumes)]
    names = list(dict.fromkeys([*own, *daa.all_volumes]))
    cells: dict[tuple[Labels, Labels], RiskCell] = {}
    for one in risk.ratios:
        cell = cells.setdefault((one.circumstances, one.method), RiskCell(dict(one.first), n=one.encounters))
        cell.ratios[RATIO + one.volume] = _effect(one)
    return OverAxes(cells.values(), [RATIO + name for name in names][:MOST_VOLUMES])


def _effect(one: Ratio) -> Effect:
    return Effect(RATIO + one.volume, "", *one.interval, one.encounters)


def axes_part(risk: Risk, daa: Daa) -> dict[str, Any] | None:
    """Pictures, and where each ratio is accepted; None of a campaign without an axis of numbers."""
    over = ratios_over_axes(risk, daa)
    drawn = pictures(over, dict.fromkeys(over.metrics(), daa.accepted_ratio))
    if drawn is None:
        return None
    rows = list(_accepted(over, daa.accepted_ratio))
    told, lines = answer(over, daa.accepted_ratio)
    methods = list(dict.fromkeys(method for row in rows for method in row["where"]))
    return {
        "pictures": drawn,
        "limit": words.number(daa.accepted_ratio, 2),
        "methods": methods,
        "rows": [row | {"cells": [row["where"].get(method, words.DASH) for method in methods]} for row in rows],
        "told": told,
        "lines": lines,
        "answer": f"{told}: {'; '.join(lines)}." if lines else "",
    }


def answer(over: OverAxes, limit: float) -> tuple[str, list[str]]:
    """Of the volume that matters most and the first axis: where each method's whole interval is accepted. What is told, and the lines
    of it.
    """
    names = over.metrics()
    if not names:
        return "", []
    axis = over.curves[0].axis
    found = [row for row in _accepted(over, limit) if row["name"] == names[0] and row["axis"] == axis]
    said = [row["panel"].split(", ") for row in found]
    differ = [", ".join(part for part in panel if not all(part in other for other in said)) for panel in said]
    parts = [
        (f"{panel}: " if panel else "") + ", ".join(f"{method} {where}" for method, where in row["where"].items())
        for panel, row in zip(differ, found, strict=True)
    ]
    what, enough = title(names[0].removeprefix(RATIO)), words.number(limit, 2)
    told = f"Where the ratio of risk for {what} is at most {enough} with all of its interval, over {over.curves[0].title}"
    return told, parts


def _accepted(over: OverAxes, limit: float) -> Iterator[dict[str, Any]]:
    """A line for each volume, axis and panel: to each method where on the axis."""
    for name in over.metrics():
        for curve in over.curves:
            for panel in curve.panels:
                where = {line.method: where_accepted(line, name, limit, words.setting(curve.axis)[1]) for line in panel.lines}
                volume = title(name.removeprefix(RATIO))
                yield {"name": name, "volume": volume, "axis": curve.axis, "over": curve.title, "panel": panel.title, "where": where}


def where_accepted(line: Line, name: str, limit: float, unit: str) -> str:
    """At which places of its axis the upper end of the interval is at most the limit: from one on, up to one, or at which."""
    known = [(x, cell.effects[name].high) for x, cell in line.points if name in cell.effects]
    good = [x for x, high in known if not math.isnan(high) and high <= limit]
    places = [x for x, _ in known]
    if not good:
        return "nowhere"
    if len(good) == len(places):
        return f"throughout ({_span(places, unit)})"
    if good == places[-len(good) :]:
        return f"from {_with_unit(good[0], unit)} on"
    if good == places[: len(good)]:
        return f"up to {_with_unit(good[-1], unit)}"
    return f"at {_with_unit(', '.join(map(place_text, good)), unit)}"


def _with_unit(place: float | str, unit: str) -> str:
    return f"{place if isinstance(place, str) else place_text(place)} {unit}".rstrip()


def _span(places: Sequence[float], unit: str) -> str:
    return f"{place_text(places[0])} to {_with_unit(places[-1], unit)}"
