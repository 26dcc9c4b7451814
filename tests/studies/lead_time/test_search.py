"""The search finds the least lead: against fine grids, and where the truth is known."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from testbed.studies.lead_time.search import clearance_at, least_lead, search
from testbed.studies.lead_time.searched_encounter import drawn
from tests.studies.lead_time.studies import AT_ONCE, RAILS, STUDY, study

GRID = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0)


@given(least=st.floats(0.001, 7.0))
def test_a_threshold_is_found_within_the_tolerance(least: float) -> None:
    found = least_lead(lambda lead_s: lead_s >= least, GRID, 0.02)
    if least > GRID[-1]:
        assert math.isinf(found)
    else:
        assert least <= found <= least + 0.02


@given(kept=st.lists(st.booleans(), min_size=7, max_size=7), low=st.floats(0.0, 0.4))
def test_the_least_lead_lies_above_the_last_failure_of_the_grid(kept: list[bool], low: float) -> None:
    """Between two leads of the grid the answer is that of the longer one, so that the least lead is the failure itself, bisected."""
    found = least_lead(lambda lead_s: kept[min(k for k, lead in enumerate(GRID) if lead_s <= lead)], GRID, 0.02, low)
    if not kept[-1]:
        assert math.isinf(found)
        return
    failures = [lead for lead, was in zip(GRID, kept, strict=True) if not was]
    above = max([low, *failures])
    assert above < found <= above + 0.02


@pytest.mark.parametrize("replicate", range(3))
def test_a_velocity_that_jumps_keeps_the_radius_from_the_edge_of_the_sphere_on(replicate: int) -> None:
    """What a velocity obstacle promises holds where the velocity is flown at once: at any lead, with nothing to spare."""
    found = search(study(replicate=replicate, **RAILS, **AT_ONCE))
    assert found.entry_s < found.lead_s <= found.entry_s + 0.02 + 1e-9
    touching = [clear for clear, lead_s in zip(found.grid_clearance_m, STUDY["leads_s"], strict=True) if lead_s > found.entry_s]
    assert np.allclose(touching, 0.0, atol=1e-6)
    assert abs(found.lead_s - found.best_s) <= 0.02 + 1e-9


@pytest.mark.slow
def test_the_search_agrees_with_a_fine_grid_of_flights() -> None:
    plan = study(plant={"kind": "point_mass"}, replan={"answer": "direct", "swell_m": 8.0, "rejoin": {"when": "clear"}})
    one = drawn(plan)
    found = search(plan)
    fine = np.arange(0.5, 3.001, 0.05)
    kept = [clearance_at(plan, one, float(lead_s)) >= 0.0 for lead_s in fine]
    least = next(lead_s for k, lead_s in enumerate(fine) if all(kept[k:]))
    assert least - 0.05 <= found.lead_s <= least + 0.02
    assert found.fails_again == 0
    assert found.flights <= len(STUDY["leads_s"]) + 7


def test_a_trigger_inside_of_the_sphere_is_too_late_without_a_flight() -> None:
    plan = study(**RAILS)
    one = drawn(plan)
    assert clearance_at(plan, one, 0.5 * one.entry_s) == pytest.approx(float(np.linalg.norm(one.miss_m)) - one.radius_m)


def test_without_a_planner_no_lead_suffices() -> None:
    found = search(study(method={"kind": "none"}, **RAILS))
    assert math.isinf(found.lead_s)
    assert math.isinf(found.range_m)
    assert found.fails_again == 0
    assert math.isfinite(found.best_s)
    assert np.allclose(found.grid_clearance_m, found.miss_m - found.radius_m, atol=1e-6)


@pytest.mark.slow
def test_the_same_search_gives_the_same_numbers() -> None:
    plan = study(aircraft="c172p")
    assert search(plan) == search(plan)
