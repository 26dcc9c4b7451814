"""Which of many tracks may come closest to a point that moves: a few places of each rule out most of them.

A flight is cut into stretches. In each the point stays within a box, and a track gets no farther from where it is half way than its
top speed takes it: so its clearance is known from below and from above. Who is never as near as another one surely is somewhere cannot
be the nearest. What remains is worked out row by row, as if nothing had been ruled out.
"""

from collections.abc import Sequence

import numpy as np

from testbed.flight.traffic.bounds import bounds_of
from testbed.flight.traffic.track import Track

Array = np.ndarray
STRETCHES, FEWEST_ROWS = 64, 16
SPARE_M, WIDER = 1e-3, 1.000001  # rounding must not rule out an obstacle


class Nearest:
    """Tracks over the rows of a flight, at times (n,)."""

    def __init__(self, time_s: Array, tracks: Sequence[Track]) -> None:
        self._first = np.arange(0, len(time_s) - 1, max(FEWEST_ROWS, len(time_s) // STRETCHES))
        shape = (len(tracks), len(self._first))
        self._centre, self._strays = np.full((*shape, 3), np.nan), np.zeros(shape)
        self._gone, self._stays = np.zeros(shape, bool), np.zeros(shape, bool)
        if not len(self._first):
            return
        begin, end = time_s[self._first], time_s[np.append(self._first[1:], len(time_s) - 1)]
        for k, bounds in enumerate(map(bounds_of, tracks)):
            if bounds is not None:
                half_way = np.clip(0.5 * (begin + end), bounds.from_s, bounds.to_s)
                self._centre[k] = tracks[k].sampled(half_way)[0]
                self._strays[k] = WIDER * bounds.top_mps * (end - begin)
                self._gone[k] = (end < bounds.from_s) | (begin > bounds.to_s)
                self._stays[k] = (begin >= bounds.from_s) & (end <= bounds.to_s)

    def contenders(self, point: Array, radius_m: Array) -> Array:
        """Which of them (bool) may have the least clearance from a point at places (n,3), a row each; NaN where it is nowhere.

        ``radius_m``: of each, NaN for one that is left out.
        """
        if not len(self._first):
            return np.isfinite(radius_m)
        point = np.where(np.isfinite(point).all(axis=1)[:, None], point, np.nan)
        low, high = (self._stretches(pick, point) for pick in (np.fmin, np.fmax))
        nowhere = np.isnan(low[:, 0])
        away = self._centre - 0.5 * (low + high)
        distance = np.sqrt((away * away).sum(axis=2)) - radius_m[:, None]
        off = 0.5 * np.sqrt(((high - low) ** 2).sum(axis=1)) + self._strays + SPARE_M
        # where a track is that nothing is known of is NaN, and so is the distance: it may be anywhere
        at_least = np.where(self._gone | nowhere, np.inf, np.where(np.isnan(distance), -np.inf, distance - off)).min(axis=1)
        at_most = np.where(self._stays & ~np.isnan(distance), distance + off, np.inf).min(initial=np.inf)
        contenders: Array = np.isfinite(radius_m) & (at_least <= at_most)
        return contenders

    def _stretches(self, pick: np.ufunc, point: Array) -> Array:
        """Least or largest coordinates (stretches,3), the rows at both ends of each included."""
        found: Array = pick.reduceat(point, self._first, axis=0)
        found[:-1] = pick(found[:-1], point[self._first[1:]])
        return found
