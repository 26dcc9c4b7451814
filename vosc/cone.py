"""The exact boundary of a velocity obstacle on the velocity sphere: where the cone's generatrices pierce it.

Generatrix phi has the unit vector q(phi) = cos(alpha_0) a + sin(alpha_0) (e1 cos phi + e2 sin phi), a the line of sight, e1 the
part of v_o across it. It pierces the sphere of radius V = |v_u| where |v_o + lambda q| = V:

    lambda = -b +- sqrt(b^2 + e),   b = v_o . q = b0 + b1 cos phi,   e = V^2 - |v_o|^2

A slower obstacle (e > 0) has one closed curve, a *loop* over all phi. A faster one has its apex outside the sphere: two loops (its
near and its far side), or one that runs out on the near and back on the far side, or none. Each loop is parametrised by theta in
[0, 2 pi).

Along a loop f = v . d, for any direction d, has f' proportional to R g' - b' g with g = q . d and R = +-sqrt(b^2 + e): its zeros
are the points nearest to and farthest from d. That is how the least deflection is found without a search over the sphere.
"""

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

from vosc.encounter import Obstacle, Own, cone_half_angle
from vosc.vec import Vec, cross, dot, norm, perpendicular, right_of, scale, sub

EQUAL_SPEEDS = 1e-12  # |V^2 - v_o^2| below this fraction of V^2: the apex lies on the sphere


class Cone(NamedTuple):
    """One obstacle's cone in velocity space: apex v_o, axis (unit), cosine and sine of alpha_0."""

    apex: Vec
    axis: Vec
    cos: float
    sin: float


class Loop(NamedTuple):
    """One closed boundary curve: q = q0 + q1 cos phi + q2 sin phi, and how phi and the root's sign follow from theta.

    ``half`` 0: phi = theta, sign ``sign``. Otherwise phi = pi + half cos(theta), sign that of sin(theta). ``rising`` is the sign between
    f'(theta) and R g' - b' g.
    """

    apex: Vec
    q0: Vec
    q1: Vec
    q2: Vec
    b0: float
    b1: float
    e: float
    half: float
    sign: float
    rising: float


def cone_of(own: Own, obstacle: Obstacle) -> Cone | None:
    """The cone of ``obstacle`` seen from ``own``; ``None`` inside the sphere."""
    p = sub(obstacle.pos_m, own.pos_m)
    distance = norm(p)
    if distance < obstacle.radius_m:
        return None
    alpha0 = cone_half_angle(distance, obstacle.radius_m)
    return Cone(obstacle.vel_mps, scale(1.0 / distance, p), math.cos(alpha0), math.sin(alpha0))


def loops_of(cone: Cone, speed_mps: float) -> list[Loop]:
    """The boundary curves on the sphere of radius ``speed_mps``; none when the sphere lies wholly inside or outside the cone."""
    apex, axis = cone.apex, cone.axis
    e1 = perpendicular(axis, apex)
    e2 = cross(axis, e1)
    q0, q1, q2 = scale(cone.cos, axis), scale(cone.sin, e1), scale(cone.sin, e2)
    b0, b1 = dot(apex, q0), max(dot(apex, q1), 0.0)
    speed2 = speed_mps * speed_mps
    e = speed2 - dot(apex, apex)
    if speed2 == 0.0:
        return []
    if abs(e) <= EQUAL_SPEEDS * speed2:
        e = 0.0

    def loop(half: float, sign: float, rising: float) -> Loop:
        return Loop(apex, q0, q1, q2, b0, b1, e, half, sign, rising)

    if e >= 0.0:
        return [loop(0.0, 1.0, 1.0)]
    root = math.sqrt(-e)
    if b0 + b1 <= -root:
        return [loop(0.0, 1.0, 1.0), loop(0.0, -1.0, -1.0)]
    if b0 - b1 >= -root:
        return []
    return [loop(math.acos(max(-1.0, min(1.0, (b0 + root) / b1))), 0.0, -1.0)]


def loop_point(loop: Loop, theta: float) -> Vec:
    """The velocity on the loop at theta, m/s."""
    if loop.half > 0.0:
        phi = math.pi + loop.half * math.cos(theta)
        sign = 1.0 if math.sin(theta) >= 0.0 else -1.0
    else:
        phi, sign = theta, loop.sign
    c, s = math.cos(phi), math.sin(phi)
    b = loop.b0 + loop.b1 * c
    root = math.sqrt(max(b * b + loop.e, 0.0))
    if (b > 0.0) == (sign > 0.0):  # the form in which nothing cancels; the product of the two solutions is -e
        below = root + abs(b)
        lam = abs(loop.e) / below if below > 0.0 else 0.0
    else:
        lam = root + abs(b)
    q0, q1, q2 = loop.q0, loop.q1, loop.q2
    vo = loop.apex
    return (
        vo[0] + lam * (q0[0] + q1[0] * c + q2[0] * s),
        vo[1] + lam * (q0[1] + q1[1] * c + q2[1] * s),
        vo[2] + lam * (q0[2] + q1[2] * c + q2[2] * s),
    )


def outside(cone: Cone, velocity_mps: Vec) -> float:
    """sin(alpha - alpha_0) of a velocity: negative inside the cone, zero on it; 1 at the apex, where nothing moves."""
    wx, wy, wz = velocity_mps[0] - cone.apex[0], velocity_mps[1] - cone.apex[1], velocity_mps[2] - cone.apex[2]
    size = math.hypot(wx, wy, wz)
    if size <= 1e-12 * (abs(velocity_mps[0]) + abs(velocity_mps[1]) + abs(velocity_mps[2])):
        return 1.0
    ax, ay, az = cone.axis
    across = math.hypot(ay * wz - az * wy, az * wx - ax * wz, ax * wy - ay * wx)
    return (across * cone.cos - (ax * wx + ay * wy + az * wz) * cone.sin) / size


ON_THE_CONE = -1e-11  # sine of the angle: what lies this little inside still counts as on the boundary


def is_free(cones: Iterable[Cone], velocity_mps: Vec) -> bool:
    """Outside or on the boundary of every cone."""
    return all(outside(c, velocity_mps) >= ON_THE_CONE for c in cones)


SAMPLES = 24
_STEP = 2.0 * math.pi / SAMPLES
_ANGLES = [_STEP * k for k in range(SAMPLES)]
_TRIG = [(math.cos(a), math.sin(a)) for a in _ANGLES]


def slope_of(loop: Loop, towards: Vec) -> Callable[[float], float]:
    """R g' - b' g as a function of theta, with the sign of d(v . towards)/dtheta."""
    g0, g1, g2 = dot(loop.q0, towards), dot(loop.q1, towards), dot(loop.q2, towards)
    b0, b1, e, half, rising = loop.b0, loop.b1, loop.e, loop.half, loop.rising

    def slope(theta: float) -> float:
        phi, sign = (math.pi + half * math.cos(theta), math.sin(theta)) if half > 0.0 else (theta, loop.sign)
        c, s = math.cos(phi), math.sin(phi)
        b = b0 + b1 * c
        root = math.copysign(math.sqrt(max(b * b + e, 0.0)), sign)
        return rising * (root * (g2 * c - g1 * s) + b1 * s * (g0 + g1 * c + g2 * s))

    return slope


def zero(function: Callable[[float], float], low: float, high: float, at_low: float, at_high: float) -> float:
    """A zero between two points of opposite sign, to 1e-12 rad and better: the secant of the last two points, kept inside the bracket."""
    last, at_last, x, at_x = low, at_low, high, at_high
    for _ in range(60):
        new = x - at_x * (x - last) / (at_x - at_last) if at_x != at_last else low
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - x) < 1e-12:
            return new
        last, at_last, x, at_x = x, at_x, new, function(new)
        if at_x == 0.0:
            return x
        if (at_x > 0.0) == (at_high > 0.0):
            high = x
        else:
            low = x
    return x


def peaks(loop: Loop, towards: Vec) -> list[Vec]:
    """The points of the loop that are locally nearest to the unit vector ``towards``.

    When all are equally near (a circle round it), the one to the right of ``towards``.
    """
    slope = slope_of(loop, towards)
    slopes = [slope(a) for a in _ANGLES]
    speed = norm(loop_point(loop, 0.0))
    if max(slopes) - min(slopes) <= 1e-12 * speed:
        return peaks(loop, right_of(towards))
    found = []
    for k in range(SAMPLES):
        before, after = slopes[k - 1], slopes[k]
        if before > 0.0 >= after:
            found.append(loop_point(loop, zero(slope, _ANGLES[k] - _STEP, _ANGLES[k], before, after) if after < 0.0 else _ANGLES[k]))
    return found
