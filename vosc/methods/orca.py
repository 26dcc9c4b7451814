"""ORCA: one half-space of velocities per obstacle, and the velocity nearest to the present one in all of them.

van den Berg, Guy, Lin, Manocha, Reciprocal n-body collision avoidance, Springer Tracts in Advanced Robotics 70 (2011) 3; the
three-dimensional half-spaces as in the authors' RVO2-3D. Each of two reciprocal agents takes half of the correction; against an
obstacle that does not react half is not enough, so the default here is the whole of it (``responsibility=1``).
"""

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vosc import columns, crowd
from vosc.columns import Columns
from vosc.cone import Cone
from vosc.crowd import MARGIN, Crowd, Scene, scene_of
from vosc.encounter import Obstacle, Own, relative_velocity
from vosc.errors import WrongOption
from vosc.free import nearest_free
from vosc.methods.choice import Choice, Status, undefined
from vosc.vec import SMALLEST_SINE, FloatArray, Vec, along, combine, cross, dot, norm, perpendicular, right_of, scale, sub, unit

SETTLED = 1e-6  # of the speed: the least violation is found to this
SURE = 1e-5  # shares above this: rounding is far below MARGIN


class HalfSpace(NamedTuple):
    """Velocities v with v . normal >= offset."""

    normal: Vec
    offset: float


def half_space(own: Own, obstacle: Obstacle, responsibility: float, horizon_s: float) -> HalfSpace:
    """The ORCA constraint of one obstacle, seen from outside its sphere."""
    p = sub(obstacle.pos_m, own.pos_m)
    r, rate = obstacle.radius_m, 1.0 / horizon_s
    v, _ = relative_velocity(own.vel_mps, obstacle.vel_mps)
    w = along(v, -rate, p)
    size, ahead = norm(w), dot(w, p)
    if ahead < 0.0 and ahead * ahead > r * r * size * size:  # nearest to the cut-off sphere p / tau (its centre alone when tau is infinite)
        normal, reach = scale(1.0 / size, w), r * rate - size
    else:
        distance2, b = dot(p, p), dot(p, v)
        across = cross(p, v)
        tangent2 = max(distance2 - r * r, 1e-12 * distance2)
        t = (b + math.sqrt(max(b * b - distance2 * (dot(v, v) - dot(across, across) / tangent2), 0.0))) / distance2
        off = along(v, -t, p)
        size = norm(off)
        axis = unit(p)
        centred = size <= 1e-12 * max(norm(v), t * math.sqrt(distance2))
        normal = _aside(axis, own.vel_mps) if centred else scale(1.0 / size, off)
        if centred:  # on the axis every way out is equally long: along the generatrix on the side to which turning helps most
            sine = r / math.sqrt(distance2)
            normal = combine(math.sqrt(max(1.0 - sine * sine, 0.0)), normal, -sine, axis)
            size, t = 0.0, 0.0
            return HalfSpace(normal, dot(normal, own.vel_mps) + responsibility * norm(v) * sine)
        reach = r * t - size
    return HalfSpace(normal, dot(normal, own.vel_mps) + responsibility * reach)


def _aside(axis: Vec, velocity: Vec) -> Vec:
    """Unit vector across the axis and the velocity, upwards; where that is level, or the two are parallel, to the right."""
    side = cross(unit(axis), unit(velocity)) if norm(velocity) > 0.0 else (0.0, 0.0, 0.0)
    if norm(side) <= SMALLEST_SINE:
        return perpendicular(axis, velocity, right_of(axis))
    down = side[2] < 0.0 if abs(side[2]) > SMALLEST_SINE else dot(side, right_of(velocity)) < 0.0
    return unit(scale(-1.0, side) if down else side)


def nearest_in_ball(spaces: Sequence[HalfSpace], wanted: Vec, radius: float) -> Vec | None:
    """The point nearest to ``wanted`` in all half-spaces and in the ball round the origin; ``None`` if they have no common point.

    Constraints are added one at a time, the most violated first; each small problem is solved by trying every set of active constraints.
    """
    active: list[HalfSpace] = []
    while True:
        point = _by_enumeration(active, wanted, radius)
        if point is None:
            return None
        worst = min(spaces, key=lambda h: dot(h.normal, point) - h.offset, default=None)
        if worst is None or worst in active or dot(worst.normal, point) - worst.offset >= -1e-12 * max(radius, 1e-300):
            return point
        active.append(worst)


def _by_enumeration(spaces: Sequence[HalfSpace], wanted: Vec, radius: float) -> Vec | None:
    candidates: list[Vec] = [wanted] if norm(wanted) <= radius else []
    for count in range(4):
        for chosen in itertools.combinations(spaces, count):
            candidates += _on(chosen, wanted, radius)
    slack = 1e-9 * max(radius, 1e-300)
    fits = [c for c in candidates if norm(c) <= radius + slack and all(dot(h.normal, c) >= h.offset - slack for h in spaces)]
    return min(fits, key=lambda c: norm(sub(c, wanted)), default=None)


def _on(planes: Sequence[HalfSpace], wanted: Vec, radius: float) -> list[Vec]:
    """Points of the intersection of the planes that can be nearest: the projection of ``wanted``, and those on the ball's surface."""
    base: Vec = (0.0, 0.0, 0.0)
    axes: list[Vec] = []
    for plane in planes:  # Gram-Schmidt: the intersection is base + everything perpendicular to the axes
        rest = plane.normal
        for a in axes:
            rest = along(rest, -dot(rest, a), a)
        size = norm(rest)
        if size < 1e-9:
            return []
        a = scale(1.0 / size, rest)
        base = along(base, (plane.offset - dot(plane.normal, base)) / size, a)
        axes.append(a)
    left = wanted
    for a in axes:
        left = along(left, -dot(left, a), a)
    found = [(base[0] + left[0], base[1] + left[1], base[2] + left[2])]
    room = radius * radius - dot(base, base)
    if room >= 0.0 and len(planes) < 3 and norm(left) > 0.0:
        found.append(along(base, math.sqrt(room) / norm(left), left))
    return found


def orca(
    own: Own, obstacles: Sequence[Obstacle], responsibility: float = 1.0, horizon_s: float = math.inf, keep_speed: bool = True
) -> Choice:
    """The velocity nearest to v_u that satisfies every half-space.

    ``responsibility`` 1 takes the whole correction, 0.5 is the reciprocal half. ``horizon_s`` cuts the velocity obstacle off beyond
    that time. ``keep_speed`` asks for the present speed exactly, as a fixed-wing aircraft does; without it every speed up to the
    present one is allowed, as in the original. Where the half-spaces have no common point of that speed they are all moved back by the
    same least speed until they have one, as the authors do: the worst is violated least; whether the answer is safe the cones say.
    ``undefined`` only for an aircraft at rest. ``WrongOption`` for a responsibility outside (0, 1] or a horizon that is not above 0.
    """
    if not 0.0 < responsibility <= 1.0:
        raise WrongOption(f"responsibility: give a share in (0, 1], got {responsibility}")
    if not horizon_s > 0.0:
        raise WrongOption(f"horizon_s: give a time above 0 s (math.inf for none), got {horizon_s}")
    scene, speed = scene_of(obstacles).threats, norm(own.vel_mps)
    if not keep_speed:
        point = nearest_in_ball([half_space(own, o, responsibility, horizon_s) for o in scene], own.vel_mps, speed)
    elif speed == 0.0:
        return undefined(own)
    else:
        forbidden = forbidden_circles(own, scene, responsibility, horizon_s)
        point = None if forbidden is None else nearest_free(forbidden, speed, own.vel_mps)
    if point is None:
        point = least_violating([half_space(own, o, responsibility, horizon_s) for o in scene], own.vel_mps, keep_speed)
    return Choice(point, Status.AVOIDED)


def least_violating(spaces: Sequence[HalfSpace], wanted: Vec, keep_speed: bool) -> Vec:
    """The velocity that violates the worst of the half-spaces least, of the size of ``wanted`` or up to it; of equal ones the nearest.

    ``wanted`` itself violates them by a known speed at most; half the interval is left at every step, to ``SETTLED`` of the speed.
    """
    speed, best = norm(wanted), wanted
    low, high = 0.0, max(h.offset - dot(h.normal, wanted) for h in spaces)
    while high - low > SETTLED * speed:
        middle = 0.5 * (low + high)
        moved = [HalfSpace(h.normal, h.offset - middle) for h in spaces]
        found = _nearest_on_sphere(moved, wanted, speed) if keep_speed else nearest_in_ball(moved, wanted, speed)
        if found is None:
            low = middle
        else:
            best, high = found, middle
    return best


def _nearest_on_sphere(spaces: Sequence[HalfSpace], wanted: Vec, speed: float) -> Vec | None:
    if any(h.offset > speed for h in spaces):
        return None
    return nearest_free([circle_of(h, speed) for h in spaces if h.offset > -speed], speed, wanted)


def circle_of(space: HalfSpace, speed: float) -> Cone:
    """The velocities of one speed that a half-space forbids: those within a circle round the opposite of its normal."""
    return Cone((0.0, 0.0, 0.0), scale(-1.0, space.normal), -space.offset / speed, math.sqrt(1.0 - (space.offset / speed) ** 2))


def forbidden_circles(own: Own, scene: Scene, responsibility: float, horizon_s: float) -> Sequence[Cone] | None:
    """The circles of all obstacles; ``None`` when one of them is the whole sphere. Of many, rough ones first (``vosc.crowd``)."""
    speed = norm(own.vel_mps)
    if len(scene) <= crowd.FEW:
        spaces = [half_space(own, o, responsibility, horizon_s) for o in scene]
        if any(h.offset > speed for h in spaces):
            return None
        return [circle_of(h, speed) for h in spaces if h.offset > -speed]
    (x, y, z), offsets = rough_half_spaces(own, scene, responsibility, horizon_s)
    near = ~(np.abs(np.abs(offsets) - speed) > MARGIN * speed)  # these are decided by the exact half-space, and so are those not known
    for k in np.nonzero(near)[0].tolist():
        (x[k], y[k], z[k]), offsets[k] = half_space(own, scene[k], responsibility, horizon_s)
    if (offsets > speed).any():
        return None
    known = np.nonzero(offsets > -speed)[0]
    cosine, numbers = -offsets[known] / speed, known.tolist()

    def make(k: int) -> Cone:
        return circle_of(half_space(own, scene[numbers[k]], responsibility, horizon_s), speed)

    centre = np.zeros(len(known))
    return Crowd((centre, centre, centre), (-x[known], -y[known], -z[known]), cosine, np.sqrt(1.0 - cosine**2), make)


def rough_half_spaces(own: Own, scene: Scene, responsibility: float, horizon_s: float) -> tuple[Columns, FloatArray]:
    """``half_space`` of many obstacles: normals, offsets (n,); offsets are NaN where rounding could matter."""
    p, distance = scene.rough(own.pos_m).p, scene.rough(own.pos_m).distance
    _, velocities, r = scene.arrays
    rate = 1.0 / horizon_s
    x, y, z = velocities
    v = own.vel_mps[0] - x, own.vel_mps[1] - y, own.vel_mps[2] - z
    with np.errstate(all="ignore"):
        w = columns.along(v, -rate, p)
        size, ahead = columns.length(w), columns.dot(w, p)
        sine = -ahead / (size * distance)  # of the line of sight beyond the rim of the cut-off sphere
        cut = (ahead < 0.0) & (ahead * ahead > r * r * size * size)
        distance2, b, v2 = distance * distance, columns.dot(p, v), columns.dot(v, v)
        tangent2 = distance2 - r * r
        across, size_v = columns.cross(p, v), np.sqrt(v2)
        under = b * b - distance2 * (v2 - columns.dot(across, across) / tangent2)
        t = (b + np.sqrt(np.maximum(under, 0.0))) / distance2
        off = columns.along(v, -t, p)
        far = columns.length(off)
        n0, n1, n2 = (np.where(cut, a / size, b / far) for a, b in zip(w, off, strict=True))
        reach = np.where(cut, r * rate - size, r * t - far)
        u0, u1, u2 = own.vel_mps
        offsets = n0 * u0 + n1 * u1 + n2 * u2 + responsibility * reach
        known = (size > SURE * (size_v + rate * distance)) & np.where(
            cut,
            True,
            (tangent2 > SURE * distance2) & (under > SURE * b * b) & (far > SURE * (size_v + np.abs(t) * distance)),
        )
        known &= np.abs(sine - r / distance) > SURE
        speed = norm(own.vel_mps)
        known &= (size_v > SURE * (speed + scene.speeds)) & (size_v < speed / SURE)  # also where the squares in v2 are lost: 0
    offsets[~known] = math.nan
    return (n0, n1, n2), offsets
