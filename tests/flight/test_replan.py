"""The planner's decisions: every kind is recorded, once per new threat, and the quick look never hides a threat."""

import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from testbed import fly, measure
from testbed.flight.planning.rejoin import resized
from testbed.flight.planning.watch import Watch
from testbed.flight.plants.base import State
from testbed.flight.sensing import Seen
from tests.plans import KINEMATIC, paper_obstacle, plan
from vosc import Obstacle, Own, threat

STRAIGHT = {"start_enu_m": [0, 0, 0], "goal_enu_m": [900, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
coordinate = st.floats(-300, 300)
vector = st.tuples(coordinate, coordinate, coordinate)


def flown(*obstacles: dict, **changes: object):
    return fly(plan(route=STRAIGHT, obstacles=list(obstacles), **(KINEMATIC | changes)))


def sphere(name: str, position: list[float], speed: float, direction: list[float], radius: float = 20.0) -> dict:
    return {"name": name, "radius_m": radius, "position_enu_m": position, "speed_mps": speed, "direction_deg": direction}


@given(
    own=vector, velocity=vector, centre=vector, other=vector, radius=st.floats(0.1, 200), swell=st.floats(0, 50), time_s=st.floats(0, 20)
)
@example((0.0, 0.0, 0.0), (1e-200, 0.0, 0.0), (100.0, 0.0, 0.0), (0.0, 0.0, 0.0), 20.0, 0.0, 0.0)  # a speed whose square is zero
def test_the_watch_never_hides_a_threat(
    own: tuple, velocity: tuple, centre: tuple, other: tuple, radius: float, swell: float, time_s: float
) -> None:
    seen = Seen("O", radius, centre, other, time_s)
    before = Seen("O", radius, seen.at(time_s - 2.0), other, time_s - 2.0)  # by a sensor that is late
    state = State(*own, *velocity, *[0.0] * 14)
    if threat(Own(own, velocity), Obstacle(centre, other, radius + swell)).is_threat:
        assert Watch(swell).alarmed((), time_s, state, [seen])
    if threat(Own(own, velocity), Obstacle(before.at(time_s), other, radius + swell)).is_threat:
        assert Watch(swell).alarmed((), time_s, state, [before])
    assert not Watch(swell).alarmed((), time_s, state, [])  # out of sight
    assert not Watch(swell).alarmed({"O"}, time_s, state, [seen])  # answered already


def test_each_new_threat_is_answered_once() -> None:
    """Two head-on obstacles, one after the other, far enough apart to be met one by one."""
    record = flown(sphere("near", [300, 4, 0], 10, [180, 0]), sphere("far", [800, 0, 6], 2, [180, 0]))
    assert [event.obstacle for event in record.events] == ["near", "far"]
    assert [event.decision for event in record.events] == ["replanned", "replanned"]
    assert len(record.paths) == 3
    assert measure(record).replans == 2


def test_no_method_is_a_decision_too() -> None:
    (event,) = flown(sphere("O", [300, 4, 0], 10, [180, 0]), method={"kind": "none"}).events
    assert event.decision == "none"
    assert math.isnan(event.deflection_rad)


@pytest.mark.parametrize(
    ("obstacle", "rule", "decision"),
    [
        (sphere("O", [300, 2, 0], 0, [0, 0]), "paper_4_3_2", "no_insertion_point"),  # t = (d - R) / 0
        (sphere("O", [-50.4, -54.7, 0], 80, [20, 0]), "arrival", "undefined"),  # faster: a generatrix misses the velocity sphere
        (sphere("O", [-10, 2, 0], 60, [0, 0]), "arrival", "inside"),
    ],
)
def test_what_cannot_be_planned_is_recorded(obstacle: dict, rule: str, decision: str) -> None:
    record = flown(obstacle, replan={"time_rule": rule})
    (event,) = record.events
    assert event.decision == decision
    assert len(record.paths) == 1
    assert all(math.isnan(x) for x in event.insertion_enu_m)
    assert record.outcome.value == "collided"


def test_beyond_the_range_nothing_is_seen() -> None:
    record = flown(sphere("O", [300, 0, 0], 10, [180, 0]), sensor={"range_m": 150})
    event = record.events[0]
    assert 149.0 < math.dist(event.own_pos_enu_m, event.obstacle_pos_enu_m) <= 150.0


def test_a_threat_beyond_the_horizon_waits() -> None:
    record = flown(sphere("O", [600, 0, 0], 10, [180, 0]), sensor={"range_m": 1000}, replan={"horizon_s": 2.0})
    assert record.events[0].time_to_cpa_s == pytest.approx(2.0, abs=0.05)


def test_the_paper_s_time_rule() -> None:
    event = fly(plan(obstacles=[paper_obstacle()], replan={"time_rule": "paper_4_3_2"}, **KINEMATIC)).events[0]
    distance = math.dist(event.own_pos_enu_m, event.obstacle_pos_enu_m)
    assert event.insertion_time_s == pytest.approx((distance - 25.0) / 40.0)


def test_resized() -> None:
    assert resized((3.0, 0.0, 4.0), 10.0) == pytest.approx((6.0, 0.0, 8.0))
