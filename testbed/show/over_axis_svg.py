"""The pictures of a metric over axes as static SVG: readable without JavaScript, in the dark and on paper."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

from markupsafe import Markup, escape

from testbed.results.statistics import Effect
from testbed.show import palette
from testbed.show.axis_words import KEPT, RATIO, axis_title, interval_text, less_is_better, metric_text, metric_title, place_text
from testbed.show.figures import CATEGORIES
from testbed.show.key_frames import STROKES
from testbed.show.over_axis import Curves, Grid, HeatMap, Line, OverAxes, Panel

WIDTH, HEIGHT = 340.0, 230.0
LEFT, RIGHT, TOP, BOTTOM = 46.0, 12.0, 10.0, 38.0
ROUND, RIM = 320.0, 34.0  # a polar plot: size, and room for the names of the directions
MOST_TICKS = 9
HALF_WAY: Final = (244, 241, 234)  # of the colours of a heat map, between what is bad and what is good
BAD, GOOD = palette.rgba(palette.VERMILLION)[:3], palette.rgba(palette.BLUE)[:3]

Style = dict[str, str]
Range = tuple[float, float]
Limits = Mapping[str, float]
NO_LIMITS: Final[Limits] = {}


def styles(names: Sequence[str]) -> dict[str, Style]:
    """A colour and a dash for each method, in the order given; without avoidance grey."""
    others = [name for name in names if name != "no avoidance"]
    made = {}
    for name in names:
        k = others.index(name) if name in others else -1
        light, dark = CATEGORIES[k % len(CATEGORIES)] if k >= 0 else (palette.GREY, palette.GREY)
        dash = list(STROKES.values())[(k // len(CATEGORIES) - 1) % len(STROKES)] if k >= len(CATEGORIES) else "2 3" if k < 0 else ""
        made[name] = {"light": light, "dark": dark, "dash": dash}
    return made


def pictures(over: OverAxes, limits: Limits = NO_LIMITS) -> dict[str, Any] | None:
    """What the template needs: the metrics, by figure its panels in each of them, the lines' colours, the table. None without an axis.

    ``limits``: of metrics of which less is better, up to where they are good enough; drawn as a line, and as a frame about the cells
    whose whole interval is.
    """
    if not over.curves:
        return None
    metrics = over.metrics()
    lines = list(dict.fromkeys(line.method for curve in over.curves for panel in curve.panels for line in panel.lines))
    looks = styles(lines)
    curves = [_curve_figure(curve, metrics, looks, limits) for curve in over.curves]
    maps = [_heat_figure(pair, metrics, limits) for pair in over.heat_maps]
    return {
        "metrics": [metric_title(name) for name in metrics],
        "figures": maps + curves if limits else curves + maps,  # where there is a limit, the maps show at a glance where it is kept
        "legend": [{"name": name, **looks[name]} for name in lines],
        "table": table(over, metrics),
    }


def table(over: OverAxes, metrics: Sequence[str]) -> dict[str, Any]:
    """Every number that is drawn, a line a cell."""
    cells = over.drawn()
    axes = list(dict.fromkeys(axis for cell in cells for axis in cell.labels))
    rows = []
    for cell in cells:
        numbers = []
        for name in metrics:
            effect = cell.effects[name]
            sort = f"{effect.value:.6g}" if math.isfinite(effect.value) else ""
            numbers.append({"text": metric_text(name, effect.value, unit=False), "note": interval_text(name, effect), "sort": sort})
        rows.append({"labels": [cell.labels.get(axis, "") for axis in axes], "n": cell.n, "numbers": numbers})
    return {"axes": axes, "metrics": [metric_title(name) for name in metrics], "rows": rows}


def _curve_figure(curve: Curves, metrics: Sequence[str], looks: dict[str, Style], limits: Limits) -> dict[str, Any]:
    each = []
    for name in metrics:
        span = _range(name, [cell.effects[name] for panel in curve.panels for line in panel.lines for _, cell in line.points])
        draw = _polar if curve.round else _curve
        limit = limits.get(name, math.nan)
        each.append([{"title": panel.title, "svg": draw(panel, name, span, looks, curve.title, limit)} for panel in curve.panels])
    if curve.round:
        notes = ["Direction it comes from: north is up" for _ in metrics]
    else:
        effects = [cell.effects for panel in curve.panels for line in panel.lines for _, cell in line.points]
        notes = ["Bars: 95 % interval" if any(one[name].low < one[name].high for one in effects) else "" for name in metrics]
        notes = [note + (f"; dashed: {metric_text(name, limits[name])}" if note and name in limits else "")
                 for name, note in zip(metrics, notes, strict=True)]  # fmt: skip
    return {"title": f"over {curve.title}", "notes": notes, "left_out": curve.left_out, "each": each}


def _heat_figure(pair: HeatMap, metrics: Sequence[str], limits: Limits) -> dict[str, Any]:
    across, upward = axis_title(pair.across), axis_title(pair.upward)
    each = []
    for name in metrics:
        span = _range(name, [cell.effects[name] for grid in pair.grids for cell in grid.cells.values()])
        limit = limits.get(name, math.nan)
        each.append([{"title": grid.title, "svg": _heat(grid, name, span, pair, limit)} for grid in pair.grids])
    return {
        "title": f"over {across}, and {upward}",
        "notes": [
            "Blue: better; orange: worse"
            + (f"; framed: the whole interval is at most {metric_text(name, limits[name])}" if name in limits else "")
            for name in metrics
        ],
        "left_out": pair.left_out,
        "each": each,
    }


def _range(name: str, effects: Sequence[Effect]) -> Range:
    """Of what is drawn, intervals included; a share from nothing to all, a clearance with 0 in it. Intervals of ratios may be endless."""
    if name == KEPT:
        return 0.0, 1.0
    if name.startswith(RATIO):
        return 0.0, max(1.05, *(1.05 * one.value for one in effects if math.isfinite(one.value)), 0.0)
    known = [x for one in effects for x in (one.value, one.low, one.high) if math.isfinite(x)] or [0.0]
    low, high = min(known), max(known)
    if name == "least_clearance_m":
        low, high = min(low, 0.0), max(high, 0.0)
    gap = 0.06 * (high - low) or 1.0
    return low - gap, high + gap


def _ticks(low: float, high: float, about: int = 5) -> list[float]:
    """Round numbers within a range."""
    step = 10.0 ** math.floor(math.log10((high - low) / about))
    step *= min((m for m in (1.0, 2.0, 5.0, 10.0) if (high - low) / (m * step) <= about), default=10.0)
    return [k * step for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def _tick_text(name: str, tick: float) -> str:
    return f"{100.0 * tick:.0f} %" if name == KEPT else place_text(round(tick, 9))


def _colour(look: Style) -> str:
    return f'style="--l:{look["light"]};--d:{look["dark"]}"'


def _said(line: Line, x: float, name: str, effect: Effect) -> str:
    """What a point is, for whoever points at it."""
    return str(escape(f"{line.method} at {place_text(x)}: {metric_text(name, effect.value)} ({interval_text(name, effect)}; n {effect.n})"))


def _label(panel_title: str, name: str, axis: str) -> str:
    return str(escape(f"{metric_title(name)} over {axis}: {panel_title}"))


def _curve(panel: Panel, name: str, span: Range, looks: dict[str, Style], axis: str, limit: float) -> Markup:
    places = sorted({x for line in panel.lines for x, _ in line.points})
    first, last = places[0], places[-1]

    def px(x: float) -> float:
        return LEFT + (WIDTH - LEFT - RIGHT - 16.0) * (x - first) / (last - first or 1.0) + 8.0

    def py(y: float) -> float:
        return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * (min(y, span[1]) - span[0]) / (span[1] - span[0])

    parts = [f'<svg viewBox="0 0 {WIDTH:.0f} {HEIGHT:.0f}" role="img" aria-label="{_label(panel.title, name, axis)}">']
    if name == "least_clearance_m" and span[0] < 0.0:
        parts.append(
            f'<rect class="oa-inside" x="{LEFT:.0f}" y="{py(0.0):.1f}" width="{WIDTH - LEFT - RIGHT:.0f}" '
            f'height="{HEIGHT - BOTTOM - py(0.0):.1f}"/>'
        )
    for tick in _ticks(*span):
        parts.append(f'<path class="oa-grid" d="M{LEFT:.0f} {py(tick):.1f}H{WIDTH - RIGHT:.0f}"/>')
        parts.append(_text(LEFT - 5.0, py(tick) + 4.0, _tick_text(name, tick), "end"))
    if math.isfinite(limit):
        parts.append(f'<path class="oa-limit" d="M{LEFT:.0f} {py(limit):.1f}H{WIDTH - RIGHT:.0f}"/>')
    for x in places if len(places) <= MOST_TICKS else _ticks(first, last):
        parts.append(_text(px(x), HEIGHT - BOTTOM + 15.0, place_text(x), "middle"))
    parts.append(_text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 6.0, axis, "middle"))
    for k, line in enumerate(panel.lines):
        beside = 3.0 * (k - (len(panel.lines) - 1) / 2)  # so that the bars of lines do not cover one another
        parts += _drawn_line(line, name, looks[line.method], lambda x, y, beside=beside: (px(x) + beside, py(y)), closed=False)
    return Markup("".join([*parts, "</svg>"]))


def _drawn_line(line: Line, name: str, look: Style, at: Any, closed: bool) -> list[str]:
    known = [(x, cell.effects[name]) for x, cell in line.points if math.isfinite(cell.effects[name].value)]
    if not known:
        return []
    path = "L".join("{:.1f} {:.1f}".format(*at(x, effect.value)) for x, effect in known)
    dash = f' stroke-dasharray="{look["dash"]}"' if look["dash"] else ""
    parts = [f'<g class="oa-line" {_colour(look)}><path d="M{path}{"Z" if closed else ""}"{dash}/>']
    for x, effect in known:
        cx, cy = at(x, effect.value)
        if math.isfinite(effect.low) and math.isfinite(effect.high):
            parts.append('<path d="M{:.1f} {:.1f}L{:.1f} {:.1f}"/>'.format(*at(x, effect.low), *at(x, effect.high)))
        parts.append(f'<circle cx="{cx:.1f}" cy="{cy:.1f}" r="3"><title>{_said(line, x, name, effect)}</title></circle>')
    return [*parts, "</g>"]


def _polar(panel: Panel, name: str, span: Range, looks: dict[str, Style], axis: str, limit: float) -> Markup:
    middle, reach = ROUND / 2, ROUND / 2 - RIM

    def at(degrees: float, y: float) -> tuple[float, float]:
        r = reach * (0.12 + 0.88 * (y - span[0]) / (span[1] - span[0]))  # the least value keeps off the middle: directions stay apart
        angle = math.radians(degrees)
        return middle + r * math.sin(angle), middle - r * math.cos(angle)

    parts = [f'<svg viewBox="0 0 {ROUND:.0f} {ROUND:.0f}" role="img" aria-label="{_label(panel.title, name, axis)}">']
    zero = name == "least_clearance_m"
    if math.isfinite(limit):
        parts.append(f'<circle class="oa-limit" cx="{middle:.0f}" cy="{middle:.0f}" r="{middle - at(0.0, min(limit, span[1]))[1]:.1f}"/>')
    for tick in sorted({*_ticks(*span, about=4), *([0.0] if zero else [])}):
        edge = at(0.0, tick)
        ring = "oa-zero" if zero and tick == 0.0 else "oa-grid"
        parts.append(f'<circle class="{ring}" cx="{middle:.0f}" cy="{middle:.0f}" r="{middle - edge[1]:.1f}"/>')
        x, y = at(22.5, tick)
        parts.append(_text(x, y, _tick_text(name, tick), "middle", "oa-over"))
    for k, direction in enumerate(("N", "NE", "E", "SE", "S", "SW", "W", "NW")):
        angle = math.radians(45.0 * k)
        x, y = (middle + (reach + 17.0) * math.sin(angle), middle - (reach + 17.0) * math.cos(angle))
        (ax, ay), (bx, by) = at(45.0 * k, span[0]), at(45.0 * k, span[1])
        parts.append(f'<path class="oa-grid" d="M{ax:.1f} {ay:.1f}L{bx:.1f} {by:.1f}"/>')
        parts.append(_text(x, y + 4.0, direction, "middle"))
    for line in panel.lines:
        places = sorted(x % 360.0 for x, _ in line.points)
        gaps = [b - a for a, b in zip(places, [*places[1:], places[0] + 360.0], strict=True)]
        parts += _drawn_line(line, name, looks[line.method], at, closed=len(places) > 2 and max(gaps) <= 120.0)
    return Markup("".join([*parts, "</svg>"]))


def _shade(name: str, amount: float, span: Range) -> tuple[int, int, int]:
    """Orange for worse, blue for better. A clearance has its middle at 0, what is better when it is low begins blue, a ratio of 1 or
    more is as bad as any.
    """
    if name.startswith(RATIO):
        span = 0.0, 1.0
    if name == "least_clearance_m":
        share = amount / (span[1] if amount > 0.0 else -span[0]) if amount else 0.0
    else:
        share = 2.0 * (amount - span[0]) / (span[1] - span[0]) - 1.0
        share = -share if less_is_better(name) else share
    end, much = (GOOD if share > 0.0 else BAD), min(abs(share), 1.0)
    red, green, blue = (round(a + much * (b - a)) for a, b in zip(HALF_WAY, end, strict=True))
    return red, green, blue


def _heat(grid: Grid, name: str, span: Range, pair: HeatMap, limit: float) -> Markup:
    across, upward = axis_title(pair.across), axis_title(pair.upward)
    columns, rows = ([*sorted({place[k] for place in grid.cells})] for k in (0, 1))
    wide, tall = max((WIDTH - LEFT - RIGHT) / len(columns), 26.0), 30.0
    right, low = LEFT + wide * len(columns), TOP + 12.0 + tall * len(rows)
    parts = [
        f'<svg viewBox="0 0 {right + RIGHT:.0f} {low + BOTTOM:.0f}" role="img" '
        f'aria-label="{_label(grid.title, name, f"{across} and {upward}")}">'
    ]
    for (x, y), cell in sorted(grid.cells.items()):
        effect, left, top = cell.effects[name], LEFT + wide * columns.index(x), low - tall * (rows.index(y) + 1)
        if not math.isfinite(effect.value):
            continue
        shade = _shade(name, effect.value, span)
        bright = 0.299 * shade[0] + 0.587 * shade[1] + 0.114 * shade[2] > 140.0
        where = f"{across} {grid.name(pair.across, 0, x)}, {upward} {grid.name(pair.upward, 1, y)}"
        said = escape(f"{where}: {metric_text(name, effect.value)} ({interval_text(name, effect)})")
        parts.append(
            f'<rect x="{left + 1:.1f}" y="{top + 1:.1f}" width="{wide - 2:.1f}" height="{tall - 2:.0f}" rx="3" '
            f'fill="rgb({shade[0]},{shade[1]},{shade[2]})"><title>{said}</title></rect>'
        )
        if effect.high <= limit:
            parts.append(
                f'<rect class="oa-frame" x="{left + 2:.1f}" y="{top + 2:.1f}" width="{wide - 4:.1f}" height="{tall - 4:.0f}" rx="2"/>'
            )
        written = metric_text(name, effect.value, unit=False).removesuffix(" %")
        parts.append(_text(left + wide / 2, top + tall / 2 + 4.0, written, "middle", "oa-dark" if bright else "oa-bright"))
    for k, x in enumerate(columns):
        parts.append(_text(LEFT + wide * (k + 0.5), low + 14.0, grid.name(pair.across, 0, x), "middle"))
    for k, y in enumerate(rows):
        parts.append(_text(LEFT - 5.0, low - tall * (k + 0.5) + 4.0, grid.name(pair.upward, 1, y), "end"))
    parts.append(_text(2.0, TOP + 2.0, upward, "start"))
    parts.append(_text((LEFT + right) / 2, low + BOTTOM - 6.0, across, "middle"))
    return Markup("".join([*parts, "</svg>"]))


def _text(x: float, y: float, said: str, anchor: str, css: str = "") -> str:
    css = f' class="{css}"' if css else ""
    return f'<text{css} x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(said)}</text>'
