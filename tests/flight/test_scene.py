"""The stage: the original path, the level rotation, where flights begin, and when obstacles are where."""

import numpy as np
import pytest

from testbed.campaign.words.settings import FlightPlan
from testbed.core.frames import unit_from_direction, wind_enu_from_compass
from testbed.core.units import DEG
from testbed.flight.air import ground_speed_along
from testbed.flight.scene import level_rotation, make_scene
from testbed.flight.traffic.track import least_clearance
from tests.plans import KINEMATIC, paper_obstacle, plan


def scene(a_plan: FlightPlan):
    return make_scene(a_plan)


def test_the_original_path_passes_the_trigger_point() -> None:
    route = scene(plan()).route
    assert route.length_m == pytest.approx(557.9, abs=0.05)
    s, distance = route.nearest(np.array([[162.0, 101.0, 64.3]]))
    assert s[0] == pytest.approx(202.5, abs=0.1)
    assert distance[0] < 0.1


def test_level_geometry_is_the_same_encounter_turned_about_the_start() -> None:
    """Distances between the route and the obstacle are kept at every instant; both end tangents are horizontal."""
    given, level = (scene(plan(geometry=kind, obstacles=[paper_obstacle()])) for kind in ("as_given", "level"))
    assert level.route.frame(0.0)[1][2] == pytest.approx(0.0, abs=1e-12)
    assert level.goal_tangent[2] == pytest.approx(0.0, abs=1e-12)
    s = np.linspace(0.0, given.route.length_m, 50)
    distances = [
        np.linalg.norm(one.route.sample(s)[0] - (np.asarray(one.tracks[0].pos) + np.outer(s / 50.0, one.tracks[0].vel)), axis=1)
        for one in (given, level)
    ]
    assert np.allclose(*distances, atol=1e-6)


def test_level_rotation_is_a_rotation_and_the_least_one() -> None:
    first, last = (np.array(unit_from_direction(*d)) for d in ((40.87, 26.13), (10.0, 2.84)))
    turn = level_rotation(first, last)
    assert np.allclose(turn @ turn.T, np.eye(3))
    assert np.linalg.det(turn) == pytest.approx(1.0)
    normal = np.cross(last, first)
    tilt = np.arccos(abs(normal[2]) / np.linalg.norm(normal))
    assert np.arccos((np.trace(turn) - 1) / 2) == pytest.approx(tilt)
    assert np.allclose((level_rotation(first, first) @ first)[2], 0.0)


def test_a_flight_begins_where_the_climb_is_low_enough() -> None:
    found = scene(plan(begin={"climb_at_most_deg": 18}))
    climb = np.arcsin(found.route.frame(found.begin_s_m)[1][2]) / DEG
    assert climb == pytest.approx(18.0, abs=0.01)
    assert found.planned_time_s == pytest.approx((found.route.length_m - found.begin_s_m) / 50.0)


def test_an_obstacle_is_at_its_place_when_the_plan_has_the_aircraft_at_the_point() -> None:
    for begin in ({"at_route_s_m": 0.0}, {"at_route_s_m": 100.0}):
        found = scene(plan(begin=begin, obstacles=[paper_obstacle()]))
        at = (found.route.nearest(np.array([[162.0, 101.0, 64.3]]))[0][0] - found.begin_s_m) / 50.0
        assert np.allclose(found.tracks[0].at(at)[0], (254, 63.6, 60.7), atol=1e-6)


def test_a_start_past_the_end_is_an_outcome_with_a_reason() -> None:
    from testbed import fly

    record = fly(plan(begin={"at_route_s_m": 900}, **KINEMATIC))
    assert record.outcome.value == "no_path"
    assert "past the end" in record.message


def test_wind_triangle() -> None:
    """Ground speed along a tangent: the air velocity that remains has the true airspeed."""
    wind = wind_enu_from_compass(12.0, 300.0)
    assert wind[0] > 0.0 > wind[1], "a wind from the north-west blows towards the south-east"
    for direction in ((0, 0), (90, 20), (200, -10)):
        tangent = unit_from_direction(*direction)
        ground = ground_speed_along(tangent, 50.0, wind)
        assert np.linalg.norm(ground * np.array(tangent) - wind) == pytest.approx(50.0)
    assert ground_speed_along((1.0, 0.0, 0.0), 10.0, (0.0, 20.0, 0.0)) == 0.0


def test_least_clearance_between_samples_against_a_fine_search() -> None:
    rng = np.random.default_rng(5)
    time_s = np.arange(6) * 0.5
    own, other = rng.normal(size=(6, 3)) * 20, rng.normal(size=(6, 3)) * 20
    fine = np.linspace(0.0, 2.5, 200_001)
    gap = np.column_stack([np.interp(fine, time_s, (own - other)[:, k]) for k in range(3)])
    found = least_clearance(time_s, own, other, 3.0)
    assert found.clearance_m == pytest.approx(np.linalg.norm(gap, axis=1).min() - 3.0, abs=1e-4)
    assert found.time_s == pytest.approx(fine[np.linalg.norm(gap, axis=1).argmin()], abs=1e-3)
