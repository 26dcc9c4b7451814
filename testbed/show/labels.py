"""Texts in a picture that do not cover one another. Sizes and places are in heights of the picture, right and up from its middle."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

Array = np.ndarray
EDGE = np.array([0.72, 0.47])  # of a picture half again as wide as high: from its middle to its sides, to its top
LETTER, LINE = 5.2, 23.0  # pixels of the viewer's letters and lines


@dataclass(frozen=True)
class Sheet:
    """What texts are put on: a picture so many pixels high at least, and how far it reaches from its middle to a side and to its top."""

    pixels: float = 480.0
    edge: Array = field(default_factory=lambda: EDGE)

    def size(self, text: str) -> tuple[float, float]:
        """Width and height that a text takes, its frame included."""
        lines = text.split("\n")
        return LETTER * (max(map(len, lines)) + 2.5) / self.pixels, LINE * len(lines) / self.pixels

    def sizes(self, texts: Sequence[str]) -> Array:
        """(m, 2)."""
        return np.array([self.size(text) for text in texts]).reshape(-1, 2)

    def within(self, wanted: Array, sizes: Array) -> Array:
        """Places (m, 2) moved into the picture."""
        room = np.maximum(self.edge - 0.5 * sizes, 0.0)
        return np.clip(wanted, -room, room)


def spread(wanted: Array, sizes: Array, top: float = EDGE[1]) -> Array:
    """Places (m, 2) for texts of ``sizes`` (m, 2), as near as may be to where they are ``wanted``: only ever moved up or down, and not
    past the picture's ``top`` and bottom as long as there is room.

    The first has its way, each other one gives way to those before it. In plain numbers: it is called for every instant of a flight.
    """
    placed: list[tuple[float, float, float, float]] = []
    for (x, y), (width, height) in zip(wanted.tolist(), sizes.tolist(), strict=True):
        # heights that are taken where this text stands: middle, and how far from it this text's middle has to be
        taken = [(v, 0.5 * (h + height)) for u, v, w, h in placed if abs(u - x) < 0.5 * (w + width)]
        placed.append((x, _free(y, taken, top - 0.5 * height), width, height))
    return np.array([place[:2] for place in placed]).reshape(-1, 2)


def _free(want: float, taken: list[tuple[float, float]], top: float) -> float:
    """The nearest height that is not taken."""
    best, cost = want, (True, math.inf)
    for y in (want, *(v + side * room for v, room in taken for side in (1.0, -1.0))):
        how = (abs(y) > top + 1e-9, abs(y - want))
        if how < cost and all(abs(y - v) > room - 1e-9 for v, room in taken):
            best, cost = y, how
    return best


def overlaps(places: Array, sizes: Array) -> bool:
    """Whether any two of the texts cover one another."""
    apart = np.abs(places[:, None] - places[None])
    room = 0.5 * (sizes[:, None] + sizes[None]) - 1e-9
    covered = (apart < room).all(axis=2)
    return bool(np.triu(covered, 1).any())
