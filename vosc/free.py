"""The free direction nearest to a given one: exact, over the complement of any number of cones on the velocity sphere.

The nearest free point is a point of one boundary curve where the distance is stationary, or a point where two boundary curves cross. So:

1. A cone that holds the wanted direction must be left: its own nearest boundary point is a lower bound. The largest of these bounds,
   if free of every other cone, is the answer. Most encounters end here, in scalar arithmetic.
2. Otherwise a disc round the wanted direction is searched, and doubled until it holds a free point. Inside it every boundary curve is
   sampled; stretches surely covered by another cone are dropped (the margin by second differences, so that no gap between samples is
   lost); what remains, the crossings and the stationary points, is refined to rounding, nearest first, until no nearer one can follow.

Circles on the sphere (the paper's caps, half-spaces of velocities) are cones with their apex at the centre, so they need no code of
their own.
"""

import heapq
import itertools
import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from vosc.cone import Cone, Loop, loop_point, loops_of, outside, peaks, slope_of, zero
from vosc.crowd import Crowd, holding, is_free
from vosc.vec import FloatArray, IntArray, Vec, dot, norm, scale, sub, unit

GRID = 48
BLOCK = 300_000  # numbers in a table of samples times cones: a dense scene is worked through in blocks
CROWD = 40  # cones from which a cheap first sieve pays
_THETA = 2.0 * np.pi * np.arange(GRID) / GRID
_STEP = 2.0 * math.pi / GRID
_AFTER = np.arange(1, GRID + 1) % GRID
_AROUND = np.arange(-1, 3)
_BEFORE = np.arange(-1, GRID - 1) % GRID


def nearest_free(cones: Sequence[Cone], speed_mps: float, towards: Vec) -> Vec | None:
    """The velocity of size ``speed_mps`` outside all ``cones`` that makes the least angle with ``towards``; ``None`` if there is none.

    Boundaries count as free. Deterministic; among equally near answers the first found.
    """
    aim = unit(towards)
    wanted = scale(speed_mps, aim)
    if speed_mps == 0.0:
        return wanted if is_free(cones, wanted) else None
    must: Vec | None = None
    for cone in holding(cones, wanted):
        exits = [v for loop in loops_of(cone, speed_mps) for v in peaks(loop, aim)]
        if not exits:
            return None  # the whole sphere lies inside this cone
        out = max(exits, key=lambda v: dot(v, aim))
        if must is None or dot(out, aim) < dot(must, aim):
            must = out
    if must is None:
        return wanted
    if is_free(cones, must):
        return must
    least = math.acos(max(-1.0, min(1.0, dot(must, aim) / speed_mps)))
    radius = max(1.5 * least, least + 0.1)
    while True:
        found = _search(within(cones, wanted, 2.0 * speed_mps * math.sin(0.5 * min(radius, math.pi))), speed_mps, aim, min(radius, math.pi))
        if found is not None or radius >= math.pi:
            return found
        radius *= 2.0


def within(cones: Sequence[Cone], velocity: Vec, distance: float) -> list[Cone]:
    """The cones that come within ``distance`` of a velocity."""
    near = cones.within(velocity, distance) if isinstance(cones, Crowd) else cones
    return [c for c in near if _reach(c, velocity) <= distance * (1.0 + 1e-9)]


def _reach(cone: Cone, velocity: Vec) -> float:
    """Distance in velocity space from ``velocity`` to the cone (0 inside)."""
    sine = outside(cone, velocity)
    w = sub(velocity, cone.apex)
    ahead = dot(w, cone.axis) * cone.cos + math.sqrt(max(dot(w, w) - dot(w, cone.axis) ** 2, 0.0)) * cone.sin
    return max(sine, 0.0) * norm(w) if ahead > 0.0 else norm(w)  # beyond a right angle from the generatrix the apex is nearest


def _stack(loops: Sequence[Loop]) -> tuple[FloatArray, ...]:
    flat = np.array([(*loop.apex, *loop.q0, *loop.q1, *loop.q2, *loop[4:]) for loop in loops])
    return flat[:, 0:3], flat[:, 3:6], flat[:, 6:9], flat[:, 9:12], *(flat[:, k : k + 1] for k in range(12, 17))


def _sample(loops: Sequence[Loop]) -> FloatArray:
    """Points of all loops at the grid of theta (L, GRID, 3): what ``loop_point`` gives, vectorised."""
    apex, q0, q1, q2, b0, b1, e, half, sign = _stack(loops)
    turned = half > 0.0
    phi = np.where(turned, math.pi + half * np.cos(_THETA), _THETA)
    far = np.where(turned, np.sin(_THETA), sign) >= 0.0
    c, s = np.cos(phi), np.sin(phi)
    b = b0 + b1 * c
    above = np.sqrt(np.maximum(b * b + e, 0.0)) + np.abs(b)
    lam = np.where((b > 0.0) == far, np.abs(e) / np.where(above > 0.0, above, 1.0), above)[..., None]
    q = q0[:, None] + c[..., None] * q1[:, None] + s[..., None] * q2[:, None]
    points: FloatArray = apex[:, None] + lam * q
    return points


def sides(points: FloatArray, cones: Sequence[Cone]) -> FloatArray:
    """Value cos(alpha_0) |w| - w . axis at points (m, 3) for all cones (m, n): negative inside."""
    apex, axis = np.array([c.apex for c in cones]), np.array([c.axis for c in cones])
    cosine = np.array([c.cos for c in cones])
    square = (points**2).sum(axis=1)[:, None] - 2.0 * points @ apex.T + (apex**2).sum(axis=1)
    out: FloatArray = cosine * np.sqrt(np.maximum(square, 0.0)) - points @ axis.T + (apex * axis).sum(axis=1)
    return out


def _search(cones: Sequence[Cone], speed: float, aim: Vec, radius: float) -> Vec | None:
    """The nearest free point within ``radius`` of ``aim``, or ``None``."""
    owned = [(k, loop) for k, cone in enumerate(cones) for loop in loops_of(cone, speed)]
    if not owned:
        return None
    owner, loops = np.array([k for k, _ in owned]), [loop for _, loop in owned]
    points = _sample(loops)
    height = points @ np.array(aim) / speed
    bend = np.abs(height[:, _BEFORE] - 2.0 * height + height[:, _AFTER])
    # stretch k runs from sample k to k + 1; `bound` is above every height on it
    bound = np.maximum(height, height[:, _AFTER]) + np.maximum(bend, bend[:, _AFTER])
    line, start = np.nonzero(bound >= math.cos(radius) - 1e-12)
    queue: list[tuple[float, int, Callable[[], list[Vec]]]] = []
    tick = itertools.count()
    best: Vec | None = None
    best_height = math.cos(radius) - 1e-12
    order = np.argsort(-bound[line, start], kind="stable")  # nearest first: a dense scene need not be looked at in full
    line, start = line[order], start[order]
    per_block = max(1, BLOCK // len(cones))
    for first in range(0, len(line), per_block):
        rows, columns = line[first : first + per_block], start[first : first + per_block]
        if bound[rows[0], columns[0]] < best_height:
            break
        for height_bound, refine in _open_stretches(cones, loops, owner, points, bound, rows, columns, aim):
            heapq.heappush(queue, (-height_bound, next(tick), refine))
        after = first + per_block
        coming = float(bound[line[after], start[after]]) if after < len(line) else -math.inf
        while queue and -queue[0][0] >= max(best_height, coming):
            for velocity in heapq.heappop(queue)[2]():
                level = dot(velocity, aim) / speed
                if level > best_height and is_free(cones, velocity):
                    best, best_height = velocity, level
    return best


def _open_stretches(
    cones: Sequence[Cone],
    loops: list[Loop],
    owner: IntArray,
    points: FloatArray,
    bound: FloatArray,
    rows: IntArray,
    columns: IntArray,
    aim: Vec,
) -> list[tuple[float, Callable[[], list[Vec]]]]:
    """For each stretch that no other cone surely covers: its bound, and a function that refines its crossings and its peak."""
    if len(cones) > CROWD:
        # a side changes by at most twice the way (3 for the arc over its chord): so deep a sample settles its stretch alone
        step = np.linalg.norm(points[rows, _AFTER[columns]] - points[rows, columns], axis=1)
        deep = sides(points[rows, columns], cones)
        deep[np.arange(len(rows)), owner[rows]] = 0.0
        kept = deep.min(axis=1) > -3.0 * step
        rows, columns = rows[kept], columns[kept]
    own_cone = owner[rows][:, None] == np.arange(len(cones))
    corners = points[rows[:, None], (columns[:, None] + _AROUND) % GRID]
    side = sides(corners.reshape(-1, 3), cones).reshape(len(rows), 4, len(cones))
    bend = np.abs(side[:, :2] - 2.0 * side[:, 1:3] + side[:, 2:])
    slack = np.maximum(bend[:, 0], bend[:, 1])
    high, low = np.maximum(side[:, 1], side[:, 2]), np.minimum(side[:, 1], side[:, 2])
    covered = ((high < -slack) & ~own_cone).any(axis=1)
    contact = (low <= slack) & (high >= -slack) & ~own_cone & ~covered[:, None]
    out: list[tuple[float, Callable[[], list[Vec]]]] = []
    for i in np.nonzero(~covered)[0].tolist():
        others = [cones[j] for j in np.nonzero(contact[i])[0].tolist()]
        out.append((float(bound[rows[i], columns[i]]), partial(_refine, loops[int(rows[i])], float(_THETA[columns[i]]), others, aim)))
    return out


def _refine(loop: Loop, theta: float, others: Sequence[Cone], aim: Vec) -> list[Vec]:
    """The peak of the stretch [theta, theta + step], and its crossings with ``others``."""
    end = theta + _STEP
    slope = slope_of(loop, aim)
    found = [loop_point(loop, x) for x in zeros(slope, theta, end)]
    for cone in others:

        def side(x: float, cone: Cone = cone) -> float:
            return outside(cone, loop_point(loop, x))

        found += [loop_point(loop, x) for x in zeros(side, theta, end)]
    return found


def zeros(function: Callable[[float], float], low: float, high: float) -> list[float]:
    """The zeros in a short interval on which the function has at most one extremum: none, one, or two."""
    at_low, at_high = function(low), function(high)
    if (at_low > 0.0) != (at_high > 0.0):
        return [zero(function, low, high, at_low, at_high)]
    turn = 0.5 * (low + high)
    at_turn = function(turn)
    if (at_turn > 0.0) == (at_low > 0.0):
        # the extremum of the parabola through the three points: only if that comes near zero can there be a pair of zeros
        slope, bend = at_high - at_low, at_high - 2.0 * at_turn + at_low
        sign = 1.0 if at_low > 0.0 else -1.0
        if sign * bend <= 0.0 or abs(slope) > 4.0 * abs(bend) or sign * (at_turn - 0.125 * slope * slope / bend) > 0.5 * abs(at_turn):
            return []
        turn = _valley(lambda x: sign * function(x), low, high)
        at_turn = function(turn)
    if (at_turn > 0.0) == (at_low > 0.0):
        return []
    return [zero(function, low, turn, at_low, at_turn), zero(function, turn, high, at_turn, at_high)]


def _valley(function: Callable[[float], float], low: float, high: float) -> float:
    """Where the function is least, or the first point seen below zero (golden section)."""
    ratio = 0.5 * (math.sqrt(5.0) - 1.0)
    a, b = high - ratio * (high - low), low + ratio * (high - low)
    at_a, at_b = function(a), function(b)
    for _ in range(30):
        if at_a < 0.0 or at_b < 0.0:
            break
        if at_a < at_b:
            high, b, at_b = b, a, at_a
            a = high - ratio * (high - low)
            at_a = function(a)
        else:
            low, a, at_a = a, b, at_b
            b = low + ratio * (high - low)
            at_b = function(b)
    return a if at_a < at_b else b
