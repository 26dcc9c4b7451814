"""What the pose of a re-plan asks of an aircraft, against closed forms of circles."""

import math

import numpy as np
import pytest

from testbed.airframe.proof_courses import turn_radius, turn_radius_at
from testbed.core.frames import unit_from_direction
from testbed.flight.plants.aircraft import load_aircraft
from testbed.studies.scoam.pose import pose_reach

G0 = 9.80665
LIMITS = load_aircraft("gtm_t2").limits


def test_turn_radius_at_a_load_factor_is_that_at_its_bank():
    assert turn_radius_at(50.0, 2.0) == pytest.approx(turn_radius(50.0, math.acos(1 / 2.0)))
    assert turn_radius_at(50.0, 1.0) == math.inf


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_level_quarter_circle(side):
    reach = pose_reach((0, 0, 0), (50, 0, 0), (200, side * 200, 0), (0, side * 50, 0), LIMITS)
    pull = 2500.0 / 200.0 / G0
    assert reach.radius_m == pytest.approx(200.0)
    assert reach.load_factor == pytest.approx(math.hypot(1.0, pull))
    assert reach.bank_deg == pytest.approx(-side * math.degrees(math.atan(pull)))  # right positive, left is +y
    assert reach.reachable
    assert reach.wide_enough


def test_a_pull_up_adds_gravity():
    radius = 300.0
    there = (radius * math.sin(0.3), 0, radius * (1 - math.cos(0.3)))
    reach = pose_reach((0, 0, 0), (50, 0, 0), there, (50 * math.cos(0.3), 0, 50 * math.sin(0.3)), LIMITS)
    assert reach.load_factor == pytest.approx(1.0 + 2500.0 / radius / G0, rel=1e-6)
    assert reach.load_factor_least == pytest.approx(math.cos(0.3) + 2500.0 / radius / G0, rel=1e-6)


def test_straight_ahead_and_behind():
    ahead = pose_reach((0, 0, 0), (50, 0, 0), (100, 0, 0), (50, 0, 0), LIMITS)
    assert (ahead.radius_m, ahead.load_factor, ahead.bank_deg, ahead.reachable) == (math.inf, 1.0, 0.0, True)
    behind = pose_reach((0, 0, 0), (50, 0, 0), (-100, 0, 0), (50, 0, 0), LIMITS)
    assert (behind.radius_m, behind.load_factor, behind.reachable) == (0.0, math.inf, False)


def test_pose_of_section_5_1_is_out_of_reach_of_every_aircraft_here():
    velocity, command = (tuple(50.0 * np.array(unit_from_direction(*d))) for d in ((24.7, 12.0), (36.6, 13.2)))
    for name in ("gtm_t2", "c172p", "t37"):
        reach = pose_reach((162, 101, 64.3), velocity, (226.34, 159.56, 79.05), command, load_aircraft(name).limits)
        assert reach.radius_m == pytest.approx(102.53, abs=0.01)
        assert reach.load_factor == pytest.approx(3.01, abs=0.01)
        assert reach.is_bound
        assert not reach.reachable
        assert reach.radius_m > reach.steepest_radius_m  # not ruled out by curvature alone
