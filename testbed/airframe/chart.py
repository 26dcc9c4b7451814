"""Line charts as static SVG: no script, no network; colours come from the page's style sheet, so they follow dark mode and print."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from markupsafe import Markup, escape

Array = np.ndarray
WIDTH, HEIGHT = 480, 300
LEFT, RIGHT, TOP, BOTTOM = 58, 14, 12, 44
DASHES = {"solid": "", "dash": "7 4", "dot": "2 4"}


class Line(NamedTuple):
    """One curve. ``colour`` is 0 for the colour of the text, 1..5 for those of the page; NaN breaks the curve."""

    x: Array
    y: Array
    name: str = ""
    colour: int = 1
    style: str = "solid"
    marks: bool = False


def chart(
    lines: Sequence[Line],
    x_label: str,
    y_label: str,
    *,
    y_range: tuple[float | None, float | None] = (None, None),
    levels: Sequence[tuple[float, str]] = (),
) -> Markup:
    """An SVG of the curves with axes in round numbers; ``levels`` are horizontal limits with a name."""
    xs = np.concatenate([np.asarray(line.x, float) for line in lines])
    ys = np.concatenate([np.asarray(line.y, float) for line in lines] + [np.array([level for level, _ in levels])])
    x_ticks = ticks(float(np.nanmin(xs)), float(np.nanmax(xs)), 7)
    low, high = (float(edge(ys)) if given is None else given for edge, given in zip((np.nanmin, np.nanmax), y_range, strict=True))
    y_ticks = ticks(low, high, 6)
    x0, x1 = float(np.nanmin(xs)), float(np.nanmax(xs))
    y0, y1 = min(y_ticks[0], low), max(y_ticks[-1], high)

    def across(x: float) -> float:
        return LEFT + (x - x0) / (x1 - x0) * (WIDTH - LEFT - RIGHT)

    def up(y: float) -> float:
        return HEIGHT - BOTTOM - (y - y0) / (y1 - y0) * (HEIGHT - TOP - BOTTOM)

    parts = [f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(y_label)} over {escape(x_label)}">']
    for tick in x_ticks:
        if x0 - 1e-9 <= tick <= x1 + 1e-9:
            parts.append(_line(across(tick), TOP, across(tick), HEIGHT - BOTTOM, "grid"))
            parts.append(_text(across(tick), HEIGHT - BOTTOM + 16, _number(tick), "middle"))
    for tick in y_ticks:
        parts.append(_line(LEFT, up(tick), WIDTH - RIGHT, up(tick), "zero" if tick == 0.0 else "grid"))
        parts.append(_text(LEFT - 7, up(tick) + 4, _number(tick), "end"))
    parts.append(_text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 8, x_label, "middle", "label"))
    middle = (TOP + HEIGHT - BOTTOM) / 2
    parts.append(f'<text class="label" text-anchor="middle" transform="translate(14 {middle:.0f}) rotate(-90)">{escape(y_label)}</text>')
    for level, name in levels:
        parts.append(_line(LEFT, up(level), WIDTH - RIGHT, up(level), "limit"))
        parts.append(_text(WIDTH - RIGHT - 4, up(level) - 4, name, "end", "limit-name"))
    for line in lines:
        parts += _curve(line, across, up)
    return Markup("".join([*parts, "</svg>"])) + _legend(lines)


def _curve(line: Line, across, up) -> list[str]:  # type: ignore[no-untyped-def]
    x, y = np.asarray(line.x, float), np.asarray(line.y, float)
    good = np.isfinite(x) & np.isfinite(y)
    dash = f' stroke-dasharray="{DASHES[line.style]}"' if DASHES[line.style] else ""
    parts = []
    for run in np.split(np.arange(len(x)), np.flatnonzero(~good)):
        kept = [k for k in run if good[k]]
        if len(kept) > 1:
            points = " ".join(f"{across(x[k]):.1f},{up(y[k]):.1f}" for k in kept)
            parts.append(f'<polyline class="c{line.colour}" points="{points}"{dash}/>')
    if line.marks:
        parts += [f'<circle class="c{line.colour}" cx="{across(x[k]):.1f}" cy="{up(y[k]):.1f}" r="3"/>' for k in np.flatnonzero(good)]
    return parts


def _legend(lines: Sequence[Line]) -> Markup:
    named = [line for line in lines if line.name]
    if not named:
        return Markup("")
    items = [
        f'<span><svg viewBox="0 0 26 8"><line class="c{line.colour}" x1="0" y1="4" x2="26" y2="4"'
        + (f' stroke-dasharray="{DASHES[line.style]}"' if DASHES[line.style] else "")
        + f"/></svg>{escape(line.name)}</span>"
        for line in named
    ]
    return Markup('<p class="legend">' + "".join(items) + "</p>")


def ticks(low: float, high: float, most: int) -> list[float]:
    """Round numbers that span a range: steps of 1, 2 or 5 times a power of ten, at most ``most`` of them or so."""
    about = max(1.0, abs(low), abs(high))
    if not high - low > 1e-9 * about:  # one value, or rounding of it
        low, high = low - 0.5 * about, high + 0.5 * about
    rough = (high - low) / most
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(size * power for size in (1.0, 2.0, 5.0, 10.0) if size * power >= rough * (1.0 - 1e-9))
    first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
    return [round(k * step, 12) for k in range(first, last + 1)]


def _line(x0: float, y0: float, x1: float, y1: float, css: str) -> str:
    return f'<line class="{css}" x1="{x0:.1f}" y1="{y0:.1f}" x2="{x1:.1f}" y2="{y1:.1f}"/>'


def _text(x: float, y: float, text: str, anchor: str, css: str = "tick") -> str:
    return f'<text class="{css}" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(text)}</text>'


def _number(value: float) -> str:
    return f"{value:g}".replace("-", "\u2212")
