"""Texts in a picture that do not cover one another. Sizes and places are in heights of the picture, right and up from its middle."""

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

    def size(self, text: str) -> Array:
        """Width and height that a text takes, its frame included."""
        lines = text.split("\n")
        return np.array([LETTER * (max(map(len, lines)) + 2.5), LINE * len(lines)]) / self.pixels

    def sizes(self, texts: Sequence[str]) -> Array:
        """(m, 2)."""
        return np.array([self.size(text) for text in texts])

    def within(self, wanted: Array, sizes: Array) -> Array:
        """Places (m, 2) moved into the picture."""
        room = np.maximum(self.edge - 0.5 * sizes, 0.0)
        return np.clip(wanted, -room, room)


def spread(wanted: Array, sizes: Array, top: float = EDGE[1]) -> Array:
    """Places (m, 2) for texts of ``sizes`` (m, 2), as near as may be to where they are ``wanted``: only ever moved up or down, and not
    past the picture's ``top`` and bottom as long as there is room.

    The first has its way, each other one gives way to those before it.
    """
    placed = np.array(wanted, float)
    for k in range(1, len(placed)):
        placed[k] = _free(placed[k], sizes[k], placed[:k], sizes[:k], top)
    return placed


def _free(want: Array, own: Array, others: Array, sizes: Array, top: float) -> Array:
    """The nearest place above or below ``want`` that overlaps none of the others."""
    room = 0.5 * (sizes + own)
    level = np.abs(others[:, 0] - want[0]) < room[:, 0]  # those that are in its way up or down
    tries = [0.0, *(others[level, 1] + room[level, 1] - want[1]), *(others[level, 1] - room[level, 1] - want[1])]
    for shift in sorted(tries, key=lambda shift: (abs(want[1] + shift) > top - 0.5 * own[1] + 1e-9, abs(shift))):
        if not np.any(level & (np.abs(others[:, 1] - want[1] - shift) < room[:, 1] - 1e-9)):
            return want + np.array([0.0, shift])
    return want


def overlaps(places: Array, sizes: Array) -> bool:
    """Whether any two of the texts cover one another."""
    apart = np.abs(places[:, None] - places[None])
    room = 0.5 * (sizes[:, None] + sizes[None]) - 1e-9
    covered = (apart < room).all(axis=2)
    return bool(np.triu(covered, 1).any())
