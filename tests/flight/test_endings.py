"""Whatever a plan asks for, it ends in an outcome with a sentence; a fault of the program is none of them."""

from typing import Any
from unittest import mock

import numpy as np
import pytest

from testbed import fly, measure
from testbed.core.chain import Chain
from testbed.flight import scene as scenes
from testbed.flight.planning.replan import Replanner
from testbed.flight.record import FlightRecord, Outcome
from testbed.results.empty import undeclared
from testbed.run.job import Job, run_job
from tests.plans import plan
from vosc.errors import SamePoint

STRAIGHT = {"start_enu_m": [0, 0, 0], "goal_enu_m": [900, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
PLANTS = ["kinematic", "point_mass", "jsbsim"]


def flown(**changes: Any) -> FlightRecord:
    """A flight, and its row looked at."""
    a_plan = plan(**{"route": STRAIGHT} | changes)
    record = fly(a_plan)
    with mock.patch("testbed.flight.fly.fly", return_value=record):
        row = run_job(Job(a_plan)).row
    assert row["outcome"] != "crashed", row["traceback"]
    assert undeclared(row) == []
    return record


@pytest.mark.parametrize("plant", PLANTS)
@pytest.mark.parametrize("kind", [{"kind": "steady"}, {"kind": "power_law", "exponent": 1}])
def test_a_wind_over_the_airspeed_is_no_path(plant: str, kind: dict[str, Any]) -> None:
    record = flown(plant={"kind": plant}, speed_mps=35, air={"wind": {**kind, "speed_mps": 37, "from_deg": 90}})
    assert record.outcome is Outcome.NO_PATH
    assert "the wind is too strong" in record.message


@pytest.mark.parametrize("plant", PLANTS)
@pytest.mark.parametrize(("terrain_z_m", "words"), [(0, "on the ground"), (40, "40.0 m under the ground")])
def test_a_start_at_or_under_the_ground_hits_it(plant: str, terrain_z_m: float, words: str) -> None:
    record = flown(plant={"kind": plant}, terrain_z_m=terrain_z_m)
    assert record.outcome is Outcome.HIT_GROUND
    assert words in record.message


@pytest.mark.slow
@pytest.mark.parametrize("plant", PLANTS)
@pytest.mark.parametrize("guidance", ["look_ahead", "l1"])
@pytest.mark.parametrize("elevation", [90, -90])
def test_a_vertical_tangent_is_an_outcome(plant: str, guidance: str, elevation: float) -> None:
    route = STRAIGHT | {"goal_enu_m": [600, 0, 300], "start_direction_deg": [0, elevation]}
    record = flown(plant={"kind": plant}, route=route, guidance={"kind": guidance}, terrain_z_m=-600)
    assert record.outcome is Outcome.REACHED or plant != "kinematic"


def test_a_vertical_goal_is_reached_by_a_point() -> None:
    assert flown(plant={"kind": "kinematic"}, route=STRAIGHT | {"goal_direction_deg": [58.5, 90]}).outcome is Outcome.REACHED


def test_a_ground_speed_that_is_the_wind_leaves_no_airspeed() -> None:
    """The point mass stands still in the air: it falls, or is late, and divides by nothing."""
    record = flown(
        plant={"kind": "point_mass"},
        speed_hold="groundspeed",
        speed_mps=36,
        air={"wind": {"kind": "steady", "speed_mps": 36, "from_deg": 270}},
    )
    assert record.outcome in (Outcome.HIT_GROUND, Outcome.TIMED_OUT, Outcome.REACHED)


def test_a_flight_that_ends_at_its_first_tick_has_a_log() -> None:
    high = STRAIGHT | {"start_enu_m": [0, 0, 1e5], "goal_enu_m": [900, 0, 1e5]}
    record = flown(plant={"kind": "kinematic"}, route=high)
    assert record.outcome is Outcome.DIVERGED
    assert len(record.columns["time_s"]) == len(record.columns["guidance.s_m"]) == 1
    assert measure(record).begin_s_m == 0.0


@pytest.mark.parametrize(
    ("limits", "obstacles", "longest_s", "name"), [({"flight_s": 7}, 0, 7.0, "flight_s"), ({"log_mb": 10}, 40, 21.9, "log_mb")]
)
def test_a_flight_ends_at_its_limit_and_says_which(limits: dict[str, float], obstacles: int, longest_s: float, name: str) -> None:
    far = {"radius_m": 5, "position_enu_m": [0, 9000, 0], "speed_mps": 0, "direction_deg": [0, 0]}
    crowd = [far | {"name": f"O{k}"} for k in range(obstacles)]
    route = STRAIGHT | {"goal_enu_m": [2000, 0, 0]}
    record = flown(plant={"kind": "kinematic"}, limits=limits, route=route, obstacles=crowd)
    assert record.outcome is Outcome.TIMED_OUT
    assert f"the longest flight that limits.{name} allows" in record.message
    assert record.columns["time_s"][-1] == pytest.approx(longest_s, abs=0.1)
    assert record.longest_s == pytest.approx(longest_s, abs=0.1)


def test_no_route_is_told_by_name_and_a_fault_of_the_program_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuses(*_: Any) -> None:
        raise SamePoint("p0 and p1 are the same")

    def fails(*_: Any) -> None:
        raise ValueError("an array of the wrong shape")

    monkeypatch.setattr(scenes.ph, "hermite", refuses)
    record = fly(plan(plant={"kind": "kinematic"}))
    assert (record.outcome, record.message) == (Outcome.NO_PATH, "no route: p0 and p1 are the same")
    monkeypatch.setattr(scenes.ph, "hermite", fails)
    row = run_job(Job(plan(plant={"kind": "kinematic"}))).row
    assert row["outcome"] == "crashed"
    assert "in _chain" in row["traceback"]


@pytest.mark.parametrize("place", ["when_clear", "way"])
def test_a_fault_in_the_way_back_is_no_reason_to_fly_on(monkeypatch: pytest.MonkeyPatch, place: str) -> None:
    def fails(*_: Any, **__: Any) -> None:
        raise ValueError("an array of the wrong shape")

    start = Replanner.start

    def started(self: Replanner, context: Any) -> Any:
        memory = start(self, context)
        monkeypatch.setattr(self._rejoin, place, fails)
        return memory

    monkeypatch.setattr(Replanner, "start", started)
    standing = {"name": "A", "radius_m": 25, "position_enu_m": [400, 5, 0], "speed_mps": 0, "direction_deg": [0, 0]}
    answer = "direct" if place == "when_clear" else "insertion_point"
    row = run_job(Job(plan(route=STRAIGHT, plant={"kind": "kinematic"}, obstacles=[standing], replan={"answer": answer}))).row
    assert (row["outcome"], row["message"]) == ("crashed", "ValueError: an array of the wrong shape")


# ---- ways back to routes of many pieces

COURSES = {
    "racetrack": ({"kind": "racetrack", "straight_m": 700, "radius_m": 320, "laps": 2}, [450, 4, 0]),
    "swerve": ({"kind": "swerve", "heading_deg": 12, "swing_m": 280, "swings": 7}, [880, -25, 0]),
}


def on_course(shape: dict[str, Any], place: list[float], plant: str, rejoin: dict[str, Any], answer: str = "direct") -> FlightRecord:
    route = {"start_enu_m": [0, 0, 0], "start_direction_deg": [0, 0], "shape": shape}
    standing = {"name": "A", "radius_m": 25, "position_enu_m": place, "speed_mps": 0, "direction_deg": [0, 0]}
    replan = {"answer": answer, "swell_m": 8, "rejoin": {"to": "route", **rejoin}}
    return fly(plan(route=route, plant={"kind": plant}, obstacles=[standing], sensor={"range_m": 200}, replan=replan))


@pytest.mark.parametrize("plant", ["kinematic", "point_mass"])
@pytest.mark.parametrize("course", COURSES)
def test_a_flight_comes_back_to_a_route_of_many_pieces(course: str, plant: str) -> None:
    record = on_course(*COURSES[course], plant, {"when": "clear"})
    assert len(record.paths[0].curves) > 8
    avoids, back = record.events[:2]
    assert (avoids.decision, back.decision) == ("replanned", "rejoined")
    assert 1.0 < back.time_s - avoids.time_s < 8.0
    route: Chain = record.paths[0].chain
    after = round((back.time_s + 14.0) * record.plan.rates.plant_hz)
    some = slice(after, after + 600, 60)
    off = route.nearest(record.columns["own.pos_enu_m"][some])[1]
    assert off.max() < 5.0
    assert record.columns["time_s"][-1] == pytest.approx(route.length_m / 50.0, rel=0.03), "no lap more, and none less"


def test_the_way_back_at_once_leads_along_the_route_too() -> None:
    record = on_course(*COURSES["racetrack"], "kinematic", {"when": "insertion_point"}, answer="insertion_point")
    assert record.paths[1].chain.length_m == pytest.approx(record.paths[0].chain.length_m, abs=600.0)
    assert record.outcome in (Outcome.REACHED, Outcome.COLLIDED)


@pytest.mark.slow
def test_a_way_back_leads_to_the_lap_that_was_left() -> None:
    """What crosses on the third lap throws nobody back to the first, which passes the same place."""
    shape = {"kind": "racetrack", "straight_m": 600, "radius_m": 300, "laps": 4}
    lap = 2 * 600 + 2 * np.pi * 300
    crosses = {"name": "A", "radius_m": 25, "position_enu_m": [300, 0, 0], "speed_mps": 20, "direction_deg": [90, 0]}
    crosses |= {"when": {"time_s": (2 * lap + 300) / 50}}
    route = {"start_enu_m": [0, 0, 0], "start_direction_deg": [0, 0], "shape": shape}
    replan = {"answer": "direct", "swell_m": 8, "rejoin": {"to": "route"}}
    seen = {"sensor": {"range_m": 200}, "replan": replan, "rates": {"plant_hz": 60}}
    record = fly(plan(route=route, plant={"kind": "kinematic"}, obstacles=[crosses], **seen))
    assert [event.decision for event in record.events] == ["replanned", "rejoined"]
    assert record.outcome in (Outcome.REACHED, Outcome.COLLIDED)  # it may meet again, a lap later, what it has answered once
    assert record.columns["time_s"][-1] == pytest.approx(4 * lap / 50.0, abs=4.0)


def test_a_flight_that_finds_no_gentle_way_takes_the_gentlest_in_the_end() -> None:
    """Radius 100 m: no way back keeps within 45 deg of bank at 50 m/s; a held direction lasts 600 m, and then it turns."""
    shape = {"kind": "racetrack", "straight_m": 900, "radius_m": 100, "laps": 1}
    record = on_course(shape, [880, 0, 0], "kinematic", {"when": "clear"})
    assert [event.decision for event in record.events[:2]] == ["replanned", "rejoined"]
    assert record.outcome is Outcome.REACHED


def test_a_missing_number_without_a_reason_is_found() -> None:
    row = run_job(Job(plan(plant={"kind": "kinematic"}))).row
    assert undeclared(row) == []
    assert undeclared(row | {"max_bank_deg": float("nan")}) == ["max_bank_deg"]
    assert undeclared(row | {"max_bank_deg": float("inf"), "deflection_deg": float("inf")}) == ["deflection_deg", "max_bank_deg"]
    none = run_job(Job(plan(begin={"at_route_s_m": 900}))).row
    assert np.isnan(none["flight_time_s"])
    assert undeclared(none) == []
    assert "path_length_m" in undeclared(none | {"message": ""}), "a flight that was not flown says why"
