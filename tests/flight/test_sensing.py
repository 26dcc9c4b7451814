"""The truth sensor: who is in range, exactly as they are, whatever kind of track they are on; and what no other sensor may answer."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from testbed.flight.fly import make_sensor
from testbed.flight.plants.base import State
from testbed.flight.sensing import Seen, SensorContext
from testbed.flight.sensing.own import OwnSensor
from testbed.flight.sensing.truth import Truth
from testbed.flight.traffic import Sampled, Traffic
from testbed.flight.traffic.straight import Straight
from tests.plans import plan

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


NOW_S, HERE = 2.0, State(*[0.0] * 20)
LINE = Straight("O", 5.0, (50.0, 0.0, 0.0), (-10.0, 0.0, 0.0))
GOOD = Seen("O", 5.0, (30.0, 0.0, 0.0), (-10.0, 0.0, 0.0), NOW_S)


class Answers:
    """Says what it was made to say; a function is asked with the traffic."""

    def __init__(self, answer: Any) -> None:
        self._answer = answer

    def start(self, context: SensorContext) -> None: ...

    def sense(self, memory: Any, time_s: float, own: State, traffic: Traffic) -> Any:  # noqa: ARG002
        return self._answer(traffic) if callable(self._answer) else self._answer


def look(answer: Any) -> Any:
    return OwnSensor("mine:Eye", Answers(answer)).sense(None, NOW_S, HERE, Traffic((LINE,)))


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (None, "not None"),
        ((GOOD,), "not (Body("),
        ((None, None), "not (memory, None)"),
        ((None, (one for one in [GOOD])), "not (memory, <generator"),
        ((None, GOOD), "not (memory, Body("),
        ((None, ("O",)), "it is no Seen"),
        ((None, (GOOD._replace(name=3),)), "its name is no text"),
        ((None, (GOOD, GOOD)), "two of the same name: O, O"),
        ((None, (GOOD._replace(pos=(math.nan, 0.0, 0.0)),)), "three finite numbers"),
        ((None, (GOOD._replace(pos=None),)), "three finite numbers"),
        ((None, (GOOD._replace(vel=(1.0, 2.0)),)), "three finite numbers"),
        ((None, (GOOD._replace(radius_m=0.0),)), "radius_m is a number above 0"),
        ((None, (GOOD._replace(radius_m=math.nan),)), "radius_m is a number above 0"),
        ((None, (GOOD._replace(time_s=math.inf),)), "time_s is a finite number"),
        ((None, (GOOD._replace(time_s=NOW_S + 0.1),)), "later than now, 2 s"),
    ],
)
def test_what_a_sensor_of_one_s_own_may_not_answer_is_refused_in_words(answer: Any, words: str) -> None:
    with pytest.raises(ValueError, match=r"the sensor mine:Eye must return \(memory, tuple of Seen\), not ") as refused:
        look(answer)
    assert words in str(refused.value)


def test_what_a_sensor_of_one_s_own_may_answer_is_taken_as_it_is() -> None:
    assert look((7, [GOOD])) == (7, (GOOD,))
    assert look((7, ())) == (7, ())
    assert look(lambda traffic: (7, traffic.at(NOW_S))) == (7, (GOOD,))
    assert look(lambda traffic: (7, traffic.at(NOW_S - 1.0)))[1][0].pos == (40.0, 0.0, 0.0)


@pytest.mark.parametrize(
    "asked", [lambda traffic: traffic.at(NOW_S + 0.5), lambda traffic: traffic.tracks[0].sampled(np.array([0.0, NOW_S + 0.5]))]
)
def test_no_sensor_of_one_s_own_sees_what_is_to_come(asked: Any) -> None:
    with pytest.raises(ValueError, match=r"asks where O is at 2\.5 s, but it is 2 s"):
        look(lambda traffic: (None, asked(traffic)))


def test_the_sensor_that_is_built_in_is_asked_without_a_go_between() -> None:
    assert type(make_sensor(plan())) is Truth
