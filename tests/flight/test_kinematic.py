"""The paper's point: exact arrival, exact time, and the encounter of section 5.1."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from testbed import fly, measure
from testbed.core.units import G0_MPS2
from testbed.flight.plants.kinematic import coordinated
from testbed.flight.record import Outcome
from tests.plans import KINEMATIC, paper_obstacle, plan


def test_arrives_at_the_goal_in_length_over_speed() -> None:
    record = fly(plan(**KINEMATIC))
    assert record.outcome is Outcome.REACHED
    assert math.dist(record.columns["own.pos_enu_m"][-1], (500, 200, 100)) < 1e-6
    metrics = measure(record)
    assert abs(metrics.flight_time_s - record.paths[0].length_m / 50.0) <= 1.0 / 120.0
    assert metrics.cross_track_max_m < 1e-9
    assert metrics.schedule_error_s == pytest.approx(0.0, abs=1e-4)


@settings(max_examples=25, deadline=None)
@given(
    goal=st.tuples(*[st.floats(-800, 800)] * 2, st.floats(-100, 300)).filter(lambda p: math.hypot(*p) > 100),
    start=st.tuples(st.floats(-180, 180), st.floats(-60, 60)),
    end=st.tuples(st.floats(-180, 180), st.floats(-60, 60)),
    speed=st.floats(20, 120),
)
def test_arrives_on_any_route(goal: tuple, start: tuple, end: tuple, speed: float) -> None:
    route = {"start_enu_m": [0, 0, 0], "goal_enu_m": goal, "start_direction_deg": start, "goal_direction_deg": end}
    record = fly(plan(route=route, speed_mps=speed, terrain_z_m=-5000.0, **KINEMATIC))
    assert record.outcome is Outcome.REACHED, record.message
    crossing = measure(record).flight_time_s
    # a route may cross the goal's plane near the goal before it arrives; it never arrives late
    assert crossing <= record.paths[0].length_m / speed + 1.0 / 120.0 + 1e-9


def test_constant_speed_and_the_bank_of_a_steady_turn() -> None:
    """tan(bank) = V^2 / (g R) on a level circle, load factor 1/cos(bank)."""
    bank, load_factor = coordinated((50.0, 0.0, 0.0), (0.0, -(50.0**2) / 300.0, 0.0))
    assert math.tan(bank) == pytest.approx(50.0**2 / (G0_MPS2 * 300.0))
    assert load_factor == pytest.approx(1.0 / math.cos(bank))
    assert bank > 0.0, "a turn to the right is a positive bank"


@pytest.mark.parametrize(("reading", "threat"), [("as_printed", False), ("azimuth_106", True), ("direction_106_10", True)])
def test_the_readings_differ_in_the_threat(reading: str, threat: bool) -> None:
    record = fly(plan(obstacles=[paper_obstacle(reading)], **KINEMATIC))
    assert [event.decision for event in record.events] == (["replanned"] if threat else [])


def test_the_planner_keeps_the_sphere_clear_and_its_absence_does_not() -> None:
    with_planner, without = (
        measure(fly(plan(obstacles=[paper_obstacle()], method={"kind": kind}, **KINEMATIC))) for kind in ("scoam", "none")
    )
    assert with_planner.least_clearance_m + 25.0 == pytest.approx(27.25, abs=0.1)
    assert without.least_clearance_m + 25.0 == pytest.approx(8.4, abs=0.1)
    assert without.outcome == "collided"


def test_least_clearance_is_that_of_the_straight_lines_for_a_straight_route() -> None:
    """Closed form: own along +x at 50 m/s, obstacle along +y at 30 m/s that passes 8 m behind."""
    straight = {"start_enu_m": [0, 0, 0], "goal_enu_m": [600, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
    obstacle = {"name": "O", "radius_m": 5, "position_enu_m": [300, -188, 3], "speed_mps": 30, "direction_deg": [90, 0]}
    metrics = measure(fly(plan(route=straight, obstacles=[obstacle], method={"kind": "none"}, **KINEMATIC)))
    p, v = np.array([300.0, -188.0, 3.0]), np.array([-50.0, 30.0, 0.0])
    t = -(p @ v) / (v @ v)
    assert metrics.least_clearance_m == pytest.approx(np.linalg.norm(p + t * v) - 5.0, abs=1e-9)
    assert metrics.time_at_least_clearance_s == pytest.approx(t, abs=1e-9)


def test_steady_wind_changes_the_ground_speed_of_a_point_that_holds_airspeed() -> None:
    straight = {"start_enu_m": [0, 0, 0], "goal_enu_m": [600, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
    wind = {"wind": {"kind": "steady", "speed_mps": 10, "from_deg": 270}}
    tail = measure(fly(plan(route=straight, air=wind, **KINEMATIC)))
    hold = measure(fly(plan(route=straight, air=wind, speed_hold="groundspeed", **KINEMATIC)))
    assert tail.flight_time_s == pytest.approx(600 / 60, abs=1 / 120)
    assert hold.flight_time_s == pytest.approx(600 / 50, abs=1 / 120)
    assert hold.max_airspeed_mps == pytest.approx(40.0)
