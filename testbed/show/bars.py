"""Rows of intervals as static SVG: readable without JavaScript, in the dark and on paper."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup, escape

from testbed.airframe.chart import ticks
from testbed.show.words import number

AREA, ROW, TOP, BOTTOM, RIGHT = 268, 26, 6, 36, 52  # px of the drawing: its area, the height of a row, and what is around
LETTER, NAMES, MOST_NAMES = 6.7, 200, 360  # px of a letter, and of the column of names on the left at least and at most
MOST_TICKS = 80  # flights of a row that are drawn one by one
FEWEST = 6  # flights of a row below which there is no interval to speak of


class Scale:
    """From a quantity to x of the drawing, with round numbers at both ends; right of a column that holds the names."""

    def __init__(self, values: Sequence[float], names: Sequence[str]):
        self.marks = ticks(min(values), max(values), 6)
        self.low, self.high = self.marks[0], self.marks[-1]
        self.names = min(MOST_NAMES, max(NAMES, math.ceil(LETTER * max(map(len, names), default=0)) + 12))
        self.wide = self.names + AREA + RIGHT

    def __call__(self, value: float) -> float:
        return self.names + (value - self.low) / (self.high - self.low) * AREA


@dataclass(frozen=True)
class Interval:
    """A row: from low over middle to high, and what else is drawn of it: single flights as ticks, a word at the right end."""

    name: str
    low: float
    middle: float
    high: float
    each: Sequence[float] = ()
    note: str = ""


def frame(scale: Scale, rows: int, label: str, shade_below: float | None = None) -> list[str]:
    """The beginning of a picture: its grid, the line at zero, the label of its axis; shaded is what is inside an obstacle."""
    bottom = TOP + rows * ROW
    parts = [f'<svg class="bars" viewBox="0 0 {scale.wide} {bottom + BOTTOM}" role="img" aria-label="{escape(label)}">']
    if shade_below is not None and scale.low < shade_below:
        parts.append(
            f'<rect class="inside" x="{scale.names}" y="{TOP}" width="{scale(shade_below) - scale.names:.1f}" height="{bottom - TOP}"/>'
        )
    for mark in scale.marks:
        css = "zero" if mark == 0.0 else "grid"
        parts.append(f'<line class="{css}" x1="{scale(mark):.1f}" x2="{scale(mark):.1f}" y1="{TOP}" y2="{bottom}"/>')
        text = f"{mark:g}".replace("-", "\N{MINUS SIGN}")
        parts.append(f'<text x="{scale(mark):.1f}" y="{bottom + 14}" text-anchor="middle">{text}</text>')
    parts.append(f'<text x="{scale.names + AREA / 2:.0f}" y="{bottom + 30}" text-anchor="middle">{escape(label)}</text>')
    return parts


def row_name(scale: Scale, y: float, name: str) -> str:
    """What stands left of a row; what is too long for its column loses its middle, and is said whole when pointed at."""
    most = int((scale.names - 12) / LETTER)
    short = name if len(name) <= most else f"{name[: most // 2 - 1]}\N{HORIZONTAL ELLIPSIS}{name[-(most - most // 2) :]}"
    title = f"<title>{escape(name)}</title>" if short != name else ""
    return f'<text class="name" x="{scale.names - 8}" y="{y + ROW / 2 + 4:.1f}" text-anchor="end">{title}{escape(short)}</text>'


def intervals(
    rows: Sequence[Interval],
    label: str,
    whole: tuple[float, ...] = (0.0,),
    shade_below_zero: bool = False,
    digits: int = 1,
    line: tuple[float, str] | None = None,
) -> Markup:
    """A row each: a line from low to high, a dot at the middle, whose number stands at the right end. ``line``: a level, and its name."""
    known = [row for row in rows if all(math.isfinite(x) for x in (row.low, row.middle, row.high))]
    if not known:
        return Markup("")
    scale = Scale([*whole, *(x for row in known for x in (row.low, row.middle, row.high, *row.each))], [row.name for row in known])
    parts = frame(scale, len(known), label, 0.0 if shade_below_zero else None)
    if line:
        x, bottom = scale(line[0]), TOP + len(known) * ROW
        parts.append(f'<line class="level" x1="{x:.1f}" x2="{x:.1f}" y1="{TOP}" y2="{bottom}"><title>{escape(line[1])}</title></line>')
    for k, row in enumerate(known):
        y = TOP + k * ROW + ROW / 2
        text = f"{row.name}: {number(row.middle, digits)}"
        text += f" ({number(row.low, digits)} to {number(row.high, digits)})" if row.low != row.high else ""
        parts.append(row_name(scale, TOP + k * ROW, row.name))
        marks = "".join(f'<line class="tick" x1="{scale(x):.1f}" x2="{scale(x):.1f}" y1="{y - 6}" y2="{y + 6}"/>' for x in row.each)
        parts.append(
            f'<g class="interval"><title>{escape(text + row.note)}</title>{marks}'
            f'<line x1="{scale(row.low):.1f}" x2="{scale(row.high):.1f}" y1="{y}" y2="{y}"/>'
            f'<circle cx="{scale(row.middle):.1f}" cy="{y}" r="4.5"/></g>'
        )
        parts.append(f'<text class="value" x="{scale.wide}" y="{y + 4}" text-anchor="end">{escape(number(row.middle, digits))}</text>')
    return Markup("".join([*parts, "</svg>"]))


def of_flights(name: str, values: Sequence[float]) -> Interval:
    """The row of a sample: 5th percentile, median, 95th percentile; few flights one by one."""
    low, middle, high = (float(x) for x in np.percentile(values, (5.0, 50.0, 95.0))) if len(values) else (math.nan,) * 3
    if len(values) < FEWEST:
        low = high = middle
    each = tuple(values) if 1 < len(values) <= MOST_TICKS else ()
    return Interval(name, low, middle, high, each, f", n = {len(values)}")
