"""Slope charts as static SVG: a line from its value in one run to that in another, coloured by which way it went."""

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Final, NamedTuple

from markupsafe import Markup, escape

from testbed.airframe.chart import ticks
from testbed.core.utf8 import clipped
from testbed.show import words

WIDTH, HEIGHT, TOP, BOTTOM = 500, 300, 26, 10
FROM, TO = 56, 236  # x of the two runs
MOST_NAMED: Final = 4
APART = 14  # px between two names
LONGEST = 42


class Slope(NamedTuple):
    """A line. ``tone``: better, worse, changed or same, a class of the style sheet."""

    name: str
    first: float
    second: float
    tone: str


def slope_chart(slopes: Sequence[Slope], heading: str, unit: str, digits: int, names: tuple[str, str], zero: bool) -> Markup:
    """The chart; of the lines that change most the names stand beside them, of the others in their tooltips. ``zero``: draw that level."""
    finite = (one for one in slopes if math.isfinite(one.first) and math.isfinite(one.second))
    known = [one._replace(first=round(one.first, digits + 1), second=round(one.second, digits + 1)) for one in finite]  # no noise magnified
    if not known:
        return Markup("")
    values = [value for one in known for value in (one.first, one.second)] + ([0.0] if zero else [])
    marks = ticks(min(values), max(values), 5)
    low, high = min(marks[0], *values), max(marks[-1], *values)

    def y(value: float) -> float:
        return HEIGHT - BOTTOM - (value - low) / ((high - low) or 1.0) * (HEIGHT - TOP - BOTTOM)

    parts = [*_frame(marks, y, names, zero)]
    for one in sorted(known, key=_change):
        x1, y1, x2, y2 = FROM, y(one.first), TO, y(one.second)
        told = f"{one.name}: {words.number(one.first, digits)} to {words.number(one.second, digits)} {unit}".rstrip()
        parts.append(
            f'<g class="{one.tone}"><title>{escape(told)}</title><line x1="{x1}" y1="{y1:.1f}" x2="{x2}" y2="{y2:.1f}"/>'
            f'<circle cx="{x1}" cy="{y1:.1f}" r="3"/><circle cx="{x2}" cy="{y2:.1f}" r="3"/></g>'
        )
    most = sorted(known, key=_change, reverse=True)[:MOST_NAMED]
    for one, at in _spread_out([(one, y(one.second)) for one in most if one.second != one.first]):
        name = escape(clipped(one.name, LONGEST))
        parts.append(f'<text x="{TO + 10}" y="{at + 4:.1f}" class="name"><title>{escape(one.name)}</title>{name}</text>')
    what = f"{heading}{f', {unit}' if unit else ''}: {words.counted(len(known), 'line')} from {names[0]} to {names[1]}"
    head = f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(what)}">'
    return Markup("".join([head, *parts, "</svg>"]))


def _change(one: Slope) -> float:
    return abs(one.second - one.first)


def _frame(marks: Sequence[float], y: Callable[[float], float], names: tuple[str, str], zero: bool) -> Iterator[str]:
    """Levels with their figures, and the two runs."""
    for mark in marks:
        kind = "zero" if zero and mark == 0.0 else "grid"
        yield f'<line class="{kind}" x1="{FROM}" y1="{y(mark):.1f}" x2="{TO}" y2="{y(mark):.1f}"/>'
        yield f'<text x="{FROM - 8}" y="{y(mark) + 4:.1f}" text-anchor="end">{words.number(mark, _decimals(marks))}</text>'
    for x, name in ((FROM, names[0]), (TO, names[1])):
        yield f'<line class="end" x1="{x}" y1="{TOP - 6}" x2="{x}" y2="{HEIGHT - BOTTOM}"/>'
        yield f'<text class="run-name" x="{x}" y="{TOP - 12}" text-anchor="middle">{escape(clipped(name, 22))}</text>'


def _decimals(marks: Sequence[float]) -> int:
    step = min((b - a for a, b in pairwise(marks)), default=1.0)
    return max(0, -math.floor(math.log10(step) + 1e-9))


def _spread_out(named: Sequence[tuple[Slope, float]]) -> list[tuple[Slope, float]]:
    """Names from top to bottom, none over another, none below the chart."""
    down = sorted(named, key=lambda item: item[1])
    places: list[float] = []
    for _, wanted in down:
        places.append(max(wanted, places[-1] + APART) if places else wanted)
    over = max(0.0, places[-1] - (HEIGHT - BOTTOM)) if places else 0.0
    return [(one, place - over) for (one, _), place in zip(down, places, strict=True)]
