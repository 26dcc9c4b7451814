"""What ``Curve.frame`` gives, to the last bit, in columns: the arithmetic of the scalar kernel in the same order, on arrays.

``Curve.sample`` is as exact but rounds otherwise. Who steps along a curve one place at a time, and would like to look up many places at
once without his flight changing in the last digit, asks here.
"""

import numpy as np

from vosc.ph_curve import TABLE, Curve
from vosc.vec import FloatArray

Column = tuple[FloatArray, FloatArray, FloatArray]
LEAST_SIGMA = 1e-150  # squares of less are no numbers to divide by


def frames(curve: Curve, s_m: FloatArray) -> tuple[Column, Column, Column]:
    """Points (m), unit tangents and curvature vectors (1/m) at arc lengths (n,), each as its x, y and z (n,)."""
    s_m = np.asarray(s_m, dtype=np.float64)
    t = parameters(curve, s_m)
    preimage, position = curve._kernel
    x0, x1, x2, x3, y0, y1, y2, y3, z0, z1, z2, z3, ex, ey, ez = preimage
    p, q, r = position[:8], position[8:16], position[16:]
    ax, ay, az = ((x3 * t + x2) * t + x1) * t + x0, ((y3 * t + y2) * t + y1) * t + y0, ((z3 * t + z2) * t + z1) * t + z0
    sigma = ax * ax + ay * ay + az * az
    if not (sigma > LEAST_SIGMA).all():  # a cusp
        points, tangents, bends = zip(*(curve.frame(s) for s in s_m.tolist()), strict=True)
        return _columns(points), _columns(tangents), _columns(bends)
    dx, dy, dz = (3.0 * x3 * t + 2.0 * x2) * t + x1, (3.0 * y3 * t + 2.0 * y2) * t + y1, (3.0 * z3 * t + 2.0 * z2) * t + z1
    w = ax * ex + ay * ey + az * ez
    dw = dx * ex + dy * ey + dz * ez
    k = 2.0 * w / sigma
    f = 2.0 / (sigma * sigma)
    g = dw - 2.0 * w * (ax * dx + ay * dy + az * dz) / sigma
    point = _polynomial(p, t), _polynomial(q, t), _polynomial(r, t)
    return point, (k * ax - ex, k * ay - ey, k * az - ez), (f * (w * dx + g * ax), f * (w * dy + g * ay), f * (w * dz + g * az))


def parameters(curve: Curve, s_m: FloatArray) -> FloatArray:
    """``Curve.parameter`` at arc lengths (n,)."""
    per_m, starts = curve._starts
    c = (0.0, *curve._arc_padded)
    place = s_m * per_m
    on = (s_m > 0.0) & (s_m < curve.length_m)
    i = np.where(on, np.minimum(place, TABLE - 1), 0.0).astype(np.intp)
    u = place - i
    low, k1, k2, k3, high = np.array(starts).T[:, i]
    t = np.minimum(np.maximum(((k3 * u + k2) * u + k1) * u + low, low), high)
    t = np.where(on, t, np.where(s_m > 0.0, 1.0, 0.0))
    settled = ~on
    for _ in range(60):
        ds = ((((((c[7] * t + c[6]) * t + c[5]) * t + c[4]) * t + c[3]) * t + c[2]) * t + c[1]) * t - s_m
        above = ds > 0.0
        low, high = np.where(above, low, t), np.where(above, t, high)
        slope = (((((7.0 * c[7] * t + 6.0 * c[6]) * t + 5.0 * c[5]) * t + 4.0 * c[4]) * t + 3.0 * c[3]) * t + 2.0 * c[2]) * t + c[1]
        rising = slope > 0.0
        new = np.where(rising, t - ds / np.where(rising, slope, 1.0), 0.5 * (low + high))
        new = np.where((low <= new) & (new <= high), new, 0.5 * (low + high))
        near = np.abs(new - t) < 3e-8
        t = np.where(settled, t, new)
        settled |= near
        if settled.all():
            break
    return t


def _polynomial(c: tuple[float, ...], t: FloatArray) -> FloatArray:
    value: FloatArray = ((((((c[7] * t + c[6]) * t + c[5]) * t + c[4]) * t + c[3]) * t + c[2]) * t + c[1]) * t + c[0]
    return value


def _columns(rows: "tuple[tuple[float, float, float], ...]") -> Column:
    x, y, z = np.array(rows, dtype=np.float64).T
    return x, y, z


def tangent(curve: Curve, s_m: float) -> tuple[float, float, float]:
    """The second of ``Curve.frame`` for half its cost."""
    t = curve.parameter(s_m)
    x0, x1, x2, x3, y0, y1, y2, y3, z0, z1, z2, z3, ex, ey, ez = curve._kernel[0]
    ax, ay, az = ((x3 * t + x2) * t + x1) * t + x0, ((y3 * t + y2) * t + y1) * t + y0, ((z3 * t + z2) * t + z1) * t + z0
    sigma = ax * ax + ay * ay + az * az
    if not sigma > 0.0:
        return curve.e
    k = 2.0 * (ax * ex + ay * ey + az * ez) / sigma
    return k * ax - ex, k * ay - ey, k * az - ez
