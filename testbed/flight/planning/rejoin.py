"""The way back after an avoidance: to the goal, or to the route, at once behind the insertion point or when the flight is clear.

*Clear* is the first time at which every known obstacle opens (its distance grows) and the predicted rest of the flight, along the way
back, keeps the radius of every one of them and a margin. Until then the flight holds the avoidance direction, so that coming back is
no second conflict. Predictions hold the present speed over the ground; obstacles go on straight from where they were last seen.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np

from testbed.campaign.words.route import LONGEST_ROUTE_M
from testbed.core.chain import FEW, Chain
from testbed.core.frames import Vec3
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.impossible import NoWayError
from testbed.flight.planning.context import Context
from testbed.flight.plants.base import State
from testbed.flight.sensing.base import Seen
from testbed.flight.traffic.track import least_clearance
from vosc import Degenerate, ph
from vosc.vec import add, norm, scale

HELD_M = 600.0  # length of the path along a direction that is held; flights go on straight past it
PREDICTED_S = 12.0  # how far ahead the rest of a flight is looked at
PREDICTION_STEP_S = 0.05  # between samples obstacle and aircraft move straight
ROUND_ABOUT = 2.0  # a route is at most so much longer than the straight line between two of its places: half a circle has 1.57
AHEAD_S = np.arange(1.0, 12.5, 0.5)  # where on the route to come back to, in flight times ahead of the nearest point


LOOKED_AT = np.linspace(0.0, 1.0, 17)  # shares of a way's length
TIGHTER = 1.000001  # rounding must not refuse a way
FAR_AHEAD_S = np.concatenate([AHEAD_S, np.arange(15.0, 61.0, 3.0)])  # of a course that bends away, and comes round again


def joined(start: Vec3, along: Vec3, end: Vec3, along_there: Vec3, magnitude_chords: float) -> ph.Curve:
    """The PH curve between two points in two directions, end tangents ``magnitude_chords`` long. Raises ``NoWayError``."""
    chord_m = math.dist(start, end)
    if not chord_m <= LONGEST_ROUTE_M:
        raise NoWayError(f"it would be {chord_m / 1000.0:,.0f} km long; at most {LONGEST_ROUTE_M / 1000.0:g} km")
    size = magnitude_chords * chord_m
    return _curve(start, resized(along, size), end, resized(along_there, size))


def _curve(start: Vec3, along: Vec3, end: Vec3, along_there: Vec3) -> ph.Curve:
    try:
        return ph.hermite(start, along, end, along_there)
    except Degenerate as error:
        raise NoWayError(str(error)) from error


def resized(vector: Vec3, size: float) -> Vec3:
    """The vector scaled to a length. Raises ``NoWayError`` when it has no direction."""
    if (length := norm(vector)) == 0.0:
        raise NoWayError("it would begin or end at a standstill, which has no direction")
    return scale(size / length, vector)


def ray(point: Vec3, velocity: Vec3) -> ph.Curve:
    """The straight line in the direction of a velocity. Raises ``NoWayError`` when it has none."""
    arrow = resized(velocity, HELD_M)
    return _curve(point, arrow, add(point, arrow), arrow)


class ByArcLength(Protocol):
    """A path by arc length, as far as a prediction needs it."""

    length_m: float

    def points(self, s_m: np.ndarray) -> np.ndarray: ...


def miss_along(
    path: ByArcLength, s_m: float, speed_mps: float, time_s: float, obstacles: Sequence[Seen], within_s: float = PREDICTED_S
) -> float:
    """Least distance (m) to the centre of any of the obstacles along the rest of a path, flown on at that speed; infinite for none."""
    lasts_s = max(path.length_m - s_m, 1.0) / speed_mps if speed_mps > 0.0 else PREDICTED_S
    elapsed = np.arange(0.0, min(PREDICTED_S, lasts_s, within_s), PREDICTION_STEP_S)
    points = path.points(s_m + speed_mps * elapsed)
    centres = (np.asarray(seen.at(time_s)) + np.outer(elapsed, seen.vel) for seen in obstacles)
    return min((least_clearance(elapsed, points, centre, 0.0).clearance_m for centre in centres), default=math.inf)


def opens(state: State, seen: Seen, time_s: float) -> bool:
    """Does the distance to the obstacle grow?"""
    x, y, z = seen.at(time_s)
    wx, wy, wz = seen.vel
    return (x - state.x) * (wx - state.vx) + (y - state.y) * (wy - state.vy) + (z - state.z) * (wz - state.vz) > 0.0


class Way(NamedTuple):
    """A way back: its pieces, and what the route's arc length is more than the way's once it is on the route; NaN where it never is."""

    curves: tuple[ph.Curve, ...]
    ahead_m: float = math.nan


class Rejoin:
    """The way back of one flight."""

    def __init__(self, context: Context) -> None:
        self._settings, self._magnitude = context.replan.rejoin, context.replan.magnitude_chords
        self._context = context
        once = context.replan.policy == "once"  # else a way back within the swell would be called a conflict again at once
        self._margin_m = self._settings.margin_m if once else max(self._settings.margin_m, context.replan.swell_m)
        self._most_curvature = G0_MPS2 * math.tan(self._settings.bank_deg * DEG) / context.speed_mps**2

    def when_clear(self, time_s: float, state: State, known: Sequence[Seen], left_s_m: float, now: bool) -> Way | None:
        """The way back from the present state, once it is clear of all that is ``known``; None while it is not.

        Raises ``NoWayError`` at the goal, or too near to the route to turn to it.
        """
        if not all(opens(state, seen, time_s) for seen in known):
            return None
        velocity = (state.vx, state.vy, state.vz)
        way = self.way((state.x, state.y, state.z), velocity, left_s_m, now)
        chain, speed = Chain(way.curves), norm(velocity)
        kept = (miss_along(chain, 0.0, speed, time_s, [seen]) - seen.radius_m for seen in known)
        return way if all(clearance >= self._margin_m for clearance in kept) else None

    def way(self, point: Vec3, velocity: Vec3, left_s_m: float, now: bool) -> Way:
        """PH pieces from a point, along a velocity over the ground, to the goal or to the route and along it.

        ``left_s_m``: arc length at which the flight left the route. ``now``: it cannot wait for a gentler way. Raises ``NoWayError``.
        """
        if self._settings.to == "route" and (way := self._to_route(point, velocity, left_s_m, now)):
            return way
        return Way((joined(point, velocity, self._context.goal, self._context.goal_tangent, self._magnitude),))

    def _to_route(self, point: Vec3, velocity: Vec3, left_s_m: float, now: bool) -> Way | None:
        """To the first point of the route that can be reached within the bank that is set aside for it; None where it is at its end.

        On a route of many pieces the goal is no way out: it may lie where the flight began, laps away. There is then no way yet; or, for
        who must turn now, the gentlest that there is.
        """
        route = self._context.route
        many = len(route.curves) > FEW
        tight: list[tuple[ph.Curve, float]] = []
        for s_m in self._nearest(point, norm(velocity), left_s_m) + norm(velocity) * (FAR_AHEAD_S if many else AHEAD_S):
            if s_m >= route.length_m - 1.0:
                return None
            target, tangent, _ = route.frame(float(s_m))
            join = joined(point, velocity, target, tangent, self._magnitude)
            if self._gentle(join):
                return Way((join, *route.tail(float(s_m))), float(s_m) - join.length_m)
            tight.append((join, float(s_m)))
        if many and now:
            join, there_m = min(tight, key=lambda one: one[0].max_curvature())
            return Way((join, *route.tail(there_m)), there_m - join.length_m)
        if many:
            raise NoWayError(f"the route is too near to turn to it with {self._settings.bank_deg:g} deg of bank")
        return None

    def _gentle(self, join: ph.Curve) -> bool:
        """Within the bank; most that are not show it at a few places, which cost a fiftieth of the exact extreme."""
        bends = np.linalg.norm(join.sample(LOOKED_AT * join.length_m)[2], axis=1)
        return not (bends > TIGHTER * self._most_curvature).any() and join.max_curvature() <= self._most_curvature

    def _nearest(self, point: Vec3, speed_mps: float, left_s_m: float) -> float:
        """Arc length of the route's nearest point; where it passes a place on every lap, of the lap that the flight left."""
        route = self._context.route
        if len(route.curves) <= FEW:
            return float(route.nearest(np.asarray(point)[None])[0][0])
        reach_m = ROUND_ABOUT * math.dist(route.frame(left_s_m)[0], point) + speed_mps * float(AHEAD_S[-1])
        first, last = route.leg(left_s_m), route.leg(min(left_s_m + reach_m, route.length_m))
        within = Chain(route.curves[first : last + 1]).nearest(np.asarray(point)[None])[0][0]
        return max(left_s_m, route.starts_m[first] + float(within))
