"""Straight flight of the aircraft, against the figures that gtm_t2's source gives for this very model."""

import math

import pytest

from testbed.airframe.trim import fastest_level, lift_curve, stall_speed, steepest_climb, trim, trim_table
from testbed.core.units import DEG
from testbed.flight.plants.aircraft import load_aircraft

GTM = load_aircraft("gtm_t2")


@pytest.mark.parametrize(("climb", "alpha", "throttle"), [(0, 2.96, 0.402), (11, 2.76, 0.763), (20, 2.50, 0.990)])
def test_gtm_t2_trims_as_published(climb: float, alpha: float, throttle: float) -> None:
    point = trim(GTM, 50.0, climb * DEG)
    assert point is not None
    assert point.alpha_rad / DEG == pytest.approx(alpha, abs=0.1)
    assert point.throttle == pytest.approx(throttle, abs=0.01)


def test_gtm_t2_climbs_as_steeply_as_published() -> None:
    """In quarter degrees, as it was published; between 20.25 and 20.5 deg the throttle reaches its stop."""
    assert steepest_climb(GTM, 50.0) / DEG == pytest.approx(20.25)


def test_gtm_t2_stalls_as_published() -> None:
    assert stall_speed(GTM, 50.0) == pytest.approx(28.7, abs=0.05)


def test_angle_of_attack_for_a_load_factor() -> None:
    curve = lift_curve(GTM, 50.0)
    assert curve.alpha_for(2.6) / DEG == pytest.approx(10.0, abs=0.15)  # the published limit of good data: 2.6 g
    assert curve.lift_at(curve.alpha_for(2.0)) == pytest.approx(2.0)
    assert curve.most == pytest.approx(3.0, abs=0.05)
    assert math.isnan(curve.alpha_for(3.5))


def test_level_lift_is_what_the_thrust_does_not_carry() -> None:
    """At the trimmed angle of attack lift = weight - thrust sin(alpha + tilt), some 1 % here."""
    point = trim(GTM, 50.0)
    assert point is not None
    assert 0.98 < lift_curve(GTM, 50.0).lift_at(point.alpha_rad) < 1.0


def test_no_trim_is_no_error() -> None:
    assert trim(GTM, 15.0) is None
    assert math.isnan(steepest_climb(GTM, 15.0))
    (row,) = trim_table(GTM, [15.0, 50.0], [0.0])
    assert row[0] is None
    assert row[1] is not None


@pytest.mark.slow
def test_the_fastest_level_flight() -> None:
    t37 = load_aircraft("t37")
    fastest = fastest_level(t37, 90.0, 200.0)
    assert trim(t37, fastest) is not None
    assert fastest == 200.0 or trim(t37, fastest + 1.0) is None
