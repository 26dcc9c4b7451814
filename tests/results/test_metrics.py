"""Metrics against hand-made records whose answers are known."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from testbed import fly, measure
from testbed.flight.record import FlightRecord
from testbed.results import quantities
from testbed.results.quantities import goal_crossing
from tests.plans import KINEMATIC, plan

STRAIGHT = {"start_enu_m": [0, 0, 0], "goal_enu_m": [600, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}


@pytest.fixture
def record() -> FlightRecord:
    return fly(plan(route=STRAIGHT, **KINEMATIC))


def changed(record: FlightRecord, **columns: np.ndarray) -> FlightRecord:
    return replace(record, columns=record.columns | columns)


def test_a_flight_past_the_goal_is_cut_at_its_plane(record: FlightRecord) -> None:
    """The same flight, flown 0.2 m further on each sample: the plane is crossed between the last two."""
    moved = changed(record, **{"own.pos_enu_m": record.columns["own.pos_enu_m"] + [0.2, 0.0, 0.0]})
    end, share = goal_crossing(moved)
    assert 0.0 < share < 1.0
    metrics = measure(moved)
    assert metrics.flight_time_s == pytest.approx(12.0 - 0.2 / 50.0, abs=1e-9)
    assert metrics.path_length_m == pytest.approx(600.0 - 0.2, abs=1e-9)
    assert end == len(moved.columns["time_s"]) - 2


def test_a_flight_that_comes_within_the_gate_behind_the_goals_plane_is_cut_at_the_plane(record: FlightRecord) -> None:
    """It crosses the plane 25 m aside and ends 12 m further on, where it is 20 m from the goal."""
    t = record.columns["time_s"]
    pos = np.column_stack([12.0 + 50.0 * t, np.full_like(t, 16.0), np.zeros_like(t)])
    pos[pos[:, 0] < 611.0, 1] = 25.0
    end, share = goal_crossing(changed(record, **{"own.pos_enu_m": pos}))
    assert 12.0 + 50.0 * (end + share) / record.plan.rates.plant_hz == pytest.approx(600.0, abs=1e-9)


def test_schedule_error_is_positive_when_late(record: FlightRecord) -> None:
    pos = record.columns["own.pos_enu_m"].copy()
    pos[:, 0] = 0.98 * pos[:, 0] + 12.0  # from 12 m on at 49 m/s: at the goal after 600 m where 588 m were planned
    late = measure(changed(record, **{"own.pos_enu_m": pos}))
    assert late.schedule_error_s == pytest.approx(12.0 - 588.0 / 50.0, abs=1e-6)


def test_cross_track_is_root_mean_square_and_maximum(record: FlightRecord) -> None:
    n = len(record.columns["time_s"])
    offset = np.where(np.arange(n) % 2 == 0, 3.0, 1.0)
    metrics = measure(changed(record, **{"path.cross_track_m": offset}))
    assert metrics.cross_track_max_m == 3.0
    assert metrics.cross_track_rms_m == pytest.approx(math.sqrt(np.mean(offset**2)), rel=1e-3)


def test_planned_clearance_is_the_clearance_of_a_point_on_schedule() -> None:
    obstacle = {"name": "O", "radius_m": 5, "position_enu_m": [300, -188, 3], "speed_mps": 30, "direction_deg": [90, 0]}
    metrics = measure(fly(plan(route=STRAIGHT, obstacles=[obstacle], method={"kind": "none"}, **KINEMATIC)))
    assert metrics.planned_clearance_m == pytest.approx(metrics.least_clearance_m, abs=1e-9)


def test_the_limits_that_were_reached_are_named() -> None:
    """Straight on nothing is; a turn of 60 m radius asks gtm_t2 for more bank and lift than it may have."""
    straight, tight = (
        measure(fly(plan(route=route, begin={"at_route_s_m": 0}, plant={"kind": "jsbsim"})))
        for route in (STRAIGHT, {"start_enu_m": [0, 0, 0], "start_direction_deg": [0, 0], "shape": {"kind": "circle", "radius_m": 60}})
    )
    assert straight.limits_hit == ""
    assert {"bank", "load_factor"} <= set(tight.limits_hit.split())
    assert straight.airspeed_rms_error_mps < 0.2
    assert straight.wind_along_std_mps == pytest.approx(0.0, abs=1e-9)


def test_gusts_along_the_flight_are_those_of_the_air(record: FlightRecord) -> None:
    wind = np.zeros_like(record.columns["own.pos_enu_m"])
    wind[:, 0] = 3.0 * np.sin(record.columns["time_s"] * 2 * math.pi)  # twelve whole periods along the flight
    assert measure(changed(record, **{"air.wind_enu_mps": wind})).wind_along_std_mps == pytest.approx(3.0 / math.sqrt(2.0), rel=1e-2)


def test_an_obstacle_that_is_never_there_does_not_hide_the_nearest() -> None:
    time_s, still = np.arange(4.0), np.zeros((4, 3))
    there = {"A": still + np.array([30.0, 0.0, 0.0]), "B": np.full((4, 3), np.nan)}
    columns = {"time_s": time_s, "own.pos_enu_m": still} | {f"obstacle.{name}.pos_enu_m": pos for name, pos in there.items()}
    plan = SimpleNamespace(obstacles=[SimpleNamespace(name=name, radius_m=10.0) for name in there])
    found = quantities.closest_approach(SimpleNamespace(columns=columns, plan=plan))
    assert (found.clearance_m, found.obstacle) == (20.0, "A")
