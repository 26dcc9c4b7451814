"""PH curves joined end to end, addressed by one arc length, straight on before the start and past the end."""

from collections.abc import Callable, Sequence

import numpy as np

from testbed.core.frames import Vec3
from vosc import ph

Array = np.ndarray
FEW = 8  # up to this many pieces are all searched for the nearest point; of more, those about a guess, if there is one
ROUNDING = 1e-9  # of a distance: far more than it is off by
BLOCK = 1 << 18  # distances of points from pieces that are held at once
NEWTON_STEPS, FEW_NEWTON_STEPS = 12, 2
SETTLED_M = 1e-2  # a last step this short leaves an error of curvature times its square


class Chain:
    """A path of one or more pieces. Everything here is exact; ``testbed.flight.route.path`` has the fast table for the loop."""

    def __init__(self, curves: Sequence[ph.Curve]) -> None:
        self.curves = tuple(curves)
        ends = np.cumsum([curve.length_m for curve in self.curves])
        self.length_m = float(ends[-1])
        self.starts_m = tuple(float(s) for s in [0.0, *ends[:-1]])

    def leg(self, s_m: float) -> int:
        """Which piece an arc length lies on."""
        return max(0, int(np.searchsorted(self.starts_m, s_m, side="right")) - 1)

    def tail(self, s_m: float) -> tuple[ph.Curve, ...]:
        """The pieces from an arc length in [0, length_m) on."""
        k = self.leg(s_m)
        return (self.curves[k].tail(s_m - self.starts_m[k]), *self.curves[k + 1 :])

    def frame(self, s_m: float) -> tuple[Vec3, Vec3, Vec3]:
        """Point (m), unit tangent and curvature vector (1/m) at an arc length."""
        if 0.0 <= s_m <= self.length_m:
            k = self.leg(s_m) if len(self.curves) > 1 else 0
            return self.curves[k].frame(min(s_m - self.starts_m[k], self.curves[k].length_m))
        k, end = (0, 0.0) if s_m < 0.0 else (-1, self.curves[-1].length_m)
        point, tangent, _ = self.curves[k].frame(end)
        beyond = s_m if s_m < 0.0 else s_m - self.length_m
        return (point[0] + beyond * tangent[0], point[1] + beyond * tangent[1], point[2] + beyond * tangent[2]), tangent, (0.0, 0.0, 0.0)

    def sample(self, s_m: Array) -> tuple[Array, Array, Array]:
        """Points, unit tangents and curvature vectors, (n,3) each, at arc lengths (n,)."""
        rows = self._rows(np.asarray(s_m, dtype=float), lambda curve, s: np.hstack(curve.sample(s)), 9)
        return rows[:, :3], rows[:, 3:6], rows[:, 6:]

    def points(self, s_m: Array) -> Array:
        """Points (n,3) at arc lengths (n,)."""
        return self._rows(np.asarray(s_m, dtype=float), lambda curve, s: curve.points(s), 3)

    def _rows(self, s_m: Array, take: Callable[[ph.Curve, Array], Array], width: int) -> Array:
        """What ``take`` has of each piece; before the start and past the end the rows of a straight line (point, tangent, no curvature)."""
        rows = np.empty((len(s_m), width))
        which = np.clip(np.searchsorted(self.starts_m, s_m, side="right") - 1, 0, None)
        inside = (s_m >= 0.0) & (s_m <= self.length_m)
        for k in np.unique(which[inside]):
            mine, curve = inside & (which == k), self.curves[k]
            rows[mine] = take(curve, np.clip(s_m[mine] - self.starts_m[k], 0.0, curve.length_m))
        for outside, end in ((s_m < 0.0, 0.0), (s_m > self.length_m, self.length_m)):
            if outside.any():
                point, tangent, _ = self.frame(end)
                beyond = np.asarray(point) + np.outer(s_m[outside] - end, tangent)
                rows[outside] = np.hstack([beyond, np.broadcast_to((*tangent, 0.0, 0.0, 0.0), (len(beyond), 6))])[:, :width]
        return rows

    def nearest(self, points: Array, guess_s_m: Array | None = None) -> tuple[Array, Array]:
        """Arc lengths (n,) of the nearest points, and the distances (n,), m; past the end the straight line counts.

        ``guess_s_m`` (n,), where there is one, is where to look first: Newton's method from there settles the points close to the
        path, and the whole path is searched for the others. Of a chain of more than eight pieces (a racetrack passes the same place
        on every lap) the point nearest to the guess is meant; without one, the first of those that are nearest of all. What is not
        finite has NaN for both.
        """
        points = np.asarray(points, dtype=float)
        good = np.isfinite(points).all(axis=1)
        if not good.all():
            s_m, distance = np.full((2, len(points)), np.nan)
            if good.any():
                s_m[good], distance[good] = self.nearest(points[good], None if guess_s_m is None else guess_s_m[good])
            return s_m, distance
        many = len(self.curves) > FEW
        if guess_s_m is None:
            return self._global(points)
        s_m, distance, settled = self._local(points, np.array(guess_s_m, dtype=float), NEWTON_STEPS if many else FEW_NEWTON_STEPS)
        if not many and not settled.all():
            s_m[~settled], distance[~settled] = self._global(points[~settled])
        return s_m, distance

    def _global(self, points: Array) -> tuple[Array, Array]:
        """The whole path is searched, but for pieces that are too far away to matter."""
        s_m, distance = np.zeros(len(points)), np.full(len(points), np.inf)
        every = max(1, BLOCK // len(self.curves))
        for first in range(0, len(points), every):
            some = slice(first, first + every)
            for curve, start, mine in zip(self.curves, self.starts_m, self._in_reach(points[some]).T, strict=True):
                if not mine.any():
                    continue
                rows = first + np.flatnonzero(mine)
                there, apart = curve.nearest(points[rows])
                nearer = apart < distance[rows]
                s_m[rows[nearer]], distance[rows[nearer]] = start + there[nearer], apart[nearer]
        point, tangent, _ = self.curves[-1].frame(self.curves[-1].length_m)
        beyond = (points - point) @ np.asarray(tangent)
        aside = np.linalg.norm(points - point - np.outer(beyond, tangent), axis=1)
        past = (beyond > 0.0) & (aside < distance)
        return np.where(past, self.length_m + beyond, s_m), np.where(past, aside, distance)

    def _in_reach(self, points: Array) -> Array:
        """Which pieces may be nearest to which points (n, pieces): no place of a piece is farther from its middle than half its length."""
        if len(self.curves) <= FEW:
            return np.ones((len(points), len(self.curves)), dtype=bool)
        halves = np.array([0.5 * curve.length_m for curve in self.curves])
        middles = np.array([curve.frame(half)[0] for curve, half in zip(self.curves, halves, strict=True)])
        apart = np.sqrt(sum((points[:, None, k] - middles[None, :, k]) ** 2 for k in range(3)))
        return np.asarray(apart - halves <= (1.0 + ROUNDING) * apart.min(axis=1)[:, None])

    def _local(self, points: Array, s_m: Array, steps: int) -> tuple[Array, Array, Array]:
        """Newton's method on the foot of the perpendicular, from a guess.

        Settled is what no longer moves and lies within half the least radius of the path, where no other foot is nearer unless the
        path itself comes back to that place.
        """
        step = np.zeros(len(s_m))
        for _ in range(steps):
            place, tangent, curvature = self.sample(s_m)
            offset = points - place
            slope = np.maximum(1.0 - np.einsum("ij,ij->i", offset, curvature), 0.25)
            after = np.maximum(0.0, s_m + np.einsum("ij,ij->i", offset, tangent) / slope)
            s_m, step = after, after - s_m
        distance = np.linalg.norm(points - self.points(s_m), axis=1)
        return s_m, distance, (np.abs(step) < SETTLED_M) & (distance * self.max_curvature() < 0.5)

    def max_curvature(self) -> float:
        """Greatest curvature of any piece, 1/m."""
        return max(curve.max_curvature() for curve in self.curves)
