"""Answers without an insertion point, and ways back: what a velocity obstacle promises, and no second conflict."""

import math
from dataclasses import asdict

import numpy as np
import pytest

from testbed import fly, measure
from testbed.core.chain import Chain
from testbed.flight.planning.rejoin import miss_along
from testbed.flight.record import FlightRecord, Outcome
from testbed.flight.sensing import Seen
from testbed.results.flight_row import collided
from testbed.show.flight_summary import leg_names
from testbed.show.pilot_log import decided as told
from tests.plans import GTM, KINEMATIC, paper_obstacle, plan
from vosc import ph

LONG = {"start_enu_m": [0, 0, 0], "goal_enu_m": [2500, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
CROSSING = {"name": "O", "radius_m": 25, "position_enu_m": [500, 10, 0], "speed_mps": 40, "direction_deg": [94, 0], "when": {"time_s": 10}}
DIRECT = {"answer": "direct"}
EARLY = {"sensor": {"range_m": 2000}}


def crossing(replan: dict, **changes: object) -> FlightRecord:
    """A long straight level flight, crossed from the right with 10 m of miss; decided on 6 s before."""
    settings = {"horizon_s": 6, **replan}
    return fly(plan(route=LONG, obstacles=[CROSSING], replan=settings, **(EARLY | KINEMATIC | changes)))


@pytest.mark.parametrize("kind", ["scoam", "least_deflection", "droam_hp", "droam_vp"])
@pytest.mark.parametrize("swell_m", [0.0, 5.0])
def test_a_velocity_that_jumps_keeps_exactly_what_the_planner_took_for_the_radius(kind: str, swell_m: float) -> None:
    """The promise of a velocity obstacle, at the edge of which every one of these methods puts the velocity."""
    record = crossing(DIRECT | {"swell_m": swell_m}, method={"kind": kind})
    metrics = measure(record)
    assert metrics.least_clearance_m == pytest.approx(swell_m, abs=1e-6)
    assert record.outcome is Outcome.REACHED


def test_a_direct_answer_is_held_until_the_flight_is_clear_and_then_left() -> None:
    record = crossing(DIRECT)
    first, back = record.events
    assert (first.decision, back.decision) == ("replanned", "rejoined")
    assert not np.isfinite(first.insertion_enu_m).any()
    hz = record.plan.rates.plant_hz
    held = slice(round(first.time_s * hz) + 1, round(back.time_s * hz))  # the row of the decision is from before it
    velocity = record.columns["own.vel_enu_mps"][held]
    assert np.allclose(velocity, first.command_enu_mps, atol=1e-9)
    metrics = measure(record)
    closest = metrics.time_at_least_clearance_s
    assert closest - first.time_s <= metrics.clear_time_s <= back.time_s - first.time_s
    relative = np.array(back.obstacle_pos_enu_m) - back.own_pos_enu_m
    assert relative @ (np.array(back.obstacle_vel_enu_mps) - back.own_vel_enu_mps) > 0.0  # it opens


@pytest.mark.parametrize("answer", ["insertion_point", "direct"])
def test_the_way_back_to_the_route_ends_on_it_and_stays(answer: str) -> None:
    record = crossing({"answer": answer, "rejoin": {"to": "route", "when": "clear"}, "swell_m": 8})
    metrics = measure(record)
    assert record.outcome is Outcome.REACHED
    assert 3.0 < metrics.rejoin_time_s < 16.0
    pos, hz = record.columns["own.pos_enu_m"], record.plan.rates.plant_hz
    back = round((record.events[0].time_s + metrics.rejoin_time_s) * hz)
    off_route = np.hypot(pos[:, 1], pos[:, 2])
    assert off_route[back:].max() <= 5.0
    assert off_route[:back].max() > 5.0
    assert off_route[-1] < 1e-6
    start = round(record.events[0].time_s * hz)
    assert metrics.rejoin_length_m == pytest.approx(50.0 * (back - start) / hz, rel=1e-3)  # a point at constant speed
    tightest = max(curve.max_curvature() for curve in record.paths[-1].curves)
    assert tightest <= 9.80665 * math.tan(math.radians(45)) / 50.0**2


def test_coming_back_keeps_the_margin_that_is_asked_for() -> None:
    """From the moment of the way back on; before, the velocity obstacle's edge is touched."""
    record = crossing(DIRECT | {"rejoin": {"margin_m": 12.0}})
    back = round(record.events[1].time_s * record.plan.rates.plant_hz)
    assert record.columns["obstacle.O.clearance_m"][back:].min() >= 12.0 - 0.01


def test_a_flight_back_on_an_aircraft() -> None:
    record = crossing(DIRECT | {"swell_m": 8, "rejoin": {"to": "route"}}, plant={"kind": "jsbsim"}, aircraft="gtm_t2")
    metrics = measure(record)
    assert metrics.least_clearance_m > 0.0
    assert math.isfinite(metrics.rejoin_time_s)


def test_the_parts_of_the_clearance_add_up() -> None:
    metrics = measure(fly(plan(obstacles=[paper_obstacle()], **GTM)))
    whole = metrics.planned_clearance_m + metrics.schedule_part_m + metrics.cross_track_part_m
    assert whole == pytest.approx(metrics.least_clearance_m, abs=1e-9)
    assert metrics.cross_track_part_m < -1.0  # the aircraft is off the path by metres there
    kinematic = measure(fly(plan(obstacles=[paper_obstacle()], **KINEMATIC)))
    assert kinematic.schedule_part_m == pytest.approx(0.0, abs=1e-6)
    assert kinematic.cross_track_part_m == pytest.approx(0.0, abs=1e-6)


def test_deflections_of_a_point_on_rails() -> None:
    """At the insertion point it flies the commanded direction; on the S-turn to it, farther away from where it came from."""
    record = fly(plan(obstacles=[paper_obstacle()], **KINEMATIC))
    metrics = measure(record)
    assert metrics.deflection_ground_deg == pytest.approx(metrics.deflection_deg, abs=1e-9)
    assert metrics.flown_deflection_deg == pytest.approx(metrics.deflection_deg, abs=1.0)  # a tick or less from the point
    assert metrics.peak_deflection_deg > metrics.flown_deflection_deg + 5.0
    assert metrics.avoidance_time_s == pytest.approx(record.paths[1].curves[0].length_m / 50.0, abs=1 / 120)
    assert metrics.insertion_miss_m < 50.0 / 120


def test_the_miss_along_a_path_is_that_of_a_flight_along_it() -> None:
    """Against the flight itself, without planner; and a straight line against the closed form."""
    flown = fly(plan(obstacles=[paper_obstacle()], method={"kind": "none"}, **KINEMATIC))
    metrics = measure(flown)
    assert metrics.route_miss_m == pytest.approx(metrics.least_clearance_m + 25.0, abs=0.05)
    line = Chain([ph.hermite((0, 0, 0), (600, 0, 0), (600, 0, 0), (600, 0, 0))])
    seen = Seen("O", 1.0, (250.0, -150.0, 7.0), (0.0, 30.0, 0.0), 0.0)
    assert miss_along(line, 0.0, 50.0, 0.0, [seen]) == pytest.approx(7.0, abs=0.01)
    assert miss_along(line, 0.0, 50.0, 0.0, []) == math.inf


@pytest.mark.parametrize("share", [0.0, 0.3, 0.9])
def test_the_tail_of_a_curve_is_the_curve(share: float) -> None:
    curve = ph.hermite((0, 0, 0), (300, 100, 50), (400, 200, 30), (200, -150, 80))
    tail = curve.tail(share * curve.length_m)
    assert tail.length_m == pytest.approx((1.0 - share) * curve.length_m, rel=1e-12)
    for s in np.linspace(0.0, tail.length_m, 7):
        for mine, whole in zip(tail.frame(s), curve.frame(share * curve.length_m + s), strict=True):
            assert np.allclose(mine, whole, atol=1e-9)


def test_a_touch_is_told_as_no_collision_and_the_way_back_as_what_it_is() -> None:
    """The point that turns at once passes at the radius, less what rounding takes: nothing may call that a hit."""
    record = crossing(DIRECT | {"swell_m": 0})
    metrics = measure(record)
    shaved = asdict(metrics) | {"least_clearance_m": -1e-13}
    assert not collided(shaved)
    assert collided(shaved | {"least_clearance_m": -2e-6})
    assert not collided(shaved | {"least_clearance_m": math.nan})
    first, back = (" ".join(line.text for line in told(event)) for event in record.events)
    assert "is a threat" in first
    assert "turns" in first
    assert "at once" in first
    assert back.startswith("Clear of")
    assert "way back" in back
    assert "path kept" not in back
    legs = leg_names(record)
    hz = record.plan.rates.plant_hz
    decided, left = (round(event.time_s * hz) for event in record.events)
    assert set(legs[:decided]) == {"route"}
    assert set(legs[decided + 1 : left]) == {"avoid"}
    assert set(legs[left + 1 :]) == {"rejoin"}
