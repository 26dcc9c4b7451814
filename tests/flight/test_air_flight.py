"""Aircraft in the air: they feel what is recorded, they start in it undisturbed, and the same plan meets the same air."""

import math

import numpy as np
import pytest
from pydantic import ValidationError

from testbed import fly, measure
from testbed.core.units import DEG
from testbed.flight.fly import start_of
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.plants.jsbsim import JsbsimPlant
from testbed.flight.plants.jsbsim_start import issue, load_model, trim_level
from testbed.flight.record import FlightRecord
from testbed.flight.scene import make_scene
from tests.plans import C172P, GTM, KINEMATIC, PAPER_ROUTE, plan

STRAIGHT = {"start_enu_m": [0, 0, 0], "goal_enu_m": [500, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
POINT = GTM | {"plant": {"kind": "point_mass"}}
PLANTS = {"kinematic": KINEMATIC, "point_mass": POINT, "gtm_t2": GTM, "c172p": C172P}
DRYDEN = {"turbulence": {"kind": "dryden", "severity": "moderate"}}
EVERYTHING = {
    "wind": {"kind": "power_law", "speed_mps": 6, "from_deg": 200},
    "gust": {"kind": "one_minus_cosine", "amplitude_mps": 4, "rise_m": 40, "at_route_s_m": 250},
    **DRYDEN,
}


def gust(**changes: object) -> dict:
    return {"gust": {"kind": "step", "amplitude_mps": 1, "at_time_s": 1.0} | changes}


@pytest.mark.parametrize("name", PLANTS)
def test_the_airspeed_is_the_velocity_less_the_air_that_is_recorded(name: str) -> None:
    record = fly(plan(air=EVERYTHING, **PLANTS[name]))
    columns = record.columns
    air_velocity = columns["own.vel_enu_mps"] - columns["air.wind_enu_mps"]
    # 1e-7: JSBSim's attitude quaternion is of unit length between two steps to some 1e-10
    assert np.abs(np.linalg.norm(air_velocity, axis=1) - columns["own.airspeed_mps"]).max() < 1e-7
    assert columns["air.wind_enu_mps"][:, 2].std() > 0.5


def test_the_aircraft_feels_the_air_of_the_model() -> None:
    """What JSBSim has as its total wind, read back, is the air of each tick: series, gust, and shear at the place of one tick ago."""
    a_plan = plan(air=EVERYTHING, **GTM)
    columns, air = fly(a_plan).columns, make_scene(a_plan).air
    places = columns["own.pos_enu_m"]
    for k in range(0, len(places), 7):
        expected = air.at(k / 120, tuple(places[max(0, k - 1)]))
        assert np.allclose(columns["air.wind_enu_mps"][k], expected, atol=1e-9)


def test_attitude_alpha_and_beta_are_those_of_the_velocity_through_the_air() -> None:
    from scipy.spatial.transform import Rotation

    columns = fly(plan(air=EVERYTHING, **GTM)).columns
    through = columns["own.vel_enu_mps"] - columns["air.wind_enu_mps"]
    body = Rotation.from_quat(columns["own.quat_enu_from_body_xyzw"]).inv().apply(through)
    a, b, v = (columns[key] for key in ("own.alpha_rad", "own.beta_rad", "own.airspeed_mps"))
    expected = v[:, None] * np.column_stack([np.cos(a) * np.cos(b), np.sin(b), np.sin(a) * np.cos(b)])
    assert np.abs(body - expected).max() < 0.02
    assert np.abs(b).max() > 0.5 * DEG


def test_a_point_on_rails_is_not_moved_by_gusts() -> None:
    calm, rough = (fly(plan(air=air, **KINEMATIC)) for air in ({}, DRYDEN))
    assert np.array_equal(calm.columns["own.pos_enu_m"], rough.columns["own.pos_enu_m"])
    assert rough.columns["own.airspeed_mps"].std() > 0.3


def test_a_point_on_rails_takes_the_time_of_the_plan_in_shear() -> None:
    sheared = {"wind": {"kind": "power_law", "speed_mps": 8, "from_deg": 200, "exponent": 0.3}}
    climb = PAPER_ROUTE | {"goal_enu_m": [500, 200, 200]}
    record = fly(plan(route=climb, air=sheared, **KINEMATIC))
    assert measure(record).flight_time_s == pytest.approx(make_scene(record.plan).planned_time_s, abs=1.01 / 120)
    assert np.abs(record.columns["own.airspeed_mps"] - 50.0).max() < 1e-9
    assert measure(record).schedule_error_s == pytest.approx(0.0, abs=1.01 / 120)


@pytest.mark.parametrize("name", ["gtm_t2", "c172p"])
def test_starts_undisturbed_in_shear(name: str) -> None:
    """The wind at the height of the start, 200 m above the ground, is 1.53 times the one at 10 m."""
    record = fly(plan(air={"wind": {"kind": "power_law", "speed_mps": 7, "from_deg": 120}}, **PLANTS[name]))
    calm = fly(plan(**PLANTS[name]))
    assert np.linalg.norm(record.columns["air.wind_enu_mps"][0]) > 1.5 * 7
    assert record.columns["own.airspeed_mps"][0] == pytest.approx(50.0, abs=1e-6)
    slip = record.columns["own.beta_rad"][:60] - calm.columns["own.beta_rad"][:60]
    assert np.abs(slip).max() < 0.5 * DEG
    assert measure(record).cross_track_max_m < 1.2


@pytest.mark.parametrize("name", PLANTS)
def test_a_held_ground_speed_is_there_from_the_start(name: str) -> None:
    """8 m/s from ahead of the route's start (49 deg): 50 m/s over the ground, more through the air."""
    air = {"wind": {"kind": "steady", "speed_mps": 8, "from_deg": 49}}
    record = fly(plan(air=air, speed_hold="groundspeed", **PLANTS[name]))
    assert np.linalg.norm(record.columns["own.vel_enu_mps"][0]) == pytest.approx(50.0, abs=1e-6)
    assert record.columns["own.airspeed_mps"][0] > 55.0
    assert measure(record).outcome == "reached"


@pytest.mark.parametrize("name", ["gtm_t2", "c172p"])
def test_a_step_gust_jumps_the_load_factor_by_lift_slope_times_gust_angle(name: str) -> None:
    """First step after an updraught w at speed V: dn = (dn/dalpha) w/V, with the slope from the same aircraft put at another alpha."""
    case = PLANTS[name] | {"route": STRAIGHT, "begin": {"at_route_s_m": 0}}
    calm, hit = (fly(plan(air=air, **case)).columns["own.load_factor"] for air in ({}, gust()))
    assert np.array_equal(calm[:120], hit[:120])  # the gust is there at row 120, and so is its force
    aircraft, a_plan = load_aircraft(name), plan(**case)
    start = start_of(a_plan, make_scene(a_plan))
    fdm = load_model(aircraft, 120)
    trim = trim_level(fdm, aircraft, 50.0, 200.0)
    (_, low), (_, high) = (issue(fdm, start, trim.alpha, extra, 200.0) for extra in (0.0, math.atan(1 / 50)))
    assert hit[120] - calm[120] == pytest.approx(high - low, rel=0.05)
    assert hit[120] - calm[120] > 0.05


def test_an_updraught_lifts_and_a_gust_from_the_left_is_sideslip_from_the_left() -> None:
    case = GTM | {"route": STRAIGHT, "begin": {"at_route_s_m": 0}}
    up = fly(plan(air=gust(amplitude_mps=3), **case)).columns
    assert up["own.pos_enu_m"][120:180, 2].max() > 0.05
    towards_right = fly(plan(air=gust(amplitude_mps=3, direction_deg=[-90, 0]), **case)).columns
    assert towards_right["air.wind_enu_mps"][200] == pytest.approx((0.0, -3.0, 0.0))
    assert towards_right["own.beta_rad"][120] == pytest.approx(-math.atan(3 / 50), abs=0.1 * DEG)


def records(**changes: object) -> tuple[FlightRecord, FlightRecord]:
    a = fly(plan(air=DRYDEN, **GTM))
    return a, fly(plan(**({"air": DRYDEN} | GTM | changes)))


def test_the_same_plan_is_the_same_record_and_another_seed_is_not() -> None:
    a, b = records()
    assert all(a.columns[key].tobytes() == b.columns[key].tobytes() for key in a.columns)
    _, other = records(seed=1)
    assert not np.allclose(a.columns["air.wind_enu_mps"][:500], other.columns["air.wind_enu_mps"][:500], atol=0.1)


def test_a_finer_step_of_the_plant_flies_through_the_same_air() -> None:
    coarse, fine = records(rates={"plant_hz": 480, "guidance_hz": 60})
    n = min(len(coarse.columns["time_s"]), len(fine.columns["time_s"][::4]))
    assert np.abs(coarse.columns["air.wind_enu_mps"][:n] - fine.columns["air.wind_enu_mps"][::4][:n]).max() < 1e-9
    places = (coarse.columns["own.pos_enu_m"][:n], fine.columns["own.pos_enu_m"][::4][:n])
    assert np.linalg.norm(places[0] - places[1], axis=1).max() < 0.2


@pytest.mark.parametrize("height_m", [150.0, 450.0, 900.0])
@pytest.mark.parametrize("severity", ["light", "severe"])
def test_jsbsim_s_own_turbulence_blows_at_every_height(height_m: float, severity: str) -> None:
    air = {"turbulence": {"kind": "jsbsim", "severity": severity}}
    record = fly(plan(air=air, route=STRAIGHT, aircraft="c172p", terrain_z_m=-height_m))
    assert record.columns["air.wind_enu_mps"].std(axis=0).min() > 0.15
    again = fly(plan(air=air, route=STRAIGHT, aircraft="c172p", terrain_z_m=-height_m))
    assert record.columns["own.pos_enu_m"].tobytes() == again.columns["own.pos_enu_m"].tobytes()


def test_jsbsim_s_own_turbulence_is_refused_elsewhere() -> None:
    with pytest.raises(ValidationError, match=r"turbulence\.kind: jsbsim goes with plant\.kind: jsbsim, not with kinematic"):
        plan(air={"turbulence": {"kind": "jsbsim", "severity": "light"}}, **KINEMATIC)


@pytest.mark.parametrize("air", [{}, {"wind": {"kind": "steady", "speed_mps": 9, "from_deg": 10}}])
def test_air_that_never_changes_costs_nothing_per_tick(air: dict) -> None:
    """A step is JSBSim's own, and no wind is read."""
    a_plan = plan(air=air, **GTM)
    scene = make_scene(a_plan)
    plant = JsbsimPlant(load_aircraft("gtm_t2"), start_of(a_plan, scene), 120, 60, -200.0, scene.air)
    assert plant.step == plant.step_bare
    assert len(plant.sample()) == len(JsbsimPlant(load_aircraft("gtm_t2"), start_of(a_plan, scene), 120, 60, -200.0).sample())


@pytest.mark.parametrize("name", ["gtm_t2", "c172p"])
@pytest.mark.parametrize("severity", ["moderate", "severe"])
def test_keeps_to_the_path_in_turbulence(name: str, severity: str) -> None:
    rms = [
        measure(fly(plan(seed=seed, air={"turbulence": {"kind": "dryden", "severity": severity}}, **PLANTS[name]))).cross_track_rms_m
        for seed in range(5)
    ]
    assert max(rms) < (0.8 if severity == "moderate" else 1.2)
