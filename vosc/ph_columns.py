"""What ``Curve.frame`` gives, to the last bit, in columns: the arithmetic of the scalar kernel in the same order, on arrays.

``Curve.sample`` is as exact but rounds otherwise. Who steps along a curve one place at a time, and would like to look up many places at
once without his flight changing in the last digit, asks here; and so does who has many curves joined end to end: all are looked up at
once.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from vosc.ph_curve import TABLE, Curve
from vosc.vec import FloatArray, IntArray, Vec

Column = tuple[FloatArray, FloatArray, FloatArray]
LEAST_SIGMA = 1e-150  # squares of less are no numbers to divide by


def frames(curve: Curve, s_m: FloatArray) -> tuple[Column, Column, Column]:
    """Points (m), unit tangents and curvature vectors (1/m) at arc lengths (n,), each as its x, y and z (n,)."""
    t = parameters(curve, s_m)
    preimage, position = curve._kernel
    return (_points(position, t), *_bends(preimage, t))


def parameters(curve: Curve, s_m: FloatArray) -> FloatArray:
    """``Curve.parameter`` at arc lengths (n,)."""
    per_m, starts = curve._starts
    return _parameters(s_m, curve.length_m, per_m, curve._arc_padded, lambda i: np.array(starts).T[:, i])


class Pieces:
    """Curves looked up together: a place is the number of its curve and the arc length on that."""

    def __init__(self, curves: Sequence[Curve]) -> None:
        self._preimage, self._position = (np.array(rows).T.copy() for rows in zip(*(curve._kernel for curve in curves), strict=True))
        self._arc = np.array([curve._arc_padded for curve in curves]).T.copy()
        self._per_m = np.array([curve._starts[0] for curve in curves])
        self._starts = np.array([curve._starts[1] for curve in curves])
        self._length = np.array([curve.length_m for curve in curves])

    def on(self, which: IntArray) -> "Rows":
        """For places on these curves (n,)."""
        return Rows(self, which)


class Rows:
    """Places on given curves, one a row, of which only the arc lengths still change."""

    def __init__(self, pieces: Pieces, which: IntArray) -> None:
        self.which = which
        self._preimage, self._position, self._arc = (each[:, which] for each in (pieces._preimage, pieces._position, pieces._arc))
        self._per_m, self._length, self._starts = pieces._per_m[which], pieces._length[which], pieces._starts

    def _parameter(self, s_m: FloatArray) -> FloatArray:
        return _parameters(s_m, self._length, self._per_m, self._arc, lambda i: self._starts[self.which, i].T)

    def frames(self, s_m: FloatArray) -> tuple[Column, Column, Column]:
        """As the function of that name."""
        t = self._parameter(s_m)
        return (_points(self._position, t), *_bends(self._preimage, t))

    def points(self, s_m: FloatArray) -> Column:
        """The first of them."""
        return _points(self._position, self._parameter(s_m))


def _points(position: Any, t: FloatArray) -> Column:
    x, y, z = (_polynomial(position[k : k + 8], t) for k in (0, 8, 16))
    return x, y, z


def _bends(preimage: Any, t: FloatArray) -> tuple[Column, Column]:
    x0, x1, x2, x3, y0, y1, y2, y3, z0, z1, z2, z3, ex, ey, ez = preimage
    ax, ay, az = ((x3 * t + x2) * t + x1) * t + x0, ((y3 * t + y2) * t + y1) * t + y0, ((z3 * t + z2) * t + z1) * t + z0
    dx, dy, dz = (3.0 * x3 * t + 2.0 * x2) * t + x1, (3.0 * y3 * t + 2.0 * y2) * t + y1, (3.0 * z3 * t + 2.0 * z2) * t + z1
    sigma = ax * ax + ay * ay + az * az
    moving = sigma > LEAST_SIGMA
    if not moving.all():  # a cusp
        sigma = np.where(moving, sigma, 1.0)
    w = ax * ex + ay * ey + az * ez
    dw = dx * ex + dy * ey + dz * ez
    k = 2.0 * w / sigma
    f = 2.0 / (sigma * sigma)
    g = dw - 2.0 * w * (ax * dx + ay * dy + az * dz) / sigma
    tangent = k * ax - ex, k * ay - ey, k * az - ez
    bend = f * (w * dx + g * ax), f * (w * dy + g * ay), f * (w * dz + g * az)
    if not moving.all():
        (tx, ty, tz), (bx, by, bz) = tangent, bend
        tangent = np.where(moving, tx, ex), np.where(moving, ty, ey), np.where(moving, tz, ez)
        bend = np.where(moving, bx, 0.0), np.where(moving, by, 0.0), np.where(moving, bz, 0.0)
    return tangent, bend


def _parameters(s_m: FloatArray, length_m: Any, per_m: Any, arc: Any, starts: Any) -> FloatArray:
    """``starts``: from an interval of each row to the cubic in it and its ends (5,n)."""
    c1, c2, c3, c4, c5, c6, c7 = arc
    place = s_m * per_m
    on = (s_m > 0.0) & (s_m < length_m)
    i = np.where(on, np.minimum(place, TABLE - 1), 0.0).astype(np.intp)
    u = place - i
    low, k1, k2, k3, high = starts(i)
    t = np.minimum(np.maximum(((k3 * u + k2) * u + k1) * u + low, low), high)
    t = np.where(on, t, np.where(s_m > 0.0, 1.0, 0.0))
    settled = ~on
    for _ in range(60):
        ds = ((((((c7 * t + c6) * t + c5) * t + c4) * t + c3) * t + c2) * t + c1) * t - s_m
        above = ds > 0.0
        low, high = np.where(above, low, t), np.where(above, t, high)
        slope = (((((7.0 * c7 * t + 6.0 * c6) * t + 5.0 * c5) * t + 4.0 * c4) * t + 3.0 * c3) * t + 2.0 * c2) * t + c1
        rising = slope > 0.0
        new = np.where(rising, t - ds / np.where(rising, slope, 1.0), 0.5 * (low + high))
        new = np.where((low <= new) & (new <= high), new, 0.5 * (low + high))
        near = np.abs(new - t) < 3e-8
        t = np.where(settled, t, new)
        settled |= near
        if settled.all():
            break
    return t


def _polynomial(c: Any, t: FloatArray) -> FloatArray:
    value: FloatArray = ((((((c[7] * t + c[6]) * t + c[5]) * t + c[4]) * t + c[3]) * t + c[2]) * t + c[1]) * t + c[0]
    return value


def tangent(curve: Curve, s_m: float) -> Vec:
    """The second of ``Curve.frame`` for half its cost."""
    return tangents_of(curve)(s_m)


def tangents_of(curve: Curve) -> Callable[[float], Vec]:
    """The function of arc length that ``tangent`` is on this curve, for who asks it often: all that it needs is at hand."""
    x0, x1, x2, x3, y0, y1, y2, y3, z0, z1, z2, z3, ex, ey, ez = curve._kernel[0]
    (c1, c2, c3, c4, c5, c6, c7), (per_m, starts) = curve._arc_padded, curve._starts
    d2, d3, d4, d5, d6, d7 = 2.0 * c2, 3.0 * c3, 4.0 * c4, 5.0 * c5, 6.0 * c6, 7.0 * c7
    length, last = curve.length_m, TABLE - 1

    def at(s_m: float) -> Vec:
        if not 0.0 < s_m < length:
            t = curve.parameter(s_m)
        else:
            place = s_m * per_m
            i = int(place)
            i = i if i < last else last
            u = place - i
            low, k1, k2, k3, high = starts[i]
            t = ((k3 * u + k2) * u + k1) * u + low
            t = low if t < low else high if t > high else t
            ds = ((((((c7 * t + c6) * t + c5) * t + c4) * t + c3) * t + c2) * t + c1) * t - s_m
            slope = (((((d7 * t + d6) * t + d5) * t + d4) * t + d3) * t + d2) * t + c1
            new = t - ds / slope if slope > 0.0 else -1.0
            # the start is off by less than this nearly everywhere; elsewhere the search goes on
            t = new if -3e-8 < new - t < 3e-8 and low <= new <= high else curve.parameter(s_m)
        ax, ay, az = ((x3 * t + x2) * t + x1) * t + x0, ((y3 * t + y2) * t + y1) * t + y0, ((z3 * t + z2) * t + z1) * t + z0
        sigma = ax * ax + ay * ay + az * az
        if not sigma > 0.0:
            return ex, ey, ez
        k = 2.0 * (ax * ex + ay * ey + az * ez) / sigma
        return k * ax - ex, k * ay - ey, k * az - ez

    return at
