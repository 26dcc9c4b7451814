"""The paper's equations once more, for the tests only: plain numpy, nothing shared with ``vosc`` or ``testbed.studies.scoam``."""

import itertools
import math

import numpy as np

INPUTS = {  # printed value, half a unit in the last place
    "xu": (162, 0.5), "yu": (101, 0.5), "zu": (64.3, 0.05), "au": (24.7, 0.05), "eu": (12.0, 0.05),
    "xo": (254, 0.5), "yo": (63.6, 0.05), "zo": (60.7, 0.05), "vo": (40, 0.5), "ao": (135, 0.5), "eo": (12.4, 0.05), "ro": (25, 0.0),
    "x1": (254, 0.5), "y1": (63.8, 0.05), "z1": (59.8, 0.05), "v1": (35, 0.5), "a1": (106, 0.5), "e1": (11.4, 0.05), "r1": (25, 0.0),
    "x2": (208, 0.5), "y2": (186, 0.5), "z2": (42.5, 0.05), "v2": (32, 0.5), "a2": (-50.3, 0.05), "e2": (-15.4, 0.05), "r2": (30, 0.0),
}  # fmt: skip
READ = {
    "as_printed": {},
    "azimuth_106": {"ao": (106, 0.5)},
    "direction_106_10": {"ao": (106.1, 0.05), "eo": (10.4, 0.05)},
    "o2_elevation_plus": {"e2": (15.4, 0.05)},
}


def u(azimuth, elevation):
    a, e = math.radians(azimuth), math.radians(elevation)
    return np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])


def between(a, b):
    """Angle of two vectors, deg."""
    return math.degrees(
        2.0
        * math.atan2(
            np.linalg.norm(a / np.linalg.norm(a) - b / np.linalg.norm(b)), np.linalg.norm(a / np.linalg.norm(a) + b / np.linalg.norm(b))
        )
    )


def azel(v):
    return math.degrees(math.atan2(v[1], v[0])), math.degrees(math.asin(v[2] / np.linalg.norm(v)))


def me(g):
    return np.array([g["xu"], g["yu"], g["zu"]]), 50.0 * u(g["au"], g["eu"])


def other(g, n):
    return np.array([g[f"x{n}"], g[f"y{n}"], g[f"z{n}"]]), g[f"v{n}"] * u(g[f"a{n}"], g[f"e{n}"]), g[f"r{n}"]


def outside(g, n, v, d0=None):
    """How far a velocity lies outside the cone, alpha - alpha_0 (section 2), deg."""
    (p, _), (po, vo, r) = me(g), other(g, n)
    return between(v - vo, po - p) - math.degrees(math.asin(r / (d0 or np.linalg.norm(po - p))))


def critical(g, n, d0=None):
    """Both critical velocities: the generatrices of the plane of v_uo and P_uP_o, and |v_o + lambda q| = 50 (eq. 5-18)."""
    (p, vu), (po, vo, r) = me(g), other(g, n)
    sight = (po - p) / np.linalg.norm(po - p)
    a0 = math.asin(r / (d0 or np.linalg.norm(po - p)))
    w = vu - vo
    side = w - (w @ sight) * sight
    side /= np.linalg.norm(side)
    out = []
    for sign in (1, -1):
        q = math.cos(a0) * sight + sign * math.sin(a0) * side
        out.append(vo + max(np.roots([1.0, 2.0 * vo @ q, vo @ vo - 2500.0]).real) * q)
    return out


def cap(g, n, d0=None):
    """r, psi_r, theta_r, gamma (eq. 24-28)."""
    near, far = critical(g, n, d0)
    m = 0.5 * (near + far)
    return (np.linalg.norm(m), *azel(m), math.degrees(math.asin(np.linalg.norm(near - far) / 100.0)))


def insertion(g, n, d0=None):
    """Q_avo with k = 1.25 (eq. 34-35): t by iterating "own travel time to Q_avo", or (d_0 - R) / |v_o|."""
    (p, _), (po, vo, r) = me(g), other(g, n)
    ahead = po + 1.25 * r * vo / np.linalg.norm(vo)
    t = (d0 - r) / np.linalg.norm(vo) if d0 else 1.0
    while not d0:
        new = np.linalg.norm(ahead + vo * t - p) / 50.0
        if abs(new - t) < 1e-13:
            break
        t = new
    return ahead + vo * t, t


def droam(g, names, plane, printed, caps=None):
    """The turn in one plane, to the side nearest to the print: scan, then bisection."""
    _, vu = me(g)

    def after(x):
        return 50.0 * (u(g["au"] + x, g["eu"]) if plane == "hp" else u(g["au"], g["eu"] + x))

    def free(x):
        if caps:
            return min(between(after(x), u(a, e)) - gamma for a, e, gamma in caps)
        return min(outside(g, n, after(x)) for n in names)

    turns = []
    for sign in (1, -1):
        if free(0.0) >= 0.0:
            turns.append(0.0)
            continue
        grid = np.arange(0.0, 180.0 if plane == "hp" else 90.0 - sign * g["eu"], 0.5)
        high = next((x for x in grid if free(sign * x) >= 0.0), None)
        if high is None:
            continue
        low = high - 0.5
        for _ in range(36):  # to 1e-11 deg
            middle = 0.5 * (low + high)
            low, high = (middle, high) if free(sign * middle) < 0.0 else (low, middle)
        turns.append(sign * high)
    return min((between(after(x), vu) for x in turns), key=lambda a: abs(a - printed))


def least_turn(g):
    """Least deflection out of the cone of O, by a fine scan of the generatrices: good to 1e-4 deg."""
    (p, vu), (po, vo, r) = me(g), other(g, "o")
    if outside(g, "o", vu) >= 0.0:
        return 0.0
    sight = (po - p) / np.linalg.norm(po - p)
    a0 = math.asin(r / np.linalg.norm(po - p))
    e1 = np.cross(sight, [0.0, 0.0, 1.0])
    e1 /= np.linalg.norm(e1)
    e2 = np.cross(sight, e1)
    phi = np.linspace(0.0, 2.0 * math.pi, 40001)[:, None]
    q = math.cos(a0) * sight + math.sin(a0) * (np.cos(phi) * e1 + np.sin(phi) * e2)
    b = q @ vo
    v = vo + (-b + np.sqrt(b * b + 2500.0 - vo @ vo))[:, None] * q
    return math.degrees(math.acos((v @ vu / 2500.0).max()))


def k_point(g, caps):
    """K with y = 101.0 on the rim of one of the caps (axis azimuth, elevation, half-angle), nearest to the printed K (eq. 32-33)."""
    p, _ = me(g)
    y = 101.0 - p[1]
    found = []
    for a, e, gamma in caps:
        m = u(a, e)
        level = 50.0 * math.cos(math.radians(gamma)) - m[1] * y
        # x = (level - m_z z) / m_x into x^2 + z^2 = 2500 - y^2
        for z in np.roots([m[2] ** 2 + m[0] ** 2, -2.0 * level * m[2], level**2 - m[0] ** 2 * (2500.0 - y * y)]):
            if abs(z.imag) < 1e-9:
                found.append(p + np.array([(level - m[2] * z.real) / m[0], y, z.real]))
    return min(found, key=lambda k: np.linalg.norm(k - [206.5, 101.0, 88.5]))


def spread(function, reading, keys, corners=10):
    """Value of ``function``, and a lower and an upper estimate of its largest change over the corners of the rounding of ``keys``.

    All corners of those that move it most; the rest is added to the upper estimate.
    """
    given = {**INPUTS, **READ[reading]}
    centre = {k: v for k, (v, _) in given.items()}
    value = function(centre)
    moves = {k: abs(function({**centre, k: centre[k] + given[k][1]}) - value) for k in keys if given[k][1] > 0.0}
    big = sorted(moves, key=moves.get)[-corners:]
    rest = sum(moves[k] for k in moves if k not in big)
    worst = 0.0
    for signs in itertools.product((-1.0, 1.0), repeat=len(big)):
        worst = max(worst, abs(function({**centre, **{k: centre[k] + s * given[k][1] for k, s in zip(big, signs, strict=True)}}) - value))
    return value, worst, 1.05 * worst + 1.6 * rest
