"""The check campaigns pass, and each judge refuses what is wrong."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from testbed import expand, fly, load_campaign
from testbed.flight.air.dryden import autocorrelation
from testbed.results.checks import CHECKS, CheckResult, judge, variance_of_power
from testbed.spec.model import Campaign, FlightPlan
from testbed.types import FlightRecord

FOLDER = Path(__file__).resolve().parents[2] / "campaigns" / "check"
SLOW = {"turbulence", "turbulence_jsbsim"}
MINE = ["wind_triangle", "wind_invariance", "gust_response", "turbulence", "turbulence_jsbsim"]


def flown(name: str, *cells: str) -> tuple[Campaign, list[FlightRecord]]:
    """A check campaign and its flights, or those whose cell holds one of the words."""
    campaign = load_campaign(FOLDER / f"{name}.yaml")
    plans = [plan for plan in expand(campaign) if not cells or any(word in plan.cell for word in cells)]
    return campaign, [fly(plan) for plan in plans]


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in MINE])
def test_the_check_campaigns_pass(name: str) -> None:
    campaign, records = flown(name)
    results = judge(campaign, records)
    assert [result for result in results if not result.passed] == []
    assert len({result.quantity for result in results}) == len(results)


def with_plan(record: FlightRecord, **changes: object) -> FlightRecord:
    """The same flight, said to have been flown under another plan."""
    return replace(record, plan=FlightPlan.model_validate(record.plan.model_dump() | changes))


def failures(campaign: Campaign, records: list[FlightRecord]) -> list[CheckResult]:
    return [result for result in judge(campaign, records) if not result.passed]


def test_the_wind_triangle_of_another_wind_fails() -> None:
    campaign, records = flown("wind_triangle", "kinematic/45")
    assert failures(campaign, records) == []
    other = {"wind": {"kind": "steady", "speed_mps": 9.5, "from_deg": 45}}
    assert len(failures(campaign, [with_plan(record, air=other) for record in records])) == 2


def test_a_naive_planner_is_not_invariant() -> None:
    campaign = load_campaign(FOLDER / "wind_invariance.yaml", ["replan.vo_frame=ground_naive"])
    records = [fly(plan) for plan in expand(campaign) if "scoam/kinematic" in plan.cell]
    assert {failure.quantity.split(": ")[1] for failure in failures(campaign, records)} >= {"place, m", "velocity, m/s", "angle, deg"}


def test_a_flight_without_a_decision_is_not_invariant() -> None:
    campaign, records = flown("wind_invariance", "scoam/kinematic")
    assert failures(campaign, [*records[:1], *(replace(record, events=()) for record in records[1:])])


def test_a_gust_that_comes_late_fails() -> None:
    campaign, records = flown("gust_response", "gtm_t2")
    late = [
        replace(r, columns=r.columns | {"own.load_factor": np.roll(r.columns["own.load_factor"], 3)})
        if r.plan.air.gust.kind == "one_minus_cosine"
        else r
        for r in records
    ]
    assert failures(campaign, records) == []
    assert failures(campaign, late)


def test_turbulence_of_another_severity_or_scale_fails() -> None:
    """One flight is enough to tell severe from light; four to see that the air was taken for slower than it was."""
    campaign = load_campaign(FOLDER / "turbulence.yaml", ["replicates=4"])
    records = [fly(plan) for plan in expand(campaign) if "kinematic" in plan.cell]
    light = {"turbulence": {"kind": "dryden", "severity": "light"}}
    low = {"turbulence": {"kind": "dryden", "severity": "moderate", "height_m": 15.0}}
    assert any("sigma" in failure.quantity for failure in failures(campaign, [with_plan(record, air=light) for record in records]))
    assert any("power" in failure.quantity for failure in failures(campaign, [with_plan(record, air=low) for record in records]))


def test_no_number_is_no_pass() -> None:
    assert not CheckResult("x", 0.0, math.nan, 1.0).passed


def test_nothing_to_judge_is_said() -> None:
    campaign, _ = flown("gust_response", "no such cell")
    with pytest.raises(ValueError, match="none of the 0 flights can be judged"):
        judge(campaign, [])


def test_every_kind_of_check_has_a_judge() -> None:
    kinds = {load_campaign(FOLDER / f"{name}.yaml").check.kind for name in MINE}
    assert kinds <= set(CHECKS)


def test_the_variance_of_a_measured_power_is_right() -> None:
    """Mean squares of 2000 exact first-order series of 20 s, tau = 1 s, against 2/T^2 int int R^2."""
    rng = np.random.default_rng(2)
    n, tau, dt = 400, 1.0, 0.05
    decay = math.exp(-dt / tau)
    series = np.empty((2000, n))
    series[:, 0] = rng.normal(size=2000)
    for k in range(1, n):
        series[:, k] = decay * series[:, k - 1] + math.sqrt(1 - decay**2) * rng.normal(size=2000)
    assert autocorrelation(np.array(dt), tau, False) == pytest.approx(decay)
    assert np.var(np.mean(series**2, axis=1)) == pytest.approx(variance_of_power(tau, False, [n * dt]), rel=0.15)
