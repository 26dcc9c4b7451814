"""What an encounter was, and whether the radius was kept: against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from testbed import fly, measure
from testbed.flight.record import TOUCH_M, Outcome, kept_and_flew_on, kept_clear
from testbed.results.measured import Encounter, encounter
from tests.plans import KINEMATIC, plan

STRAIGHT = {"start_enu_m": [0, 0, 0], "goal_enu_m": [600, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
CROSSING = {"name": "O", "radius_m": 20, "position_enu_m": [300, -180, 3], "speed_mps": 30, "direction_deg": [90, 0]}


def flown(**changes: object):
    return fly(plan(**({"route": STRAIGHT, "obstacles": [CROSSING], "method": {"kind": "none"}} | KINEMATIC | changes)))


def test_a_crossing_at_right_angles_without_a_decision_is_that_of_the_start():
    """Nothing comes within a range of 1 m: the straight lines of the start, (300, -180, 3) away, closing at (50, -30, 0)."""
    metrics = measure(flown(sensor={"kind": "truth", "range_m": 1}))
    assert math.isnan(metrics.trigger_time_s)
    away, moving = np.array([300.0, -180.0, 3.0]), np.array([50.0, -30.0, 0.0])
    assert metrics.encounter_radius_m == 20.0
    assert metrics.encounter_speed_mps == pytest.approx(30.0)
    assert metrics.encounter_crossing_deg == pytest.approx(90.0)
    assert metrics.encounter_closing_mps == pytest.approx(away @ moving / np.linalg.norm(away))
    assert metrics.encounter_miss_m == pytest.approx(np.linalg.norm(np.cross(away, moving)) / np.linalg.norm(moving))
    assert metrics.encounter_miss_m - 20.0 == pytest.approx(metrics.least_clearance_m, abs=1e-6)  # both do fly straight on


def test_with_a_decision_the_encounter_is_that_of_its_obstacle_then():
    """A nearer obstacle flies beside, no threat; the one that is decided about comes head on."""
    beside = {"name": "A", "radius_m": 1, "position_enu_m": [0, 12, 0], "speed_mps": 50, "direction_deg": [0, 0]}
    ahead = {"name": "B", "radius_m": 10, "position_enu_m": [500, 5, 0], "speed_mps": 40, "direction_deg": [180, 0]}
    metrics = measure(flown(obstacles=[beside, ahead], method={"kind": "scoam"}, sensor={"kind": "truth", "range_m": 100}))
    assert metrics.trigger_time_s > 0.0
    assert metrics.encounter_radius_m == 10.0
    assert metrics.encounter_crossing_deg == pytest.approx(180.0, abs=1e-3)
    assert metrics.encounter_miss_m == pytest.approx(5.0, abs=1e-3)
    assert 89.0 < metrics.encounter_closing_mps < 90.0


def test_without_obstacles_there_is_no_encounter_and_nothing_to_keep():
    metrics = measure(flown(obstacles=[]))
    assert metrics.kept_clear is None
    assert math.isnan(metrics.encounter_radius_m)
    assert math.isnan(metrics.encounter_miss_m)


def test_an_outcome_does_not_hide_a_collision():
    through = flown(obstacles=[CROSSING | {"radius_m": 40, "position_enu_m": [300, -180, 0]}])
    assert through.outcome == Outcome.COLLIDED
    for outcome in (Outcome.COLLIDED, Outcome.HIT_GROUND, Outcome.TIMED_OUT):
        assert measure(replace(through, outcome=outcome)).kept_clear is False
    assert measure(replace(flown(), outcome=Outcome.HIT_GROUND)).kept_clear is (measure(flown()).least_clearance_m >= 0.0)


@pytest.mark.parametrize(
    ("clearance_m", "kept"), [(3.0, True), (0.0, True), (-1e-9, True), (-TOUCH_M, True), (-1.1 * TOUCH_M, False), (math.nan, None)]
)
def test_a_touch_is_no_collision_and_a_flight_that_hit_the_ground_did_not_fly_on(clearance_m, kept):
    assert kept_clear(clearance_m) is kept
    assert kept_and_flew_on(Outcome.REACHED, clearance_m) is (kept is True)
    assert not kept_and_flew_on("hit_ground", clearance_m)


vectors = st.tuples(*[st.floats(-300.0, 300.0)] * 3).map(np.array)


@given(vectors, vectors, vectors, vectors)
def test_closing_is_the_rate_of_the_distance_and_miss_the_least_of_the_lines(own_pos, own_vel, pos, vel):
    met = encounter(own_pos, own_vel, pos, vel, 5.0)

    def distance(t):
        return np.linalg.norm(pos + vel * t - own_pos - own_vel * t)

    if distance(0.0) > 1.0:
        assert met.closing_mps == pytest.approx(-(distance(1e-4) - distance(-1e-4)) / 2e-4, abs=2e-2, rel=1e-3)
    assert all(met.miss_m <= distance(t) * (1 + 1e-9) + 1e-6 for t in np.linspace(-20.0, 20.0, 81))
    assert math.isnan(met.crossing_deg) or 0.0 <= met.crossing_deg <= 180.0


def test_a_state_that_is_no_number_has_no_encounter():
    still = np.zeros(3)
    assert encounter(np.full(3, np.nan), still, still, still, 5.0)[0] != 5.0
    assert math.isnan(encounter(still, still, still, still, 5.0).closing_mps)
    assert math.isnan(encounter(still, still, np.ones(3), still, 5.0).crossing_deg)
    assert isinstance(encounter(still, still, np.ones(3), still, 5.0), Encounter)
