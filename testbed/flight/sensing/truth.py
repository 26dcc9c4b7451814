"""The sensor of the paper: the truth, within a range of the obstacle's centre."""

import math
from typing import NamedTuple

from testbed.flight.plants.base import State, make
from testbed.flight.sensing.base import NOTHING, Seen, SensorContext
from testbed.flight.traffic.straight import Straight
from testbed.flight.traffic.track import Track, Traffic

WIDER = 1.000001  # of a squared range: rounding must not hide an obstacle
Row = tuple[Track, float, float, float, float, float, float]


class Memory(NamedTuple):
    """The range, the traffic that was met first, and a row for each of its tracks: a line's place at time 0 and its velocity, else NaN."""

    range_m: float
    wide2: float
    traffic: Traffic | None = None
    rows: tuple[Row, ...] = ()


class Truth:
    """Every obstacle whose centre is within range, as it is."""

    def start(self, context: SensorContext) -> Memory:
        return Memory(context.range_m, WIDER * context.range_m**2)

    def sense(self, memory: Memory, time_s: float, own: State, traffic: Traffic) -> tuple[Memory, tuple[Seen, ...]]:
        """What ``traffic.at`` has within range. Most looks see nothing: a line that is far away is passed over in half a microsecond."""
        range_m, wide2, known, rows = memory
        if known is not traffic:
            rows = tuple(_row(track) for track in traffic.tracks)
            memory = Memory(range_m, wide2, traffic, rows)
        seen = NOTHING
        x, y, z = pos = own[:3]
        for track, cx, cy, cz, ux, uy, uz in rows:
            px, py, pz = cx + ux * time_s - x, cy + uy * time_s - y, cz + uz * time_s - z
            if px * px + py * py + pz * pz > wide2:
                continue
            moving = track.at(time_s)
            if moving is not None and math.dist(moving[0], pos) <= range_m:
                seen = (*seen, make(Seen, (track.name, track.radius_m, *moving, time_s)))
        return memory, seen


def _row(track: Track) -> Row:
    """NaN is never too far away: a track that is no line is always asked."""
    return (track, *track.pos, *track.vel) if isinstance(track, Straight) else (track, *(math.nan,) * 6)
