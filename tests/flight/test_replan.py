"""The planner's decisions: every kind is recorded, once per new threat, and the quick look never hides a threat."""

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from testbed import fly, measure
from testbed.flight.planning.rejoin import resized
from testbed.flight.planning.watch import Watch
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.plants.base import State
from testbed.flight.sensing import Seen
from testbed.show.pilot_log import decided
from tests.plans import KINEMATIC, paper_obstacle, plan
from vosc import Obstacle, Own, threat

STRAIGHT = {"start_enu_m": [0, 0, 0], "goal_enu_m": [900, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
coordinate = st.floats(-300, 300)
vector = st.tuples(coordinate, coordinate, coordinate)


def flown(*obstacles: dict, **changes: object):
    return fly(plan(route=STRAIGHT, obstacles=list(obstacles), **(KINEMATIC | changes)))


def sphere(name: str, position: list[float], speed: float, direction: list[float], radius: float = 20.0) -> dict:
    return {"name": name, "radius_m": radius, "position_enu_m": position, "speed_mps": speed, "direction_deg": direction}


@given(
    own=vector, velocity=vector, centre=vector, other=vector, radius=st.floats(0.1, 200), swell=st.floats(0, 50), time_s=st.floats(0, 20)
)
@example((0.0, 0.0, 0.0), (1e-200, 0.0, 0.0), (100.0, 0.0, 0.0), (0.0, 0.0, 0.0), 20.0, 0.0, 0.0)  # a speed whose square is zero
def test_the_watch_never_hides_a_threat(
    own: tuple, velocity: tuple, centre: tuple, other: tuple, radius: float, swell: float, time_s: float
) -> None:
    seen = Seen("O", radius, centre, other, time_s)
    before = Seen("O", radius, seen.at(time_s - 2.0), other, time_s - 2.0)  # by a sensor that is late
    state = State(*own, *velocity, *[0.0] * 14)
    if threat(Own(own, velocity), Obstacle(centre, other, radius + swell)).is_threat:
        assert Watch(swell).alarmed((), time_s, state, [seen])
    if threat(Own(own, velocity), Obstacle(before.at(time_s), other, radius + swell)).is_threat:
        assert Watch(swell).alarmed((), time_s, state, [before])
    assert not Watch(swell).alarmed((), time_s, state, [])  # out of sight
    assert not Watch(swell).alarmed({"O"}, time_s, state, [seen])  # answered already


def test_each_new_threat_is_answered_once() -> None:
    """Two head-on obstacles, one after the other, far enough apart to be met one by one."""
    record = flown(sphere("near", [300, 4, 0], 10, [180, 0]), sphere("far", [800, 0, 6], 2, [180, 0]))
    assert [event.obstacle for event in record.events] == ["near", "far"]
    assert [event.decision for event in record.events] == ["replanned", "replanned"]
    assert len(record.paths) == 3
    assert measure(record).replans == 2


def test_no_method_is_a_decision_too() -> None:
    (event,) = flown(sphere("O", [300, 4, 0], 10, [180, 0]), method={"kind": "none"}).events
    assert event.decision == "none"
    assert math.isnan(event.deflection_rad)


@pytest.mark.parametrize(
    ("obstacle", "rule", "decision"),
    [
        (sphere("O", [300, 2, 0], 0, [0, 0]), "paper_4_3_2", "no_insertion_point"),  # t = (d - R) / 0
        (sphere("O", [-50.4, -54.7, 0], 80, [20, 0]), "arrival", "undefined"),  # faster: a generatrix misses the velocity sphere
        (sphere("O", [-10, 2, 0], 60, [0, 0]), "arrival", "inside"),
    ],
)
def test_what_cannot_be_planned_is_recorded(obstacle: dict, rule: str, decision: str) -> None:
    record = flown(obstacle, replan={"time_rule": rule})
    (event,) = record.events
    assert event.decision == decision
    assert len(record.paths) == 1
    assert all(math.isnan(x) for x in event.insertion_enu_m)
    assert record.outcome.value == "collided"


def test_beyond_the_range_nothing_is_seen() -> None:
    record = flown(sphere("O", [300, 0, 0], 10, [180, 0]), sensor={"range_m": 150})
    event = record.events[0]
    assert 149.0 < math.dist(event.own_pos_enu_m, event.obstacle_pos_enu_m) <= 150.0


def test_a_threat_beyond_the_horizon_waits() -> None:
    record = flown(sphere("O", [600, 0, 0], 10, [180, 0]), sensor={"range_m": 1000}, replan={"horizon_s": 2.0})
    assert record.events[0].time_to_cpa_s == pytest.approx(2.0, abs=0.05)


def test_the_paper_s_time_rule() -> None:
    event = fly(plan(obstacles=[paper_obstacle()], replan={"time_rule": "paper_4_3_2"}, **KINEMATIC)).events[0]
    distance = math.dist(event.own_pos_enu_m, event.obstacle_pos_enu_m)
    assert event.insertion_time_s == pytest.approx((distance - 25.0) / 40.0)


def test_resized() -> None:
    assert resized((3.0, 0.0, 4.0), 10.0) == pytest.approx((6.0, 0.0, 8.0))


OVERTAKEN = sphere("O", [-150, 0, 0], 80, [0, 0], 25.0)


@pytest.mark.parametrize(
    ("settings", "status", "turns_deg"),
    [
        ({"replan": {"answer": "insertion_point"}}, "leads_through_the_sphere", 178.8),  # the point lies behind, on the obstacle's course
        ({"replan": {"answer": "direct"}}, "turns_back", 154.94),  # the larger root of eq. 13
        ({"replan": {"answer": "direct"}, "method": {"kind": "scoam", "options": {"root": "nearer"}}}, "avoided", 5.872),
        ({"replan": {"answer": "direct"}, "method": {"kind": "least_deflection"}}, "avoided", 5.872),
    ],
)
def test_avoided_is_not_said_of_a_path_that_leads_through_or_turns_back(settings: dict, status: str, turns_deg: float) -> None:
    record = flown(OVERTAKEN, sensor={"range_m": 200}, **settings)
    event = record.events[0]
    assert event.decision == "replanned"
    assert event.status == status
    assert math.degrees(event.path_turns_rad) == pytest.approx(turns_deg, abs=0.1)
    # the point on rails flies the path as planned: what the event foretells comes true
    assert measure(record).least_clearance_m == pytest.approx(event.path_clearance_m, abs=0.01)
    told = decided(event)[-1]
    assert ("turns back by" in told.text) == (turns_deg > 90)
    assert ("inside a sphere" in told.text) == (status == "leads_through_the_sphere")
    assert (told.level == "WARN") == (status != "avoided")


def test_the_first_time_ahead_is_an_option() -> None:
    (event, *_) = flown(OVERTAKEN, sensor={"range_m": 200}, replan={"arrival_root": "forward"}).events
    assert event.insertion_enu_m[0] == pytest.approx(50 * 118.75 / 30)  # -150 + 31.25 + 80 t = 50 t


def test_the_point_behind_the_obstacle_is_an_option() -> None:
    ahead, behind = (
        fly(plan(obstacles=[paper_obstacle()], begin={"at_route_s_m": 122}, replan={"insertion_side": side}, **KINEMATIC)).events[0]
        for side in ("ahead", "behind")
    )
    assert ahead.obstacle_vel_enu_mps == behind.obstacle_vel_enu_mps
    course = [v / 40 for v in ahead.obstacle_vel_enu_mps]
    for event, sign in ((ahead, 1.0), (behind, -1.0)):
        places = (event.insertion_enu_m, event.obstacle_pos_enu_m, event.obstacle_vel_enu_mps)
        along = [q - p - v * event.insertion_time_s for q, p, v in zip(*places, strict=True)]
        assert along == pytest.approx([sign * 1.25 * 25 * c for c in course], abs=1e-6)


def test_a_known_obstacle_that_is_no_threat_is_considered_when_asked() -> None:
    """It waits where the answer to the threat would lead; only with ``consider: all`` the answer goes round it."""
    threat_, seen = sphere("O", [250, 0, 0], 40, [180, 0]), {"sensor": {"range_m": 300}, "replan": {"answer": "direct"}}
    lone = flown(threat_, **seen).events[0]
    way = [c / 50 for c in lone.command_enu_mps]
    bystander = sphere("B", [200 * c for c in way], 0, [0, 0], 12.0)
    only_threats = flown(threat_, bystander, **seen)
    both = flown(threat_, bystander, method={"kind": "scoam", "options": {"consider": "all"}}, **seen)
    assert only_threats.events[0].command_enu_mps == lone.command_enu_mps
    assert only_threats.events[0].status == "leads_through_the_sphere"
    assert both.events[0].command_enu_mps != lone.command_enu_mps
    assert both.events[0].path_clearance_m > -1e-6
    assert [event.obstacle for event in both.events if event.decision == "replanned"] == ["O"]


@pytest.mark.parametrize("wind", [{}, {"air": {"wind": {"kind": "steady", "speed_mps": 10, "from_deg": 200}}}])
def test_the_goal_is_the_route_s_unless_told_otherwise(wind: dict) -> None:
    """A direction to the goal that is free is taken as it is, over the ground also in a wind."""
    aside = {"route": STRAIGHT | {"goal_enu_m": [900, 300, 0]}, "obstacles": [sphere("O", [160, 0, 0], 0, [0, 0], 10.0)]}
    method = {"kind": "scoam", "options": {"objective": "goal", "boundary": "exact"}}
    record = fly(plan(method=method, replan={"answer": "direct"}, sensor={"range_m": 200}, **aside, **KINEMATIC, **wind))
    event = record.events[0]
    to_goal = [g - p for g, p in zip((900, 300, 0), event.own_pos_enu_m, strict=True)]
    ratio = event.command_enu_mps[1] / event.command_enu_mps[0]
    assert ratio == pytest.approx(to_goal[1] / to_goal[0], rel=1e-6)


def test_a_point_on_the_curve_by_what_it_asks_of_the_aircraft() -> None:
    """In a bank to the right the least roll is a turn to that side; the planner knows the bank."""
    events = [
        fly(
            plan(
                obstacles=[paper_obstacle()],
                begin={"at_route_s_m": 122},
                method={"kind": "scoam", "options": {"objective": objective}},
                plant={"kind": "point_mass"},
                aircraft="gtm_t2",
            )
        ).events[0]
        for objective in ("least_deflection", "least_roll", "least_load_factor")
    ]
    assert all(event.status in ("avoided", "unsafe", "leads_through_the_sphere") for event in events)
    assert len({event.command_enu_mps for event in events}) == 3
    assert events[0].deflection_rad <= min(event.deflection_rad for event in events) + 1e-9


def test_a_flyable_path_keeps_the_limits_or_says_which_forbids_it() -> None:
    """Seen from 200 m gtm_t2 has a path; from the paper's 100 m, on the printed pose, nothing is within bank and load factor."""
    limits = load_aircraft("gtm_t2").limits
    near, far = (
        fly(plan(obstacles=[paper_obstacle()], begin={"at_route_s_m": s_m}, sensor={"range_m": range_m}, **FLYABLE))
        for s_m, range_m in ((122, 100), (40, 200))
    )
    (event,) = near.events
    assert (event.decision, event.status) == ("no_path", "no_path")
    assert event.reason == "of 36 ends none is within the aircraft's limits: load factor of 2.6"
    assert decided(event)[-1].text.endswith(f"path kept, no path ({event.reason})")
    (event,) = far.events
    assert event.decision == "replanned"
    before, there = far.paths[0].chain, far.paths[1].curves[0]
    joint = np.array(before.frame(float(before.nearest(np.array([event.own_pos_enu_m]))[0][0]))[2])
    np.testing.assert_allclose(there.frame(0.0)[2], joint, atol=1e-6)  # G2: the bend goes on
    point, tangent, bend = there.sample(np.linspace(0.0, there.length_m, 2000))
    speed, up = math.hypot(*event.own_vel_enu_mps), np.array([0.0, 0.0, 1.0])
    lift = speed**2 * bend / 9.80665 + up - tangent * tangent[:, 2:]  # of a coordinated flight along the curve, over the weight
    left = np.cross(up, tangent)
    left /= np.linalg.norm(left, axis=1)[:, None]
    bank = np.unwrap(np.arctan2(-(lift * left).sum(axis=1), (lift * np.cross(tangent, left)).sum(axis=1)))
    step_s = np.linalg.norm(np.diff(point, axis=0), axis=1) / speed
    assert np.abs(np.diff(bank) / step_s).max() < math.radians(limits.roll_rate_dps) * 1.02
    assert np.linalg.norm(bend, axis=1).max() * speed**2 / 9.80665 < limits.load_factor_max
    assert np.degrees(np.arcsin(tangent[:, 2])).max() <= 30.01


FLYABLE = {"replan": {"path": "flyable"}, "aircraft": "gtm_t2", **KINEMATIC}
