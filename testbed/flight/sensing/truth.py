"""The sensor of the paper: the truth, within a range of the obstacle's centre or of its surface."""

import math
from typing import Literal, NamedTuple

from testbed.flight.plants.base import State, make
from testbed.flight.sensing.base import NOTHING, Seen, SensorContext
from testbed.flight.sensing.lookout import Lookout
from testbed.flight.traffic.track import Traffic

RangeTo = Literal["centre", "surface"]


class Memory(NamedTuple):
    """The range, and who of the traffic that was met last is near."""

    range_m: float
    lookout: Lookout | None = None


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
        """What ``traffic.at`` has within range. Most looks see nothing."""
        range_m, lookout = memory
        if lookout is None or lookout.traffic is not traffic:
            lookout = Lookout(traffic, [self.reach_m(range_m, track.radius_m, self._range_to) for track in traffic.tracks])
            memory = Memory(range_m, lookout)
        seen, pos = NOTHING, own[:3]
        for _, track, moving in lookout.look(time_s, pos):
            if math.dist(moving[0], pos) <= self.reach_m(range_m, track.radius_m, self._range_to):
                seen = (*seen, make(Seen, (track.name, track.radius_m, *moving, time_s, None)))
        return memory, seen
