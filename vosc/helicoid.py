"""Helicoidal arcs: the space curves of constant curvature 1 that no other curve between the same poses bends less than.

They are the extremals of "the least greatest curvature" (Pontryagin). Minimise kappa in t' = kappa w, x' = t, |w| <= 1, with
free length: the costates p (constant, here of length 1 and along -z) and q (perpendicular to t) give w = q / |q| and p.t + kappa |q| = 0.
With kappa = 1 and f = |q| = -p.t this leaves curvature 1 everywhere, no straight part, and

    f^2 = y(s) = cos^2(beta) cos^2(s) + sin^2(beta) sin^2(s),      torsion = sin(beta) cos(beta) / y,

in cylinder coordinates, with k = tan(beta) and the elliptic integrals F, E, Pi of m = 1 - k^2, n = 1 - k^4,

    r = cos^2(beta) sqrt(cos^2 s + k^4 sin^2 s),    z = cos(beta) E(s),    theta = k (cos(beta) F(s) + k sin(beta) Pi(s)).

beta = pi / 4 is the helix of 45 degrees. As beta goes to 0 the curve becomes circles in one plane with centres on the z axis, which
meet where s = pi / 2 (mod pi) and there bend the other way: two arcs make the plane S.

Sources: H. J. Sussmann, Shortest 3-dimensional paths with a prescribed curvature bound, Proc. 34th CDC (1995), whose helicoidal arcs
obey the same torsion equation with one more constant for the cost of length (0 here); L. E. Dubins (1957) in the plane. Integrals:
B. C. Carlson, Numerical computation of real or complex elliptic integrals (1995).
"""

import numpy as np

from vosc.vec import FloatArray

_ROUNDS = 16  # of duplication, each of which divides the spread of the arguments by four; the error is of its square


def elliptic(s: FloatArray, k: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """F, E and Pi of amplitude ``s`` (rad, any), m = 1 - k^2 and, for Pi, n = 1 - k^4; k > 0."""
    whole = np.round(s / np.pi)
    rest = s - whole * np.pi
    part, full = _incomplete(np.sin(rest), np.cos(rest), k), _incomplete(np.ones_like(k), np.zeros_like(k), k)
    return part[0] + 2.0 * whole * full[0], part[1] + 2.0 * whole * full[1], part[2] + 2.0 * whole * full[2]


def _incomplete(sine: FloatArray, cosine: FloatArray, k: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The three integrals for an amplitude in [-pi/2, pi/2] (DLMF 19.25.5, 19.25.9, 19.25.14)."""
    c2, s2 = cosine * cosine, sine * sine
    rf, rd, rj = _carlson(c2, c2 + k * k * s2, c2 + k**4 * s2)
    first = sine * rf
    return first, first - (1.0 - k * k) * s2 * sine * rd / 3.0, first + (1.0 - k**4) * s2 * sine * rj / 3.0


def _carlson(x: FloatArray, y: FloatArray, p: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """R_F(x, y, 1), R_D(x, y, 1) and R_J(x, y, 1, p) by duplication; (p - x)(p - y)(p - 1) must not be negative."""
    z = np.ones_like(x)
    tail = (p - x) * (p - y) * (p - z)
    sum_d, sum_j, power = np.zeros_like(x), np.zeros_like(x), 1.0
    for _ in range(_ROUNDS):
        rx, ry, rz, rp = np.sqrt(x), np.sqrt(y), np.sqrt(z), np.sqrt(p)
        shift = rx * ry + ry * rz + rz * rx
        d = (rp + rx) * (rp + ry) * (rp + rz)
        e = np.sqrt(np.maximum(tail, 0.0)) * power * np.sqrt(power) / d
        sum_d += power / (rz * (z + shift))
        sum_j += power / d * np.where(e < 1e-8, 1.0, np.arctan(e) / np.maximum(e, 1e-300))
        x, y, z, p = 0.25 * (x + shift), 0.25 * (y + shift), 0.25 * (z + shift), 0.25 * (p + shift)
        power *= 0.25
    mean_f, mean_d, mean_j = (x + y + z) / 3.0, (x + y + 3.0 * z) / 5.0, (x + y + z + 2.0 * p) / 5.0
    return 1.0 / np.sqrt(mean_f), 3.0 * sum_d + power * mean_d**-1.5, 6.0 * sum_j + power * mean_j**-1.5


def helicoid(beta: FloatArray, s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points (n,3), unit tangents (n,3) and curvature vectors (n,3, unit) at arc lengths s (n,) of the curves of parameters beta (n,).

    beta in (-pi/2, pi/2), not 0: positive ones are right-handed, negative ones left-handed.
    """
    k, hand = np.abs(np.tan(beta)), np.sign(beta)
    sb, cb = np.abs(np.sin(beta)), np.cos(beta)
    first, second, third = elliptic(s, k)
    sine, cosine = np.sin(s), np.cos(s)
    y = cb * cb * cosine * cosine + sb * sb * sine * sine
    r = np.sqrt(cb**4 * cosine * cosine + sb**4 * sine * sine)
    turn = hand * k / cb * (cb * cb * first + sb * sb * third)
    f, half_rate = np.sqrt(y), (sb * sb - cb * cb) * sine * cosine  # y' / 2
    out, around = half_rate / r, hand * sb * cb * f / r  # speeds away from the axis and about it
    ct, st = np.cos(turn), np.sin(turn)
    place = np.stack([r * ct, r * st, cb * second], axis=-1)
    tangent = np.stack([out * ct - around * st, out * st + around * ct, f], axis=-1)
    bend = half_rate / y  # f' / f
    normal = np.stack([bend * tangent[:, 0] - place[:, 0] / y, bend * tangent[:, 1] - place[:, 1] / y, half_rate / f], axis=-1)
    return place, tangent, normal
