"""The sensor of the paper: the truth, within a range of the obstacle's centre or of its surface."""

import math
from typing import Literal, NamedTuple

from testbed.flight.plants.base import State, make
from testbed.flight.sensing.base import NOTHING, Seen, SensorContext
from testbed.flight.traffic.straight import Straight
from testbed.flight.traffic.track import Track, Traffic

WIDER = 1.000001  # of a squared range: rounding must not hide an obstacle
Row = tuple[Track, float, float, float, float, float, float, float, float]
RangeTo = Literal["centre", "surface"]


class Memory(NamedTuple):
    """The range, the traffic that was met first, and a row for each of its tracks: from how far its centre is seen, the square of that
    and a little more, a line's place at time 0 and its velocity, else NaN.
    """

    range_m: float
    traffic: Traffic | None = None
    rows: tuple[Row, ...] = ()


class Truth:
    """Every obstacle within range, as it is. ``range_to``: the range counts to the sphere's centre (the paper), or to its surface."""

    def __init__(self, range_to: RangeTo = "centre") -> None:
        self._range_to = range_to

    @staticmethod
    def reach_m(range_m: float, radius_m: float, range_to: RangeTo = "centre") -> float:
        """From how far, to the centre, a sphere of that radius is seen."""
        return range_m + radius_m if range_to == "surface" else range_m

    def start(self, context: SensorContext) -> Memory:
        return Memory(context.range_m)

    def sense(self, memory: Memory, time_s: float, own: State, traffic: Traffic) -> tuple[Memory, tuple[Seen, ...]]:
        """What ``traffic.at`` has within range. Most looks see nothing: a line that is far away is passed over in half a microsecond."""
        _, known, rows = memory
        if known is not traffic:
            rows = tuple(self._row(track, memory.range_m) for track in traffic.tracks)
            memory = Memory(memory.range_m, traffic, rows)
        seen = NOTHING
        x, y, z = pos = own[:3]
        for track, reach_m, wide2, cx, cy, cz, ux, uy, uz in rows:
            px, py, pz = cx + ux * time_s - x, cy + uy * time_s - y, cz + uz * time_s - z
            if px * px + py * py + pz * pz > wide2:
                continue
            moving = track.at(time_s)
            if moving is not None and math.dist(moving[0], pos) <= reach_m:
                seen = (*seen, make(Seen, (track.name, track.radius_m, *moving, time_s, None)))
        return memory, seen

    def _row(self, track: Track, range_m: float) -> Row:
        """NaN is never too far away: a track that is no line is always asked."""
        reach_m = self.reach_m(range_m, track.radius_m, self._range_to)
        reach = (track, reach_m, WIDER * reach_m**2)
        return (*reach, *track.pos, *track.vel) if isinstance(track, Straight) else (*reach, *(math.nan,) * 6)
