"""Horizontal by vertical misses as static SVG, with the volumes drawn: readable without JavaScript, in the dark and on paper."""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from markupsafe import Markup, escape

from testbed.campaign.words.daa import Volume
from testbed.results.daa.columns import title
from testbed.show.words import number

Point = tuple[float, float]
WIDTH, HEIGHT = 360.0, 250.0
LEFT, RIGHT, TOP, BOTTOM = 44.0, 10.0, 12.0, 38.0
FARTHEST = 97.5  # per cent of the misses that the picture reaches out to
TOO_LARGE = 2.0  # a volume that is so many times what the misses need is named, and not drawn


def misses_svg(points: Sequence[Point], every: Sequence[Point], volumes: Mapping[str, Volume]) -> Markup:
    """The misses of some flights, to the scale that those of ``every`` one need."""
    need = [max(1.0, float(np.percentile([point[k] for point in every], FARTHEST))) for k in (0, 1)]
    drawn = {name: (one.radius_m, one.half_height_m or one.radius_m) for name, one in volumes.items()}
    drawn = {name: size for name, size in drawn.items() if all(size[k] <= TOO_LARGE * need[k] for k in (0, 1))}
    reach = [1.08 * max([need[k], *(size[k] for size in drawn.values())]) for k in (0, 1)]
    inner = WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM

    def x(value: float) -> float:
        return LEFT + inner[0] * value / reach[0]

    def y(value: float) -> float:
        return HEIGHT - BOTTOM - inner[1] * value / reach[1]

    parts = [f'<svg viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" aria-label="horizontal and vertical misses of {len(points)} flights">']
    for k, step in enumerate(map(_step, reach)):
        for n in range(int(reach[k] / step) + 1):
            parts.append(_tick(k, n * step, x, y))
    names = []
    for name, (wide, high) in sorted(drawn.items(), key=lambda item: -item[1][0]):
        right, top, ground = x(wide), y(high), y(0)
        if volumes[name].shape == "sphere":
            way = f"M{LEFT:g} {top:.1f}A{right - LEFT:.1f} {ground - top:.1f} 0 0 1 {right:.1f} {ground:.1f}"
            names.append((LEFT + 4.0, top, name, "start"))
        else:
            way = f"M{LEFT:g} {top:.1f}H{right:.1f}V{ground:.1f}"
            names.append((right - 3.0, top, name, "end"))
        parts.append(f'<path class="volume" d="{way}"/>')
    inside = [point for point in points if point[0] <= reach[0] and point[1] <= reach[1]]
    parts += [f'<circle cx="{x(h):.1f}" cy="{y(v):.1f}" r="2.6"/>' for h, v in inside]
    for at, up, name, anchor in names:
        parts.append(f'<text class="name" x="{at:.1f}" y="{up - 4.0:.1f}" text-anchor="{anchor}">{escape(title(name))}</text>')
    if beyond := len(points) - len(inside):
        parts.append(f'<text x="{WIDTH - RIGHT:g}" y="{TOP + 8:g}" text-anchor="end">{beyond} beyond</text>')
    parts.append(f'<text x="{WIDTH - RIGHT:g}" y="{HEIGHT - 5:g}" text-anchor="end">horizontal miss, m</text>')
    parts.append(f'<text transform="translate(11 {TOP:g}) rotate(-90)" text-anchor="end">vertical miss, m</text>')
    return Markup("".join([*parts, "</svg>"]))


def _step(reach: float) -> float:
    """Between two numbers of an axis: 1, 2 or 5 times a power of ten, four to nine of them."""
    rough = reach / 4.0
    power = 10.0 ** math.floor(math.log10(rough))
    return max(factor * power for factor in (1.0, 2.0, 5.0) if factor * power <= rough)


def _tick(axis: int, value: float, x: Callable[[float], float], y: Callable[[float], float]) -> str:
    text = number(value, 0 if value >= 1.0 or value == 0.0 else 1)
    if axis == 0:
        at = x(value)
        line = f'<line class="grid" x1="{at:.1f}" x2="{at:.1f}" y1="{TOP:g}" y2="{HEIGHT - BOTTOM:g}"/>'
        return f'{line}<text x="{at:.1f}" y="{HEIGHT - BOTTOM + 14:g}" text-anchor="middle">{text}</text>'
    at = y(value)
    line = f'<line class="grid" x1="{LEFT:g}" x2="{WIDTH - RIGHT:g}" y1="{at:.1f}" y2="{at:.1f}"/>'
    return f'{line}<text x="{LEFT - 5:g}" y="{at + 4:.1f}" text-anchor="end">{text}</text>'
