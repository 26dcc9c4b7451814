"""The aeroplanes: how they start, how they track, what they do when something is wrong."""

import math

import numpy as np
import pytest

from testbed import fly, measure
from testbed.core.units import DEG
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.plants.jsbsim_start import load_model, node, trim_level
from testbed.flight.record import FlightRecord, Outcome
from tests.plans import C172P, GTM, PAPER_ROUTE, paper_obstacle, plan

CASES = {"gtm_t2": GTM, "c172p": C172P}


@pytest.fixture(scope="module")
def calm() -> dict[str, FlightRecord]:
    return {name: fly(plan(**case)) for name, case in CASES.items()}


@pytest.mark.parametrize("name", CASES)
def test_tracks_the_original_path_in_calm_air(name: str, calm: dict[str, FlightRecord]) -> None:
    """The bound of the first flight: RMS 0.5 m, maximum 1.2 m."""
    metrics = measure(calm[name])
    assert metrics.outcome == "reached"
    assert metrics.cross_track_rms_m <= 0.5
    assert metrics.cross_track_max_m <= 1.2
    assert metrics.min_airspeed_mps > 45.0


@pytest.mark.parametrize("name", CASES)
def test_starts_on_the_path_with_its_track_climb_bank_and_load_factor(name: str, calm: dict[str, FlightRecord]) -> None:
    record = calm[name]
    columns = record.columns
    point, tangent, curvature = record.paths[0].curves[0].frame(measure(record).begin_s_m)
    velocity = columns["own.vel_enu_mps"][0]
    assert np.linalg.norm(columns["own.pos_enu_m"][0] - point) < 1e-6
    assert np.linalg.norm(velocity) == pytest.approx(50.0, abs=1e-6)
    assert np.allclose(velocity / 50.0, tangent, atol=1e-9)
    lift = 2500.0 * np.asarray(curvature) + [0, 0, 9.80665]
    lift -= (lift @ np.asarray(tangent)) * np.asarray(tangent)
    assert columns["own.load_factor"][0] == pytest.approx(np.linalg.norm(lift) / 9.80665, abs=0.03)
    assert abs(columns["own.beta_rad"][0]) < 0.01 * DEG


@pytest.mark.parametrize("name", CASES)
def test_position_is_the_integral_of_velocity(name: str, calm: dict[str, FlightRecord]) -> None:
    columns = calm[name].columns
    pos, vel, time_s = (columns[key] for key in ("own.pos_enu_m", "own.vel_enu_mps", "time_s"))
    integral = pos[0] + np.cumsum(0.5 * (vel[1:] + vel[:-1]) * np.diff(time_s)[:, None], axis=0)
    assert np.abs(integral - pos[1:]).max() < 0.05


def test_attitude_agrees_with_velocity_alpha_and_beta(calm: dict[str, FlightRecord]) -> None:
    """In still air the velocity in body axes is V (cos a cos b, sin b, sin a cos b)."""
    from scipy.spatial.transform import Rotation

    columns = calm["gtm_t2"].columns
    body = Rotation.from_quat(columns["own.quat_enu_from_body_xyzw"]).inv().apply(columns["own.vel_enu_mps"].copy())
    a, b, v = (columns[key] for key in ("own.alpha_rad", "own.beta_rad", "own.airspeed_mps"))
    expected = v[:, None] * np.column_stack([np.cos(a) * np.cos(b), np.sin(b), np.sin(a) * np.cos(b)])
    assert np.abs(body - expected).max() < 0.02


@pytest.mark.parametrize("name", CASES)
def test_a_kept_schedule_is_kept(name: str) -> None:
    """The bound of the schedule hold in calm air: 0.05 s."""
    metrics = measure(fly(plan(guidance={"schedule": "keep"}, **CASES[name])))
    assert abs(metrics.schedule_error_s) <= 0.05
    assert metrics.cross_track_max_m <= 0.8


@pytest.mark.parametrize("name", CASES)
def test_the_second_law_flies_the_original_path(name: str) -> None:
    metrics = measure(fly(plan(guidance={"kind": "l1"}, **CASES[name])))
    assert metrics.outcome == "reached"
    assert metrics.cross_track_max_m <= 1.2


def test_same_plan_same_record(calm: dict[str, FlightRecord]) -> None:
    again = fly(plan(**GTM))
    for key, column in calm["gtm_t2"].columns.items():
        assert column.tobytes() == again.columns[key].tobytes(), key


def test_the_planner_re_plans_once_and_records_what_it_did() -> None:
    record = fly(plan(obstacles=[paper_obstacle()], **GTM))
    (event,) = record.events
    assert event.decision == "replanned"
    assert len(record.paths) == 2
    assert math.dist(event.own_pos_enu_m, event.obstacle_pos_enu_m) <= 100.0
    assert event.alpha_rad < event.alpha0_rad
    first = record.paths[1].curves[0]
    assert np.allclose(first.point(0.0), event.own_pos_enu_m)
    assert np.allclose(first.point(first.length_m), event.insertion_enu_m)
    command = np.asarray(event.command_enu_mps)
    assert np.allclose(first.tangent(first.length_m), command / np.linalg.norm(command))
    assert np.linalg.norm(command) == pytest.approx(np.linalg.norm(event.own_vel_enu_mps))


@pytest.mark.parametrize(("wind_from", "name"), [(0, "gtm_t2"), (120, "gtm_t2"), (240, "c172p")])
def test_starts_undisturbed_in_wind_and_keeps_to_the_path(wind_from: float, name: str, calm: dict[str, FlightRecord]) -> None:
    air = {"wind": {"kind": "steady", "speed_mps": 10, "from_deg": wind_from}}
    record = fly(plan(air=air, **CASES[name]))
    assert record.columns["own.airspeed_mps"][0] == pytest.approx(50.0, abs=0.05)
    slip = record.columns["own.beta_rad"][:60] - calm[name].columns["own.beta_rad"][:60]
    assert np.abs(slip).max() < 0.5 * DEG  # a wind that the start ignored would make it 11 deg
    metrics = measure(record)
    assert metrics.outcome == "reached"
    assert metrics.cross_track_max_m < 1.2


def test_too_slow_to_fly_is_an_outcome() -> None:
    record = fly(plan(speed_mps=20.0, **GTM))
    assert record.outcome is Outcome.TRIM_FAILED
    assert "20 m/s" in record.message
    assert math.isnan(measure(record).flight_time_s)


@pytest.mark.parametrize(("aircraft", "reach_m"), [("gtm_t2", 0.5), ("c172p", 6.0)])
def test_touching_the_ground_ends_the_flight(aircraft: str, reach_m: float) -> None:
    """At the first touch of belly, wheel or wing: a moment later JSBSim's springs would have thrown the aircraft back into the air."""
    dive = PAPER_ROUTE | {"goal_enu_m": [600, 0, -150], "start_direction_deg": [0, -5], "goal_direction_deg": [0, -20]}
    record = fly(plan(route=dive, aircraft=aircraft, plant={"kind": "jsbsim"}, terrain_z_m=-60.0))
    assert record.outcome is Outcome.HIT_GROUND
    assert record.message.startswith("came down at ")
    height = record.columns["own.pos_enu_m"][:, 2] + 60.0
    assert 0.0 < height[-1] < reach_m
    assert np.abs(record.columns["own.load_factor"][:-3]).max() < 2.5, "looked for every second tick: nothing but air before"


def test_a_state_that_becomes_nan_ends_the_flight(monkeypatch: pytest.MonkeyPatch) -> None:
    from testbed.flight.plants.jsbsim import JsbsimPlant

    honest = JsbsimPlant.command

    def broken(self, state, command):
        stopped = honest(self, state, command)
        if state.x > 200.0:
            self._set_elevator(math.nan)
        return stopped

    monkeypatch.setattr(JsbsimPlant, "command", broken)
    record = fly(plan(**GTM))
    assert record.outcome is Outcome.DIVERGED
    assert measure(record).outcome == "diverged"


def test_a_goal_that_is_never_passed_times_out() -> None:
    """Twice around would be needed: the goal lies behind, at a place that the aircraft flies past wide."""
    route = {"start_enu_m": [0, 0, 0], "goal_enu_m": [60, 40, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [180, 0]}
    record = fly(plan(route=route, plant={"kind": "jsbsim"}, aircraft="c172p"))
    assert record.outcome is Outcome.TIMED_OUT
    assert record.columns["time_s"][-1] == pytest.approx(3 * record.paths[0].length_m / 50.0, abs=0.02)


def test_a_missing_property_is_refused() -> None:
    fdm = load_model(load_aircraft("gtm_t2"), 120)
    with pytest.raises(KeyError, match="no property 'fcs/elevator-cmd-nrom'"):
        node(fdm, "fcs/elevator-cmd-nrom")


@pytest.mark.parametrize(("climb", "alpha", "throttle"), [(0, 2.96, 0.402)])
def test_gtm_t2_trims_as_its_source_says(climb: float, alpha: float, throttle: float) -> None:
    """The first figure of each pair: level trim at 50 m/s, 150 m."""
    trim = trim_level(load_model(load_aircraft("gtm_t2"), 120), load_aircraft("gtm_t2"), 50.0, 150.0)
    assert trim.alpha / DEG == pytest.approx(alpha, abs=0.1)
    assert trim.throttle == pytest.approx(throttle, abs=0.01)


def test_the_model_files_are_what_the_generator_writes() -> None:
    import subprocess
    import sys

    script = load_aircraft("gtm_t2").folder / "make_model.py"
    assert subprocess.run([sys.executable, str(script), "--check"], check=False).returncode == 0
