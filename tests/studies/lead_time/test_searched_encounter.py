"""Encounters are of the class that is asked for, the same for all, and met with the lead that is asked for."""

import math

import numpy as np
import pytest
from scipy.stats import kstest

from testbed import fly, measure
from testbed.campaign.words.settings import FlightPlan
from testbed.studies.lead_time.searched_encounter import at_lead, drawn
from tests.studies.lead_time.studies import AT_ONCE, HEAD_WIND, RAILS, SIDE_WIND, STUDY, study


def test_the_class_is_that_of_the_study() -> None:
    plan = study()
    found = [drawn(plan.model_copy(update={"replicate": replicate})) for replicate in range(600)]
    speeds = np.array([np.linalg.norm(one.obstacle_vel_mps) for one in found])
    directions = np.array([one.obstacle_vel_mps for one in found]) / speeds[:, None]
    radii = np.array([one.radius_m for one in found])
    misses = np.array([np.linalg.norm(one.miss_m) for one in found])
    assert kstest((speeds - 20.0) / 30.0, "uniform").pvalue > 1e-3
    assert kstest((radii - 25.0) / 5.0, "uniform").pvalue > 1e-3
    assert kstest((misses / radii) ** 2, "uniform").pvalue > 1e-3  # even in area on the disc
    for axis in range(3):  # every coordinate of a direction that is even on the sphere is even in [-1, 1]
        assert kstest(0.5 * (directions[:, axis] + 1.0), "uniform").pvalue > 1e-3
    for one in found:
        assert abs(one.miss_m @ one.closing_mps) < 1e-9 * one.closing_speed_mps * one.radius_m
        assert one.entry_s < STUDY["leads_s"][-1]
        assert np.allclose(one.closing_mps + one.obstacle_vel_mps, [50.0, 0.0, 0.0])


def test_what_is_compared_meets_the_same_encounter() -> None:
    first = drawn(study())
    for other in (study(**RAILS), study(aircraft="c172p", **AT_ONCE), study(method={"kind": "droam_hp"}), study(**SIDE_WIND)):
        assert np.array_equal(drawn(other).miss_m, first.miss_m)
        assert np.array_equal(drawn(other).closing_mps, first.closing_mps)


def test_entry_is_where_straight_flight_enters_the_sphere() -> None:
    one = drawn(study())
    place = one.miss_m - one.entry_s * one.closing_mps
    assert np.linalg.norm(place) == pytest.approx(one.radius_m, abs=1e-9)


@pytest.mark.parametrize("air", [{}, HEAD_WIND, SIDE_WIND], ids=["calm", "head_wind", "side_wind"])
def test_without_a_planner_the_closest_approach_is_the_lead_after_the_trigger(air: dict) -> None:
    plan = study(method={"kind": "none"}, options=STUDY | {"run_up_s": 0.5}, **RAILS, **air)
    one = drawn(plan)
    row = measure(fly(at_lead(plan, one, 1.37)))
    assert row.time_at_least_clearance_s == pytest.approx(0.5 + 1.37, abs=1e-6)
    assert row.least_clearance_m == pytest.approx(float(np.linalg.norm(one.miss_m)) - one.radius_m, abs=1e-6)


def triggered(plan: FlightPlan, lead_s: float) -> tuple[float, float]:
    """Time of the first decision, and the time to the closest approach that the planner saw."""
    event = fly(at_lead(plan, drawn(plan), lead_s)).events[0]
    return event.time_s, event.time_to_cpa_s


@pytest.mark.parametrize("air", [{}, SIDE_WIND], ids=["calm", "side_wind"])
@pytest.mark.parametrize("run_up_s", [0.0, 0.5])
def test_the_trigger_falls_on_the_lead(air: dict, run_up_s: float) -> None:
    """Not a look earlier or later, also for leads that are no multiple of a look."""
    plan = study(options=STUDY | {"run_up_s": run_up_s}, **RAILS, **air)
    for lead_s in (0.9, 1.0, 1.2345, 2.0):
        time_s, to_cpa = triggered(plan, lead_s)
        assert time_s == pytest.approx(run_up_s, abs=1e-9)
        assert to_cpa == pytest.approx(lead_s, abs=1e-6)


@pytest.mark.slow
def test_the_trigger_falls_on_the_lead_in_flight_too() -> None:
    for aircraft in ("gtm_t2", "c172p"):
        time_s, to_cpa = triggered(study(aircraft=aircraft, options=STUDY | {"run_up_s": 1.0}), 1.5)
        assert time_s == 1.0
        assert to_cpa == pytest.approx(1.5, abs=1e-3)


def test_the_range_is_closing_speed_times_lead_and_the_radius() -> None:
    one = drawn(study())
    start = one.miss_m - 2.0 * one.closing_mps
    assert math.isclose(one.range_m(2.0), 2.0 * one.closing_speed_mps + one.radius_m)
    assert np.linalg.norm(start) <= one.range_m(2.0)
