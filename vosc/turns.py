"""Turning along a circle of the velocity sphere until every cone is left: the building block of methods that choose a plane first.

A circle is v(omega) = centre + ahead cos(omega) + aside sin(omega), from the present velocity at omega = 0. A great circle is a
turn in a plane through the velocity; a circle of latitude is a turn at constant climb angle.
"""

import math
from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from vosc.cone import Cone, is_free, outside
from vosc.free import sides, zeros
from vosc.vec import BoolArray, Vec, cross, scale, unit

GRID = 64
_STEP = 2.0 * math.pi / GRID
_COS, _SIN = np.cos(_STEP * np.arange(GRID)), np.sin(_STEP * np.arange(GRID))


class Circle(NamedTuple):
    """The circle centre + ahead cos(omega) + aside sin(omega), m/s."""

    centre: Vec
    ahead: Vec
    aside: Vec

    def at(self, omega: float) -> Vec:
        """The velocity after a turn by omega."""
        c, s = math.cos(omega), math.sin(omega)
        z, a, b = self
        return (z[0] + c * a[0] + s * b[0], z[1] + c * a[1] + s * b[1], z[2] + c * a[2] + s * b[2])


def great_circle(velocity_mps: Vec, normal: Vec) -> Circle:
    """The turn about the unit vector ``normal``, which is perpendicular to the velocity; counter-clockwise seen from its tip."""
    return Circle((0.0, 0.0, 0.0), velocity_mps, cross(normal, velocity_mps))


def level_circle(velocity_mps: Vec) -> Circle:
    """The turn about the vertical: constant climb angle, to the left for positive omega."""
    x, y, z = velocity_mps
    return Circle((0.0, 0.0, z), (x, y, 0.0), (-y, x, 0.0))


def vertical_circle(velocity_mps: Vec) -> Circle | None:
    """The turn in the vertical plane through the velocity, up for positive omega; ``None`` for a vertical velocity (no such plane)."""
    x, y, _ = velocity_mps
    size = math.hypot(x, y)
    return great_circle(velocity_mps, (y / size, -x / size, 0.0)) if size > 1e-12 * abs(velocity_mps[2]) and size > 0.0 else None


def circle_in_plane(velocity_mps: Vec, other: Vec) -> Circle | None:
    """The turn in the plane of the velocity and ``other``, towards ``other`` for positive omega; ``None`` when the two are parallel."""
    u, v = unit(velocity_mps), unit(other)
    normal = cross(u, v)
    size = math.hypot(*normal)
    return great_circle(velocity_mps, scale(1.0 / size, normal)) if size > 1e-12 else None


def first_free(cones: Sequence[Cone], circles: Sequence[Circle], senses: Sequence[int]) -> list[tuple[float, int, Circle]]:
    """For each circle and each side (+1, -1) the least turn omega in [0, pi] that leaves every cone: (omega, side, circle), where
    there is one.

    All circles are sampled at once; the stretch in which the last cone is left is refined to rounding.
    """
    rows = np.array(circles)
    points = rows[:, None, 0] + _COS[:, None] * rows[:, None, 1] + _SIN[:, None] * rows[:, None, 2]
    table = sides(points.reshape(-1, 3), cones).reshape(len(circles), GRID, len(cones))
    found = []
    for sense in senses:
        side = table[:, (sense * np.arange(-1, GRID // 2 + 2)) % GRID]
        bend = np.abs(side[:, :-2] - 2.0 * side[:, 1:-1] + side[:, 2:])
        slack = np.maximum(bend[:, :-1], bend[:, 1:])
        low, high = np.minimum(side[:, 1:-2], side[:, 2:-1]), np.maximum(side[:, 1:-2], side[:, 2:-1])
        contact: BoolArray = np.logical_and(low <= slack, high >= -slack)
        covered: BoolArray = np.any(high < -slack, axis=2)
        for k, circle in enumerate(circles):
            omega = _leave(cones, circle, sense, ~covered[k], contact[k])
            if omega is not None:
                found.append((omega, sense, circle))
    return found


def _leave(cones: Sequence[Cone], circle: Circle, sense: int, stretches: BoolArray, touched: BoolArray) -> float | None:
    """The first free turn in the stretches that no cone surely covers: their starts, and the crossings inside."""
    for k in np.nonzero(stretches)[0].tolist():
        start = k * _STEP
        found = [start]
        for j in np.nonzero(touched[k])[0].tolist():
            found += zeros(partial(_side, cones[j], circle, sense), start, start + _STEP)
        for omega in sorted(found):
            if omega <= math.pi and is_free(cones, circle.at(sense * omega)):
                return omega
    return None


def least_turn(cones: Sequence[Cone], circles: Sequence[Circle], senses: Sequence[int]) -> Vec | None:
    """The velocity after the least turn on any circle to any side that leaves every cone; between equal turns the one named first."""
    best: tuple[float, int, Circle] | None = None
    for turn in first_free(cones, circles, senses):
        if best is None or turn[0] < best[0] - 1e-12:
            best = turn
    return None if best is None else best[2].at(best[1] * best[0])


def _side(cone: Cone, circle: Circle, sense: int, omega: float) -> float:
    return outside(cone, circle.at(sense * omega))
