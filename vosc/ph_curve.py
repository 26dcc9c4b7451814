"""One spatial Pythagorean-hodograph curve: evaluation by arc length, extremes, nearest points.

Here the preimage is a pure vector a(t), and r'(t) is the axis e turned half round a(t); a general quaternion is not needed:

    r'(t) = 2 (a.e) a - |a|^2 e,    |r'(t)| = |a(t)|^2 = sigma(t),    a(t) in Bernstein form

so speed and arc length are polynomials and exact (Farouki, al-Kandari, Sakkalis 2002). With h = w a' - w' a, w = a.e, the curvature is
2 |h| / sigma^2. Quintics have a quadratic preimage; septics, whose start curvature can be given, a cubic one.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from vosc.errors import NoCurve, NotNumbers
from vosc.polynomial import Poly, derivative, difference, extremum_candidates, horner, integral, nearest, product, total
from vosc.vec import LARGEST, FloatArray, Vec, array, combine, dot, scale, three

TABLE = 32  # intervals of the arc-length table that starts the inversion
SEARCH = 128  # intervals of the sampling that starts the projection
SMALLEST_ROOT = 1e-25  # square root of metres: the fourth powers of a shorter curve's coefficients are lost
CUSP = 1e-12  # a least parameter speed below this fraction of the mean one counts as a cusp: infinite curvature
STILL = 1e-150  # parameter speed whose square could be lost: no speed, a cusp

Frame = tuple[Vec, Vec, Vec]


@dataclass(frozen=True)
class Curve:
    """A spatial PH curve, evaluated by arc length ``s_m`` in [0, length_m]; beyond its ends it stays at the end.

    Made by ``ph.hermite`` (the canonical quintic) and ``ph.flyable``. Frame of the inputs, metres. The fields are the preimage:
    axis ``e`` (unit vector), ``a`` its three (quintic) or four (septic) Bernstein coefficients, square root of metres, and
    ``start_m``.
    """

    start_m: Vec
    e: Vec
    a: tuple[Vec, ...]

    def __post_init__(self) -> None:
        if len(self.a) not in (3, 4):
            raise NotNumbers(f"Curve.a: give three or four coefficients, got {len(self.a)}")
        object.__setattr__(self, "start_m", three("Curve.start_m", self.start_m))
        object.__setattr__(self, "e", three("Curve.e", self.e))
        object.__setattr__(self, "a", tuple(three("Curve.a", p) for p in self.a))
        if not any(abs(x) > SMALLEST_ROOT for p in self.a for x in p):
            raise NoCurve("Curve: all coefficients are zero, or as good as: a curve without length")

    def __reduce__(self) -> tuple[type["Curve"], tuple[Vec, Vec, tuple[Vec, ...]]]:
        return Curve, (self.start_m, self.e, self.a)  # without what was cached: a used curve pickles like a fresh one

    # ---- polynomials in t, lowest power first ----------------------------

    @cached_property
    def _preimage(self) -> tuple[Poly, ...]:
        """x, y, z of a(t)."""
        if len(self.a) == 3:
            return tuple((p, 2.0 * (q - p), p - 2.0 * q + r) for p, q, r in zip(*self.a, strict=True))
        return tuple((p, 3.0 * (q - p), 3.0 * (p - 2.0 * q + r), s - p + 3.0 * (q - r)) for p, q, r, s in zip(*self.a, strict=True))

    @cached_property
    def _w(self) -> Poly:
        """a.e."""
        return tuple(dot((x, y, z), self.e) for x, y, z in zip(*self._preimage, strict=True))

    @cached_property
    def _sigma(self) -> Poly:
        """|a|^2, of degree 4 (quintic) or 6 (septic)."""
        return total([product(x, x) for x in self._preimage])

    @cached_property
    def _arc(self) -> Poly:
        """Arc length from t = 0."""
        return integral(self._sigma)

    @cached_property
    def _hodograph(self) -> tuple[Poly, ...]:
        """x, y, z of r'."""
        pairs = zip(self._preimage, self.e, strict=True)
        return tuple(tuple(2.0 * p - e * s for p, s in zip(product(self._w, x), self._sigma, strict=True)) for x, e in pairs)

    @cached_property
    def _position(self) -> tuple[Poly, ...]:
        """x, y, z of r."""
        return tuple(integral(v, start) for start, v in zip(self.start_m, self._hodograph, strict=True))

    @cached_property
    def _bend(self) -> tuple[Poly, ...]:
        """x, y, z of h = w a' - w' a, without the highest power, which cancels."""
        w = self._w
        return tuple(difference(product(w, derivative(x)), product(derivative(w), x))[:-1] for x in self._preimage)

    @cached_property
    def _kernel(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Everything the scalar kernel needs, flat: one attribute access a call."""
        cubic = (c for p in self._preimage for c in (*p, 0.0, 0.0)[:4])
        return (*cubic, *self.e), tuple(c for p in self._position for c in (*p, 0.0, 0.0)[:8])

    @cached_property
    def _arc_padded(self) -> Poly:
        """The arc length's coefficients from the first power to the seventh."""
        return (*self._arc[1:], 0.0, 0.0)[:7]

    @cached_property
    def _table(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """(s, t, dt/ds) at equidistant t: starts the inversion."""
        t = np.linspace(0.0, 1.0, TABLE + 1)
        return horner(self._arc, t), t, 1.0 / np.maximum(horner(self._sigma, t), 1e-9 * self.length_m)

    @cached_property
    def _starts(self) -> tuple[float, tuple[tuple[float, ...], ...]]:
        """(1 / spacing, cubics t(u) between equidistant s, u in [0, 1], and their ends): the scalar kernel's start of the inversion."""
        s = np.linspace(0.0, self.length_m, TABLE + 1)
        t = self._parameter(s)
        slope = s[1] / np.maximum(horner(self._sigma, t), 1e-9 * self.length_m)
        low, high, left, right = t[:-1], t[1:], slope[:-1], slope[1:]
        rise = high - low
        rows = np.stack([low, left, 3.0 * rise - 2.0 * left - right, left + right - 2.0 * rise, high], axis=1)
        return TABLE / self.length_m, tuple(map(tuple, rows.tolist()))

    # ---- scalars ----------------------------

    @cached_property
    def length_m(self) -> float:
        """Arc length, exact: the integral of a polynomial."""
        return math.fsum(self._arc)

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
        t = extremum_candidates(rising)  # d(curvature^2)/dt = 0
        return float((2.0 * np.sqrt(np.maximum(horner(rho, t), 0.0)) / horner(sigma, t) ** 2).max())

    def max_curvature(self) -> float:
        """Largest curvature, 1/m, exact (roots of a polynomial); inf where the parameter speed vanishes."""
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
        s_m = float(s_m)  # a numpy scalar would make every sum below ten times slower
        if not s_m > 0.0:
            return 0.0
        if s_m >= self.length_m:
            return 1.0
        per_m, starts = self._starts
        c1, c2, c3, c4, c5, c6, c7 = self._arc_padded
        place = s_m * per_m
        i = min(int(place), TABLE - 1)
        u = place - i
        low, k1, k2, k3, high = starts[i]
        t = min(max(((k3 * u + k2) * u + k1) * u + low, low), high)
        for _ in range(60):
            ds = ((((((c7 * t + c6) * t + c5) * t + c4) * t + c3) * t + c2) * t + c1) * t - s_m
            if ds > 0.0:
                high = t
            else:
                low = t
            slope = (((((7.0 * c7 * t + 6.0 * c6) * t + 5.0 * c5) * t + 4.0 * c4) * t + 3.0 * c3) * t + 2.0 * c2) * t + c1
            new = t - ds / slope if slope > 0.0 else 0.5 * (low + high)
            if not low <= new <= high:
                new = 0.5 * (low + high)
            if abs(new - t) < 3e-8:  # Newton doubles the digits: the step after this one would be rounding
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
        x0, x1, x2, x3, y0, y1, y2, y3, z0, z1, z2, z3, ex, ey, ez = preimage
        p0, p1, p2, p3, p4, p5, p6, p7, q0, q1, q2, q3, q4, q5, q6, q7, r0, r1, r2, r3, r4, r5, r6, r7 = position
        ax, ay, az = ((x3 * t + x2) * t + x1) * t + x0, ((y3 * t + y2) * t + y1) * t + y0, ((z3 * t + z2) * t + z1) * t + z0
        dx, dy, dz = (3.0 * x3 * t + 2.0 * x2) * t + x1, (3.0 * y3 * t + 2.0 * y2) * t + y1, (3.0 * z3 * t + 2.0 * z2) * t + z1
        w = ax * ex + ay * ey + az * ez
        dw = dx * ex + dy * ey + dz * ez
        sigma = ax * ax + ay * ay + az * az
        point = (
            (((((((p7 * t + p6) * t + p5) * t + p4) * t + p3) * t + p2) * t + p1) * t + p0),
            (((((((q7 * t + q6) * t + q5) * t + q4) * t + q3) * t + q2) * t + q1) * t + q0),
            (((((((r7 * t + r6) * t + r5) * t + r4) * t + r3) * t + r2) * t + r1) * t + r0),
        )
        if not sigma > STILL:
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

    def tail(self, s_m: float) -> "Curve":
        """The same curve from arc length ``s_m`` (0 <= s_m < length_m) on: its preimage subdivided (de Casteljau)."""
        t = self.parameter(s_m)
        row, last = list(self.a), []
        while row:
            last.append(row[-1])
            row = [combine(1.0 - t, p, t, q) for p, q in pairwise(row)]
        # on the rest of the interval dr/du = (1 - t) dr/dt, so the preimage shrinks by the root
        return Curve(self.frame(s_m)[0], self.e, tuple(scale(math.sqrt(1.0 - t), a) for a in reversed(last)))

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
            done = bool((np.abs(new - t) < 3e-8).all())
            t = new
            if done:
                break
        return t

    def _points(self, t: FloatArray) -> FloatArray:
        return np.stack([horner(p, t) for p in self._position], axis=-1)

    def points(self, s_m: FloatArray) -> FloatArray:
        """Points (n,3) m at arc lengths (n,): the first of ``sample``, for half its cost."""
        return self._points(self._parameter(np.asarray(s_m, dtype=np.float64)))

    def sample(self, s_m: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Points (n,3) m, unit tangents (n,3), curvature vectors (n,3) 1/m at arc lengths (n,); what ``frame`` gives, vectorised."""
        t = self._parameter(np.asarray(s_m, dtype=np.float64))
        a = np.stack([horner(x, t) for x in self._preimage], axis=-1)
        da = np.stack([horner(derivative(x), t) for x in self._preimage], axis=-1)
        e = np.array(self.e)
        w, dw, sigma, rate = a @ e, da @ e, (a * a).sum(axis=-1), (a * da).sum(axis=-1)
        moving = sigma > STILL
        sigma = np.where(moving, sigma, 1.0)
        tangents = np.where(moving[:, None], (2.0 * w / sigma)[:, None] * a - e, e)
        bends = (2.0 / sigma**2)[:, None] * (w[:, None] * da + (dw - 2.0 * w * rate / sigma)[:, None] * a)
        return self._points(t), tangents, np.where(moving[:, None], bends, 0.0)

    def tangents(self, s_m: FloatArray) -> FloatArray:
        """Unit tangents (n,3) at arc lengths (n,): the second of ``sample``, for half its cost."""
        t = self._parameter(np.asarray(s_m, dtype=np.float64))
        a, e = np.stack([horner(x, t) for x in self._preimage], axis=-1), np.array(self.e)
        w, sigma = a @ e, (a * a).sum(axis=-1)
        moving = sigma > 0.0
        return np.where(moving[:, None], (2.0 * w / np.where(moving, sigma, 1.0))[:, None] * a - e, e)

    def nearest(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Arc lengths (m,) of the points of the curve nearest to ``points`` (m,3), and the distances (m,), m; the exact projection
        in space.

        Where the nearest point is an end, the arc length is 0 or ``length_m``. ``NotNumbers`` if ``points`` is no (m,3) of such numbers.
        """
        points = np.asarray(points, dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != 3 or not (np.abs(points) <= LARGEST).all():
            raise NotNumbers(f"points: give an array of shape (m, 3), finite and below {LARGEST:g} in size, got shape {points.shape}")
        t = nearest(self._position, points, SEARCH)
        return horner(self._arc, t), np.linalg.norm(self._points(t) - points, axis=1)
