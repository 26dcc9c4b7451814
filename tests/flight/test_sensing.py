"""The truth sensor: who is in range, exactly as they are, whatever kind of track they are on."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from testbed.flight.plants.base import State
from testbed.flight.sensing import Seen, SensorContext
from testbed.flight.sensing.truth import Truth
from testbed.flight.traffic import Sampled, Traffic
from testbed.flight.traffic.straight import Straight

coordinate = st.floats(-200, 200)
vector = st.tuples(coordinate, coordinate, coordinate)


class Elsewhere(Sampled):
    """The same line, as a track of another kind."""

    def __init__(self, line: Straight) -> None:
        self.name, self.radius_m, self._line = line.name, line.radius_m, line

    def at(self, time_s: float):
        return self._line.at(time_s)


def context(range_m: float) -> SensorContext:
    return SensorContext(range_m, 60, np.random.default_rng(0))


@given(own=vector, places=st.lists(st.tuples(vector, vector), max_size=3), range_m=st.floats(1, 300), time_s=st.floats(0, 20))
def test_seen_is_what_is_within_range(own: tuple, places: list, range_m: float, time_s: float) -> None:
    lines = [Straight(f"O{k}", 5.0, pos, vel) for k, (pos, vel) in enumerate(places)]
    state, sensor = State(*own, *[0.0] * 17), Truth()
    within = tuple(body for body in Traffic(tuple(lines)).at(time_s) if math.dist(body.pos, own) <= range_m)
    for tracks in (lines, [Elsewhere(line) for line in lines]):
        memory, seen = sensor.sense(sensor.start(context(range_m)), time_s, state, Traffic(tuple(tracks)))
        assert seen == within
        assert all(isinstance(one, Seen) for one in seen)
        again, _ = sensor.sense(memory, time_s, state, Traffic(()))
        assert sensor.sense(again, time_s, state, Traffic(tuple(tracks)))[1] == within  # other traffic, the same sensor
