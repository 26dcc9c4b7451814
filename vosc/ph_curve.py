"""One spatial Pythagorean-hodograph quintic: evaluation by arc length, extremes, nearest points.

A canonical PH quintic needs no general quaternion: with its two free angles at zero the preimage is a pure vector a(t), and r'(t)
is the axis e turned half round a(t):

    r'(t) = 2 (a.e) a - |a|^2 e,    |r'(t)| = |a(t)|^2 = sigma(t),    a(t) = A0 (1-t)^2 + 2 A1 t (1-t) + A2 t^2

so the speed is a polynomial of degree 4 and the arc length one of degree 5, both exact (Farouki, al-Kandari, Sakkalis 2002). With h
= w a' - w' a, w = a.e, of degree 2, the curvature is 2 |h| / sigma^2.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vosc.polynomial import Poly, derivative, difference, extremum_candidates, horner, integral, nearest, product, total
from vosc.vec import FloatArray, Vec, array, dot

TABLE = 32  # intervals of the arc-length table that starts the inversion
SEARCH = 128  # intervals of the sampling that starts the projection
CUSP = 1e-12  # a least parameter speed below this fraction of the mean one counts as a cusp: infinite curvature

Frame = tuple[Vec, Vec, Vec]


@dataclass(frozen=True)
class Curve:
    """A canonical spatial PH quintic, evaluated by arc length ``s_m`` in [0, length_m]; beyond its ends it stays at the end.

    Made by ``ph.hermite``. Frame of the inputs, metres. The fields are the preimage: axis ``e`` (unit vector), ``a0 a1 a2`` (Bernstein
    coefficients, square root of metres), ``start_m``.
    """

    start_m: Vec
    e: Vec
    a0: Vec
    a1: Vec
    a2: Vec

    def __reduce__(self) -> tuple[type["Curve"], tuple[Vec, ...]]:
        return Curve, (self.start_m, self.e, self.a0, self.a1, self.a2)  # without what was cached: a used curve pickles like a fresh one

    # ---- polynomials in t, lowest power first ----------------------------

    @cached_property
    def _preimage(self) -> tuple[Poly, ...]:
        """x, y, z of a(t)."""
        return tuple((p, 2.0 * (q - p), p - 2.0 * q + r) for p, q, r in zip(self.a0, self.a1, self.a2, strict=True))

    @cached_property
    def _w(self) -> Poly:
        """a.e."""
        return tuple(dot((x, y, z), self.e) for x, y, z in zip(*self._preimage, strict=True))

    @cached_property
    def _sigma(self) -> Poly:
        """|a|^2, degree 4."""
        return total([product(x, x) for x in self._preimage])

    @cached_property
    def _arc(self) -> Poly:
        """Arc length from t = 0, degree 5."""
        return integral(self._sigma)

    @cached_property
    def _hodograph(self) -> tuple[Poly, ...]:
        """x, y, z of r', degree 4."""
        pairs = zip(self._preimage, self.e, strict=True)
        return tuple(tuple(2.0 * p - e * s for p, s in zip(product(self._w, x), self._sigma, strict=True)) for x, e in pairs)

    @cached_property
    def _position(self) -> tuple[Poly, ...]:
        """x, y, z of r, degree 5."""
        return tuple(integral(v, start) for start, v in zip(self.start_m, self._hodograph, strict=True))

    @cached_property
    def _bend(self) -> tuple[Poly, ...]:
        """x, y, z of h = w a' - w' a, degree 2 (the cubic terms cancel)."""
        w = self._w
        return tuple((w[0] * x[1] - w[1] * x[0], 2.0 * (w[0] * x[2] - w[2] * x[0]), w[1] * x[2] - w[2] * x[1]) for x in self._preimage)

    @cached_property
    def _kernel(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Everything the scalar kernel needs, flat: one attribute access a call."""
        (x, y, z), e = self._preimage, self.e
        return (*x, *y, *z, *e), tuple(c for p in self._position for c in p)

    @cached_property
    def _table(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """(s, t, dt/ds) at equidistant t: starts the inversion."""
        t = np.linspace(0.0, 1.0, TABLE + 1)
        return horner(self._arc, t), t, 1.0 / np.maximum(horner(self._sigma, t), 1e-9 * self.length_m)

    @cached_property
    def _starts(self) -> tuple[float, tuple[float, ...]]:
        """(1 / spacing, t at equidistant s): the scalar kernel's start of the inversion."""
        s = np.linspace(0.0, self.length_m, TABLE + 1)
        t = self._parameter(s)
        return TABLE / self.length_m, (*t.tolist(), 1.0)

    # ---- scalars ----------------------------

    @cached_property
    def length_m(self) -> float:
        """Arc length, exact: the integral of a polynomial."""
        a0, a1, a2 = self.a0, self.a1, self.a2
        return (dot(a0, a0) + dot(a0, a1) + (2.0 * dot(a1, a1) + dot(a0, a2)) / 3.0 + dot(a1, a2) + dot(a2, a2)) / 5.0

    @cached_property
    def min_speed(self) -> float:
        """Least parameter speed |dr/dt| over the mean one: near 0 the curve has a cusp, 1 is a straight line of even speed."""
        return float(horner(self._sigma, extremum_candidates(derivative(self._sigma))).min()) / self.length_m

    @cached_property
    def _max_curvature(self) -> float:
        if self.min_speed < CUSP:
            return math.inf
        rho = total([product(x, x) for x in self._bend])
        sigma = self._sigma
        rising = difference(product(derivative(rho), sigma), product(rho, tuple(4.0 * c for c in derivative(sigma))))
        t = extremum_candidates(rising)  # d(curvature^2)/dt = 0, degree 7
        return float((2.0 * np.sqrt(np.maximum(horner(rho, t), 0.0)) / horner(sigma, t) ** 2).max())

    def max_curvature(self) -> float:
        """Largest curvature, 1/m, exact (roots of a polynomial of degree 7); inf where the parameter speed vanishes."""
        return self._max_curvature

    @property
    def min_radius_m(self) -> float:
        """Least radius of curvature; inf on a straight line."""
        return 1.0 / self._max_curvature if self._max_curvature > 0.0 else math.inf

    def climb_range_rad(self) -> tuple[float, float]:
        """Least and largest climb angle of the tangent, rad, exact (roots of a polynomial)."""
        z, sigma = self._hodograph[2], self._sigma
        t = extremum_candidates(difference(product(derivative(z), sigma), product(z, derivative(sigma))))
        horizontal = np.hypot(horner(self._hodograph[0], t), horner(self._hodograph[1], t))
        climb = np.arctan2(horner(z, t), horizontal)
        return float(climb.min()), float(climb.max())

    # ---- one arc length ----------------------------

    def parameter(self, s_m: float) -> float:
        """Parameter t in [0, 1] at arc length ``s_m``, to 1e-12 of the length."""
        if not s_m > 0.0:
            return 0.0
        if s_m >= self.length_m:
            return 1.0
        per_m, starts = self._starts
        _, c1, c2, c3, c4, c5 = self._arc
        place = s_m * per_m
        i = int(place)
        low, high = starts[i], starts[i + 1]
        t = low + (place - i) * (high - low)
        for _ in range(60):
            ds = ((((c5 * t + c4) * t + c3) * t + c2) * t + c1) * t - s_m
            if ds > 0.0:
                high = t
            else:
                low = t
            slope = (((5.0 * c5 * t + 4.0 * c4) * t + 3.0 * c3) * t + 2.0 * c2) * t + c1
            new = t - ds / slope if slope > 0.0 else 0.5 * (low + high)
            if not low <= new <= high:
                new = 0.5 * (low + high)
            if abs(new - t) < 1e-9:  # Newton doubles the digits: the step after this one would be rounding
                return new
            t = new
        return t

    def frame(self, s_m: float) -> Frame:
        """Point (m), unit tangent and curvature vector (1/m, towards the centre of curvature) at arc length ``s_m``, as tuples of
        three floats.

        The scalar kernel: about 2 us once the curve is warm. At a cusp, where there is no tangent, the curvature vector is zero.
        """
        t = self.parameter(s_m)
        preimage, position = self._kernel
        x0, x1, x2, y0, y1, y2, z0, z1, z2, ex, ey, ez = preimage
        p0, p1, p2, p3, p4, p5, q0, q1, q2, q3, q4, q5, r0, r1, r2, r3, r4, r5 = position
        ax, ay, az = (x2 * t + x1) * t + x0, (y2 * t + y1) * t + y0, (z2 * t + z1) * t + z0
        dx, dy, dz = 2.0 * x2 * t + x1, 2.0 * y2 * t + y1, 2.0 * z2 * t + z1
        w = ax * ex + ay * ey + az * ez
        dw = dx * ex + dy * ey + dz * ez
        sigma = ax * ax + ay * ay + az * az
        point = (
            ((((p5 * t + p4) * t + p3) * t + p2) * t + p1) * t + p0,
            ((((q5 * t + q4) * t + q3) * t + q2) * t + q1) * t + q0,
            ((((r5 * t + r4) * t + r3) * t + r2) * t + r1) * t + r0,
        )
        if not sigma > 0.0:
            return point, self.e, (0.0, 0.0, 0.0)
        k = 2.0 * w / sigma
        tangent = (k * ax - ex, k * ay - ey, k * az - ez)
        # dT/dt = 2 (w a' + w' a) / sigma - 4 w (a.a') a / sigma^2; the arc length adds one more 1/sigma
        f = 2.0 / (sigma * sigma)
        g = dw - 2.0 * w * (ax * dx + ay * dy + az * dz) / sigma
        return point, tangent, (f * (w * dx + g * ax), f * (w * dy + g * ay), f * (w * dz + g * az))

    def point(self, s_m: float) -> FloatArray:
        """(3,) position at arc length ``s_m``, m."""
        return array(self.frame(s_m)[0])

    def tangent(self, s_m: float) -> FloatArray:
        """(3,) unit tangent at arc length ``s_m``."""
        return array(self.frame(s_m)[1])

    def curvature(self, s_m: float) -> float:
        """Curvature at arc length ``s_m``, 1/m, never negative."""
        k = self.frame(s_m)[2]
        return math.hypot(k[0], k[1], k[2])

    # ---- many at once ----------------------------

    def _parameter(self, s: FloatArray) -> FloatArray:
        """Parameters t (n,) at arc lengths s (n,): cubic start from the table, then Newton inside the table's interval."""
        nodes, ts, slopes = self._table
        s = np.clip(s, 0.0, self.length_m)
        i = np.clip(np.searchsorted(nodes, s, side="right") - 1, 0, TABLE - 1)
        low, high, ds = ts[i], ts[i + 1], nodes[i + 1] - nodes[i]
        u = np.clip((s - nodes[i]) / np.where(ds > 0.0, ds, 1.0), 0.0, 1.0)
        v = 1.0 - u
        t = low * v * v * (1.0 + 2.0 * u) + high * u * u * (3.0 - 2.0 * u) + ds * u * v * (slopes[i] * v - slopes[i + 1] * u)
        t = np.clip(t, low, high)
        for _ in range(60):
            error = horner(self._arc, t) - s
            low, high = np.where(error > 0.0, low, t), np.where(error > 0.0, t, high)
            slope = horner(self._sigma, t)
            new = t - error / np.where(slope > 0.0, slope, math.inf)
            new = np.where((new < low) | (new > high) | (slope <= 0.0), 0.5 * (low + high), new)
            done = bool((np.abs(new - t) < 1e-9).all())
            t = new
            if done:
                break
        return t

    def _points(self, t: FloatArray) -> FloatArray:
        return np.stack([horner(p, t) for p in self._position], axis=-1)

    def sample(self, s_m: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Points (n,3) m, unit tangents (n,3), curvature vectors (n,3) 1/m at arc lengths (n,); what ``frame`` gives, vectorised."""
        t = self._parameter(np.asarray(s_m, dtype=np.float64))
        a = np.stack([horner(x, t) for x in self._preimage], axis=-1)
        da = np.stack([horner(derivative(x), t) for x in self._preimage], axis=-1)
        e = np.array(self.e)
        w, dw, sigma, rate = a @ e, da @ e, (a * a).sum(axis=-1), (a * da).sum(axis=-1)
        moving = sigma > 0.0
        sigma = np.where(moving, sigma, 1.0)
        tangents = np.where(moving[:, None], (2.0 * w / sigma)[:, None] * a - e, e)
        bends = (2.0 / sigma**2)[:, None] * (w[:, None] * da + (dw - 2.0 * w * rate / sigma)[:, None] * a)
        return self._points(t), tangents, np.where(moving[:, None], bends, 0.0)

    def nearest(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Arc lengths (m,) of the points of the curve nearest to ``points`` (m,3), and the distances (m,), m; the exact projection
        in space.

        Where the nearest point is an end, the arc length is 0 or ``length_m``. ``ValueError`` if ``points`` is not a finite (m,3).
        """
        points = np.asarray(points, dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
            raise ValueError(f"points: give a finite array of shape (m, 3), got shape {points.shape}")
        t = nearest(self._position, points, SEARCH)
        return horner(self._arc, t), np.linalg.norm(self._points(t) - points, axis=1)
