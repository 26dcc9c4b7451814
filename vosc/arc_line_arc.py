"""The widest arc, line, arc between two poses: a curve that anyone can check with a pair of compasses.

With u the direction of the line and d_0 = R_0 tan(theta_0 / 2) the tangent length of the first arc, which turns from t_0 to u by
theta_0 < pi (likewise d_1, from u to t_1), and l >= 0 the line's length,

    Q - P = d_0 t_0 + (d_0 + l + d_1) u + d_1 t_1.

So d_0 and d_1 are free where l >= 0, and u follows from them. The greatest smaller radius is found on a grid that closes in.
"""

import math
from dataclasses import dataclass

import numpy as np

from vosc.vec import FloatArray, Vec, along, cross, dot, norm, perpendicular, unit

_GRID = np.linspace(-1.0, 1.0, 41)
_ZOOMS = 24


@dataclass(frozen=True)
class ArcLineArc:
    """``radius_m`` is the smaller of the two radii, which may differ; angles in [0, pi)."""

    radius_m: float
    radius_in_m: float
    radius_out_m: float
    turn_in_rad: float
    turn_out_rad: float
    line_m: float
    line_direction: Vec

    @property
    def turn_rad(self) -> float:
        return self.turn_in_rad + self.turn_out_rad

    @property
    def lengths_m(self) -> Vec:
        """Of the arc, the line and the arc."""
        first, last = (r * a if a > 0.0 else 0.0 for r, a in ((self.radius_in_m, self.turn_in_rad), (self.radius_out_m, self.turn_out_rad)))
        return first, self.line_m, last


def _tangent_half(cosine: FloatArray) -> FloatArray:
    return np.sqrt(np.maximum(1.0 - cosine, 0.0) / np.maximum(1.0 + cosine, 1e-300))


def arc_line_arc(offset_m: Vec, t0: Vec, t1: Vec) -> ArcLineArc | None:
    """The widest one from the origin in unit direction ``t0`` to ``offset_m`` in ``t1``; ``None`` if there is none."""
    size = norm(offset_m)
    chord, start, end = np.array(offset_m) / size, np.array(t0), np.array(t1)
    centre, half, best = np.array([0.5, 0.5]), 0.5, -1.0
    for _ in range(_ZOOMS):
        shares = np.clip(centre[:, None] + half * _GRID, 1e-6, 1.0 - 1e-6)  # d / (d + |Q - P|)
        d0, d1 = (shares[0] / (1.0 - shares[0]))[:, None], (shares[1] / (1.0 - shares[1]))[None, :]
        left = chord - d0[:, :, None] * start - d1[:, :, None] * end
        length = np.sqrt((left * left).sum(axis=2))
        u = left / np.maximum(length, 1e-300)[:, :, None]
        r0, r1 = d0 / np.maximum(_tangent_half(u @ start), 1e-12), d1 / np.maximum(_tangent_half(u @ end), 1e-12)
        value = np.where(length >= d0 + d1, np.minimum(r0, r1), -1.0)
        i, j = np.unravel_index(int(value.argmax()), value.shape)
        if value[i, j] > best:
            best, centre = float(value[i, j]), np.array([shares[0, i], shares[1, j]])
        half *= 0.5
    return _built(offset_m, t0, t1, centre) if best > 1e-5 else None


def _built(offset: Vec, t0: Vec, t1: Vec, shares: FloatArray) -> ArcLineArc:
    d0, d1 = (norm(offset) * shares / (1.0 - shares)).tolist()
    left = along(along(offset, -d0, t0), -d1, t1)
    u = unit(left)
    half0, half1 = (0.5 * math.atan2(norm(cross(t, u)), dot(t, u)) for t in (t0, t1))
    r0, r1 = (d / math.tan(h) if h > 0.0 else math.inf for d, h in ((d0, half0), (d1, half1)))
    return ArcLineArc(min(r0, r1), r0, r1, 2.0 * half0, 2.0 * half1, max(norm(left) - d0 - d1, 0.0), u)


def arc_line_arc_frames(curve: ArcLineArc, p0: Vec, t0: Vec, t1: Vec, n: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points (m), unit tangents and curvature vectors (1/m), (n,3) each, evenly spaced along the curve."""
    u = curve.line_direction
    lengths = curve.lengths_m
    bends = [(t0, perpendicular(t0, u), curve.radius_in_m), (u, (0.0, 0.0, 0.0), math.inf), (u, perpendicular(u, t1), curve.radius_out_m)]
    s = np.linspace(0.0, sum(lengths), n)
    places, tangents, curvatures = (np.empty((n, 3)) for _ in range(3))
    here, begin = np.array(p0), 0.0
    for (tangent, normal, radius), length in zip(bends, lengths, strict=True):
        mine = s >= begin - 1e-12
        t, m, along_m = np.array(tangent), np.array(normal), s[mine] - begin
        places[mine], tangents[mine], curvatures[mine] = _arc(here, t, m, radius, along_m)
        here, begin = _arc(here, t, m, radius, np.array([length]))[0][0], begin + length
    return places, tangents, curvatures


def _arc(here: FloatArray, t: FloatArray, m: FloatArray, radius: float, s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    if not math.isfinite(radius):
        return here + s[:, None] * t, np.broadcast_to(t, (len(s), 3)), np.zeros((len(s), 3))
    c, d = np.cos(s / radius)[:, None], np.sin(s / radius)[:, None]
    return here + radius * (d * t + (1.0 - c) * m), c * t + d * m, (c * m - d * t) / radius
