"""A constant rate of turn, acceleration and vertical speed in closed form: what legs of traffic are made of."""

import math
from bisect import bisect_right
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from testbed.core.frames import Vec3

Array = np.ndarray
SMALL_RAD = 1e-2
"""Below this angle the integrals of a turn are series: their closed forms would lose digits."""


class Piece(NamedTuple):
    """From ``pos`` at ``time_s``: level speed, its rate, azimuth, its rate, vertical speed."""

    time_s: float
    pos: Vec3
    speed: float
    rate: float
    azimuth: float
    turn: float
    climb: float


def _integrals(theta: Any, m: Any) -> tuple[Any, Any, Any, Any]:
    """Of exp(i theta s) and of s exp(i theta s) over s from 0 to 1, real and imaginary parts; ``m``: ``math`` or ``numpy``."""
    half = m.sin(0.5 * theta)
    sine, versine = m.sin(theta), 2.0 * half * half
    return sine / theta, versine / theta, (theta * sine - versine) / theta**2, (sine - theta * (1.0 - versine)) / theta**2


def _series(theta: Any) -> tuple[Any, Any, Any, Any]:
    """The same for a small angle."""
    square = theta * theta
    return (
        1.0 - square / 6.0 + square * square / 120.0,
        theta * (0.5 - square / 24.0),
        0.5 - square / 8.0 + square * square / 144.0,
        theta * (1.0 / 3.0 - square / 30.0),
    )


def along(piece: Piece, t: float) -> tuple[Vec3, Vec3]:
    """Place and velocity after that long on a piece."""
    theta = piece.turn * t
    c0, s0, c1, s1 = _series(theta) if abs(theta) < SMALL_RAD else _integrals(theta, math)
    ahead, aside = t * (piece.speed * c0 + piece.rate * t * c1), t * (piece.speed * s0 + piece.rate * t * s1)
    cos, sin = math.cos(piece.azimuth), math.sin(piece.azimuth)
    (x, y, z), speed, azimuth = piece.pos, piece.speed + piece.rate * t, piece.azimuth + theta
    return (
        (x + cos * ahead - sin * aside, y + sin * ahead + cos * aside, z + piece.climb * t),
        (speed * math.cos(azimuth), speed * math.sin(azimuth), piece.climb),
    )


class Chained:
    """Pieces one after the other, the first one and the last one without an end. What does not depend on time is worked out once."""

    def __init__(self, pieces: Sequence[Piece]) -> None:
        """The first one's time is where the second one begins, from where it counts backwards."""
        starts = [piece.time_s for piece in pieces[1:]]
        rows = [(one, math.cos(one.azimuth), math.sin(one.azimuth)) for one in pieces]
        self._starts, ends = starts, zip([-math.inf, *starts], [*starts, math.inf], strict=True)
        self._rows = [
            (low, high, one.turn == 0.0 and one.rate == 0.0, one, cos, sin) for (low, high), (one, cos, sin) in zip(ends, rows, strict=True)
        ]
        self._table = np.array([(one.time_s, *one.pos, *one[2:], cos, sin) for one, cos, sin in rows])
        self._row = self._rows[0]  # the one asked for last: a flight asks for it again and again

    def at(self, time_s: float) -> tuple[Vec3, Vec3]:
        """Place and velocity at a time, to the last digit those of ``along``."""
        low, high, straight, piece, cos, sin = self._row
        if not low <= time_s < high:
            self._row = low, high, straight, piece, cos, sin = self._rows[bisect_right(self._starts, time_s)]
        since_s, (x, y, z), speed, rate, azimuth, turn, climb = piece
        t = time_s - since_s
        if straight:
            ahead = t * speed
            return (x + cos * ahead, y + sin * ahead, z + climb * t), (speed * cos, speed * sin, climb)
        theta = turn * t
        c0, s0, c1, s1 = _series(theta) if abs(theta) < SMALL_RAD else _integrals(theta, math)
        ahead, aside = t * (speed * c0 + rate * t * c1), t * (speed * s0 + rate * t * s1)
        speed, azimuth = speed + rate * t, azimuth + theta
        return (
            (x + cos * ahead - sin * aside, y + sin * ahead + cos * aside, z + climb * t),
            (speed * math.cos(azimuth), speed * math.sin(azimuth), climb),
        )

    def sampled(self, time_s: Array) -> tuple[Array, Array]:
        """The same at times (n,): arrays (n,3)."""
        which = np.searchsorted(self._starts, time_s, side="right")
        since_s, x, y, z, speed, rate, azimuth, turn, climb, cos, sin = self._table[which].T
        t = time_s - since_s
        theta = turn * t
        small = np.abs(theta) < SMALL_RAD
        exact = _integrals(np.where(small, 1.0, theta), np)
        c0, s0, c1, s1 = (np.where(small, a, b) for a, b in zip(_series(theta), exact, strict=True))
        ahead, aside = t * (speed * c0 + rate * t * c1), t * (speed * s0 + rate * t * s1)
        speed, azimuth = speed + rate * t, azimuth + theta
        pos = np.column_stack([x + cos * ahead - sin * aside, y + sin * ahead + cos * aside, z + climb * t])
        return pos, np.column_stack([speed * np.cos(azimuth), speed * np.sin(azimuth), climb])

    def top_speed(self) -> float:
        """The greatest on any piece, which is at one of its ends, m/s."""
        ends = [one.speed + (one.rate * (high - one.time_s) if one.rate else 0.0) for _, high, _, one, _, _ in self._rows]
        return max(math.hypot(max(abs(one.speed), abs(end)), one.climb) for (_, _, _, one, _, _), end in zip(self._rows, ends, strict=True))
