"""Two equal arcs in one plane: what the helicoidal arc becomes when both directions lie in one plane with the chord. Closed form.

With n the left normal in that plane, the centres are P + e R n_0 and Q - e R n_1 (e = +1: left, then right), 2 R apart:

    |D|^2 - 2 e R D.(n_0 + n_1) + R^2 (|n_0 + n_1|^2 - 4) = 0,      D = Q - P.

For parallel directions and an offset (dx, dy) that is R = (dx^2 + dy^2) / (4 |dy|). One circle, where it fits, is two arcs of it.
"""

import math

import numpy as np

from vosc.arc_line_arc import ArcLineArc
from vosc.vec import SMALLEST_SINE, Vec, add, along, angle, combine, cross, dot, norm, scale, sub, unit

IN_PLANE = 1e-9  # angle (rad) between the planes of the chord and either direction
_ROUNDING = 1e-9


def plane_arcs(offset_m: Vec, t0: Vec, t1: Vec) -> ArcLineArc | None:
    """The widest S of two equal arcs, or the one circle, from the origin in unit direction ``t0`` to ``offset_m`` in ``t1``.

    ``None`` when the three do not lie in one plane (or in a line), and when an arc would turn by pi or more.
    """
    chord, distance = unit(offset_m), norm(offset_m)
    first, second = cross(chord, t0), cross(chord, t1)
    across = max(first, second, key=norm)
    if norm(across) < SMALLEST_SINE or norm(cross(first, second)) > IN_PLANE * norm(first) * norm(second) + 1e-15 * norm(across):
        return None
    axis = unit(across)
    circle = _circle(offset_m, t0, t1)
    found = [circle] if circle is not None else []
    n0, n1 = cross(axis, t0), cross(axis, t1)
    both = add(n0, n1)
    for side in (1.0, -1.0):
        half, square = side * dot(offset_m, both), 4.0 - dot(both, both)
        # square R^2 + 2 half R - |D|^2 = 0 has one positive root; written so that nothing cancels when square is nearly zero
        below = half + math.sqrt(half * half + square * distance * distance)
        if below <= 0.0:
            continue
        radius = distance * distance / below
        between = sub(along(offset_m, -side * radius, n1), scale(side * radius, n0))  # of the centres
        u = scale(-side, cross(unit(between), axis))
        arcs = ArcLineArc(radius, radius, radius, angle(t0, u), angle(u, t1), 0.0, u)
        if _meets(arcs, offset_m, t0, t1):
            found.append(arcs)
    return max(found, key=lambda arcs: arcs.radius_m, default=None)


def _meets(arcs: ArcLineArc, offset: Vec, t0: Vec, t1: Vec) -> bool:
    """Whether arcs that turn by the angles of the directions, and not the long way round, end where they should."""
    if max(arcs.turn_in_rad, arcs.turn_out_rad) > math.pi - _ROUNDING:
        return False
    d0, d1 = (arcs.radius_m * math.tan(0.5 * turn) for turn in (arcs.turn_in_rad, arcs.turn_out_rad))
    there = add(combine(d0, t0, d1, t1), scale(d0 + d1, arcs.line_direction))
    return norm(sub(there, offset)) < 1e-7 * norm(offset)


def _circle(offset: Vec, t0: Vec, t1: Vec) -> ArcLineArc | None:
    """One circle through both poses: the end direction is the start's, mirrored in the chord."""
    chord = unit(offset)
    if not np.allclose(along(scale(2.0 * dot(chord, t0), chord), -1.0, t0), t1, rtol=0.0, atol=_ROUNDING):
        return None
    half = angle(chord, t0)
    radius = 0.5 * norm(offset) / math.sin(half) if half > 0.0 else math.inf
    return ArcLineArc(radius, radius, radius, half, half, 0.0, chord) if 0.0 < half < math.pi - _ROUNDING else None
