"""Pictures of geometry in space, as plain data: they are drawn twice, as SVG (``svg_picture.py``) and in a recording."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from testbed.show import palette, shapes

Array = np.ndarray

INKS = {
    "own": ("#0B5FA5", palette.SKY),
    "obstacle": ("#C24A00", palette.VERMILLION),
    "relative": ("#6A3D9A", palette.RELATIVE),
    "cap": ("#B97700", palette.ORANGE),
    "chosen": ("#B03A7D", palette.PURPLE),
    "route": ("#6B7280", palette.GREY),
    "avoid": ("#9A8500", palette.YELLOW),
    "rejoin": ("#00805C", palette.GREEN),
    "ink": ("#20262E", palette.WHITE),
    "faint": ("#B9C0C8", palette.NIGHT_LINES),
}
"""One meaning, one colour: on paper, and on the dark of the viewer."""


@dataclass(frozen=True)
class Line:
    """A line through points (n, 3)."""

    points: Array
    ink: str
    width: float = 1.5
    dashed: bool = False


@dataclass(frozen=True)
class Arrow:
    """A vector from a point."""

    origin: Array
    vector: Array
    ink: str
    width: float = 2.2


@dataclass(frozen=True)
class Body:
    """Something convex that can be seen through: points (n, 3), triangles (m, 3) of their numbers."""

    points: Array
    triangles: Array
    ink: str
    opacity: float = 0.16


@dataclass(frozen=True)
class Sphere:
    """A sphere, with its net."""

    centre: Array
    radius: float
    ink: str
    opacity: float = 0.10


@dataclass(frozen=True)
class Dot:
    """A point."""

    place: Array
    ink: str
    size: float = 3.5


@dataclass(frozen=True)
class Text:
    """Words at a place, moved by so many pixels to the right and down. ``_`` begins an index: ``v_uo``."""

    place: Array
    text: str
    ink: str
    moved: tuple[float, float] = (0.0, 0.0)


Thing = Line | Arrow | Body | Sphere | Dot | Text


@dataclass(frozen=True)
class Value:
    """A number beside a picture: its sign, what it is, and what the paper prints for it, if anything. ``value`` may be a vector."""

    sign: str
    what: str
    value: float | tuple[float, ...]
    unit: str = ""
    digits: int = 2
    printed: str = ""

    @property
    def text(self) -> str:
        """The number as it is written beside the picture, its unit after it."""
        from testbed.show.words import number

        parts = self.value if isinstance(self.value, tuple) else (self.value,)
        told = ", ".join(number(part, self.digits) for part in parts)
        return f"{f'({told})' if len(parts) > 1 else told} {self.unit}".rstrip()


@dataclass(frozen=True)
class Picture:
    """A numbered figure: what is in it, from where it is seen (towards the eye), its numbers, and what has to be said of it."""

    number: int
    title: str
    things: Sequence[Thing]
    towards: tuple[float, float, float]
    values: Sequence[Value] = ()
    note: str = ""
    unit: str = "m"
    larger: tuple[float, float, float, float] | None = None
    """A place and how far round it: the part that is shown once more, larger."""
    sphere_around: bool = False
    """Whether spheres may reach out of the picture, which what is on them is to fill."""


@dataclass
class Sketch:
    """Collects the things of a picture."""

    things: list[Thing] = field(default_factory=list)

    def line(self, points: Sequence[Array], ink: str, width: float = 1.5, dashed: bool = False) -> None:
        """A line through points."""
        self.things.append(Line(np.asarray(points, float), ink, width, dashed))

    def arrow(
        self, origin: Array, vector: Array, ink: str, text: str = "", moved: tuple[float, float] = (6.0, -4.0), at: float = 1.0
    ) -> None:
        """A vector with its name beside it, ``at`` a share of its length."""
        self.things.append(Arrow(np.asarray(origin, float), np.asarray(vector, float), ink))
        if text:
            self.text(np.asarray(origin) + at * np.asarray(vector), text, ink, moved)

    def dot(self, place: Array, ink: str, text: str = "", moved: tuple[float, float] = (7.0, -6.0)) -> None:
        """A point with its name beside it."""
        self.things.append(Dot(np.asarray(place, float), ink))
        if text:
            self.text(place, text, ink, moved)

    def text(self, place: Array, text: str, ink: str, moved: tuple[float, float] = (0.0, 0.0)) -> None:
        """Words."""
        self.things.append(Text(np.asarray(place, float), text, ink, moved))

    def sphere(self, centre: Array, radius: float, ink: str, opacity: float = 0.10) -> None:
        """A sphere."""
        self.things.append(Sphere(np.asarray(centre, float), radius, ink, opacity))

    def cone(self, apex: Array, axis: Array, half_angle: float, length: float, ink: str, opacity: float = 0.14) -> Array:
        """A cone whose side lines are so long; returns its rim (n, 3)."""
        rim = (
            np.asarray(apex) + length * shapes.turned_from_x_axis(shapes.circles(np.array([half_angle])), np.asarray(axis, float)[None])[0]
        )
        self.things.append(Body(np.vstack([apex, rim[:-1]]), shapes.cone_triangles(), ink, opacity))
        self.line(rim, ink, 1.1)
        return np.asarray(rim)

    def cap(self, centre: Array, axis: Array, half_angle: float, radius: float, ink: str, opacity: float = 0.34) -> None:
        """The part of a sphere within an angle of an axis."""
        towards, angle = np.asarray(axis, float)[None], np.array([half_angle])
        patch = np.asarray(centre) + radius * shapes.turned_from_x_axis(shapes.caps(angle), towards)[0]
        self.things.append(Body(patch, shapes.cap_triangles(), ink, opacity))
        self.line(np.asarray(centre) + radius * shapes.turned_from_x_axis(shapes.circles(angle), towards)[0], ink, 1.6)

    def angle(
        self, apex: Array, first: Array, last: Array, size: float, ink: str, text: str = "", moved: tuple[float, float] = (4.0, 4.0)
    ) -> None:
        """An arc between two directions with its name in the middle."""
        one, other = (np.asarray(v, float) / np.linalg.norm(v) for v in (first, last))
        share = np.linspace(0.0, 1.0, 21)[:, None]
        turn = float(np.arccos(np.clip(one @ other, -1.0, 1.0)))
        if turn < 1e-9:
            return
        arc = np.asarray(apex) + size * (np.sin((1.0 - share) * turn) * one + np.sin(share * turn) * other) / np.sin(turn)
        self.line(arc, ink, 1.2)
        if text:
            self.text(arc[len(arc) // 2], text, ink, moved)
