"""The manoeuvres the tables compare: turns in one plane (DROAM), and the PH paths through the insertion point."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from testbed.core.units import DEG
from testbed.studies.scoam.audit.case import Case
from testbed.studies.scoam.audit.geometry import (
    direction_in_force,
    heading,
    multi_direction,
    obstacle,
    point_in_force,
    position,
    rim,
    seen,
    turn,
)
from testbed.studies.scoam.audit.readings import CHAIN
from vosc import Obstacle, ph
from vosc.encounter import cone_margin
from vosc.vec import Vec, deflection, direction, norm, scale, sub

ROUTE_START_DEG, ROUTE_END_DEG = (40.87, 26.13), (10.00, 2.84)
OBSTACLES = {"o": ("o",), "o1": ("o1", "o2")}
"""The obstacles of the case whose insertion point is built from the key."""
STEP_DEG = 1.0
MAGNITUDES = tuple(0.5 + 0.1 * i for i in range(26))
"""Lengths of the end derivatives, in chords, over which an unprinted choice is varied."""


@dataclass(frozen=True)
class _OutsideCaps:
    """How far (deg) a direction lies outside the printed caps."""

    caps: tuple[tuple[Vec, float], ...]

    def __call__(self, d: Vec) -> float:
        return min((deflection(axis, d) - half) / DEG for axis, half in self.caps)


@dataclass(frozen=True)
class _OutsideCones:
    """How far (deg) a direction lies outside the exact cones."""

    speed: float
    me: Vec
    bodies: tuple[Obstacle, ...]

    def __call__(self, d: Vec) -> float:
        return min(cone_margin(self.me, scale(self.speed, d), body) / DEG for body in self.bodies)


def droam(case: Case, name: str, plane: str) -> list[Vec]:
    """Directions after the turn in azimuth (``hp``) or elevation (``vp``) that first leaves every cone; one for either side, if any."""
    free: Callable[[Vec], float]
    if case.has(CHAIN):
        free = _OutsideCaps(tuple(rim(case, one) for one in OBSTACLES[name]))
    else:
        free = _OutsideCones(case["own.speed"], position(case, "own"), tuple(seen(case, one) for one in OBSTACLES[name]))
    return list(_first_free(free, case["own.az"], case["own.el"], plane))


@cache  # rows of one table, and roundings of numbers that a turn does not depend on, ask for the same turn again
def _first_free(free: Callable[[Vec], float], azimuth: float, elevation: float, plane: str) -> tuple[Vec, ...]:
    def after(angle: float) -> Vec:
        return direction((azimuth + angle) * DEG, elevation * DEG) if plane == "hp" else direction(azimuth * DEG, (elevation + angle) * DEG)

    out = []
    for side in (1.0, -1.0):
        high, limit = 0.0, 180.0 if plane == "hp" else 90.0 - side * elevation
        while high <= limit and free(after(side * high)) < 0.0:
            high += STEP_DEG
        if high > limit:
            continue
        low = max(0.0, high - STEP_DEG)
        while high - low > 1e-11:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if free(after(side * middle)) < 0.0 else (low, middle)
        out.append(after(side * high))
    return tuple(out)


def nearest(values: Sequence[float], printed: float) -> float:
    """Assumption ``nearest_branch``."""
    return min(values, key=lambda value: abs(value - printed), default=math.nan)


def scoam(case: Case, name: str) -> Vec:
    """The direction of the paper's own method in force."""
    return direction_in_force(case) if name == "o" else multi_direction(case)


def turns(case: Case, name: str, method: str) -> list[float]:
    """Deflections of a row of Table 2 (``name`` "o") or 4 ("o1"), deg: one, or one for either side."""
    return [turn(case, new) for new in (droam(case, name, method) if method != "scoam" else [scoam(case, name)])]


def _join(p0: Vec, t0: Vec, p1: Vec, t1: Vec, magnitude: float) -> ph.Curve:
    size = magnitude * norm(sub(p1, p0))
    return ph.hermite(p0, scale(size, t0), p1, scale(size, t1))


def route(case: Case) -> ph.Curve:
    """The path P_s to P_f under the assumption ``route_tangents``."""
    return _route(*_route_ends(case))


def _route_ends(case: Case) -> tuple[Vec, Vec]:
    start, goal = ((case[f"route.{end}_x"], case[f"route.{end}_y"], case[f"route.{end}_z"]) for end in ("start", "goal"))
    return start, goal


@cache
def _flown(start: Vec, goal: Vec, me: Vec) -> float:
    """Length of the route to the point of it that is nearest, m."""
    return float(_route(start, goal).nearest(np.array([me]))[0][0])


@cache
def _route(start: Vec, goal: Vec) -> ph.Curve:
    (a0, e0), (a1, e1) = ROUTE_START_DEG, ROUTE_END_DEG
    return _join(start, direction(a0 * DEG, e0 * DEG), goal, direction(a1 * DEG, e1 * DEG), 1.0)


def legs(case: Case, name: str, new: Vec, magnitude: float = 1.0) -> tuple[ph.Curve, ph.Curve]:
    """P_t to Q_avo, arriving along ``new``, and Q_avo to P_f."""
    return _through(case, point_in_force(case, name), new, magnitude)


def _through(case: Case, middle: Vec, new: Vec, magnitude: float) -> tuple[ph.Curve, ph.Curve]:
    me = position(case, "own")
    goal = (case["route.goal_x"], case["route.goal_y"], case["route.goal_z"])
    a1, e1 = ROUTE_END_DEG
    return _join(me, heading(case, "own"), middle, new, magnitude), _join(middle, new, goal, direction(a1 * DEG, e1 * DEG), magnitude)


def path_length(case: Case, name: str, new: Vec, magnitude: float = 1.0) -> float:
    """Length P_s to P_f along the route to P_t and through Q_avo, m."""
    return _flown(*_route_ends(case), position(case, "own")) + sum(leg.length_m for leg in legs(case, name, new, magnitude))


def chord_length(case: Case, name: str) -> float:
    """Length of the straight pieces P_s, P_t, Q_avo, P_f: no path is shorter."""
    goal = (case["route.goal_x"], case["route.goal_y"], case["route.goal_z"])
    me, middle = position(case, "own"), point_in_force(case, name)
    return norm(me) + norm(sub(middle, me)) + norm(sub(goal, middle))


def lengths(case: Case, name: str, method: str, magnitude: float = 1.0) -> list[float]:
    """Path lengths of a row of Table 2 or 4."""
    directions = droam(case, name, method) if method != "scoam" else [scoam(case, name)]
    return [path_length(case, name, new, magnitude) for new in directions]


def leg_time(case: Case, name: str, new: Vec) -> float:
    """Time along the PH leg from P_t to Q_avo, s."""
    return legs(case, name, new)[0].length_m / case["own.speed"]


def clearance(case: Case, name: str, magnitude: float = 1.0) -> float:
    """Least distance to a centre minus R on the printed path, m: through the printed Q_avo along the printed direction, at printed speeds.

    The obstacles are those of the reading. Between samples (0.7 m) both bodies are taken to move straight: less than a millimetre off.
    """
    q, new, speed = ("q", "dir", case["own.speed"]) if name == "o" else ("q2", "dir2", case["own.speed"])
    first, second = _through(case, position(case, q), heading(case, new), magnitude)
    s = np.linspace(0.0, first.length_m + second.length_m, 541)
    at = np.where((s < first.length_m)[:, None], first.points(s), second.points(s - first.length_m))
    least_gap = math.inf
    for body in (obstacle(case, one) for one in OBSTACLES[name]):
        gap = at - np.array(body.pos_m) - np.outer(s / speed, body.vel_mps)
        step = np.diff(gap, axis=0)
        along = np.clip(-(gap[:-1] * step).sum(axis=1) / (step**2).sum(axis=1), 0.0, 1.0)
        least_gap = min(least_gap, float(np.linalg.norm(gap[:-1] + along[:, None] * step, axis=1).min()) - body.radius_m)
    return least_gap
