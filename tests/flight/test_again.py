"""Threats that are answered again: what asks for it, what comes of it, and that noise is not answered with every look."""

import math
import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from testbed import expand, fly, load_campaign, measure
from testbed.campaign import SpecError
from testbed.campaign.reading.expand import flight_id
from testbed.campaign.words.planning import Replan
from testbed.core.chain import Chain
from testbed.flight.planning.again import Again, Foretold, Past
from testbed.flight.plants.base import State
from testbed.flight.record import FlightRecord, reversals
from testbed.flight.scene import make_scene
from testbed.flight.sensing import Seen
from testbed.show.pilot_log import decided
from tests.plans import KINEMATIC, plan
from vosc import ph

TURNS = """name: x
question: y
plugins: [PLUGIN]
route: {start_enu_m: [0, 0, 0], goal_enu_m: [1500, 0, 0], start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}
obstacles:
  - name: O
    kind: "turning:Turning"
    options: {rate_dps: -6}
    radius_m: 25
    position_enu_m: [400, -200, 0]
    speed_mps: 30
    direction_deg: [120, 0]
sensor: {range_m: 300}
plant: {kind: kinematic}
replan: {swell_m: 5, rejoin: {to: route, when: clear}}
sweep: {replan.answer: [direct, insertion_point], replan.policy: [once, every_s, on_change]}
"""


@cache
def turning() -> dict[tuple[str, str], FlightRecord]:
    """An obstacle turns after the flight as it gives way, by answer and policy."""
    file = Path(__file__).parents[2] / "docs" / "plugins" / "turning.py"
    with tempfile.TemporaryDirectory() as folder:
        campaign = Path(folder) / "x.yaml"
        campaign.write_text(TURNS.replace("PLUGIN", str(file)))
        return {(p.replan.answer, p.replan.policy): fly(p) for p in expand(load_campaign(campaign))}


@pytest.mark.parametrize("answer", ["direct", "insertion_point"])
def test_an_obstacle_that_turns_is_answered_again(answer: str) -> None:
    once, every_s, on_change = (turning()[answer, policy] for policy in ("once", "every_s", "on_change"))
    assert measure(once).least_clearance_m < -10.0
    for record in (every_s, on_change):
        assert measure(record).least_clearance_m > 0.0
        assert record.outcome.value == "reached"
        assert record.events[-1].decision == "rejoined"
    assert all(event.reason == "O: 1 s later" for event in every_s.events[1:-1])
    reasons = {event.reason for event in on_change.events[1:-1]}
    assert "O: the path ahead is no longer clear" in reasons
    told = [line.text for event in on_change.events for line in decided(event)]
    assert any(line.endswith("(O: the path ahead is no longer clear)") for line in told)
    for record, least_s in ((every_s, 1.0), (on_change, 0.5)):
        times = [event.time_s for event in record.events if event.decision != "rejoined"]
        assert np.diff(times).min() >= least_s - 1e-6


RACETRACK = {
    "start_enu_m": [0, 0, 0],
    "start_direction_deg": [0, 0],
    "shape": {"kind": "racetrack", "straight_m": 500, "radius_m": 250, "laps": 2},
}
COMES_ROUND = {
    "name": "O",
    "radius_m": 20,
    "position_enu_m": [500, 0, 3],
    "speed_mps": 20,
    "direction_deg": [150, 0],
    "when": {"time_s": 10},
}


@pytest.mark.slow
def test_a_second_conflict_on_the_way_back_along_a_route_of_many_pieces() -> None:
    """Half a lap later the racetrack leads through the sphere that was passed: once flies into it."""
    given = {"route": RACETRACK, "obstacles": [COMES_ROUND], "sensor": {"range_m": 200}, **KINEMATIC}
    once, again = (
        fly(plan(replan={"policy": policy, "answer": "direct", "swell_m": 5, "rejoin": {"to": "route"}}, **given))
        for policy in ("once", "on_change")
    )
    assert measure(once).least_clearance_m < -4.0
    assert measure(again).least_clearance_m > 4.0
    assert [event.decision for event in again.events] == ["replanned", "rejoined", "held", "rejoined"]
    held = again.events[2]
    assert held.command_enu_mps == held.own_vel_enu_mps
    assert again.outcome.value == "reached"
    assert np.linalg.norm(again.columns["own.pos_enu_m"][-1]) < 20.0  # the end of the last lap, which is where it began
    assert measure(again).replans == 2
    assert [line.text for line in decided(held)] == ["Straight on, until the way back is clear (O: the path ahead is no longer clear)"]


STRAIGHT = {"start_enu_m": [0, 0, 0], "goal_enu_m": [900, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
HEAD_ON = {"name": "O", "radius_m": 25, "position_enu_m": [600, 4, 0], "speed_mps": 20, "direction_deg": [180, 0]}
SHAPES = {
    "swerve": {"kind": "swerve", "heading_deg": 15, "swing_m": 300, "swings": 5},
    "random": {"kind": "random", "least_radius_m": [150, 250], "climb_at_most_deg": 10},
}


@pytest.mark.parametrize("shape", SHAPES)
def test_on_a_route_of_any_shape_a_path_that_leads_through_is_not_flown_to_its_end(shape: str) -> None:
    """The S-turn to the insertion point leads through the sphere, which the planner knows; the flight ends on its route all the same."""
    route = {"start_enu_m": [0, 0, 0], "start_direction_deg": [0, 0], "shape": SHAPES[shape]}
    given = {"route": route, "terrain_z_m": -2000, "sensor": {"range_m": 200}, **KINEMATIC}
    way = make_scene(plan(**given)).route
    place, tangent, _ = way.frame(500.0)
    course = math.degrees(math.atan2(tangent[1], tangent[0])) + 150.0
    meets = COMES_ROUND | {"position_enu_m": [place[0], place[1], place[2] + 3.0], "direction_deg": [course, 0]}
    once, again = (
        fly(plan(obstacles=[meets], replan={"policy": policy, "swell_m": 5, "rejoin": {"to": "route", "when": "clear"}}, **given))
        for policy in ("once", "on_change")
    )
    assert once.events[0].status == "leads_through_the_sphere"
    assert measure(once).least_clearance_m < -1.0
    assert measure(again).least_clearance_m > 1.0
    assert again.outcome.value == "reached"
    assert again.events[1].reason.startswith("O: the path ahead never was clear")
    assert math.dist(again.columns["own.pos_enu_m"][-1], way.frame(way.length_m)[0]) < 1.0


LINE = Chain([ph.hermite((0, 0, 0), (600, 0, 0), (600, 0, 0), (600, 0, 0))])
ALONG = State(0.0, 0.0, 0.0, 50.0, *[0.0] * 16)


def passing(clearance_m: float, course_deg: float = 90.0) -> Seen:
    """Flies across ahead of the line and misses it, below, by so much."""
    way = math.radians(course_deg)
    return Seen("O", 20.0, (200.0, -80.0, -20.0 - clearance_m), (20.0 * math.cos(way), 20.0 * math.sin(way), 0.0), 0.0)


@pytest.mark.parametrize(
    ("before_m", "course_deg", "now_m", "why"),
    [
        (10.0, 90.0, 5.0, ""),
        (10.0, 90.0, 0.5, ""),
        (10.0, 90.0, -0.5, "O: the path ahead is no longer clear"),
        (0.0, 90.0, -1.5, ""),
        (0.0, 90.0, -2.5, "O: the path ahead is no longer clear"),
        (-5.0, 90.0, -4.0, "O: the path ahead never was clear"),
        (-5.0, 90.0, -8.0, "O: the conflict grows again"),
        (10.0, 100.5, 1.0, "O: the obstacle has turned"),
        (10.0, 99.5, 1.0, ""),
        (10.0, 120.0, 3.0, ""),
        (0.5, 120.0, 1.0, ""),
    ],
)
def test_what_asks_for_another_decision(before_m: float, course_deg: float, now_m: float, why: str) -> None:
    rule, past = Again(Replan(policy="on_change")), Past(0.0, 0.0, {"O": Foretold(passing(0.0, course_deg).vel, before_m)})
    assert rule.asked(past, 0.4, ALONG, [passing(now_m)], LINE, 0.0)[1] == ""  # too soon
    state, seen = ALONG, passing(now_m)._replace(time_s=1.0)
    noted, found = rule.asked(past, 1.0, state, [seen], LINE, 0.0)
    assert found == why
    if not why:
        assert rule.asked(noted, 1.05, state, [passing(-50.0)._replace(time_s=1.05)], LINE, 0.0)[1] == ""  # looked at a moment ago


def test_noise_is_not_answered_with_every_look() -> None:
    """Clearances to and fro about what was foretold, 0.8 m of noise: none of 300 looks asks; without hysteresis every few do."""
    noise, asked = 0.8 * np.random.default_rng(5).normal(size=300), {}
    for grows_m in (2.0, 0.0):
        rule = Again(Replan.model_validate({"policy": "on_change", "again": {"grows_m": grows_m, "hold_s": 0.0}}))
        past, asked[grows_m] = Past(0.0, 0.0, {"O": Foretold(passing(0.0).vel, 0.5)}), 0
        for k, error in enumerate(noise.clip(-1.9, 1.9)):
            past, why = rule.asked(past, 1.0 + 0.1 * k, ALONG, [passing(0.5 + error)._replace(time_s=1.0 + 0.1 * k)], LINE, 0.0)
            asked[grows_m] += bool(why)
    assert asked[2.0] == 0
    assert asked[0.0] > 60
    options = {"position_noise_m": 4.0, "velocity_noise_mps": 3.0}
    sensor, replan = {"kind": "imperfect", "range_m": 350, "options": options}, {"policy": "on_change", "answer": "direct", "swell_m": 5}
    record = fly(plan(route=STRAIGHT, obstacles=[HEAD_ON], sensor=sensor, replan=replan, **KINEMATIC))
    times = [event.time_s for event in record.events]
    assert len(times) > 3
    assert np.diff(times).min() >= 0.5 - 1e-6
    assert reversals(record.events) == ()
    assert measure(record).least_clearance_m > 0.0


def test_a_reversal_is_a_turn_to_the_other_side() -> None:
    (first, *_) = turning()["direct", "once"].events
    east = replace(first, own_vel_enu_mps=(50.0, 0.0, 0.0))
    left, right, up = (
        replace(east, time_s=t, command_enu_mps=way) for t, way in ((1.0, (49, 9, 0)), (2.0, (49, -9, 2)), (3.0, (49, 1, 9)))
    )
    straight, back = replace(east, command_enu_mps=(50.0, 0.5, 0.0)), replace(right, decision="rejoined")
    assert reversals([left, left, up]) == ()
    assert reversals([left, right, left]) == (2.0, 1.0)
    assert reversals([left, straight, back, right]) == (2.0,)
    assert reversals([right, up]) == ()
    assert reversals([]) == ()


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ("replan: {policy: often}", "replan.policy: must be one of 'once', 'every_s', 'on_change'"),
        ("replan: {policy: every_s, again: {every_s: 0}}", "replan.again.every_s: must be more than 0"),
        ("replan: {again: {hold_s: -1}}", "replan.again.hold_s: must be at least 0"),
        ("replan: {policy: on_change}\nplanner: {kind: survivor}", "survivor has its own rule when it decides anew"),
        ("replan: {policy: every_s}\nplanner: {kind: lattice}", "lattice has its own rule when it decides anew"),
    ],
)
def test_what_is_no_policy_is_refused_in_one_sentence(said: str, words: str, tmp_path: Path) -> None:
    file = tmp_path / "x.yaml"
    file.write_text("name: x\nquestion: y\nroute: {start_enu_m: [0, 0, 0], goal_enu_m: [900, 0, 0], "
                    "start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}\n" + said)  # fmt: skip
    with pytest.raises(SpecError) as caught:
        load_campaign(file)
    (problem,) = caught.value.problems
    assert words in str(problem)


def test_a_flight_that_keeps_the_defaults_is_the_flight_of_before() -> None:
    said: dict[str, Any] = {"replan": {"policy": "once", "again": {"every_s": 1.0}}, "tracker": {"kind": "none"}}
    assert flight_id(plan(**said)) == flight_id(plan())
    others = [{"replan": {"again": {"every_s": 2.0}}}, {"tracker": {"kind": "kalman"}}, {"replan": {"policy": "every_s"}}]
    assert len({flight_id(plan(**other)) for other in [*others, {}]}) == 4
