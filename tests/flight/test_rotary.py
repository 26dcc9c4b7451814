"""Air that turns: the rotary gusts against MIL-F-8785C, their signs, and how JSBSim's aerodynamics feel them."""

import math
import shutil
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import welch
from scipy.spatial.transform import Rotation

from testbed import fly
from testbed.core.seeds import stream
from testbed.core.units import FT
from testbed.flight.air import AirModel, field
from testbed.flight.air.dryden import SERIES_HZ, dryden, dryden_series
from testbed.flight.air.rotary import rotary_series, rotary_spectra, sigma_roll
from testbed.flight.fly import start_of
from testbed.flight.plants.aircraft import Aircraft, load_aircraft
from testbed.flight.plants.jsbsim import JsbsimPlant
from testbed.flight.plants.jsbsim_model import AERO_RATES, IN_ROTATING_AIR, ROTARY_GUST, read_model
from testbed.flight.plants.jsbsim_start import load_model, model_file, node
from testbed.flight.scene import make_scene
from tests.plans import C172P, GTM, KINEMATIC, plan

SPEED, SPAN = 50.0, 2.0875
MODERATE = dryden("moderate", 200.0)
DRYDEN = {"turbulence": {"kind": "dryden", "severity": "moderate"}}
HERE = (0.0, 0.0, 0.0)
PLANTS = {"gtm_t2": GTM, "c172p": C172P, "t37": GTM | {"aircraft": "t37", "speed_mps": 90}}
AERO = [f"forces/fb{axis}-aero-lbs" for axis in "xyz"] + [f"moments/{axis}-aero-lbsft" for axis in "lmn"]


def long_series(span_m: float, count: int = 2_000_000) -> np.ndarray:
    rng = np.random.default_rng(8785)
    velocities = dryden_series(MODERATE, SPEED, count, rng)
    return rotary_series(velocities, rng.normal(size=count), MODERATE, SPEED, span_m)


def specified(wave: np.ndarray, span_m: float) -> np.ndarray:
    """Phi_p, Phi_q, Phi_r over the spatial frequency (1/m), as MIL-F-8785C 3.7.1.2 prints them."""
    _, sv, sw, _, lv, lw = MODERATE
    b, pi = span_m, math.pi
    phi_w, phi_v = (s**2 * scale / pi * (1 + 3 * (scale * wave) ** 2) / (1 + (scale * wave) ** 2) ** 2 for s, scale in ((sw, lw), (sv, lv)))
    roll = sw**2 / lw * 0.8 * (pi * lw / (4 * b)) ** (1 / 3) / (1 + (4 * b * wave / pi) ** 2)
    return np.stack([roll, wave**2 / (1 + (4 * b * wave / pi) ** 2) * phi_w, wave**2 / (1 + (3 * b * wave / pi) ** 2) * phi_v])


@pytest.mark.parametrize("span_m", [SPAN, 11.0])
def test_the_spectra_are_those_that_are_printed(span_m: float) -> None:
    """Power per Hz is 2 pi / V times that per 1/m."""
    frequency = np.geomspace(1e-3, 1e3, 61)
    expected = specified(2 * math.pi * frequency / SPEED, span_m) * 2 * math.pi / SPEED
    assert np.allclose(rotary_spectra(frequency, MODERATE, SPEED, span_m), expected, rtol=1e-12)


def test_the_strength_of_roll_is_the_integral_of_its_spectrum() -> None:
    wave = np.geomspace(1e-6, 1e6, 200_001)
    assert sigma_roll(MODERATE, SPAN) ** 2 == pytest.approx(float(np.trapezoid(specified(wave, SPAN)[0], wave)), rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("span_m", [SPAN, 11.0])
def test_variance_and_spectrum_of_a_long_series(span_m: float) -> None:
    """Welch's estimate by octave within five standard errors of its chi-square; the variance within 1 %, five standard errors of it."""
    series, segment = long_series(span_m), 2**14
    every = np.geomspace(1e-4, 1e5, 20_001)
    variances = np.trapezoid(rotary_spectra(every, MODERATE, SPEED, span_m), every)
    for k in range(3):
        power_of = rotary_spectra(every, MODERATE, SPEED, span_m)[k]
        error = math.sqrt(float(np.trapezoid(power_of**2, every)) * SERIES_HZ / len(series)) / variances[k]
        assert series[:, k].var() / variances[k] == pytest.approx(1.0, abs=5 * error + 0.003), k
        frequency, power = welch(series[:, k], SERIES_HZ, nperseg=segment)
        expected = rotary_spectra(frequency, MODERATE, SPEED, span_m)[k]
        for low in 0.02 * 2.0 ** np.arange(9):  # up to 10 Hz
            band = (frequency >= low) & (frequency < 2 * low)
            freedom = band.sum() * len(series) / segment
            share = power[band].sum() / expected[band].sum()
            assert share == pytest.approx(1.0, abs=max(0.03, 5 / math.sqrt(freedom))), (k, low)


def test_roll_is_stationary_from_the_first_sample_and_the_others_start_from_rest() -> None:
    rng = np.random.default_rng(5)
    velocities = dryden_series(MODERATE, SPEED, 2, rng)
    first = np.array([rotary_series(velocities, rng.normal(size=2), MODERATE, SPEED, SPAN)[0] for _ in range(4000)])
    assert first[:, 0].std() == pytest.approx(sigma_roll(MODERATE, SPAN), rel=5 / math.sqrt(2 * 4000))
    assert not first[:, 1:].any()


def test_a_gust_that_grows_along_the_way_is_a_rigid_rotation() -> None:
    """The air turns with Omega = (0, q_left, r_up): at x along it moves by Omega x (x, 0, 0), which the series meets at x = V t."""
    turn = np.array([0.0, 0.03, -0.02])
    x = np.arange(400) * SPEED / SERIES_HZ
    velocities = np.cross(turn, np.column_stack([x, 0 * x, 0 * x]))
    found = rotary_series(velocities, np.zeros(400), MODERATE, SPEED, SPAN)
    assert np.allclose(found[-1], turn, atol=1e-12)
    tau = 4 * SPAN / (math.pi * SPEED)  # from rest: 1 - exp(-t / tau) of it
    assert found[12, 1] == pytest.approx(0.03 * (1 - math.exp(-12 / SERIES_HZ / tau)), rel=1e-9)


def scene_air(**changes: object) -> AirModel:
    return make_scene(plan(air=DRYDEN, **changes)).air


def rotation(span_m: float, time_s: float, **changes: object) -> tuple[float, float, float]:
    turns = scene_air(**changes).rotation
    assert turns is not None
    return turns(span_m)(time_s, HERE)


def test_the_rotation_is_laid_along_the_route_like_the_velocity() -> None:
    """Between two samples of the velocity, through 1/(1 + tau s): the same recursion in ENU gives its level and its vertical part."""
    air = scene_air(route=ROUTE_NORTH_WEST)
    assert air.rotation is not None
    turns = air.rotation(SPAN)
    along, left = np.array([-0.6, 0.8, 0.0]), np.array([-0.8, -0.6, 0.0])
    pitch, yaw, dt = 0.0, 0.0, 1 / SERIES_HZ
    decays = [math.exp(-dt * math.pi * SPEED / (k * SPAN)) for k in (4, 3)]
    for k in range(1, 60):
        slope = (np.array(air.at(k * dt, HERE)) - np.array(air.at((k - 1) * dt, HERE))) / (SPEED * dt)
        pitch = decays[0] * pitch - (1 - decays[0]) * slope[2]
        yaw = decays[1] * yaw + (1 - decays[1]) * float(slope @ left)
    found = np.array(turns(59 * dt, HERE))
    assert (found @ left, found[2]) == pytest.approx((pitch, yaw), rel=1e-6)
    assert abs(found @ along) > 1e-3


ROUTE_NORTH_WEST = {
    "start_enu_m": [0, 0, 0],
    "goal_enu_m": [-1200, 1600, 0],
    "start_direction_deg": [math.degrees(math.atan2(0.8, -0.6)), 0],
    "goal_direction_deg": [math.degrees(math.atan2(0.8, -0.6)), 0],
}


def test_the_velocities_do_not_know_of_the_rotation() -> None:
    """They come from their own stream, untouched: what a seed flew through before there was any rotation it still flies through."""
    a_plan = plan(air=DRYDEN, route=ROUTE_NORTH_WEST)
    air = make_scene(a_plan).air
    assert air.rotation is not None
    air.rotation(SPAN)
    height = a_plan.route.start_enu_m[2] - a_plan.terrain_z_m
    series = dryden_series(dryden("moderate", height), SPEED, 100, stream(a_plan.seed, a_plan.replicate, "turbulence"))
    assert np.allclose([air.at(k / SERIES_HZ, HERE)[2] for k in range(100)], series[:, 2], rtol=1e-12, atol=1e-12)


def test_two_wings_meet_the_same_roll_noise_and_the_larger_feels_less_of_it() -> None:
    small, large = (np.array([rotation(span, 0.0, seed=seed)[:2] for seed in range(12)]) for span in (SPAN, 11.0))
    assert np.allclose(small / large, sigma_roll(MODERATE, SPAN) / sigma_roll(MODERATE, 11.0))  # time 0: roll alone
    assert sigma_roll(MODERATE, SPAN) > 3 * sigma_roll(MODERATE, 11.0)


def test_method_plant_and_rate_meet_the_same_rotation_and_two_seeds_do_not() -> None:
    reference = rotation(SPAN, 4.0)
    changes = [KINEMATIC | {"method": {"kind": "none"}}, {"aircraft": "c172p"}, {"rates": {"plant_hz": 240, "guidance_hz": 60}}]
    assert [rotation(SPAN, 4.0, **change) for change in changes] == [reference] * 3
    assert rotation(SPAN, 4.0, seed=1) != reference != rotation(SPAN, 4.0, replicate=1)


def test_only_frozen_turbulence_turns() -> None:
    for air in (
        {},
        {"turbulence": {"kind": "jsbsim", "severity": "light"}},
        {"gust": {"kind": "step", "amplitude_mps": 1, "at_time_s": 1}},
    ):
        assert make_scene(plan(air=air)).air.rotation is None


def feel(aircraft: Aircraft, rates: tuple[float, ...], gust: tuple[float, ...] = ()) -> np.ndarray:
    """Aerodynamic forces and moments of JSBSim at those rates of the aircraft, in air that turns as told, or in the file as it is.

    Without what the rate of the angle of attack adds: that rate is no state, it comes from the forces and from the rates of the aircraft.
    """
    model = aircraft.model
    still = {name: 0.0 for name in read_model(model_file(aircraft)).derivatives if "adot" in name}
    aircraft = aircraft.model_copy(update={"model": model.model_copy(update={"factors": model.factors | still})})
    fdm = load_model(aircraft, 120, bool(gust))
    for name, value in zip(ROTARY_GUST, gust, strict=False):
        node(fdm, name).set_double_value(value)
    for name, value in {"h-sl-ft": 2000.0, "beta-deg": 3.0, "alpha-deg": 4.0, "vt-fps": 160.0}.items():
        fdm[f"ic/{name}"] = value
    fdm["ic/p-rad_sec"], fdm["ic/q-rad_sec"], fdm["ic/r-rad_sec"] = rates
    fdm.set_trim_status(True)
    fdm.run_ic()
    return np.array([fdm[name] for name in AERO])


@pytest.mark.parametrize("name", PLANTS)
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_air_that_turns_is_felt_like_an_aircraft_that_turns_the_other_way(name: str, axis: int) -> None:
    """JSBSim's own file at the rates -g against ours at rest in a gust g."""
    aircraft = load_aircraft(name)
    gust = tuple(0.2 if k == axis else 0.0 for k in range(3))
    still, turned, moved = feel(aircraft, HERE), feel(aircraft, tuple(-g for g in gust)), feel(aircraft, HERE, gust)
    assert abs(turned[3 + axis] - still[3 + axis]) > 1e-3 * np.abs(still).max()
    assert moved == pytest.approx(turned, rel=1e-12)


def zero_rotation(velocities: np.ndarray, *_: object) -> np.ndarray:
    return np.zeros_like(velocities)


@pytest.mark.parametrize("name", PLANTS)
def test_in_air_that_turns_by_nothing_the_flight_is_that_of_the_file_as_it_is(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def without(*args: object) -> AirModel:
        air = make_air(*args)
        return AirModel(air.steady, air.uniform, air.mean, air.at, air.built_in)

    make_air = field.make_air
    monkeypatch.setattr(field, "rotary_series", zero_rotation)
    still = fly(plan(air=DRYDEN, **PLANTS[name])).columns
    monkeypatch.setattr("testbed.flight.scene.make_air", without)
    plain = fly(plan(air=DRYDEN, **PLANTS[name])).columns
    assert len(plain["time_s"]) > 500
    for key, column in plain.items():
        assert np.array_equal(column, still[key]), key


@pytest.mark.parametrize("name", ["gtm_t2", "c172p"])
def test_what_is_recorded_is_the_rotation_of_the_air_in_body_axes(name: str) -> None:
    """Read back from JSBSim: the series for the span in JSBSim's file, turned by the attitude of one tick ago."""
    a_plan = plan(air=DRYDEN, **PLANTS[name])
    columns, turns = fly(a_plan).columns, make_scene(a_plan).air.rotation
    assert turns is not None
    wing = turns({"gtm_t2": 6.8488, "c172p": 35.8}[name] * FT)
    attitude = Rotation.from_quat(columns["own.quat_enu_from_body_xyzw"].copy())
    for k in range(1, len(columns["time_s"]), 7):
        expected = attitude[k - 1].inv().apply(wing(k / 120, HERE))
        assert np.allclose(columns["air.rotation_body_radps"][k], expected, atol=1e-12)
    assert columns["air.rotation_body_radps"][0, 0] != 0.0  # the start is in the gusts of time 0
    assert columns["own.rates_body_radps"].std(axis=0).min() > 0.0


def test_the_same_plan_is_the_same_record() -> None:
    a, b = (fly(plan(air=DRYDEN, **GTM)).columns["air.rotation_body_radps"] for _ in range(2))
    assert a.tobytes() == b.tobytes()
    assert a.std(axis=0).min() > 0.05


def test_the_rotation_of_calm_air_of_jsbsim_s_own_turbulence_and_of_a_point() -> None:
    own = {"turbulence": {"kind": "jsbsim", "severity": "moderate"}}
    calm, built_in = (fly(plan(air=air, **GTM)).columns["air.rotation_body_radps"] for air in ({}, own))
    assert not calm.any()
    assert built_in[200:].std(axis=0).min() > 0.03
    for point in (KINEMATIC, {"plant": {"kind": "point_mass"}}):
        assert np.isnan(fly(plan(air=DRYDEN, **point)).columns["air.rotation_body_radps"]).all()


def test_a_sample_is_longer_only_where_the_air_turns() -> None:
    def length(air: dict) -> int:
        a_plan = plan(air=air, **GTM)
        scene = make_scene(a_plan)
        return len(JsbsimPlant(load_aircraft("gtm_t2"), start_of(a_plan, scene), 120, 60, -200.0, scene.air).sample())

    sheared = {"wind": {"kind": "power_law", "speed_mps": 5, "from_deg": 90}}
    assert (length(sheared), length(DRYDEN)) == (length({}) + 3, length({}) + 6)


@pytest.mark.parametrize("name", PLANTS)
def test_factors_keep_their_names_and_places_in_air_that_turns(name: str) -> None:
    aircraft = load_aircraft(name)
    plain, turning = (read_model(model_file(aircraft), air_turns) for air_turns in (False, True))
    assert turning.derivatives == plain.derivatives
    assert turning.lags == plain.lags
    roll_damping = next(one for one in plain.derivatives if "Clp" in one or one == "aero/gtm/Cl(velocities/p-aero-rad_sec)")
    more = aircraft.model_copy(update={"model": aircraft.model.model_copy(update={"factors": {roll_damping: 1.5}})})
    gust = (0.2, 0.0, 0.0)
    low, high = (feel(one, HERE, gust) - feel(one, HERE, HERE) for one in (aircraft, more))
    assert high[3] == pytest.approx(1.5 * low[3], rel=0.01)  # a side force that comes with it rolls the aircraft a little, too
    for rate, in_air in zip(AERO_RATES, IN_ROTATING_AIR, strict=True):
        text = turning.changed({})
        section = text[text.index("<aerodynamics") : text.index("</aerodynamics>")]
        assert section.count(rate) == 1  # in the function that takes the gust off
        assert section.count(in_air) >= 2


def test_aerodynamics_in_a_file_of_their_own_feel_it_too_and_other_rates_do_not(tmp_path: Path) -> None:
    own = load_aircraft("gtm_t2")
    text = (own.folder / "gtm_t2.xml").read_text()
    head, rest = text.split("<aerodynamics>")
    inside, tail = rest.split("</aerodynamics>")
    gust = (0.2, 0.0, 0.0)
    for folder, change in (("split", "velocities/p-aero-rad_sec"), ("deaf", "velocities/p-rad_sec")):
        copy = tmp_path / folder / "gtm_t2"
        shutil.copytree(own.folder, copy)
        (copy / "aero.xml").write_text(f"<aerodynamics>{inside.replace('velocities/p-aero-rad_sec', change)}</aerodynamics>")
        (copy / "gtm_t2.xml").write_text(f'{head}<aerodynamics file="aero"/>{tail}')
    split, deaf = (own.model_copy(update={"folder": tmp_path / folder / "gtm_t2"}) for folder in ("split", "deaf"))
    assert np.array_equal(feel(split, HERE, gust), feel(own, HERE, gust))
    assert np.array_equal(feel(deaf, HERE, gust), feel(own, HERE))
    assert not np.array_equal(feel(own, HERE, gust), feel(own, HERE))
