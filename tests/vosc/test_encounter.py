import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

from tests.vosc.draws import percent
from vosc import Obstacle, Own, threat
from vosc.encounter import closest_point, cone_margin


@pytest.mark.parametrize(
    ("reading", "alpha_deg", "is_threat"), [("as_printed", 16.79, False), ("azimuth_106", 6.24, True), ("direction_106_10", 7.02, True)]
)
def test_table_1(table_1, reading, alpha_deg, is_threat):
    answer = threat(*table_1(reading))
    assert math.degrees(answer.alpha_rad) == pytest.approx(alpha_deg, abs=0.005)
    assert math.degrees(answer.alpha0_rad) == pytest.approx(14.57, abs=0.005)
    assert answer.is_threat is is_threat


def test_table_1_as_printed_passes_at_28_7_m(table_1):
    answer = threat(*table_1("as_printed"))
    assert answer.miss_m == pytest.approx(28.7, abs=0.05)
    assert answer.time_to_cpa_s == pytest.approx(1.31, abs=0.005)


coordinate = st.floats(-300.0, 300.0)
vector = st.tuples(coordinate, coordinate, coordinate)
speed = st.floats(-60.0, 60.0)
velocity = st.tuples(speed, speed, speed)


@given(vector, velocity, vector, velocity, st.floats(1.0, 100.0))
@percent(40)
def test_agrees_with_two_straight_lines_flown(own_pos, own_vel, pos, vel, radius_m):
    p, w = np.subtract(pos, own_pos), np.subtract(own_vel, vel)
    if np.linalg.norm(w) < 1e-3:
        return_of_the_rest = threat(Own(own_pos, own_vel), Obstacle(pos, vel, radius_m))
        assert math.isfinite(return_of_the_rest.alpha_rad)
        return
    scale = 10.0 + 1000.0 / np.linalg.norm(w)
    flown = minimize_scalar(lambda t: float(((p - w * t) ** 2).sum()), bounds=(-scale, scale), method="bounded", options={"xatol": 1e-10})
    answer = threat(Own(own_pos, own_vel), Obstacle(pos, vel, radius_m))
    miss_m = float(np.linalg.norm(p - w * flown.x))
    assert answer.miss_m == pytest.approx(miss_m, abs=1e-5)
    assert answer.time_to_cpa_s * np.linalg.norm(w) == pytest.approx(flown.x * np.linalg.norm(w), abs=2e-3)
    assert np.linalg.norm(closest_point(Own(own_pos, own_vel), Obstacle(pos, vel, radius_m))) == pytest.approx(miss_m, abs=1e-5)
    if abs(miss_m - radius_m) > 1e-3 and abs(answer.time_to_cpa_s) > 1e-3:
        assert answer.is_threat == (miss_m < radius_m and flown.x > 0.0)


@given(vector, velocity, vector, velocity, st.floats(1.0, 100.0))
@percent(40)
def test_margin_is_the_angle_of_the_threat_test(own_pos, own_vel, pos, vel, radius_m):
    obstacle = Obstacle(pos, vel, radius_m)
    answer = threat(Own(own_pos, own_vel), obstacle)
    assert cone_margin(tuple(map(float, own_pos)), tuple(map(float, own_vel)), obstacle) == answer.alpha_rad - answer.alpha0_rad


extreme = st.floats(-1e30, 1e30)
extremes = st.tuples(extreme, extreme, extreme)


@given(extremes, extremes, extremes, extremes, st.floats(1e-30, 1e30))
@percent(40)
def test_never_nan(own_pos, own_vel, pos, vel, radius_m):
    answer = threat(Own(own_pos, own_vel), Obstacle(pos, vel, radius_m))
    numbers = [v for v in dataclasses.astuple(answer) if isinstance(v, float)]
    assert len(numbers) == 5
    assert not any(math.isnan(v) for v in numbers)


def test_inside_is_a_threat_only_while_closing():
    closing = threat(Own((0, 0, 0), (10, 0, 0)), Obstacle((5, 0, 0), (0, 0, 0), 20))
    leaving = threat(Own((0, 0, 0), (-10, 0, 0)), Obstacle((5, 0, 0), (0, 0, 0), 20))
    assert (closing.inside, closing.alpha0_rad, closing.is_threat) == (True, math.pi / 2, True)
    assert (leaving.inside, leaving.is_threat) == (True, False)
    assert leaving.time_to_cpa_s == pytest.approx(-0.5)


def test_at_the_centre():
    answer = threat(Own((5, 0, 0), (10, 0, 0)), Obstacle((5, 0, 0), (0, 0, 0), 20))
    assert (answer.alpha_rad, answer.time_to_cpa_s, answer.miss_m, answer.inside, answer.is_threat) == (math.pi / 2, 0.0, 0.0, True, False)


def test_exactly_on_the_sphere():
    obstacle = Obstacle((20, 0, 0), (0, 0, 0), 20)
    assert threat(Own((0, 0, 0), (1, 5, 0)), obstacle).is_threat
    assert not threat(Own((0, 0, 0), (-1, 5, 0)), obstacle).is_threat
    assert not threat(Own((0, 0, 0), (-1, 5, 0)), obstacle).inside


def test_no_relative_motion():
    answer = threat(Own((0, 0, 0), (10, 3, 1)), Obstacle((60, 80, 0), (10, 3, 1), 20))
    assert (answer.alpha_rad, answer.time_to_cpa_s, answer.miss_m, answer.is_threat) == (math.pi / 2, 0.0, 100.0, False)


def test_velocities_that_differ_by_rounding_count_as_equal():
    third = 1.0 / 3.0
    answer = threat(Own((0, 0, 0), (50 * third * 3, 0, 0)), Obstacle((100, 0, 0), (50 * (1 - 2**-52), 0, 0), 20))
    assert (answer.alpha_rad, answer.is_threat) == (math.pi / 2, False)


def test_head_on_and_stationary_and_own_at_rest():
    head_on = threat(Own((0, 0, 0), (50, 0, 0)), Obstacle((100, 0, 0), (-50, 0, 0), 25))
    assert (head_on.alpha_rad, head_on.miss_m, head_on.time_to_cpa_s, head_on.is_threat) == (0.0, 0.0, 1.0, True)
    assert threat(Own((0, 0, 0), (50, 0, 0)), Obstacle((100, 0, 0), (0, 0, 0), 25)).time_to_cpa_s == 2.0
    assert threat(Own((0, 0, 0), (0, 0, 0)), Obstacle((100, 0, 0), (-50, 0, 0), 25)).is_threat
    both_at_rest = threat(Own((0, 0, 0), (0, 0, 0)), Obstacle((100, 0, 0), (0, 0, 0), 25))
    assert not both_at_rest.is_threat


def test_a_threat_lies_ahead_and_within_the_horizon(table_1):
    own, obstacle = table_1("azimuth_106")
    time_s = threat(own, obstacle).time_to_cpa_s
    assert threat(own, obstacle, horizon_s=time_s * 1.001).is_threat
    assert not threat(own, obstacle, horizon_s=time_s).is_threat
    behind = Own(own.pos_m, tuple(2 * o - u for o, u in zip(obstacle.vel_mps, own.vel_mps, strict=True)))
    assert threat(behind, obstacle).miss_m == pytest.approx(threat(own, obstacle).miss_m)
    assert not threat(behind, obstacle).is_threat


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Own((0, 0), (1, 0, 0)), "Own.pos_m: give three numbers"),
        (lambda: Own((0, 0, math.nan), (1, 0, 0)), "Own.pos_m: all three numbers must be finite"),
        (lambda: Own((0, 0, 0), ("a", 0, 0)), "Own.vel_mps: give three numbers"),
        (lambda: Own((0, 0, 0), 5.0), "Own.vel_mps: give three numbers"),
        (lambda: Obstacle((0, 0, 0), (math.inf, 0, 0), 5), "Obstacle.vel_mps: all three"),
        (lambda: Obstacle((0, 0, 0), (1, 0, 0), 0.0), "Obstacle.radius_m: give a finite radius above 0"),
        (lambda: Obstacle((0, 0, 0), (1, 0, 0), -3.0), "Obstacle.radius_m"),
        (lambda: Obstacle((0, 0, 0), (1, 0, 0), math.nan), "Obstacle.radius_m"),
        (lambda: Obstacle((0, 0, 0), (1, 0, 0), None), "Obstacle.radius_m: give one number"),
        (lambda: threat(Own((0, 0, 0), (1, 0, 0)), Obstacle((9, 0, 0), (1, 0, 0), 1), 0.0), "horizon_s"),
        (lambda: threat(Own((0, 0, 0), (1, 0, 0)), Obstacle((9, 0, 0), (1, 0, 0), 1), math.nan), "horizon_s"),
    ],
)
def test_bad_input_says_what_to_do(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_values_are_frozen_and_take_any_three_floats():
    own = Own(np.array([1, 2, 3]), [4, 5, 6])
    assert own == Own((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))
    with pytest.raises(dataclasses.FrozenInstanceError):
        own.pos_m = (0, 0, 0)
