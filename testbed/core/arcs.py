"""A constant rate of turn, acceleration and vertical speed in closed form: what legs of traffic are made of."""

import math
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


def along_all(piece: Piece, t: Array) -> tuple[Array, Array]:
    """The same after times (n,): arrays (n,3)."""
    theta = piece.turn * t
    small = np.abs(theta) < SMALL_RAD
    exact = _integrals(np.where(small, 1.0, theta), np)
    c0, s0, c1, s1 = (np.where(small, a, b) for a, b in zip(_series(theta), exact, strict=True))
    ahead, aside = t * (piece.speed * c0 + piece.rate * t * c1), t * (piece.speed * s0 + piece.rate * t * s1)
    cos, sin = math.cos(piece.azimuth), math.sin(piece.azimuth)
    (x, y, z), speed, azimuth = piece.pos, piece.speed + piece.rate * t, piece.azimuth + theta
    pos = np.column_stack([x + cos * ahead - sin * aside, y + sin * ahead + cos * aside, z + piece.climb * t])
    return pos, np.column_stack([speed * np.cos(azimuth), speed * np.sin(azimuth), np.full(len(t), piece.climb)])
