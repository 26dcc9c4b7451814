"""Insertion point Q_avo and the time at which it is reached (paper section 4.3, eq. 34-35).

Q_avo = P_o + v_o t + k R v_o / |v_o|: ahead of the obstacle on its own course, as eq. 35 says (the sentence above it says opposite;
the printed points follow the equation). The paper leaves t open; two rules are offered:

- ``arrival`` (default): t is the time the own aircraft needs to fly straight to Q_avo at its present speed, a fixed point that is a
  quadratic in t. With k = 1.25 it reproduces the printed points of both simulated cases, so it is what the paper probably did.
- ``paper_4_3_2``: t = (d_0 - R) / |v_o|, as printed in section 4.3.2.

A stationary obstacle has no course to be ahead on. There Q_avo is defined as the point k R abeam of its centre, on the side on
which the straight line of the own aircraft already passes it (to the right when it aims exactly at the centre).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from vosc.encounter import Obstacle, Own
from vosc.errors import WrongOption
from vosc.vec import FloatArray, Vec, along, array, dot, norm, perpendicular, right_of, sub, unit

TimeRule = Literal["arrival", "paper_4_3_2"]
STATIONARY = 1e-9  # obstacle speeds below this fraction of the own speed: standing still


@dataclass(frozen=True, eq=False)
class Insertion:
    """``point_m`` (3,) Q_avo, m; ``time_s`` when the obstacle's centre is k R behind it (rule ``arrival``: and the own aircraft at it)."""

    point_m: FloatArray
    time_s: float


def smallest_positive_root(a: float, half_b: float, c: float) -> float | None:
    """Smallest t > 0 with a t^2 + 2 half_b t + c = 0, or ``None``; written so that nothing cancels when a is nearly zero."""
    under_root = half_b * half_b - a * c
    if under_root < 0.0:
        return None
    q = -(half_b + math.copysign(math.sqrt(under_root), half_b))
    roots = [num / den for num, den in ((q, a), (c, q)) if den != 0.0]
    ahead = [t for t in roots if 0.0 < t < math.inf]
    return min(ahead) if ahead else None


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


def insertion_point(own: Own, obstacle: Obstacle, k: float = 1.25, time_rule: TimeRule = "arrival") -> Insertion | None:
    """Q_avo and t (eq. 34-35), or ``None`` when no positive time solves the rule (status ``no_insertion_point``).

    ``k`` >= 1 scales the radius. No solution happens when the obstacle is faster and running away, when the own speed is zero, and, with
    ``paper_4_3_2``, inside the sphere or for a stationary obstacle. ``WrongOption`` for a k below 1 or an unknown rule.
    """
    if not 1.0 <= k < math.inf:
        raise WrongOption(f"k: give a factor of at least 1 (the paper's k R), got {k}")
    if time_rule not in ("arrival", "paper_4_3_2"):
        raise WrongOption(f"time_rule: 'arrival' or 'paper_4_3_2', got {time_rule!r}")
    speed, obstacle_speed = norm(own.vel_mps), norm(obstacle.vel_mps)
    p = sub(obstacle.pos_m, own.pos_m)
    stationary = obstacle_speed <= STATIONARY * speed
    if stationary and (speed == 0.0 or time_rule == "paper_4_3_2"):
        return None
    course = _abeam(own, obstacle) if stationary else unit(obstacle.vel_mps)
    velocity = (0.0, 0.0, 0.0) if stationary else obstacle.vel_mps
    ahead = along(p, k * obstacle.radius_m, course)  # from the own aircraft to the point that moves with the obstacle
    time: float | None
    if time_rule == "arrival":
        time = smallest_positive_root(dot(velocity, velocity) - speed * speed, dot(ahead, velocity), dot(ahead, ahead))
    else:
        time = (norm(p) - obstacle.radius_m) / obstacle_speed
    if time is None or not 0.0 < time < math.inf:
        return None
    return Insertion(array(along(own.pos_m, 1.0, along(ahead, time, velocity))), time)
