"""How wide a curve can be that joins two poses (point and direction) without a loop: the bound on the insertion pose.

The radius of a curve is here its least radius of curvature. It has no loop when it turns by less than pi in all (the integral of
curvature): its tangents then lie in a hemisphere, so it advances in some direction all the way. With a limit of 2 pi instead, nearly
closed circles of any size would count, for a point abeam for instance.

The widest such curve exists and, unless it turns by pi itself, is a helicoidal arc (`vosc.helicoid`, the maximum principle): radius R
everywhere, no straight part; in one plane it is a circle, or two equal arcs that bend to opposite sides (`vosc.plane_arcs`). So the
bound is the greatest R of the helicoidal arcs that meet both poses. That much is a theorem. That the search below has found the
greatest one is not: it solves the end conditions from many starts, and is tested against direct optimisation of the curve.

The widest arc, line, arc is never wider (0.1 to 0.8 % narrower in the paper's poses). It is the answer, named as such, where no
helicoidal arc that turns by less than pi was found: where the limit of pi holds the curve back, or more than pi is needed, and in some
gentle bends to one side whose equations were not solved. Its radius can be had; how much wider a curve could be is then not known.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

import numpy as np

from vosc.arc_line_arc import ArcLineArc, arc_line_arc, arc_line_arc_frames
from vosc.errors import NoCurve, NoDirection, SamePoint
from vosc.helicoid import helicoid
from vosc.plane_arcs import plane_arcs
from vosc.vec import BoolArray, FloatArray, Vec, angle, combine, cross, dot, norm, perpendicular, sub, three, unit

Kind = Literal["straight", "helicoidal", "plane_arcs", "arc_line_arc", "none"]
STRAIGHT_RAD = 1e-5  # both directions this close to the chord: a straight line
MOST_TURN_RAD = math.pi * (1.0 + 1e-9)
_NEAREST = 10  # starts taken from the table
_STEPS, _ENOUGH = 40, 14  # of the search; and when one start has arrived
_LAST_STEPS = 200  # of the three best starts when none has: gentle bends to one side lie in long curved valleys
_SOLVED = 1e-16  # sum of squared errors, in units of the distance and of the larger angle to the chord
_EXACT, _STUCK = 1e-28, 1e3  # sum of squared errors, and damping, at which a start is left as it is
_DIFFERENCE = 1e-8
_PLANE = 1e-10  # least |beta|: nearer to a plane than this makes no difference to rounding


@dataclass(frozen=True)
class Join:
    """The widest curve found from one pose to another.

    ``radius_m``: its least radius of curvature; inf for a straight line, 0 when there is none (the end straight behind in the same
    direction). ``turn_rad``: the integral of curvature. ``kind``: ``helicoidal`` and ``plane_arcs`` are the bound, ``arc_line_arc`` a
    radius that can be had. ``arcs``: the widest arc, line, arc; of ``plane_arcs`` the curve itself.
    """

    radius_m: float
    turn_rad: float
    length_m: float
    kind: Kind
    arcs: ArcLineArc | None
    start: tuple[Vec, Vec]
    end: tuple[Vec, Vec]
    shape: tuple[float, float, float, float]  # of the helicoidal arc: beta, s at either end, roll of the first normal

    def frames(self, n: int = 100) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Points (m), unit tangents and curvature vectors (1/m), (n,3) each, evenly spaced. ``NoCurve`` for kind ``none``."""
        if self.kind == "none":
            raise NoCurve("no curve without a loop joins these poses")
        p0, t0 = self.start
        if self.kind in ("plane_arcs", "arc_line_arc") and self.arcs is not None:
            return arc_line_arc_frames(self.arcs, p0, t0, self.end[1], n)
        if self.kind == "straight":
            share = np.linspace(0.0, 1.0, n)[:, None]
            tangents = np.broadcast_to(unit(sub(self.end[0], p0)), (n, 3))
            return (1.0 - share) * np.array(p0) + share * np.array(self.end[0]), tangents, np.zeros((n, 3))
        beta, s0, s1, roll = self.shape
        place, tangent, normal = helicoid(np.full(n, beta), np.linspace(s0, s1, n))
        frame = np.stack([tangent[0], normal[0], np.cross(tangent[0], normal[0])], axis=1)
        to_world = frame @ _turned_basis(t0, roll)
        return np.array(p0) + self.radius_m * (place - place[0]) @ to_world, tangent @ to_world, normal @ to_world / self.radius_m

    def points(self, n: int = 100) -> FloatArray:
        """Points (n,3) along the curve, m."""
        return self.frames(n)[0]


def widest_join(p0: Iterable[Any], t0: Iterable[Any], p1: Iterable[Any], t1: Iterable[Any]) -> Join:
    """The widest curve from point ``p0`` (m) in direction ``t0`` (any length) to ``p1`` in direction ``t1``.

    ``SamePoint`` for points that coincide, ``NoDirection`` for directions of no length.
    """
    start, end = (three("p0", p0), unit(three("t0", t0))), (three("p1", p1), unit(three("t1", t1)))
    offset = sub(end[0], start[0])
    distance = norm(offset)
    if distance == 0.0:
        raise SamePoint(f"p0 and p1: give two different points, got {start[0]} twice")
    for name, (_, tangent) in (("t0", start), ("t1", end)):
        if norm(tangent) == 0.0:
            raise NoDirection(f"{name}: give a direction, got the zero vector")
    chord = unit(offset)
    if max(angle(chord, start[1]), angle(chord, end[1])) < STRAIGHT_RAD:
        return Join(math.inf, 0.0, distance, "straight", None, start, end, (math.nan,) * 4)
    arcs = arc_line_arc(offset, start[1], end[1])
    found = _widest_helicoidal(chord, start[1], end[1], arcs)
    plane = plane_arcs(offset, start[1], end[1])
    if plane is not None and plane.turn_rad < MOST_TURN_RAD and (found is None or plane.radius_m >= found[0] * distance * (1.0 - 1e-9)):
        return _of_arcs(plane, "plane_arcs", start, end)
    if found is not None:
        radius, shape = found[0] * distance, found[1]
        return Join(radius, shape[2] - shape[1], radius * (shape[2] - shape[1]), "helicoidal", arcs, start, end, shape)
    if arcs is None:
        return Join(0.0, math.nan, math.nan, "none", None, start, end, (math.nan,) * 4)
    return _of_arcs(arcs, "arc_line_arc", start, end)


def _of_arcs(arcs: ArcLineArc, kind: Kind, start: tuple[Vec, Vec], end: tuple[Vec, Vec]) -> Join:
    return Join(arcs.radius_m, arcs.turn_rad, sum(arcs.lengths_m), kind, arcs, start, end, (math.nan,) * 4)


def _basis(t0: Vec) -> tuple[Vec, Vec]:
    """Two unit vectors that make a right-handed triad with ``t0``."""
    across = perpendicular(t0)
    return across, cross(t0, across)


def _turned_basis(t0: Vec, roll: float) -> FloatArray:
    """Rows t0, normal, binormal of a curve that leaves in direction ``t0`` with its normal rolled by ``roll``."""
    e1, e2 = _basis(t0)
    c, s = math.cos(roll), math.sin(roll)
    return np.array([t0, combine(c, e1, s, e2), combine(-s, e1, c, e2)])


def _widest_helicoidal(chord: Vec, t0: Vec, t1: Vec, arcs: ArcLineArc | None) -> tuple[float, tuple[float, float, float, float]] | None:
    """Radius over distance and (beta, s0, s1, roll) of the widest helicoidal arc that turns by less than 2 pi."""
    e1, e2 = _basis(t0)
    goal = np.array([[dot(chord, t0), dot(chord, e1), dot(chord, e2)], [dot(t1, t0), dot(t1, e1), dot(t1, e2)]])
    unknowns, cost = _solve(np.concatenate([_starts_from_arcs(arcs, t0, t1), _starts_from_table(goal)]), goal, _STEPS)
    if cost.min() >= _SOLVED:
        unknowns, cost = _solve(unknowns[np.argsort(cost, kind="stable")[:3], :3], goal, _LAST_STEPS)
    turn, bend = unknowns[:, 2] - unknowns[:, 1], max(angle(chord, t0), angle(chord, t1))
    good: BoolArray = (cost < _SOLVED * bend * bend) & (turn > 0.0) & (turn < MOST_TURN_RAD)
    if not good.any():
        return None
    best = int(np.where(good, unknowns[:, 4], -np.inf).argmax())
    beta, s0, s1, roll, log_radius = unknowns[best].tolist()
    return math.exp(log_radius), (_off_plane(np.array([beta])).item(), s0, s1, roll)


def _starts_from_arcs(arcs: ArcLineArc | None, t0: Vec, t1: Vec) -> FloatArray:
    """(beta, s0, s1) of curves that twist as the planes of the two arcs do.

    Bends to opposite sides meet near s = pi / 2, where torsion is k / (sigma^2 + k^2). A bend to one side twists evenly, anywhere on
    the curve: torsion k / (cos^2 s + k^2 sin^2 s) in its middle.
    """
    if arcs is None:
        return np.empty((0, 3))
    turn, u = arcs.turn_rad, arcs.line_direction
    before, after = max(arcs.turn_in_rad, 1e-3 * turn), max(arcs.turn_out_rad, 1e-3 * turn)
    twist = min(max(angle(unit(cross(t0, u)), unit(cross(u, t1))), 0.05), math.pi)
    k = 0.5 * turn / math.tan(0.5 * twist)
    middle = 0.5 * math.pi
    out = [(math.atan(g * k + 1e-4) * h, middle - before, middle + after) for g in (0.3, 1.0, 3.0) for h in (1.0, -1.0)]
    torsion, hand = 2.0 * twist / turn, math.copysign(1.0, dot(t0, cross(u, t1)))
    even = (1.0 - math.sqrt(1.0 - torsion * torsion)) / torsion if torsion < 1.0 else 1.0
    for centre, tangent in ((0.0, torsion), (0.5 * math.pi, 1.0 / torsion), (0.25 * math.pi, even), (-0.25 * math.pi, even)):
        out.append((hand * min(math.atan(tangent), 1.4), centre - 0.5 * turn, centre + 0.5 * turn))
    return np.array(out)


@lru_cache(maxsize=1)
def _table() -> tuple[FloatArray, FloatArray]:
    """Shapes (n,3) and, for each, what no rotation or scaling changes: chord.t0, chord.t1, t0.t1, and the triple product (n,4)."""
    betas = [sign * b for b in (0.02, 0.15, 0.4, 0.7) for sign in (1.0, -1.0)]
    lengths = [0.3, 0.7, 1.2, 1.8, 2.4, 3.0]
    shapes = np.array([(b, s0, s0 + turn) for b in betas for s0 in np.arange(16) * (math.pi / 16) - 0.5 * math.pi for turn in lengths])
    local = _local(shapes)
    chord = local[:, :3] / np.linalg.norm(local[:, :3], axis=1)[:, None]
    end = local[:, 3:]
    return shapes, np.stack([chord[:, 0], (chord * end).sum(axis=1), end[:, 0], np.cross(chord, end)[:, 0]], axis=1)


def _starts_from_table(goal: FloatArray) -> FloatArray:
    shapes, invariants = _table()
    chord, end = goal
    wanted = np.array([chord[0], chord @ end, end[0], np.cross(chord, end)[0]])
    order = np.argsort(np.square(invariants - wanted).sum(axis=1), kind="stable")
    return shapes[order[:_NEAREST]]


def _off_plane(beta: FloatArray) -> FloatArray:
    return np.where(np.abs(beta) < _PLANE, np.where(beta < 0.0, -_PLANE, _PLANE), beta)


def _local(shapes: FloatArray) -> FloatArray:
    """Chord and end tangent in the Frenet frame of the start, (n,6), of shapes (beta, s0, s1) for R = 1."""
    n = len(shapes)
    beta = _off_plane(shapes[:, 0])
    place, tangent, normal = helicoid(np.concatenate([beta, beta]), np.concatenate([shapes[:, 1], shapes[:, 2]]))
    frame = np.stack([tangent[:n], normal[:n], np.cross(tangent[:n], normal[:n])], axis=1)
    ahead = np.einsum("nij,nj->ni", frame, place[n:] - place[:n])
    return np.concatenate([ahead, np.einsum("nij,nj->ni", frame, tangent[n:])], axis=1)


def _errors(local: FloatArray, roll: FloatArray, log_radius: FloatArray, goal: FloatArray) -> FloatArray:
    """End conditions (n,6)."""
    c, s, radius = np.cos(roll), np.sin(roll), np.exp(log_radius)
    x, y, z, tx, ty, tz = local.T
    rows = (radius * x, radius * (c * y - s * z), radius * (s * y + c * z), tx, c * ty - s * tz, s * ty + c * tz)
    return np.stack(rows, axis=1) - goal.reshape(6)


def _shapes(x: FloatArray, hand: FloatArray) -> FloatArray:
    """(beta, s0, s1) of unknowns (a, b, length).

    beta and the phase are polar coordinates round the helix of 45 degrees, on which the phase means nothing; a and b are Cartesian.
    """
    beta = np.clip(0.25 * np.pi * hand * (1.0 - np.hypot(x[:, 0], x[:, 1])), -1.5, 1.5)
    middle, half = 0.5 * np.arctan2(x[:, 1], x[:, 0]), 0.5 * x[:, 2]
    return np.column_stack([beta, middle - half, middle + half])


def _unknowns(shapes: FloatArray, hand: FloatArray, local: FloatArray, goal: FloatArray) -> FloatArray:
    """(a, b, length, roll, log(R / distance)), (n,5), with the roll and the size that the chord asks for."""
    radial, phase = 1.0 - 4.0 / np.pi * hand * shapes[:, 0], shapes[:, 1] + shapes[:, 2]
    roll = np.arctan2(goal[0, 2], goal[0, 1]) - np.arctan2(local[:, 2], local[:, 1])
    log_radius = -0.5 * np.log(np.square(local[:, :3]).sum(axis=1))
    return np.column_stack([radial * np.cos(phase), radial * np.sin(phase), shapes[:, 2] - shapes[:, 1], roll, log_radius])


def _solve(shapes: FloatArray, goal: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
    """Solutions (n,5): beta, s0, s1, roll, log(R / distance), and the sum of squared errors (n,), from every start at once.

    Levenberg-Marquardt.
    """
    hand = np.where(shapes[:, 0] < 0.0, -1.0, 1.0)
    local = _local(shapes)
    x = _unknowns(shapes, hand, local, goal)
    error = _errors(local, x[:, 3], x[:, 4], goal)
    cost, damping = np.square(error).sum(axis=1), np.full(len(x), 1e-3)
    active = np.arange(len(x))
    for step in range(steps):
        active = active[(cost[active] > _EXACT) & (damping[active] < _STUCK)]
        if len(active) == 0 or (step >= _ENOUGH and cost.min() <= _EXACT):
            break
        now, miss = x[active], error[active]
        jacobian = _jacobian(now, hand[active], miss, goal)
        square = np.einsum("nki,nkj->nij", jacobian, jacobian)
        square[:, range(5), range(5)] += damping[active, None] * (square[:, range(5), range(5)] + 1e-9)
        move = -np.linalg.solve(square, np.einsum("nki,nk->ni", jacobian, miss)[:, :, None])[:, :, 0]
        tried = now + np.clip(move, -0.5, 0.5)
        new_error = _errors(_local(_shapes(tried, hand[active])), tried[:, 3], tried[:, 4], goal)
        new_cost = np.square(new_error).sum(axis=1)
        better = new_cost < cost[active]
        damping[active] *= np.where(better, 0.1, 10.0)
        took = active[better]
        x[took], error[took], cost[took] = tried[better], new_error[better], new_cost[better]
    return np.column_stack([_shapes(x, hand), x[:, 3:]]), cost


def _jacobian(x: FloatArray, hand: FloatArray, error: FloatArray, goal: FloatArray) -> FloatArray:
    """Derivatives (n,6,5) of the errors: differences for the shape, exact for roll and size."""
    n = len(x)
    moved = np.repeat(x[None, :, :3], 3, axis=0)
    moved[range(3), :, range(3)] += _DIFFERENCE
    nearby = _local(_shapes(moved.reshape(3 * n, 3), np.tile(hand, 3))).reshape(3, n, 6)
    out = np.empty((n, 6, 5))
    for i in range(3):
        out[:, :, i] = (_errors(nearby[i], x[:, 3], x[:, 4], goal) - error) / _DIFFERENCE
    met = error + goal.reshape(6)
    zero = np.zeros(n)
    out[:, :, 3] = np.stack([zero, -met[:, 2], met[:, 1], zero, -met[:, 5], met[:, 4]], axis=1)
    out[:, :, 4] = np.column_stack([met[:, :3], np.zeros((n, 3))])
    return out
