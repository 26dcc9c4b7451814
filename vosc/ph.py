"""Spatial Pythagorean-hodograph quintics: the curve that joins two points with given end derivatives.

``hermite`` is the canonical member of the two-parameter family of C1 Hermite interpolants (both free angles zero): closed form, of
order 4, it turns and mirrors with the data, reverses with them, and stays in the plane of planar data. The shortest member has
cusps on ordinary data.

Sources: Farouki, al-Kandari, Sakkalis, Adv. Comp. Math. 17 (2002) 369; Farouki, Giannelli, Manni, Sestini, CAGD 25 (2008) 274; Sir
and Juettler, Math. Comp. 76 (2007) 1373.
"""

import math
from collections.abc import Iterable

from vosc.errors import NoDirection, SamePoint
from vosc.ph_batch import Curves, hermite_many
from vosc.ph_curve import Curve
from vosc.ph_flyable import Flyable, Limits, flyable
from vosc.vec import Vec, add, along, combine, dot, norm, perpendicular, right_of, scale, sub, three, unit

__all__ = ["Curve", "Curves", "Flyable", "Limits", "flyable", "hermite", "hermite_many"]

OPPOSITE = 1e-9  # unit vectors whose sum is smaller than this point in opposite directions: their bisector is rounding noise


def _root(axis: Vec, c: Vec, size: float, *hints: Vec) -> Vec:
    """The pure vector a of length sqrt|c| that turns ``axis`` half round into the direction of ``c``: along the bisector of the two."""
    if size == 0.0:
        return (0.0, 0.0, 0.0)
    bisector = along(axis, 1.0 / size, c)
    length = norm(bisector)
    if length < OPPOSITE:  # every perpendicular turns the axis round: take the one on the side of the data
        return scale(math.sqrt(size), perpendicular(axis, *hints))
    return scale(math.sqrt(size) / length, bisector)


def hermite(p0_m: Iterable[float], d0_m: Iterable[float], p1_m: Iterable[float], d1_m: Iterable[float]) -> Curve:
    """The canonical PH quintic from ``p0_m`` to ``p1_m`` (m) with end derivatives ``d0_m``, ``d1_m`` (m per unit of parameter).

    The direction of a derivative is the tangent; its length is a shape parameter, best near the distance |p1 - p0| and at most 3
    times that. Collinear forward data give the straight line. When the two tangents are exactly opposite, the curve does not depend
    continuously on them (a turn to the other side is as good): ``Curve`` is then built on the side of p1. A ``Refusal`` for a zero
    or non-finite derivative and p0 = p1.
    """
    p0, d0, p1, d1 = three("p0_m", p0_m), three("d0_m", d0_m), three("p1_m", p1_m), three("d1_m", d1_m)
    n0, n1 = norm(d0), norm(d1)
    if n0 == 0.0 or n1 == 0.0:
        raise NoDirection(f"{'d0_m' if n0 == 0.0 else 'd1_m'}: give a non-zero end derivative, for example unit tangent x |p1 - p0|")
    chord = sub(p1, p0)
    if norm(chord) == 0.0:
        raise SamePoint(f"p1_m: give an end point that differs from the start, both are {p0}")
    t0, t1 = scale(1.0 / n0, d0), scale(1.0 / n1, d1)
    sum_of_tangents = add(t0, t1)
    axis = unit(sum_of_tangents) if norm(sum_of_tangents) > OPPOSITE else perpendicular(t0, chord, right_of(t0))
    a0, a2 = _root(axis, d0, n0), _root(axis, d1, n1)
    # a0 e a2* + a2 e a0* for pure vectors
    mixed = combine(2.0, combine(dot(a0, axis), a2, dot(a2, axis), a0), -2.0 * dot(a0, a2), axis)
    c = along(along(scale(120.0, chord), -15.0, add(d0, d1)), 5.0, mixed)
    b = _root(axis, c, norm(c), t0, t1, right_of(axis))
    a1 = combine(0.25, b, -0.75, add(a0, a2))
    return Curve(p0, axis, (a0, a1, a2))
