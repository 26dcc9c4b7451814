import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from tests.vosc.draws import percent
from vosc import Obstacle, Own, cap, threat
from vosc.vec import azimuth_elevation


@pytest.mark.parametrize(("reading", "gamma_deg", "theta_r_deg"), [("azimuth_106", 22.75, 5.70), ("direction_106_10", 21.86, 3.84)])
def test_table_1(table_1, reading, gamma_deg, theta_r_deg):
    found = cap(*table_1(reading))
    assert math.degrees(found.half_angle_rad) == pytest.approx(gamma_deg, abs=0.005)
    assert math.degrees(found.elevation_rad) == pytest.approx(theta_r_deg, abs=0.005)


def test_direction_of_the_critical_velocity(table_1):
    found = cap(*table_1("azimuth_106"))
    assert np.degrees(azimuth_elevation(tuple(found.nearest_mps))) == pytest.approx([36.29, 17.08], abs=0.005)


def in_the_paper_s_words(own, obstacle):
    """Eq. 5-28 done naively with numpy: Rodrigues' rotation in the avoidance plane, law of cosines for the triangle of velocities."""
    vu, vo = np.array(own.vel_mps), np.array(obstacle.vel_mps)
    p, w = np.array(obstacle.pos_m) - np.array(own.pos_m), vu - vo
    alpha0 = math.asin(obstacle.radius_m / np.linalg.norm(p))
    alpha = math.acos(np.clip(p @ w / np.linalg.norm(p) / np.linalg.norm(w), -1, 1))
    axis = np.cross(p, w) / np.linalg.norm(np.cross(p, w))
    found = []
    for turn in (alpha0 - alpha, -alpha0 - alpha):
        q = w * math.cos(turn) + np.cross(axis, w) * math.sin(turn)
        q /= np.linalg.norm(q)
        c = math.cos(math.pi - math.acos(np.clip(vo @ q / np.linalg.norm(vo), -1, 1)))
        root = vo @ vo * c * c - (vo @ vo - vu @ vu)
        found.append(vo + (np.linalg.norm(vo) * c + math.sqrt(root)) * q)
    return found


component = st.floats(-1.0, 1.0)
direction = st.tuples(component, component, component).filter(lambda v: math.hypot(*v) > 0.1)


def sized(v, size):
    return tuple(size * x / math.hypot(*v) for x in v)


encounter = st.builds(
    lambda pos, d, own, vel, slow, r: (Own((1.0, -2.0, 3.0), sized(own, 50.0)), Obstacle(sized(pos, d), sized(vel, 50.0 * slow), r)),
    direction, st.floats(40.0, 300.0), direction, direction, st.floats(0.02, 0.98), st.floats(1.0, 34.0),
)  # fmt: skip


@given(encounter)
@percent(40)
def test_closed_form_equals_the_paper_s_steps(scene):
    own, obstacle = scene
    p, w = np.subtract(obstacle.pos_m, own.pos_m), np.subtract(own.vel_mps, obstacle.vel_mps)
    assume(np.linalg.norm(np.cross(p, w)) > 1e-3 * np.linalg.norm(p) * np.linalg.norm(w))
    near, far = in_the_paper_s_words(own, obstacle)
    found = cap(own, obstacle)
    np.testing.assert_allclose(found.nearest_mps, near, atol=1e-6)
    np.testing.assert_allclose(found.farthest_mps, far, atol=1e-6)
    middle = (near + far) / 2
    assert found.radius_mps == pytest.approx(np.linalg.norm(middle), abs=1e-6)
    assert found.half_angle_rad == pytest.approx(math.asin(min(1.0, np.linalg.norm(near - far) / 100.0)), abs=1e-6)
    assert found.radius_mps == pytest.approx(50.0 * math.cos(found.half_angle_rad), abs=1e-6)


@given(encounter)
@percent(40)
def test_critical_velocities_keep_the_speed_and_lie_on_the_cone(scene):
    own, obstacle = scene
    found = cap(own, obstacle)
    for velocity in (found.nearest_mps, found.farthest_mps):
        assert np.linalg.norm(velocity) == pytest.approx(50.0, rel=1e-12)
        answer = threat(Own(own.pos_m, velocity), obstacle)
        assert answer.alpha_rad == pytest.approx(answer.alpha0_rad, abs=1e-9)
        assert not math.isnan(found.azimuth_rad + found.elevation_rad)


def test_stationary_obstacle_has_the_cone_itself():
    found = cap(Own((0, 0, 0), (50, 1, 0)), Obstacle((0, 100, 0), (0, 0, 0), 50))
    assert found.half_angle_rad == pytest.approx(math.radians(30))
    assert (found.azimuth_rad, found.elevation_rad) == pytest.approx((math.pi / 2, 0.0))


def test_signs_of_azimuth_in_all_quadrants():
    for quadrant_deg in (45, 135, -45, -135):
        a = math.radians(quadrant_deg)
        pos = (100 * math.cos(a), 100 * math.sin(a), 0)
        found = cap(Own((0, 0, 0), (pos[0] / 2, pos[1] / 2 + 1, 3)), Obstacle(pos, (0, 0, 0), 20))
        assert math.degrees(found.azimuth_rad) == pytest.approx(quadrant_deg)


def test_head_on_turns_right():
    found = cap(Own((0, 0, 0), (50, 0, 0)), Obstacle((100, 0, 0), (-40, 0, 0), 25))
    assert found.nearest_mps[1] < 0.0
    assert found.nearest_mps[2] == 0.0
    np.testing.assert_allclose(found.farthest_mps, found.nearest_mps * (1, -1, 1), atol=1e-12)


def test_vertical_head_on_is_defined():
    found = cap(Own((0, 0, 0), (0, 0, 50)), Obstacle((0, 0, 100), (0, 0, -40), 25))
    assert np.linalg.norm(found.nearest_mps) == pytest.approx(50.0)
    assert found.nearest_mps[1] < 0.0


def test_aimed_at_the_centre_takes_the_plane_of_the_own_velocity_and_the_smaller_turn():
    own, p = np.array([40.0, 30.0, 0.0]), np.array([100.0, 0.0, 0.0])
    found = cap(Own((0, 0, 0), own), Obstacle(p, own - 0.5 * p, 25))
    assert found.nearest_mps[2] == pytest.approx(0.0, abs=1e-12)
    assert own @ found.nearest_mps > own @ found.farthest_mps


def test_no_relative_motion_has_a_cap():
    found = cap(Own((0, 0, 0), (30, 40, 0)), Obstacle((0, 0, 100), (30, 40, 0), 25))
    assert found is None or np.isfinite([found.radius_mps, found.half_angle_rad]).all()


def test_inside_has_no_cap():
    assert cap(Own((0, 0, 0), (50, 0, 0)), Obstacle((10, 0, 0), (0, 0, 0), 25)) is None


def test_on_the_sphere_the_cone_is_a_half_space():
    found = cap(Own((0, 0, 0), (50, 1, 0)), Obstacle((25, 0, 0), (10, 0, 0), 25))
    assert found.nearest_mps[0] == pytest.approx(10.0)
    assert found.farthest_mps[0] == pytest.approx(10.0)


def test_own_at_rest_has_no_cap():
    assert cap(Own((0, 0, 0), (0, 0, 0)), Obstacle((100, 0, 0), (-40, 0, 0), 25)) is None


def test_a_fast_obstacle_whose_generatrix_misses_has_no_cap():
    own = Own((0, 0, 0), (20, 0, 0))
    assert cap(own, Obstacle((0, 200, 0), (1, -80, 0), 10)) is not None
    assert cap(own, Obstacle((0, 200, 0), (0, 80, 0), 10)) is None
    assert cap(own, Obstacle((0, 30, 0), (19, -80, 0), 20)) is None


def test_a_fast_obstacle_takes_the_larger_root_of_eq_14():
    own, obstacle = Own((0, 0, 0), (20, 0, 0)), Obstacle((0, 200, 0), (1, -80, 0), 10)
    found = cap(own, obstacle)
    for velocity in (found.nearest_mps, found.farthest_mps):
        q = (velocity - np.array(obstacle.vel_mps)) / np.linalg.norm(velocity - np.array(obstacle.vel_mps))
        roots = np.roots([1.0, 2 * q @ np.array(obstacle.vel_mps), 1 + 80**2 - 400.0])
        assert np.linalg.norm(velocity - np.array(obstacle.vel_mps)) == pytest.approx(roots.real.max())
