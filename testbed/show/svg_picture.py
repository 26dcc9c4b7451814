"""A picture as SVG: seen from very far (parallel lines stay parallel), fitted to its frame, its numbers in a table beside it."""

import re
import textwrap
from collections.abc import Iterator, Sequence

import numpy as np
from markupsafe import escape

from testbed.show import shapes
from testbed.show.cameras import looking
from testbed.show.drawing import INKS, Arrow, Body, Dot, Line, Picture, Sphere, Text, Thing

Array = np.ndarray
WIDTH, HEIGHT = 1120, 640
Frame = tuple[float, float, float, float]
FRAME: Frame = (30.0, 62.0, 640.0, 500.0)  # of the geometry: left, top, width, height
ABOVE: Frame = (30.0, 56.0, 640.0, 200.0)
BELOW: Frame = (30.0, 268.0, 640.0, 300.0)  # and where a part of it is shown larger
TABLE_X, ROW, TOP = 702, 21, 84
NOTE_LETTERS = 150
PAPER = 0  # of the two inks of everything

_INDEX = re.compile(r"_(\{[^}]*\}|[A-Za-z0-9'\N{PRIME}\-]+)")


def svg(picture: Picture) -> str:
    """The whole file; the same text for the same picture."""
    axes = looking(-np.asarray(picture.towards, float)[None])[0]
    fitted = [thing for thing in picture.things if not (picture.sphere_around and isinstance(thing, Sphere))]
    whole = [point for thing in fitted for point in _extent(thing, axes)]
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" role="img" '
        f'aria-label="{escape(f"Figure {picture.number}. {picture.title}")}" font-family="Inter, Helvetica, Arial, sans-serif">',
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#FFFFFF"/>',
        _words(30, 36, f"Fig. {picture.number}  {picture.title}", INKS["ink"][PAPER], 18, bold=True),
    ]
    if picture.larger is None:
        parts += _framed(picture, _Placing(axes, whole, FRAME), FRAME, False)
    else:
        middle, reach = np.asarray(picture.larger[:3]), picture.larger[3]
        around = [middle + side * reach * axes[:, k] for k, side in ((0, 1.0), (0, -1.0), (1, 0.46), (1, -0.46))]
        parts += _framed(picture, _Placing(axes, whole, ABOVE), ABOVE, False)
        parts += _framed(picture, _Placing(axes, around, BELOW), BELOW, True)
    return "\n".join([*parts, *_table(picture), *_note(picture), "</svg>"]) + "\n"


def _framed(picture: Picture, place: "_Placing", frame: Frame, edge: bool) -> list[str]:
    """The geometry in its frame, cut off at its edges; what can be seen through first, words last."""
    left, top, width, height = (round(x) for x in frame)
    box, name = f'x="{left}" y="{top}" width="{width}" height="{height}"', f"frame{top}"
    drawn = [f'<clipPath id="{name}"><rect {box}/></clipPath>', f'<g clip-path="url(#{name})">']
    for kind in (Sphere, Body, Line, Arrow, Dot, Text):
        for thing in picture.things:
            if isinstance(thing, kind):
                drawn += _drawn(thing, place)
    return [*drawn, "</g>", *([f'<rect {box} fill="none" stroke="#CBD2D9"/>'] if edge else [])]


class _Placing:
    """From places in space to pixels: seen along an axis, moved and scaled so that some points fill the frame."""

    def __init__(self, axes: Array, points: Sequence[Array], frame: Frame) -> None:
        flat = np.vstack([point @ axes[:, :2] for point in points])
        low, high = flat.min(axis=0), flat.max(axis=0)
        room = np.maximum(high - low, 1e-9)
        self.axes, self.scale = axes, 0.88 * float(min(frame[2] / room[0], frame[3] / room[1]))
        self._middle, self._centre = (low + high) / 2.0, np.array([frame[0] + frame[2] / 2.0, frame[1] + frame[3] / 2.0])

    def __call__(self, points: Array) -> Array:
        flat = np.asarray(points, float).reshape(-1, 3) @ self.axes[:, :2]
        return (flat - self._middle) * self.scale + self._centre


def _extent(thing: Thing, axes: Array) -> Iterator[Array]:
    """Points that have to be in the picture."""
    if isinstance(thing, Sphere):
        for k in (0, 1):
            yield thing.centre + thing.radius * axes[:, k]
            yield thing.centre - thing.radius * axes[:, k]
    elif isinstance(thing, Arrow):
        yield thing.origin
        yield thing.origin + thing.vector
    elif isinstance(thing, Line | Body):
        yield from thing.points
    else:
        yield thing.place


def _drawn(thing: Thing, place: _Placing) -> list[str]:
    colour = INKS[thing.ink][PAPER]
    if isinstance(thing, Sphere):
        (x, y), r = place(thing.centre)[0], thing.radius * place.scale
        net = [_path(place(line), colour, 0.5, opacity=0.30) for line in _front(thing, place.axes)]
        fill = f'fill="{colour}" fill-opacity="{thing.opacity:g}"'
        return [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{r:.1f}" {fill} stroke="{colour}" stroke-width="0.9"/>', *net]
    if isinstance(thing, Body):
        hull = " ".join(f"{x:.1f},{y:.1f}" for x, y in _hull(place(thing.points)))
        fill = f'fill="{colour}" fill-opacity="{thing.opacity:g}"'
        return [f'<polygon points="{hull}" {fill} stroke="{colour}" stroke-width="0.8" stroke-opacity="0.6"/>']
    if isinstance(thing, Line):
        return [_path(place(thing.points), colour, thing.width, thing.dashed)]
    if isinstance(thing, Arrow):
        tail, tip = place(np.vstack([thing.origin, thing.origin + thing.vector]))
        return _arrow(tail, tip, colour, thing.width)
    x, y = place(thing.place)[0]
    if isinstance(thing, Dot):
        return [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{thing.size:g}" fill="{colour}"/>']
    return [_words(x + thing.moved[0], y + thing.moved[1], thing.text, colour, 15, halo=True)]


def _front(sphere: Sphere, axes: Array) -> Iterator[Array]:
    """The half of the sphere's net that faces the eye."""
    for line in shapes.graticule():
        facing = line @ axes[:, 2] <= 0.0
        for run in np.split(np.arange(len(line)), np.flatnonzero(np.diff(facing)) + 1):
            if facing[run[0]] and len(run) > 1:
                yield sphere.centre + sphere.radius * line[run]


def _path(points: Array, colour: str, width: float, dashed: bool = False, opacity: float = 1.0) -> str:
    told = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    extra = (' stroke-dasharray="5 4"' if dashed else "") + (f' stroke-opacity="{opacity:g}"' if opacity < 1.0 else "")
    return f'<polyline points="{told}" fill="none" stroke="{colour}" stroke-width="{width:g}" stroke-linejoin="round"{extra}/>'


def _arrow(tail: Array, tip: Array, colour: str, width: float) -> list[str]:
    """A shaft and a head."""
    way = tip - tail
    length = float(np.linalg.norm(way))
    if length < 1e-6:
        return []
    along = way / length
    across, head = np.array([-along[1], along[0]]), min(11.0, 0.5 * length)
    base = tip - head * along
    corners = " ".join(f"{x:.1f},{y:.1f}" for x, y in (tip, base + 0.38 * head * across, base - 0.38 * head * across))
    return [_path(np.vstack([tail, base]), colour, width), f'<polygon points="{corners}" fill="{colour}"/>']


def _hull(points: Array) -> Array:
    """Corners of the convex hull of points in the plane, in order (Andrew's monotone chain)."""
    ordered = sorted({(round(float(x), 3), round(float(y), 3)) for x, y in points})
    halves: list[list[tuple[float, float]]] = []
    for run in (ordered, ordered[::-1]):
        half: list[tuple[float, float]] = []
        for point in run:
            while len(half) > 1 and _turn(half[-2], half[-1], point) <= 0.0:
                half.pop()
            half.append(point)
        halves.append(half[:-1])
    return np.array(halves[0] + halves[1])


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _words(x: float, y: float, text: str, colour: str, size: float, bold: bool = False, halo: bool = False, anchor: str = "start") -> str:
    """A text with its indices lowered; a halo lets it be read over lines."""
    weight = ' font-weight="600"' if bold else ""
    edge = ' stroke="#FFFFFF" stroke-width="3.5" stroke-linejoin="round" paint-order="stroke"' if halo else ""
    side = f' text-anchor="{anchor}"' if anchor != "start" else ""
    return f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size:g}" fill="{colour}"{weight}{edge}{side}>{_indexed(text, size)}</text>'


def _indexed(text: str, size: float) -> str:
    parts, at, low = [], 0, False
    for match in _INDEX.finditer(text):
        parts.append(_run(text[at : match.start()], size, low))
        low = True
        index = match.group(1).strip("{}")
        parts.append(f'<tspan dy="{0.28 * size:.1f}" font-size="{0.72 * size:.1f}">{escape(index)}</tspan>')
        at = match.end()
    return "".join([*parts, _run(text[at:], size, low)])


def _run(text: str, size: float, after_index: bool) -> str:
    if not text:
        return ""
    return f'<tspan dy="{-0.28 * size:.1f}">{escape(text)}</tspan>' if after_index else str(escape(text))


def _table(picture: Picture) -> Iterator[str]:
    """The numbers: sign and what it is, the computed value, and below it what the paper prints."""
    ink, soft = INKS["ink"][PAPER], INKS["route"][PAPER]
    for k, value in enumerate(picture.values):
        y = TOP + 2 * ROW * k
        yield f'<line x1="{TABLE_X}" y1="{y - 15}" x2="{WIDTH - 28}" y2="{y - 15}" stroke="#E4E7EB"/>'
        yield _words(TABLE_X, y + 3, value.sign, ink, 14, bold=True)
        yield _words(TABLE_X, y + 19, value.what, soft, 11)
        yield _words(WIDTH - 28, y + 3, value.text, ink, 14, anchor="end")
        if value.printed:
            yield _words(WIDTH - 28, y + 19, f"printed {value.printed}", soft, 11, anchor="end")


def _note(picture: Picture) -> Iterator[str]:
    """What has to be said, below."""
    for k, line in enumerate(textwrap.wrap(picture.note, NOTE_LETTERS)):
        yield _words(30, HEIGHT - 46 + 16 * k, line, INKS["route"][PAPER], 12)
