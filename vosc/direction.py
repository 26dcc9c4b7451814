"""Avoidance directions against several obstacles (paper section 4.2, eq. 29-33), on the paper's caps or on the exact boundary.

The paper replaces each velocity obstacle by the circle of its cap. That circle touches the exact boundary at the two critical
velocities; between them it runs up to several degrees outside on some stretches and inside, where a velocity on it collides, on
others: ``cap_gap`` measures it. Everything here takes ``boundary="paper"`` or ``"exact"``.
"""

import math
from collections.abc import Sequence
from typing import Literal, cast, get_args

import numpy as np

from vosc.cone import Cone, cone_of, loop_point, loops_of, outside
from vosc.critical_curve import Performance, cheapest
from vosc.encounter import Obstacle, Own, cone_margin, threat
from vosc.errors import WrongOption
from vosc.free import nearest_free
from vosc.spherical_cap import Cap, HalfAngle, Root, cap
from vosc.turns import least_turn, level_circle
from vosc.vec import FloatArray, Vec, along, array, combine, cross, direction, dot, norm, perpendicular, scale, three, unit

Boundary = Literal["paper", "exact"]
Objective = Literal["least_deflection", "least_climb_change", "right_of_way", "goal", "least_load_factor", "least_roll"]
OBJECTIVES: tuple[str, ...] = get_args(Objective)
SOON_S = 1e-3  # a turn is given at least so long


def cap_cone(found: Cap) -> Cone:
    """The cap's circle as a cone with its apex at the own velocity's origin: the same tests and boundaries as for an exact cone."""
    centre, gamma = direction(found.azimuth_rad, found.elevation_rad), found.half_angle_rad
    return Cone((0.0, 0.0, 0.0), centre, math.cos(gamma), math.sin(gamma))


def boundaries(
    own: Own, obstacles: Sequence[Obstacle], boundary: Boundary, root: Root = "larger", half_angle: HalfAngle = "arcsine"
) -> list[Cone] | None:
    """The forbidden regions of the velocity sphere; ``None`` when one does not exist (inside a sphere, or no cap).

    An obstacle that forbids no velocity of the own speed has no cap and needs none: it is left out. ``root`` and ``half_angle`` are
    those of the caps (``vosc.spherical_cap``).
    """
    if boundary not in ("paper", "exact"):
        raise WrongOption(f"boundary: 'paper' (circles of eq. 24-28) or 'exact', got {boundary!r}")
    cones: list[Cone] = []
    for o in obstacles:
        exact = cone_of(own, o)
        if exact is None:
            return None
        if boundary == "exact":
            cones.append(exact)
            continue
        found = cap(own, o, root, half_angle)
        if found is not None:
            cones.append(cap_cone(found))
        elif loops_of(exact, norm(own.vel_mps)) or outside(exact, own.vel_mps) < 0.0:
            return None
    return cones


def boundary_curves(own: Own, obstacle: Obstacle, boundary: Boundary = "exact", n: int = 180) -> list[FloatArray]:
    """Closed curves (n,3), m/s, that bound the obstacle's forbidden velocities on the own velocity sphere: one, two, or none."""
    cones = boundaries(own, [obstacle], boundary)
    if cones is None:
        return []
    theta = [2.0 * math.pi * k / n for k in range(n)]
    return [np.array([loop_point(loop, t) for t in theta]) for loop in loops_of(cones[0], norm(own.vel_mps))]


def cap_gap(own: Own, obstacle: Obstacle, n: int = 360) -> FloatArray | None:
    """How far the paper's circle lies outside the exact cone, rad (n,), all round from ``nearest_mps``; negative: inside.

    ``None`` without a cap.
    """
    found = cap(own, obstacle)
    if found is None:
        return None
    points = [point_on_cap(found, 2.0 * math.pi * k / n) for k in range(n)]
    return np.array([cone_margin(own.pos_m, three("point", p), obstacle) for p in points])


def _circle(found: Cap) -> tuple[Vec, Vec, Vec]:
    """Centre AM of the cap's circle, and its half-axes towards ``nearest_mps`` and a quarter turn on."""
    near, far = three("nearest_mps", found.nearest_mps), three("farthest_mps", found.farthest_mps)
    centre, a = combine(0.5, near, 0.5, far), combine(0.5, near, -0.5, far)
    normal = unit(centre) if norm(centre) > 1e-9 * norm(a) else perpendicular(unit(a), (0.0, 0.0, 1.0))
    return centre, a, cross(normal, a)


def point_on_cap(found: Cap, angle_rad: float) -> FloatArray:
    """The critical velocity K on the circle of eq. 32-33, ``angle_rad`` round from ``nearest_mps`` (3,), m/s."""
    centre, a, b = _circle(found)
    return array(along(along(centre, math.cos(angle_rad), a), math.sin(angle_rad), b))


def points_with_component(found: Cap, axis: int, value_mps: float) -> list[FloatArray]:
    """Eq. 32-33 as the paper uses them: one component of K is given (``axis`` 0, 1, 2), the others follow; two solutions, one, or none."""
    centre, a, b = _circle(found)
    size = math.hypot(a[axis], b[axis])
    wanted = value_mps - centre[axis]
    if size == 0.0 or abs(wanted) > size:
        return []
    at, half = math.atan2(b[axis], a[axis]), math.acos(wanted / size)
    return [point_on_cap(found, x) for x in ((at + half, at - half) if half > 0.0 else (at,))]


def corner_points(first: Cap, second: Cap, speed_mps: float) -> list[FloatArray]:
    """S and S' (eq. 29-31): the velocities on the circles of both caps, (3,) each, m/s; empty when the circles do not meet.

    P_uS . AM_i = r_i^2 for both caps puts S on the line of two planes; the sphere of the own speed cuts that line twice.
    """
    m1, m2 = (direction(c.azimuth_rad, c.elevation_rad) for c in (first, second))
    line = cross(m1, m2)
    sine2 = dot(line, line)
    if sine2 < 1e-24:
        return []
    c = dot(m1, m2)
    j, k = (first.radius_mps - c * second.radius_mps) / sine2, (second.radius_mps - c * first.radius_mps) / sine2
    foot = combine(j, m1, k, m2)
    left = speed_mps * speed_mps - dot(foot, foot)
    if left < 0.0:
        return []
    h = math.sqrt(left / sine2)
    return [array(along(foot, h, line)), array(along(foot, -h, line))]


def choose(
    own: Own,
    obstacles: Sequence[Obstacle],
    objective: Objective = "least_deflection",
    boundary: Boundary = "exact",
    goal: Sequence[float] | None = None,
) -> FloatArray | None:
    """The free velocity of own speed (3,), m/s, that is best by ``objective``; a point K of the union's boundary unless a free one
    beats it.

    - ``least_deflection``: least angle to v_u.
    - ``least_climb_change``: least change of climb angle; among equals the least change of azimuth.
    - ``right_of_way``: least deflection among the turns to the right (the rule for head-on and overtaking traffic).
    - ``goal``: least angle to the direction ``goal`` (three floats), which is taken itself where it is free.
    - ``least_load_factor``, ``least_roll``: what costs the aircraft least, turning until the closest approach of the nearest in time
      (``vosc.critical_curve``); from level wings.

    ``None`` when no velocity is free, or none to the right. ``WrongOption`` for an unknown objective or a missing goal. Three and
    more obstacles: the boundary is that of the union, and a crossing of two circles counts only where no third covers it (section
    4.2.1).
    """
    if objective not in OBJECTIVES:
        raise WrongOption(f"objective: one of {', '.join(OBJECTIVES)}, got {objective!r}")
    if (goal is not None) != (objective == "goal"):
        raise WrongOption("goal: give a direction with objective='goal', and only with it")
    cones = boundaries(own, obstacles, boundary)
    if cones is None:
        return None
    goal_mps = None if goal is None else three("goal", goal)
    found = best_free(cones, own.vel_mps, objective, goal_mps, time_to_turn(own, obstacles))
    return None if found is None else array(found)


def time_to_turn(own: Own, obstacles: Sequence[Obstacle]) -> float:
    """Seconds until the first closest approach that lies ahead; infinite where none does."""
    times = (threat(own, o).time_to_cpa_s for o in obstacles)
    return max(min((t for t in times if t > 0.0), default=math.inf), SOON_S)


def best_free(
    cones: Sequence[Cone], velocity_mps: Vec, objective: str, goal: Vec | None = None, within_s: float = math.inf, bank_rad: float = 0.0
) -> Vec | None:
    """``choose`` for given forbidden regions."""
    speed = norm(velocity_mps)
    if objective == "goal" and goal is not None:
        return nearest_free(cones, speed, goal)
    if objective in get_args(Performance):
        return cheapest(cones, velocity_mps, cast(Performance, objective), within_s, bank_rad)
    if objective == "right_of_way":
        left = unit((-velocity_mps[1], velocity_mps[0], 0.0))
        return nearest_free([*cones, Cone((0.0, 0.0, 0.0), left, 0.0, 1.0)] if norm(left) > 0.0 else cones, speed, velocity_mps)
    if objective == "least_climb_change":
        return _least_climb_change(cones, velocity_mps, speed)
    return nearest_free(cones, speed, velocity_mps)


def _least_climb_change(cones: Sequence[Cone], velocity: Vec, speed: float) -> Vec | None:
    """On the present circle of latitude if a point of it is free; else the nearer of the lowest free point above and the highest below."""
    level = least_turn(cones, [level_circle(velocity)], (-1, 1))
    if level is not None:
        return level
    sine = max(-1.0, min(1.0, velocity[2] / speed)) if speed > 0.0 else 0.0
    found = []
    for up in (1.0, -1.0):
        beyond = Cone((0.0, 0.0, 0.0), (0.0, 0.0, -up), -up * sine, math.sqrt(1.0 - sine * sine))
        point = nearest_free([*cones, beyond], speed, scale(-up, (0.0, 0.0, 1.0)))
        if point is not None:
            found.append(point)
    return min(found, key=lambda v: abs(v[2] - velocity[2]), default=None)
