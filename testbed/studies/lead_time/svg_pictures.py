"""Static SVG: distribution functions, histograms and logistic curves, readable without JavaScript, in the dark and on paper."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from markupsafe import Markup, escape

WIDTH, HEIGHT = 460, 230
LEFT, TOP, BOTTOM = 34, 8, 34
BINS = 24


class Curve(NamedTuple):
    """A line of a picture: points, name, and the number of its colour (class ``c<n>``); dashed for a bound or a fit."""

    x: Sequence[float]
    y: Sequence[float]
    name: str
    colour: int
    dashed: bool = False


def staircase(values: Sequence[float], longest: float) -> tuple[list[float], list[float]]:
    """The distribution function of a sample: share (0 to 1) at most x, up to ``longest``; what is infinite never counts."""
    inside = sorted(value for value in values if value <= longest)
    n = len(values)
    x, y = [0.0], [0.0]
    for k, value in enumerate(inside, 1):
        x += [max(value, 0.0), max(value, 0.0)]
        y += [(k - 1) / n, k / n]
    return [*x, longest], [*y, len(inside) / n if n else 0.0]


class Mark(NamedTuple):
    """A point of a picture that is named: where a curve crosses a half."""

    x: float
    colour: int


def shares(curves: Sequence[Curve], longest: float, title: str, x_label: str, medians: Sequence[Mark] = ()) -> Markup:
    """Shares from 0 to 100 % over a time from 0 to ``longest`` seconds."""
    parts = [_frame(title, longest, x_label)]
    for percent in (0, 25, 50, 75, 100):
        y = _y(percent / 100.0)
        parts.append(f'<line class="grid" x1="{LEFT}" y1="{y:.1f}" x2="{WIDTH}" y2="{y:.1f}"/>')
        parts.append(f'<text x="{LEFT - 5}" y="{y + 4:.1f}" text-anchor="end">{percent}</text>')
    for curve in curves:
        points = " ".join(f"{_x(x, longest):.1f},{_y(y):.1f}" for x, y in zip(curve.x, curve.y, strict=True))
        dash = " dashed" if curve.dashed else ""
        parts.append(f'<polyline class="line c{curve.colour}{dash}" points="{points}"><title>{escape(curve.name)}</title></polyline>')
    parts += [_median(mark, k, longest) for k, mark in enumerate(sorted(medians))]
    return Markup("".join([*parts, "</svg>"]))


def histogram(values: Sequence[float], longest: float, title: str, x_label: str) -> Markup:
    """Counts of a sample between 0 and ``longest``; what lies beyond is counted in words."""
    inside = np.clip([value for value in values if value <= longest], 0.0, longest)
    counts, _ = np.histogram(inside, np.linspace(0.0, longest, BINS + 1))
    tallest, step = max(int(counts.max()), 1), longest / BINS
    parts = [_frame(title, longest, x_label)]
    for k, count in enumerate(counts.tolist()):
        if count:
            x, y = _x(k * step, longest), _y(count / tallest)
            wide = _x(step, longest) - _x(0.0, longest) - 1.0
            parts.append(f'<rect class="bar" x="{x + 0.5:.1f}" y="{y:.1f}" width="{wide:.1f}" height="{_y(0.0) - y:.1f}"/>')
    parts.append(f'<text x="{LEFT - 5}" y="{_y(1.0) + 8:.1f}" text-anchor="end">{tallest}</text>')
    if beyond := len(values) - len(inside):
        parts.append(f'<text x="{WIDTH}" y="{TOP + 12}" text-anchor="end">{beyond} of {len(values)} beyond or never</text>')
    return Markup("".join([*parts, "</svg>"]))


def _median(mark: Mark, place: int, longest: float) -> str:
    """A dot at 50 %, a line down to the axis and its number, each a line lower than the one before it."""
    x, y, foot = _x(mark.x, longest), _y(0.5), _y(0.0)
    text = f'<text class="median" x="{x + 5:.1f}" y="{y + 16 + 13 * place:.1f}">{mark.x:.2f} s</text>'
    line = f'<line class="line c{mark.colour} drop" x1="{x:.1f}" y1="{y:.1f}" x2="{x:.1f}" y2="{foot:.1f}"/>'
    return f'{line}<circle class="dot c{mark.colour}" cx="{x:.1f}" cy="{y:.1f}" r="4"/>{text}'


def _frame(title: str, longest: float, x_label: str) -> str:
    ticks = range(math.floor(longest) + 1)
    marks = "".join(
        f'<line class="grid" x1="{_x(t, longest):.1f}" y1="{TOP}" x2="{_x(t, longest):.1f}" y2="{HEIGHT - BOTTOM}"/>'
        f'<text x="{_x(t, longest):.1f}" y="{HEIGHT - BOTTOM + 14}" text-anchor="middle">{t}</text>'
        for t in ticks
    )
    label = f'<text x="{0.5 * (LEFT + WIDTH):.0f}" y="{HEIGHT - 3}" text-anchor="middle">{escape(x_label)}</text>'
    axis = f'<line class="axis" x1="{LEFT}" y1="{HEIGHT - BOTTOM}" x2="{WIDTH}" y2="{HEIGHT - BOTTOM}"/>'
    return f'<svg viewBox="0 0 {WIDTH + 8} {HEIGHT}" role="img" aria-label="{escape(title)}">{marks}{axis}{label}'


def _x(value: float, longest: float) -> float:
    return LEFT + (WIDTH - LEFT) * min(value, longest) / longest


def _y(share: float) -> float:
    return HEIGHT - BOTTOM - (HEIGHT - BOTTOM - TOP) * share
