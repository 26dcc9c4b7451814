import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from tests.vosc.draws import percent
from vosc import Obstacle, Own, insertion_point
from vosc.insertion import major_obstacle


def test_single_case_reproduces_the_printed_point(table_1):
    found = insertion_point(*table_1("direction_106_10"))
    np.testing.assert_allclose(found.point_m, (226.34, 159.56, 79.05), atol=0.5)
    assert found.time_s == pytest.approx(1.765, abs=0.01)


def test_reading_azimuth_106_misses_the_printed_height_only(table_1):
    found = insertion_point(*table_1("azimuth_106"))
    np.testing.assert_allclose(found.point_m, (226.4, 159.9, 82.7), atol=0.1)


def test_multiple_case_reproduces_the_printed_point():
    a, e = math.radians(106.5), math.radians(11.5)
    own = Own((162, 101, 64.3), (50 * math.cos(math.radians(24.7)), 50 * math.sin(math.radians(24.7)), 0))
    own = Own(own.pos_m, tuple(50 * v / math.hypot(*own.vel_mps) for v in own.vel_mps))
    vel = (35 * math.cos(e) * math.cos(a), 35 * math.cos(e) * math.sin(a), 35 * math.sin(e))
    np.testing.assert_allclose(insertion_point(own, Obstacle((254, 63.8, 59.8), vel, 25)).point_m, (229, 148, 77.6), atol=0.5)


number = st.floats(-60.0, 60.0)
vector = st.tuples(number, number, number)


@given(vector, vector, vector, vector, st.floats(1.0, 30.0), st.floats(1.0, 2.0))
@percent(50)
def test_arrival_is_the_first_root_found_by_scanning(own_pos, own_vel, pos, vel, radius_m, k):
    own, obstacle = Own(own_pos, own_vel), Obstacle(pos, vel, radius_m)
    found = insertion_point(own, obstacle, k)
    vu, vo = np.linalg.norm(own_vel), np.linalg.norm(vel)
    if vo < 1.0 or vu < 1.0:
        return

    def late(t):
        t = np.asarray(t)[..., None]
        return np.linalg.norm(np.array(pos) + np.array(vel) * (t + k * radius_m / vo) - np.array(own_pos), axis=-1) - vu * t[..., 0]

    if found is not None:
        assert late(found.time_s) == pytest.approx(0.0, abs=1e-6 * (1.0 + vu * found.time_s))
        np.testing.assert_allclose(found.point_m, np.array(pos) + np.array(vel) * (found.time_s + k * radius_m / vo), atol=1e-6)
    until = found.time_s * 0.999 if found is not None else 50.0
    times = np.linspace(0.0, until, 400)
    assert (late(times) > -1e-6 * (1.0 + vu * times)).all()  # no earlier root
    if found is None and vo < vu * 0.99:
        pytest.fail("a slower obstacle can always be reached")
    if found is not None and vo < 0.9 * vu:
        again = brentq(late, 0.0, 100.0 * (1.0 + found.time_s))
        assert again == pytest.approx(found.time_s, rel=1e-6, abs=1e-9)


def test_time_rule_of_section_4_3_2(table_1):
    own, obstacle = table_1("direction_106_10")
    found = insertion_point(own, obstacle, time_rule="paper_4_3_2")
    distance_m = math.dist(own.pos_m, obstacle.pos_m)
    assert found.time_s == pytest.approx((distance_m - 25) / 40)
    step = np.array(found.point_m) - np.array(obstacle.pos_m)
    np.testing.assert_allclose(step, np.array(obstacle.vel_mps) * (found.time_s + 31.25 / 40), atol=1e-9)


def test_running_away_has_no_insertion_point():
    assert insertion_point(Own((0, 0, 0), (20, 0, 0)), Obstacle((50, 0, 0), (40, 0, 0), 5)) is None


def test_equal_speeds_are_a_linear_equation():
    found = insertion_point(Own((0, 0, 0), (40, 0, 0)), Obstacle((100, 0, 0), (-40, 0, 0), 8), k=1.25)
    assert found.time_s == pytest.approx(90 / 80)
    assert insertion_point(Own((0, 0, 0), (40, 0, 0)), Obstacle((100, 0, 0), (0, 40, 0), 8)) is None


def test_stationary_obstacle_is_passed_abeam_on_the_side_of_the_track():
    found = insertion_point(Own((0, 0, 0), (50, 0, 0)), Obstacle((100, 5, 0), (0, 0, 0), 20))
    np.testing.assert_allclose(found.point_m, (100, -20, 0), atol=1e-12)
    assert found.time_s == pytest.approx(math.hypot(100, 20) / 50)


def test_stationary_obstacle_dead_ahead_is_passed_on_its_right():
    np.testing.assert_allclose(insertion_point(Own((0, 0, 0), (50, 0, 0)), Obstacle((100, 0, 0), (0, 0, 0), 20)).point_m, (100, -25, 0))


def test_stationary_obstacle_has_no_point_by_the_rule_of_4_3_2():
    assert insertion_point(Own((0, 0, 0), (50, 0, 0)), Obstacle((100, 5, 0), (0, 0, 0), 20), time_rule="paper_4_3_2") is None


def test_inside_has_no_point_by_the_rule_of_4_3_2():
    assert insertion_point(Own((0, 0, 0), (50, 0, 0)), Obstacle((10, 5, 0), (0, 9, 0), 20), time_rule="paper_4_3_2") is None


def test_own_at_rest_has_none():
    assert insertion_point(Own((0, 0, 0), (0, 0, 0)), Obstacle((100, 5, 0), (0, 0, 0), 20)) is None
    assert insertion_point(Own((0, 0, 0), (0, 0, 0)), Obstacle((100, 5, 0), (3, 0, 0), 20)) is None


@pytest.mark.parametrize(
    ("options", "message"), [({"k": 0.5}, "k: give"), ({"k": math.nan}, "k: give"), ({"time_rule": "soon"}, "time_rule: 'arrival'")]
)
def test_bad_options_say_what_to_do(table_1, options, message):
    with pytest.raises(ValueError, match=message):
        insertion_point(*table_1("azimuth_106"), **options)


def test_major_obstacle_is_the_one_with_the_least_time_of_section_4_3_2():
    own = Own((0, 0, 0), (50, 0, 0))
    near, fast, still = Obstacle((60, 0, 0), (0, 10, 0), 20), Obstacle((200, 0, 0), (-90, 0, 0), 20), Obstacle((30, 0, 0), (0, 0, 0), 5)
    assert major_obstacle(own, [near, fast, still]) == (1, 2.0)
    assert major_obstacle(own, [near, still]) == (0, 4.0)
    assert major_obstacle(own, [still]) is None
    assert major_obstacle(own, []) is None


def test_behind_the_obstacle_as_the_sentence_says(table_1):
    own, obstacle = table_1("direction_106_10")
    ahead, behind = insertion_point(own, obstacle), insertion_point(own, obstacle, side="behind")
    course = np.array(obstacle.vel_mps) / np.linalg.norm(obstacle.vel_mps)
    for found, sign in ((ahead, 1.0), (behind, -1.0)):  # the obstacle's centre is k R from the point when the aircraft is there
        centre = np.array(obstacle.pos_m) + found.time_s * np.array(obstacle.vel_mps)
        np.testing.assert_allclose(found.point_m - centre, sign * 1.25 * 25 * course, atol=1e-9)
        assert np.linalg.norm(found.point_m - np.array(own.pos_m)) == pytest.approx(50 * found.time_s)


def test_overtaken_from_behind_the_first_time_lies_behind():
    own, obstacle = Own((0, 0, 0), (50, 0, 0)), Obstacle((-150, 0, 0), (80, 0, 0), 25)
    smallest, forward = insertion_point(own, obstacle), insertion_point(own, obstacle, root="forward")
    # on one line: -150 + 31.25 + 80 t = -50 t, or 50 t
    assert (smallest.time_s, smallest.point_m[0]) == pytest.approx((118.75 / 130, -50 * 118.75 / 130))
    assert (forward.time_s, forward.point_m[0]) == pytest.approx((118.75 / 30, 50 * 118.75 / 30))
    assert insertion_point(own, Obstacle((-150, 0, 0), (30, 0, 0), 25), root="forward") is None
