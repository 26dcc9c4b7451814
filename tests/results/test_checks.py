"""The check campaigns are judged as their comments say, and each judge refuses what is wrong."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from testbed import expand, fly, load_campaign, measure
from testbed.campaign.words.settings import Campaign, FlightPlan
from testbed.core.units import DEG
from testbed.flight.air.dryden import autocorrelation
from testbed.flight.plants import jsbsim_start
from testbed.flight.plants.aircraft import Aircraft
from testbed.flight.record import FlightRecord, Outcome
from testbed.flight.traffic import track as traffic
from testbed.results.checks import CHECKS, CheckResult, Flown, csv_bytes, evidence, judge
from testbed.results.checks.steady import circle_through
from testbed.results.checks.turbulence import variance_of_power
from testbed.run import journal
from testbed.run.job import Job, run_job

FOLDER = Path(__file__).resolve().parents[2] / "campaigns" / "check"
NAMES = sorted(file.stem for file in FOLDER.glob("*.yaml"))
QUICK = {"clearance", "energy", "excess_power", "gust_response", "modes", "trims"}
MISSED: dict[str, set[str]] = {}  # by campaign, which says why; none at present
Flights = tuple[Campaign, list[FlightRecord]]


def flown(name: str, *cells: str, overrides: Sequence[str] = ()) -> Flights:
    """A check campaign and its flights, or those whose cell holds one of the words."""
    campaign = load_campaign(FOLDER / f"{name}.yaml", overrides)
    plans = [plan for plan in expand(campaign) if not cells or any(word in plan.cell for word in cells)]
    return campaign, [(once if name == LONG else fly)(plan) for plan in plans]


LONG = "turbulence"
_once: dict[str, FlightRecord] = {}


def once(plan: FlightPlan) -> FlightRecord:
    """The flight, which lasts for minutes and is flown for several tests; nobody changes the record."""
    if plan.flight_id not in _once:
        _once[plan.flight_id] = fly(plan)
    return _once[plan.flight_id]


@pytest.fixture(scope="module", autouse=True)
def _forgotten() -> Iterator[None]:
    yield
    _once.clear()


def judged(campaign: Campaign, records: Sequence[FlightRecord]) -> tuple[CheckResult, ...]:
    """The verdict on records, with rows made of them as a run does."""
    assert campaign.check is not None
    rows = [
        asdict(measure(record)) | {"events": [asdict(e) for e in record.events], "evidence": evidence(campaign.check, record)}
        for record in records
    ]
    return judge(campaign.check, [Flown(record.plan, row) for record, row in zip(records, rows, strict=True)], len(records))


def misses(campaign: Campaign, records: Sequence[FlightRecord]) -> set[str]:
    return {line.quantity for line in judged(campaign, records) if not line.passed}


def with_plan(record: FlightRecord, **changes: object) -> FlightRecord:
    """The same flight, said to have been flown under another plan."""
    return replace(record, plan=FlightPlan.model_validate(record.plan.model_dump() | changes))


def with_column(record: FlightRecord, name: str, change: Callable[[Any], Any]) -> FlightRecord:
    """The same flight with a column that is wrong."""
    return replace(record, columns=record.columns | {name: change(record.columns[name])})


@pytest.mark.parametrize("name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in NAMES])
def test_the_check_campaigns_are_judged_as_they_say(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if name == LONG:
        monkeypatch.setattr("testbed.flight.fly.fly", once)
    campaign = load_campaign(FOLDER / f"{name}.yaml")
    assert campaign.check is not None
    plans = expand(campaign)
    results = [journal.decode(journal.encode(run_job(Job(plan, check=campaign.check)))) for plan in plans]
    lines = judge(campaign.check, [Flown(plan, result.row) for plan, result in zip(plans, results, strict=True)], len(plans))
    assert {line.quantity for line in lines if not line.passed} == MISSED.get(name, set())
    assert len({line.quantity for line in lines}) == len(lines) > 1
    assert ("MISSES" in campaign.check.tolerance) == (name in MISSED)


def test_every_kind_of_check_has_a_campaign_and_a_judge() -> None:
    assert {load_campaign(FOLDER / f"{name}.yaml").check.kind for name in NAMES} == set(CHECKS)


def test_the_wind_triangle_of_another_wind_fails() -> None:
    campaign, records = flown("wind_triangle", "kinematic/45")
    assert not misses(campaign, records)
    other = {"wind": {"kind": "steady", "speed_mps": 9.5, "from_deg": 45}}
    assert misses(campaign, [with_plan(record, air=other) for record in records]) == {"kinematic: ground speed", "kinematic: drift angle"}


def test_a_naive_planner_is_not_invariant() -> None:
    campaign, records = flown("wind_invariance", "scoam/kinematic", overrides=["replan.vo_frame=ground_naive"])
    assert misses(campaign, records) >= {f"scoam, kinematic: {kind} off by" for kind in ("place", "velocity", "angle")}


def test_a_flight_without_a_decision_is_not_invariant() -> None:
    campaign, records = flown("wind_invariance", "scoam/kinematic")
    assert misses(campaign, [*records[:1], *(replace(record, events=()) for record in records[1:])])


def test_a_gust_that_comes_late_fails() -> None:
    campaign, records = flown("gust_response", "gtm_t2")
    late = [
        with_column(r, "own.load_factor", lambda n: np.roll(n, 3)) if r.plan.air.gust.kind == "one_minus_cosine" else r for r in records
    ]
    assert not misses(campaign, records)
    assert misses(campaign, late)


def test_a_point_that_a_gust_does_not_load_enough_fails() -> None:
    campaign, records = flown("gust_response", "gtm_t2")
    light = [
        with_column(r, "own.load_factor", lambda n: 1.0 + 0.9 * (n - 1.0)) if r.plan.plant.kind == "point_mass" else r for r in records
    ]
    assert misses(campaign, light) == {"point_mass gtm_t2: peak"}


@pytest.mark.slow
def test_turbulence_of_another_severity_or_scale_fails() -> None:
    """One flight is enough to tell severe from light; four to see that the air was taken for slower than it was."""
    campaign, records = flown("turbulence", "kinematic", overrides=["replicates=4"])
    light = {"turbulence": {"kind": "dryden", "severity": "light"}}
    low = {"turbulence": {"kind": "dryden", "severity": "moderate", "height_m": 15.0}}
    assert any("sigma" in quantity for quantity in misses(campaign, [with_plan(record, air=light) for record in records]))
    assert any("power" in quantity for quantity in misses(campaign, [with_plan(record, air=low) for record in records]))


@pytest.mark.slow
def test_air_that_turns_another_wing_fails() -> None:
    """A quarter more span is more than the statistics allow, and so is a fifth less of the rates; without a span none is judged."""
    campaign, records = flown("turbulence", "gtm_t2", overrides=["replicates=4"])
    assert not misses(campaign, records)
    rates = {f"dryden in jsbsim gtm_t2: {what} {axis}" for what in ("sigma", "power") for axis in ("roll", "pitch", "yaw")}
    weak = [with_column(record, "air.rotation_body_radps", lambda rotation: 0.8 * rotation) for record in records]
    assert {name.split(" from ")[0] for name in misses(campaign, weak)} == rates
    wide, wider = flown("turbulence", "gtm_t2", overrides=["replicates=4", "check.span_m=2.6"])
    assert misses(wide, wider) >= {name for name in rates if "sigma" in name}
    still, stiller = flown("turbulence", "gtm_t2", overrides=["replicates=1", "check.span_m="])
    assert not any(name in str(judged(still, stiller)) for name in ("roll", "pitch", "yaw"))


def test_a_turn_with_another_bank_or_a_slip_fails() -> None:
    campaign, records = flown("steady_turn", "gtm_t2/left")
    assert not misses(campaign, records)
    shallow = [with_column(record, "own.bank_rad", lambda bank: 0.97 * bank) for record in records]
    slipping = [with_column(record, "own.beta_rad", lambda beta: beta + 0.6 * DEG) for record in records]
    assert misses(campaign, shallow) == {"jsbsim gtm_t2, gtm_t2/left: radius"}
    assert misses(campaign, slipping) == {"jsbsim gtm_t2, gtm_t2/left: sideslip"}


def test_an_aircraft_of_another_weight_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """A broken plant: with 2 lb less fuel in the tank (3.5 % of its weight) the aircraft is not the one of its data sheet."""
    load = jsbsim_start.load_model

    def light(aircraft: Aircraft, plant_hz: int, air_turns: bool = False) -> Any:
        fdm = load(aircraft, plant_hz, air_turns)
        fdm["propulsion/tank/contents-lbs"] = 9.48
        return fdm

    monkeypatch.setattr(jsbsim_start, "load_model", light)
    assert misses(*flown("energy", "none"))
    assert misses(*flown("excess_power", "jsbsim"))
    assert {quantity.split(": ")[1] for quantity in misses(*flown("trims"))} == {"angle of attack", "throttle"}


def test_a_trim_of_another_model_fails() -> None:
    campaign, records = flown("trims", "deg_11")
    assert not misses(campaign, records)
    wrong = [with_column(record, "own.throttle", lambda throttle: throttle + 0.011) for record in records]
    assert misses(campaign, wrong) == {"jsbsim gtm_t2, climb of 11 deg: throttle"}


def test_the_modes_of_another_speed_fail() -> None:
    """Frequencies grow with the airspeed, time constants fall."""
    campaign, records = flown("modes", overrides=["speed_mps=53"])
    assert misses(campaign, records) >= {"jsbsim gtm_t2, base: roll mode", "jsbsim gtm_t2, base: dutch roll"}


def test_a_clearance_of_samples_alone_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    def nearest_sample(time_s: Any, own: Any, obstacle: Any, radius_m: float) -> Any:
        distance = np.linalg.norm(own - obstacle, axis=1)
        k = int(np.argmin(distance))
        return traffic.Approach(float(distance[k]) - radius_m, float(time_s[k]))

    campaign, records = flown("clearance", "kinematic")
    assert not misses(campaign, records)
    monkeypatch.setattr("testbed.results.quantities.least_clearance", nearest_sample)
    assert len(misses(campaign, records)) == 6  # all but the flight that meets on a sample


def test_a_flight_that_does_not_converge_fails() -> None:
    """Two flights of the point mass exchanged: the error grows with the rate."""
    campaign, records = flown("convergence", "point_mass")
    assert not misses(campaign, records)
    rates = [{"plant_hz": hz, "guidance_hz": 60, "planner_hz": 60} for hz in (120, 480, 240, 960)]
    shown = [replace(with_plan(r, rates=rate), columns=_thinned(r, rate["plant_hz"])) for r, rate in zip(records, rates, strict=True)]
    assert "point_mass gtm_t2: what doubling the rate leaves of the error" in misses(campaign, shown)


def _thinned(record: FlightRecord, hz: int) -> dict[str, Any]:
    """Columns of a flight as if they had been recorded at another rate."""
    time_s = record.columns["time_s"]
    rows = np.clip(np.round(np.arange(0.0, time_s[-1], 1.0 / hz) * record.plan.rates.plant_hz).astype(int), 0, len(time_s) - 1)
    return {name: column[rows] for name, column in record.columns.items()}


def test_a_flight_that_failed_is_a_miss() -> None:
    campaign, records = flown("clearance", "kinematic")
    lost = [replace(records[0], outcome=Outcome.DIVERGED), *records[1:]]
    assert misses(campaign, lost) == {"flights that can be judged"}
    assert misses(campaign, lost[:1]) == {"flights that can be judged", "something to compare"}


def test_nothing_to_compare_is_a_miss() -> None:
    campaign, records = flown("gust_response", "gtm_t2/none")
    assert misses(campaign, records) == {"something to compare"}


def test_no_number_is_no_pass() -> None:
    assert not CheckResult("x", "m", 0.0, math.nan, 1.0).passed


def test_the_lines_as_csv() -> None:
    lines = [CheckResult("a, b", "m", 1.0, 1.5, 0.5), CheckResult("c", "", 0.0, math.nan, 0.1)]
    text = csv_bytes("trims", lines).decode()
    assert text.splitlines() == [
        "check,quantity,unit,truth,measured,tolerance,verdict",
        'trims,"a, b",m,1.0,1.5,0.5,passed',
        "trims,c,,0.0,,0.1,missed",
    ]


def test_the_circle_through_points_of_an_arc() -> None:
    angle = np.linspace(0.3, 1.1, 50)
    assert circle_through(np.column_stack([40.0 * np.cos(angle) + 7.0, 40.0 * np.sin(angle) - 900.0])) == pytest.approx(40.0, rel=1e-9)


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
