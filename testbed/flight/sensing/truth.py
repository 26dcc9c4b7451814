"""The sensor of the paper: the truth, within a range of the obstacle's centre."""

import math

from testbed.flight.plants.base import State, make
from testbed.flight.sensing.base import NOTHING, Seen, SensorContext
from testbed.flight.traffic.track import Traffic


class Truth:
    """Every obstacle whose centre is within range, as it is. Its memory is that range."""

    def start(self, context: SensorContext) -> float:
        return context.range_m

    def sense(self, memory: float, time_s: float, own: State, traffic: Traffic) -> tuple[float, tuple[Seen, ...]]:
        """``traffic.at``, written out: most looks see nothing, and this is asked 60 times a second."""
        seen = NOTHING
        pos = own[:3]
        for track in traffic.tracks:
            moving = track.at(time_s)
            if moving is not None and math.dist(moving[0], pos) <= memory:
                seen = (*seen, make(Seen, (track.name, track.radius_m, *moving, time_s)))
        return memory, seen
