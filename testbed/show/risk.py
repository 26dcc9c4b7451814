"""Detect and avoid on the page: ratios of risk with their intervals, what became of the events, the misses, and every column by cell."""

import math
from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from testbed.campaign.words.daa import SPHERE, Daa
from testbed.results.columns import Column, Kind
from testbed.results.daa.cells import DaaCell
from testbed.results.daa.columns import limits_text, title
from testbed.results.daa.risk import WIDE, Labels, Ratio, Risk
from testbed.show import words
from testbed.show.campaign_summary import circumstances
from testbed.show.gathered import flyer, method
from testbed.show.misses_svg import misses_svg
from testbed.show.risk_over_axes import axes_part
from testbed.show.words import number, percent

MOST_RATIOS: Final = 200
MOST_MATRICES: Final = 24
MOST_PANELS: Final = 12


def risk_part(risk: Risk | None, daa: Daa | None, axes: Sequence[str]) -> dict[str, Any] | None:
    """What the template needs; None of a campaign that does not ask."""
    if risk is None or daa is None:
        return None
    shown = risk.ratios[:MOST_RATIOS]
    eventful = [one for one in risk.ratios if one.resolved + one.unresolved + one.induced]
    return {
        "ratios": [_ratio(one) for one in shown],
        "wide": sum(one.wide for one in risk.ratios if not math.isnan(one.interval.value)),
        "wide_share": percent(WIDE),
        "several": any(one.circumstances for one in shown),
        "ratios_left_out": len(risk.ratios) - len(shown),
        "unpaired": risk.unpaired,
        "unweighted": risk.unweighted,
        "weight": risk.weight,
        "axes": axes_part(risk, daa),
        "matrices": [_matrix(one) for one in eventful[:MOST_MATRICES]],
        "matrices_left_out": max(0, len(eventful) - MOST_MATRICES),
        "limits": [
            (title(name), name, limits_text(volume).replace("<=", "\N{LESS-THAN OR EQUAL TO}")) for name, volume in daa.all_volumes.items()
        ],
        "needed_by": title(daa.needed_by),
        "dmod": f"{daa.dmod_m:.10g} m",
        **_misses(risk, daa),
        **_cells(risk, axes),
    }


def who_text(labels: Labels) -> str:
    """Who avoids, in words."""
    if not labels:
        return words.method("none")
    return ", ".join(
        words.method(label) if axis in ("method", "method.kind") else words.circumstance(axis, label) for axis, label in labels
    )


def place_text(labels: Labels) -> str:
    """Circumstances in words."""
    return ", ".join(words.circumstance(axis, label) for axis, label in labels) or "all"


def _sort(value: float) -> str:
    return f"{value:.6g}" if math.isfinite(value) else ""


def _ratio(one: Ratio) -> dict[str, Any]:
    value, low, high = one.interval
    return {
        "circumstances": place_text(one.circumstances),
        "method": who_text(one.method),
        "volume": title(one.volume),
        "ratio": number(value, 2),
        "sort": _sort(value),
        "interval": f"{number(low, 2)} to {number(high, 2)}" if math.isfinite(low) else words.DASH,
        "wide": one.wide and math.isfinite(value),
        "rest": [
            {"text": number(amount, 2), "sort": _sort(amount)} for amount in (one.unresolved_ratio, one.induced_ratio)
        ] + [{"text": percent(amount), "sort": _sort(amount)} for amount in (one.share_without, one.share_with)],
        "encounters": one.encounters,
    }  # fmt: skip


def _matrix(one: Ratio) -> dict[str, Any]:
    neither = one.encounters - one.resolved - one.unresolved - one.induced
    return {
        "title": ", ".join(filter(None, (who_text(one.method), title(one.volume)))),
        "where": place_text(one.circumstances) if one.circumstances else "",
        "unresolved": one.unresolved,
        "resolved": one.resolved,
        "induced": one.induced,
        "neither": neither,
    }


def _misses(risk: Risk, daa: Daa) -> dict[str, Any]:
    every = [point for points in risk.misses.values() for point in points]
    if not every:
        return {"panels": [], "points_left_out": 0, "panels_left_out": 0}
    volumes = {name: volume for name, volume in daa.all_volumes.items() if name != SPHERE}
    panels = [
        {"title": f"{who_text(who)}, {words.counted(len(points), 'flight')}", "svg": misses_svg(points, every, volumes)}
        for who, points in sorted(risk.misses.items(), key=lambda item: bool(item[0]))[:MOST_PANELS]
    ]
    return {"panels": panels, "points_left_out": risk.left_out, "panels_left_out": max(0, len(risk.misses) - MOST_PANELS)}


def _cells(risk: Risk, axes: Sequence[str]) -> dict[str, Any]:
    columns = [one for one in risk.cells.columns if any(one.name in cell.values for cell in risk.cells.cells.values())]
    rows = [_cell(cell, columns, axes) for cell in risk.cells.cells.values()]
    return {"columns": columns, "cells": rows, "cells_left_out": len(risk.cells.left_out)}


def _cell(cell: DaaCell, columns: Sequence[Column], axes: Sequence[str]) -> dict[str, Any]:
    return {
        "circumstances": circumstances(cell.first, axes) or "all",
        "flyer": flyer(cell.first),
        "method": method(cell.first),
        "n": cell.n,
        "numbers": [_summary(column, cell) for column in columns],
    }


def _summary(column: Column, cell: DaaCell) -> dict[str, str]:
    """Of a flag how many of how many; of a number the median and, where it has one, the worst."""
    values = cell.values.get(column.name)
    if not values:
        return {"text": words.DASH, "sort": ""}
    if column.kind is Kind.FLAG:
        return {"text": f"{int(sum(values))} of {len(values)}", "sort": _sort(sum(values) / len(values))}
    middle = float(np.median(values))
    worst = min(values) if column.worse == "low" else max(values) if column.worse == "high" else math.nan
    more = f" ({number(worst, column.digits)})" if math.isfinite(worst) else ""
    return {"text": f"{number(middle, column.digits)}{more}", "sort": _sort(middle)}
