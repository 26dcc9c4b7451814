"""Which tracks a sensor has to ask at a look: not those that cannot have come within reach since they were last asked.

What parts a track from the reach of the sensor is used up by the aircraft's way and by the track's. Both are counted by one clock in
metres, which goes on with every look by the way of the aircraft and by that of the fastest track. A track that is far off is asked again
when the clock has gone on by what it was short of. So each look costs what is near, and whatever a sensor sees it would see without.
"""

import math
from bisect import insort
from heapq import heappop, heappush

from testbed.core.frames import Vec3
from testbed.flight.traffic.bounds import bounds_of
from testbed.flight.traffic.track import Track, Traffic

Near = tuple[int, Track, tuple[Vec3, Vec3]]
WIDER, SPARE_M = 1.000001, 0.01  # rounding must not hide an obstacle: of a reach and of a speed, and of a distance
SURELY = 0.999  # of a way that is left: as long as that the clock is right
FAR_S = 0.2  # a track is far off from so many seconds of the fastest one on; below, it is asked at every look
SLOWEST_MPS = 1.0  # the clock goes on where nothing moves, too: an obstacle may appear


class Lookout:
    """Tracks around one aircraft. What was asked last is kept, and no answer depends on it: looks may come in any order."""

    def __init__(self, traffic: Traffic, reach_m: list[float]) -> None:
        """``reach_m``: from how far its centre is seen, of each track."""
        self.traffic = traffic
        bounds = [bounds_of(track) for track in traffic.tracks]
        self._fastest = WIDER * max([SLOWEST_MPS, *(each.top_mps for each in bounds if each)])
        far_m = FAR_S * self._fastest
        self._rows = [
            (track, WIDER * reach + SPARE_M, *((far_m, each.from_s, each.to_s) if each else (math.inf, 0.0, 0.0)))
            for track, reach, each in zip(traffic.tracks, reach_m, bounds, strict=True)
        ]
        self._near, self._far = list(range(len(self._rows))), list[tuple[float, int]]()  # asked at every look; and by the clock when next
        self._clock_m, self._time_s, self._pos = 0.0, 0.0, (0.0, 0.0, 0.0)

    def look(self, time_s: float, pos: Vec3) -> list[Near]:
        """In the order of the tracks, all that may be within reach: number, track, place and velocity."""
        clock_m = self._clock_m = self._clock_m + math.dist(pos, self._pos) + self._fastest * abs(time_s - self._time_s)
        self._time_s, self._pos = time_s, pos
        near, far = self._near, self._far
        while far and not far[0][0] > clock_m:  # a clock that is no number asks all
            insort(near, heappop(far)[1])
        found: list[Near] = []
        left: list[int] = []
        for k in near:
            track, reach_m, far_m, from_s, to_s = self._rows[k]
            moving = track.at(time_s)
            if moving is None:
                short_m = self._fastest * max(from_s - time_s, time_s - to_s)
            elif not (short_m := math.dist(moving[0], pos) - reach_m) > 0.0:
                found.append((k, track, moving))
                continue
            if short_m > far_m:
                heappush(far, (clock_m + SURELY * short_m, k))
                left.append(k)
        for k in left:
            near.remove(k)
        return found
