"""The air by itself: mean wind, gust shapes, and the frozen turbulence against MIL-F-8785C."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import welch

from testbed.campaign.words.air import Air, OneMinusCosineGust, StepGust
from testbed.core.units import FT, KNOT
from testbed.flight.air import make_wind
from testbed.flight.air.dryden import SERIES_HZ, START_ROOT, Dryden, autocorrelation, dryden, dryden_series, spectrum, transition
from testbed.flight.air.gusts import make_gust, shape
from testbed.flight.scene import make_scene
from tests.plans import KINEMATIC, plan

OUTPUT = np.array([math.sqrt(3.0), 1.0 - math.sqrt(3.0)])  # of the two-stage filter
UNIT = Dryden(1.0, 1.0, 1.0, 200.0, 200.0, 200.0)


def wind(**spec: object) -> Air:
    return Air.model_validate({"wind": spec})


def test_a_wind_from_the_west_blows_east_at_every_height() -> None:
    steady = make_wind(wind(kind="steady", speed_mps=7, from_deg=270))
    assert steady(3.0, (1.0, 2.0, 300.0)) == pytest.approx((7.0, 0.0, 0.0), abs=1e-12)


def test_the_power_law_over_the_ground() -> None:
    """(200/10)^(1/7) = 1.534: height counts from the terrain, not from z = 0; nothing blows below the ground."""
    sheared = make_wind(wind(kind="power_law", speed_mps=5, from_deg=0), terrain_z_m=-200.0)
    assert sheared(0.0, (0.0, 0.0, -190.0)) == pytest.approx((0.0, -5.0, 0.0))
    assert sheared(0.0, (0.0, 0.0, 0.0))[1] == pytest.approx(-5.0 * 1.5341, abs=1e-3)
    assert sheared(0.0, (0.0, 0.0, -201.0)) == (0.0, 0.0, 0.0)


def test_the_logarithmic_law_is_that_of_the_specification() -> None:
    """MIL-F-8785C 3.7.3.2: u = u_20 ln(h/z_0)/ln(20/z_0), z_0 = 0.15 ft; at 200 ft 1.4706 times the wind at 20 ft."""
    law = make_wind(wind(kind="logarithmic", speed_mps=10, from_deg=270, reference_height_m=20 * FT, roughness_m=0.15 * FT))
    assert law(0.0, (0.0, 0.0, 20 * FT))[0] == pytest.approx(10.0)
    assert law(0.0, (0.0, 0.0, 200 * FT))[0] == pytest.approx(10.0 * math.log(200 / 0.15) / math.log(20 / 0.15))
    assert law(0.0, (0.0, 0.0, 0.01))[0] == 0.0


def test_a_reference_inside_the_grass_is_refused() -> None:
    with pytest.raises(ValueError, match="reference_height_m must be more than roughness_m"):
        wind(kind="logarithmic", speed_mps=5, from_deg=0, reference_height_m=0.5, roughness_m=1.0)


@given(st.floats(-500, 500))
def test_a_gust_rises_holds_and_falls_as_it_rose(into_m: float) -> None:
    """(1 - cos(pi x / 50))/2 up to 50 m, 1 up to 80 m, mirrored after that."""
    share = shape(OneMinusCosineGust(kind="one_minus_cosine", amplitude_mps=1, at_time_s=0, rise_m=50, hold_m=30))
    assert share(into_m) == pytest.approx(share(130.0 - into_m), abs=1e-9)
    if 0 <= into_m <= 50:
        assert share(into_m) == pytest.approx(math.sin(math.pi * into_m / 100) ** 2, abs=1e-9)
    assert 0.0 <= share(into_m) <= 1.0


def test_the_gust_of_the_specification_never_falls() -> None:
    share = shape(OneMinusCosineGust(kind="one_minus_cosine", amplitude_mps=1, at_time_s=0, rise_m=50, hold_m=None))
    assert [share(x) for x in (-1.0, 0.0, 25.0, 50.0, 1e6)] == pytest.approx([0.0, 0.0, 0.5, 1.0, 1.0])


def straight(s_m: float):
    return (0.6 * s_m, 0.8 * s_m, 0.0), (0.6, 0.8, 0.0)


def test_a_gust_at_a_time_and_at_a_place() -> None:
    """To the left of a route towards (0.6, 0.8) is (-0.8, 0.6); upwards is up."""
    left = StepGust(kind="step", amplitude_mps=2, direction_deg=(90, 0), at_route_s_m=100)
    there = make_gust(left, straight, 0.0, 50.0)
    assert there(99.0, straight(99.9)[0]) == (0.0, 0.0, 0.0)
    assert there(0.0, straight(100.1)[0]) == pytest.approx((-1.6, 1.2, 0.0))
    up = OneMinusCosineGust(kind="one_minus_cosine", amplitude_mps=3, at_time_s=2.0, rise_m=25)
    then = make_gust(up, straight, 0.0, 50.0)
    assert then(1.999, (1e3, 0.0, 0.0)) == (0.0, 0.0, 0.0)
    assert then(2.5, (1e3, 0.0, 0.0)) == pytest.approx((0.0, 0.0, 3.0))  # 25 m at 50 m/s
    east = StepGust(kind="step", amplitude_mps=2, direction_deg=(0, 0), frame="enu", at_time_s=0)
    assert make_gust(east, straight, 0.0, 50.0)(0.0, (0.0, 0.0, 0.0)) == pytest.approx((2.0, 0.0, 0.0))


def test_a_gust_begins_once() -> None:
    for when in ({}, {"at_time_s": 1, "at_route_s_m": 2}):
        with pytest.raises(ValueError, match="exactly one of at_time_s and at_route_s_m"):
            StepGust(kind="step", amplitude_mps=1, **when)


@pytest.mark.parametrize(
    ("severity", "height_ft", "sigma_u", "sigma_w", "scale_u", "scale_w"),
    [  # ft/s and ft, worked out by hand from MIL-F-8785C 3.7.3.4 (figures 10, 11), 3.7.2.1 and figure 7
        ("moderate", 1000.0, 0.1 * 30 * 1.68781, 0.1 * 30 * 1.68781, 1000.0, 1000.0),
        ("light", 500.0, 0.1 * 15 * 1.68781 / 0.5885**0.4, 0.1 * 15 * 1.68781, 500 / 0.5885**1.2, 500.0),
        ("severe", 2.0, 0.1 * 45 * 1.68781 / 0.18523**0.4, 0.1 * 45 * 1.68781, 10 / 0.18523**1.2, 10.0),
        ("moderate", 3750.0, 10.6, 10.6, 1750.0, 1750.0),
        ("severe", 20000.0, (22.1 + 20.0) / 2, (22.1 + 20.0) / 2, 1750.0, 1750.0),
        ("light", 1500.0, (2.531715 + 6.9625) / 2, (2.531715 + 6.9625) / 2, 1375.0, 1375.0),
    ],
)
def test_strength_and_scale(severity: str, height_ft: float, sigma_u: float, sigma_w: float, scale_u: float, scale_w: float) -> None:
    found = dryden(severity, height_ft * FT)
    assert (found.sigma_u, found.sigma_v) == pytest.approx((sigma_u * FT, sigma_u * FT), rel=1e-4)
    assert (found.sigma_w, found.scale_w) == pytest.approx((sigma_w * FT, scale_w * FT), rel=1e-4)
    assert (found.scale_u, found.scale_v) == pytest.approx((scale_u * FT, scale_u * FT), rel=1e-4)


@pytest.mark.parametrize("step", [1e-6, 1e-3, 0.04, 0.7, 5.0])
def test_the_filter_is_exact_whatever_the_step(step: float) -> None:
    """The chain's covariance and autocorrelation are the closed form's, and its stationary state stays stationary."""
    matrix, root = transition(step)
    stationary = START_ROOT @ START_ROOT.T
    assert np.allclose(matrix @ stationary @ matrix.T + root @ root.T, stationary, rtol=1e-9, atol=1e-12)
    assert OUTPUT @ stationary @ OUTPUT == pytest.approx(1.0)
    power = np.eye(2)
    for k in range(8):
        assert OUTPUT @ power @ stationary @ OUTPUT == pytest.approx(float(autocorrelation(np.array(k * step), 1.0, True)), abs=1e-9)
        power = matrix @ power


def test_the_small_noise_of_a_small_step() -> None:
    """The determinant of the noise's covariance is step^4/12 to leading order: two stages driven by one noise."""
    _, root = transition(1e-5)
    assert np.linalg.det(root) ** 2 == pytest.approx(1e-20 / 12, rel=1e-3)


def test_variance_and_autocorrelation_of_a_long_series() -> None:
    """Within five standard errors; the error of a mean of x(t) x(t+lag) over T is about sqrt(2 tau_e / T)."""
    tau = UNIT.scale_u / 50.0
    count = 2_000_000
    series = dryden_series(UNIT, 50.0, count, np.random.default_rng(8785))
    error = 5 * math.sqrt(2 * tau * SERIES_HZ / count)
    for column in range(3):
        one = series[:, column]
        for lag in (0, 60, 240, 960):
            expected = float(autocorrelation(np.array(lag / SERIES_HZ), tau, column > 0))
            assert np.mean(one[: count - lag] * one[lag:]) == pytest.approx(expected, abs=error), (column, lag)
    assert np.abs(np.corrcoef(series.T) - np.eye(3)).max() < error


def test_the_spectrum_is_the_specification_s() -> None:
    """Welch's estimate in octave bands, within five standard errors of the chi-square of its averages."""
    model = dryden("moderate", 200.0)
    series = dryden_series(model, 50.0, 2_000_000, np.random.default_rng(3))
    segment = 2**15
    for column in range(3):
        sigma, scale = model[column], model[column + 3]
        frequency, power = welch(series[:, column], SERIES_HZ, nperseg=segment)
        expected = sigma**2 * spectrum(frequency, scale / 50.0, column > 0)
        for low in 0.01 * 2.0 ** np.arange(9):
            band = (frequency >= low) & (frequency < 2 * low)
            freedom = band.sum() * len(series) / segment
            assert power[band].sum() / expected[band].sum() == pytest.approx(1.0, abs=max(0.02, 5 / math.sqrt(freedom))), (column, low)


@pytest.mark.parametrize("two_stage", [False, True])
def test_spectrum_and_autocorrelation_belong_together(two_stage: bool) -> None:
    """Wiener-Khinchin: R(s) = int S(f) cos(2 pi f s) df."""
    frequency = np.linspace(0.0, 400.0, 4_000_001)
    for lag in (0.0, 0.5, 3.0):
        integral = np.trapezoid(spectrum(frequency, 2.0, two_stage) * np.cos(2 * np.pi * frequency * lag), frequency)
        assert integral == pytest.approx(float(autocorrelation(np.array(lag), 2.0, two_stage)), abs=1e-3)


@pytest.mark.slow
def test_the_first_sample_is_stationary() -> None:
    first = np.array([dryden_series(UNIT, 50.0, 1, np.random.default_rng(k))[0] for k in range(4000)])
    assert np.allclose(first.std(axis=0), 1.0, atol=5 / math.sqrt(2 * 4000))


def test_a_longer_series_begins_with_the_shorter_one() -> None:
    short, long = (dryden_series(UNIT, 50.0, count, np.random.default_rng(1)) for count in (100, 1000))
    assert np.array_equal(short, long[:100])


def turbulent(**changes: object):
    return make_scene(plan(air={"turbulence": {"kind": "dryden", "severity": "moderate"}}, **changes)).air


HERE = (0.0, 0.0, 0.0)
TIMES = [0.0, 0.37, 4.0, 11.0]


def test_method_plant_aircraft_and_rate_meet_the_same_air_and_two_seeds_do_not() -> None:
    reference = [turbulent().at(t, HERE) for t in TIMES]
    changes = [
        KINEMATIC | {"method": {"kind": "none"}},
        {"aircraft": "c172p", "plant": {"kind": "point_mass"}},
        {"begin": {"climb_at_most_deg": 18}},
        {"rates": {"plant_hz": 240, "guidance_hz": 60}},
    ]
    for change in changes:
        assert [turbulent(**change).at(t, HERE) for t in TIMES] == reference
    assert all(turbulent(seed=1).at(t, HERE) != old for t, old in zip(TIMES, reference, strict=True))
    assert all(turbulent(replicate=1).at(t, HERE) != old for t, old in zip(TIMES, reference, strict=True))


def test_the_severities_are_one_series_scaled() -> None:
    """The same noise: severe is 45/15 of light, below 1000 ft."""
    light, severe = (
        make_scene(plan(air={"turbulence": {"kind": "dryden", "severity": severity}})).air.at(2.0, HERE) for severity in ("light", "severe")
    )
    assert np.allclose(severe, 3.0 * np.array(light))


def test_the_height_of_the_route_s_start_sets_the_strength_unless_told() -> None:
    """sigma_w = 0.1 W20 for any height below 1000 ft, so a series at another height has another scale but not another first sample up."""
    low, high = (
        make_scene(plan(air={"turbulence": {"kind": "dryden", "severity": "light", "height_m": height}})).air for height in (50.0, 300.0)
    )
    assert low.at(0.0, HERE)[2] == pytest.approx(high.at(0.0, HERE)[2])
    assert low.at(5.0, HERE)[2] != pytest.approx(high.at(5.0, HERE)[2], rel=0.01)
    assert dryden("light", 50.0).sigma_w == pytest.approx(1.5 * KNOT)


def test_calm_and_steady_air_is_known_to_be_so() -> None:
    assert make_scene(plan()).air.steady == (0.0, 0.0, 0.0)
    steady = make_scene(plan(air={"wind": {"kind": "steady", "speed_mps": 5, "from_deg": 90}})).air
    assert steady.steady == pytest.approx((-5.0, 0.0, 0.0))
    sheared = make_scene(plan(air={"wind": {"kind": "power_law", "speed_mps": 5, "from_deg": 90}})).air
    assert (sheared.steady, sheared.uniform) == (None, None)
    assert turbulent().steady is None
    assert turbulent().uniform == (0.0, 0.0, 0.0)
