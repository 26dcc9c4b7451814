"""Turning along a circle of the velocity sphere until every cone is left: the building block of methods that choose a plane first.

A circle is v(omega) = centre + ahead cos(omega) + aside sin(omega), from the present velocity at omega = 0. A great circle is a
turn in a plane through the velocity; a circle of latitude is a turn at constant climb angle.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vosc.cone import Cone, is_free, outside
from vosc.free import sides, zeros
from vosc.vec import Vec, cross, scale, unit

GRID = 64
_STEP = 2.0 * math.pi / GRID


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
    """The turn in the vertical plane through the velocity, up for positive omega; ``None`` for a vertical velocity, which has no such plane."""
    x, y, _ = velocity_mps
    size = math.hypot(x, y)
    return great_circle(velocity_mps, (y / size, -x / size, 0.0)) if size > 1e-12 * abs(velocity_mps[2]) and size > 0.0 else None


def circle_in_plane(velocity_mps: Vec, other: Vec) -> Circle | None:
    """The turn in the plane of the velocity and ``other``, towards ``other`` for positive omega; ``None`` when the two are parallel."""
    u, v = unit(velocity_mps), unit(other)
    normal = cross(u, v)
    size = math.hypot(*normal)
    return great_circle(velocity_mps, scale(1.0 / size, normal)) if size > 1e-12 else None


def first_free(cones: Sequence[Cone], circle: Circle, sense: int, limit_rad: float = math.pi) -> float | None:
    """The least turn omega in [0, limit] to the side ``sense`` (+1 or -1) that leaves every cone, rad; ``None`` if there is none."""
    if is_free(cones, circle.at(0.0)):
        return 0.0
    turned = sense * _STEP * np.arange(-1, GRID + 2)
    centre, ahead, aside = (np.array(v) for v in circle)
    points = centre + np.cos(turned)[:, None] * ahead + np.sin(turned)[:, None] * aside
    side = sides(points, cones)
    bend = np.abs(side[:-2] - 2.0 * side[1:-1] + side[2:])
    slack = np.maximum(bend[:-1], bend[1:])
    low, high = np.minimum(side[1:-2], side[2:-1]), np.maximum(side[1:-2], side[2:-1])
    contact = (low <= slack) & (high >= -slack)
    for k in np.nonzero(~(high < -slack).any(axis=1))[0]:
        start = k * _STEP
        if start > limit_rad:
            break
        found = [start]
        for j in np.nonzero(contact[k])[0]:
            cone = cones[j]
            found += zeros(lambda x, cone=cone: outside(cone, circle.at(sense * x)), start, start + _STEP)
        for omega in sorted(found):
            if omega <= limit_rad + 1e-12 and is_free(cones, circle.at(sense * omega)):
                return omega
    return None


