"""Insertion point Q_avo and the time at which it is reached (paper section 4.3, eq. 34-35).

Q_avo = P_o + v_o t + k R v_o / |v_o|: ahead of the obstacle on its own course, as eq. 35 says; the printed points follow the equation.
The sentence above it (4.3.1) says the opposite direction: ``side="behind"`` puts the point there, where the obstacle has passed.
The paper leaves t open; two rules are offered:

- ``arrival`` (default): t is the time the own aircraft needs to fly straight to Q_avo at its present speed, a fixed point that is a
  quadratic in t. With k = 1.25 it reproduces the printed points of both simulated cases, so it is what the paper probably did.
  The quadratic may have two positive roots. ``root="smallest"`` takes the first; against a faster obstacle from behind its point may lie
  behind the aircraft, which cannot fly straight there. ``root="forward"`` takes the first whose point lies ahead.
- ``paper_4_3_2``: t = (d_0 - R) / |v_o|, as printed in section 4.3.2.

A stationary obstacle has no course to be ahead on. There Q_avo is defined as the point k R abeam of its centre, on the side on
which the straight line of the own aircraft already passes it (to the right when it aims exactly at the centre).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

from vosc.encounter import Obstacle, Own
from vosc.errors import WrongOption
from vosc.vec import LARGEST, FloatArray, Vec, along, array, dot, norm, perpendicular, right_of, scale, sub, unit

TimeRule = Literal["arrival", "paper_4_3_2"]
Side = Literal["ahead", "behind"]
ArrivalRoot = Literal["smallest", "forward"]
STATIONARY = 1e-9  # obstacle speeds below this fraction of the own speed: standing still


@dataclass(frozen=True, eq=False)
class Insertion:
    """``point_m`` (3,) Q_avo, m; ``time_s`` when the obstacle's centre is k R behind it (rule ``arrival``: and the own aircraft at it)."""

    point_m: FloatArray
    time_s: float


def positive_roots(a: float, half_b: float, c: float) -> list[float]:
    """All t > 0 with a t^2 + 2 half_b t + c = 0, the smallest first; written so that nothing cancels when a is nearly zero."""
    under_root = half_b * half_b - a * c
    if under_root < 0.0:
        return []
    q = -(half_b + math.copysign(math.sqrt(under_root), half_b))
    roots = [num / den for num, den in ((q, a), (c, q)) if den != 0.0]
    return sorted(t for t in roots if 0.0 < t < math.inf)


def major_obstacle(own: Own, obstacles: Sequence[Obstacle]) -> tuple[int, float] | None:
    """Section 4.3.2: index of the obstacle with the least t_c = (d_0 - R) / |v_o|, and that time, s; the insertion point is built
    from it.

    Give the threats only. Stationary obstacles have no t_c; ``None`` when no obstacle has one. Inside a sphere its time is 0.
    """
    times = [
        (max(norm(sub(o.pos_m, own.pos_m)) - o.radius_m, 0.0) / norm(o.vel_mps), k)
        for k, o in enumerate(obstacles)
        if norm(o.vel_mps) > STATIONARY * norm(own.vel_mps)
    ]
    if not times:
        return None
    time, k = min(times)
    return k, time


def _abeam(own: Own, obstacle: Obstacle) -> Vec:
    """Unit vector from a stationary obstacle to the side on which the own straight line passes it."""
    axis = unit(own.vel_mps)
    return perpendicular(axis, sub(own.pos_m, obstacle.pos_m), right_of(axis))


def insertion_point(
    own: Own,
    obstacle: Obstacle,
    k: float = 1.25,
    time_rule: TimeRule = "arrival",
    side: Side = "ahead",
    root: ArrivalRoot = "smallest",
) -> Insertion | None:
    """Q_avo and t (eq. 34-35), or ``None`` when no positive time solves the rule (status ``no_insertion_point``).

    ``k`` >= 1 scales the radius; ``side`` and ``root`` are explained at the top of the module. No solution happens when the obstacle is
    faster and running away, when the own speed is zero, when no root's point lies ahead (``root="forward"``), and, with ``paper_4_3_2``,
    inside the sphere or for a stationary obstacle; nor when the point is out of all range (1e30 m). ``WrongOption`` for a k below 1 or
    an unknown word.
    """
    if not 1.0 <= k < math.inf:
        raise WrongOption(f"k: give a factor of at least 1 (the paper's k R), got {k}")
    for name, word, known in (("time_rule", time_rule, TimeRule), ("side", side, Side), ("root", root, ArrivalRoot)):
        if word not in get_args(known):
            raise WrongOption(f"{name}: {' or '.join(map(repr, get_args(known)))}, got {word!r}")
    speed, obstacle_speed = norm(own.vel_mps), norm(obstacle.vel_mps)
    p = sub(obstacle.pos_m, own.pos_m)
    stationary = obstacle_speed <= STATIONARY * speed
    if stationary and (speed == 0.0 or time_rule == "paper_4_3_2"):
        return None
    course = _abeam(own, obstacle) if stationary else scale(-1.0 if side == "behind" else 1.0, unit(obstacle.vel_mps))
    velocity = (0.0, 0.0, 0.0) if stationary else obstacle.vel_mps
    ahead = along(p, k * obstacle.radius_m, course)  # from the own aircraft to the point that moves with the obstacle
    if time_rule == "arrival":
        times = positive_roots(dot(velocity, velocity) - speed * speed, dot(ahead, velocity), dot(ahead, ahead))
    else:
        times = [(norm(p) - obstacle.radius_m) / obstacle_speed]
    for time in times:
        way = along(ahead, time, velocity)
        if 0.0 < time < math.inf and (root == "smallest" or dot(way, own.vel_mps) > 0.0):
            point = along(own.pos_m, 1.0, way)
            return Insertion(array(point), time) if max(map(abs, point)) <= LARGEST else None
    return None
