"""Pictures of the verdict that are static SVG: waterfalls and rankings, readable without JavaScript, in the dark and on paper."""

import math
from collections.abc import Sequence

from markupsafe import Markup, escape

from testbed.airframe.chart import ticks
from testbed.show import words
from testbed.show.words import named, number
from testbed.studies.scoam.claim import Rank, Waterfall
from testbed.studies.scoam.page.paper_names import METHOD_NAMES, STEP_NAMES
from testbed.studies.scoam.page.quotable import signed

WIDTH, NAMES, ROW, TOP, BOTTOM = 500, 186, 26, 6, 36  # px of the drawing; NAMES: the column of names on the left
RIGHT = 44
Interval = tuple[str, float, float, float]  # name, low, middle, high


class _Scale:
    """From a quantity to x of the drawing, with round numbers at both ends."""

    def __init__(self, values: Sequence[float]):
        self.marks = ticks(min(values), max(values), 6)
        self.low, self.high = self.marks[0], self.marks[-1]

    def __call__(self, value: float) -> float:
        return NAMES + (value - self.low) / (self.high - self.low) * (WIDTH - NAMES - RIGHT)


def waterfall_svg(fall: Waterfall) -> Markup:
    """One row a rung: a bar from the clearance that the step starts from to its own. Left of zero is inside the obstacle."""
    steps = [step for step in fall.steps if math.isfinite(step.clearance_m)]
    if not steps:
        return Markup("")
    scale = _Scale([0.0, *(step.clearance_m for step in steps)])
    parts = _frame(scale, len(steps), "least clearance, m", shade_below_zero=True)
    for k, step in enumerate(steps):
        y = TOP + k * ROW
        known = math.isfinite(step.change_m)
        x0, x1 = scale(step.clearance_m - step.change_m if known else 0.0), scale(step.clearance_m)
        css = "start" if not known else "lost" if step.change_m < 0.0 else "won"
        name = named(STEP_NAMES, step.rung)
        title = f"{name}: {words.amount(step.clearance_m, 'm')}" + (f", change {signed(step.change_m)}" if known else "")
        parts.append(_name(y, name))
        parts.append(
            f'<g class="{css}"><title>{escape(title)}</title><rect x="{min(x0, x1):.1f}" y="{y + 5}" width="{max(abs(x1 - x0), 1.5):.1f}" '
            f'height="{ROW - 10}"/><line x1="{x1:.1f}" x2="{x1:.1f}" y1="{y + 2}" y2="{y + ROW - 2}"/></g>'
        )
        parts.append(
            f'<text class="value" x="{max(x0, x1) + 6:.1f}" y="{y + ROW / 2 + 4:.1f}">{escape(number(step.clearance_m, 1))}</text>'
        )
    return Markup("".join([*parts, "</svg>"]))


def share_svg(ranks: Sequence[Rank]) -> Markup:
    """Share of the population in which each method keeps the radius, with its interval."""
    rows = [
        (named(METHOD_NAMES, rank.method), 100 * rank.safe_low, 100 * rank.safe / rank.n, 100 * rank.safe_high) for rank in ranks if rank.n
    ]
    return _intervals(rows, "encounters that keep the radius, % (95 % interval)", whole=(0.0, 100.0))


def clearance_svg(ranks: Sequence[Rank]) -> Markup:
    """Median of the clearance of each method on the population, from the 5th to the 95th percentile."""
    rows = [(named(METHOD_NAMES, rank.method), rank.clearance.p05, rank.clearance.median, rank.clearance.p95) for rank in ranks if rank.n]
    return _intervals(rows, "least clearance, m (5 %, median, 95 %)", shade_below_zero=True)


def _intervals(rows: Sequence[Interval], label: str, whole: tuple[float, ...] = (0.0,), shade_below_zero: bool = False) -> Markup:
    known = [row for row in rows if all(math.isfinite(x) for x in row[1:])]
    if not known:
        return Markup("")
    scale = _Scale([*whole, *(x for row in known for x in row[1:])])
    parts = _frame(scale, len(known), label, shade_below_zero)
    for k, (name, low, middle, high) in enumerate(known):
        y = TOP + k * ROW + ROW / 2
        text = f"{name}: {number(middle, 1)} ({number(low, 1)} to {number(high, 1)})"
        parts.append(_name(TOP + k * ROW, name))
        parts.append(
            f'<g class="interval"><title>{escape(text)}</title><line x1="{scale(low):.1f}" x2="{scale(high):.1f}" y1="{y}" y2="{y}"/>'
            f'<circle cx="{scale(middle):.1f}" cy="{y}" r="4.5"/></g>'
        )
        parts.append(f'<text class="value" x="{WIDTH}" y="{y + 4}" text-anchor="end">{escape(number(middle, 1))}</text>')
    return Markup("".join([*parts, "</svg>"]))


def _frame(scale: _Scale, rows: int, label: str, shade_below_zero: bool) -> list[str]:
    bottom = TOP + rows * ROW
    parts = [f'<svg class="bars" viewBox="0 0 {WIDTH} {bottom + BOTTOM}" role="img" aria-label="{escape(label)}">']
    if shade_below_zero and scale.low < 0.0:
        parts.append(f'<rect class="inside" x="{NAMES}" y="{TOP}" width="{scale(0.0) - NAMES:.1f}" height="{bottom - TOP}"/>')
    for mark in scale.marks:
        css = "zero" if mark == 0.0 else "grid"
        parts.append(f'<line class="{css}" x1="{scale(mark):.1f}" x2="{scale(mark):.1f}" y1="{TOP}" y2="{bottom}"/>')
        text = f"{mark:g}".replace("-", "\N{MINUS SIGN}")
        parts.append(f'<text x="{scale(mark):.1f}" y="{bottom + 14}" text-anchor="middle">{text}</text>')
    parts.append(f'<text x="{(NAMES + WIDTH - RIGHT) / 2:.0f}" y="{bottom + 30}" text-anchor="middle">{escape(label)}</text>')
    return parts


def _name(y: float, name: str) -> str:
    return f'<text class="name" x="{NAMES - 8}" y="{y + ROW / 2 + 4:.1f}" text-anchor="end">{escape(name)}</text>'
