"""Paths in space and time: what is flown keeps the radius and the limits by a count of its own; or there is none, and it says why."""

import math
import sys

import numpy as np
import pytest
from pydantic import ValidationError

from testbed.campaign.words.planning import PlannerSpec
from testbed.core.chain import Chain
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.fly import fly
from testbed.flight.paths import PATHS
from testbed.flight.paths.validity import Pace, Sampled, Spheres, clearances, times
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.record import Decision, FlightRecord, Outcome
from tests.plans import GTM, KINEMATIC, plan
from vosc import ph

ROUTE = {"start_enu_m": [0, 0, 300], "goal_enu_m": [900, 100, 320], "start_direction_deg": [0, 0], "goal_direction_deg": [10, 2]}
SMALL = {
    "lattice": {"poses": 60},
    "rrt": {"trees": 4, "states": 2500},
    "genetic": {"waypoints": 1, "population": 24, "generations": 25},
    "particle_swarm": {"waypoints": 2, "particles": 24, "rounds": 20},
}
SPARE_M, SHARE, CLIMB_DEG, SPEED_MPS = 4.0, 0.9, 20.0, 50.0


def sphere(name: str, pos: list[float], speed_mps: float, azimuth_deg: float, **changes: object) -> dict[str, object]:
    """There when the flight is due at x = 300."""
    motion = {"position_enu_m": pos, "speed_mps": speed_mps, "direction_deg": [azimuth_deg, 2], "when": {"time_s": 6}}
    return {"name": name, "radius_m": 25} | motion | changes


CROWD = [sphere("A", [300, 20, 303], 30, 150), sphere("B", [320, -25, 300], 20, 60, radius_m=15), sphere("C", [480, 60, 310], 12, -90)]


def flown(kind: str, obstacles: list[dict[str, object]] = CROWD, **changes: object) -> FlightRecord:
    if kind == "rrt":
        pytest.importorskip("ompl")
    options = {"spare_m": SPARE_M, "limits_share": SHARE, "climb_at_most_deg": CLIMB_DEG} | SMALL[kind]
    scene = {"route": ROUTE, "obstacles": obstacles, "sensor": {"range_m": 400}, "method": {"kind": "none"}}
    return fly(plan(**(KINEMATIC | scene | {"planner": {"kind": kind, "options": options}} | changes)))


@pytest.fixture(scope="module")
def records() -> dict[str, FlightRecord]:
    return {}


@pytest.fixture(params=list(PATHS))
def record(request: pytest.FixtureRequest, records: dict[str, FlightRecord]) -> FlightRecord:
    """One flight of each, past three spheres."""
    kind: str = request.param
    if kind not in records:
        records[kind] = flown(kind)
    return records[kind]


@pytest.mark.slow
def test_a_path_keeps_radius_and_limits_by_brute_force(record: FlightRecord) -> None:
    """Places every 5 cm of the path, differences of these, and the spheres' straight lines: nothing of what the search looked with."""
    planned = [event for event in record.events if event.decision == Decision.PLANNED]
    assert planned
    assert record.outcome == Outcome.REACHED
    limits = load_aircraft(record.plan.aircraft).limits
    for event, path in zip(planned, record.paths[1:], strict=True):
        step_m = 0.05
        s = np.arange(0.0, path.length_m, step_m)
        points = path.chain.points(s)
        truth = {spec.name: record.columns[f"obstacle.{spec.name}.pos_enu_m"] for spec in record.plan.obstacles}
        begun = int(np.searchsorted(record.columns["time_s"], event.time_s - 1e-9))
        in_sight = {n: p for n, p in truth.items() if np.linalg.norm(p[begun] - points[0]) <= record.plan.sensor.range_m}
        for spec in record.plan.obstacles:
            if spec.name in in_sight:
                velocity = (truth[spec.name][begun + 60] - truth[spec.name][begun]) / 0.5
                centres = truth[spec.name][begun] + np.outer(s / SPEED_MPS, velocity)
                assert np.linalg.norm(points - centres, axis=1).min() >= spec.radius_m + SPARE_M - 0.02
        velocity = SPEED_MPS * np.diff(points, axis=0) / step_m
        lift = SPEED_MPS / step_m * np.diff(velocity, axis=0) + [0.0, 0.0, G0_MPS2]
        along = velocity[1:] / np.linalg.norm(velocity[1:], axis=1)[:, None]
        lift -= (lift * along).sum(axis=1)[:, None] * along
        right = np.stack([along[:, 1], -along[:, 0], 0.0 * along[:, 0]], axis=1)
        right /= np.linalg.norm(right, axis=1)[:, None]
        bank = np.arctan2((lift * right).sum(axis=1), (lift * np.cross(right, along)).sum(axis=1))
        load = np.linalg.norm(lift, axis=1) / G0_MPS2
        assert load.max() <= 1.0 + SHARE * (limits.load_factor_max - 1.0) + 0.01
        assert load.min() >= 1.0 - SHARE * (1.0 - limits.load_factor_min) - 0.01
        assert np.abs(bank).max() <= SHARE * limits.bank_deg * DEG + 0.01
        assert np.abs(np.arcsin(along[:, 2])).max() <= CLIMB_DEG * DEG + 1e-4
        every = 40  # 2 m: the rate over less is rounding of second differences
        rate = np.abs(np.diff(bank[::every])) * SPEED_MPS / (every * step_m)
        assert rate.max() <= 1.02 * SHARE * limits.roll_rate_dps * DEG
        assert math.dist(points[-1], ROUTE["goal_enu_m"]) < 0.06


@pytest.mark.slow
def test_it_joins_without_a_jump_in_bend(record: FlightRecord) -> None:
    before = record.paths[0].chain
    for path in record.paths[1:]:
        joints = [0.0, *np.cumsum([curve.length_m for curve in path.curves])[:-1]]
        for k, s in enumerate(joints):
            left = before.frame(before.nearest(path.chain.points(np.zeros(1)))[0][0]) if k == 0 else Chain(path.curves[:k]).frame(s)
            right = path.curves[k].frame(0.0)
            assert left[0] == pytest.approx(right[0], abs=1e-5)
            assert left[1] == pytest.approx(right[1], abs=1e-6)
            assert left[2] == pytest.approx(right[2], abs=1e-6)
        before = path.chain


@pytest.mark.slow
def test_the_same_plan_is_the_same_path(records: dict[str, FlightRecord]) -> None:
    """After flights of others, whose random numbers are none of its own."""
    for kind, first in records.items():
        again = flown(kind)
        assert [path.curves for path in again.paths] == [path.curves for path in first.paths]


@pytest.mark.slow
def test_an_aircraft_that_flies_it_keeps_the_radius() -> None:
    record = flown("lattice", **GTM)
    assert record.outcome == Outcome.REACHED
    for spec in record.plan.obstacles:
        apart = record.columns["own.pos_enu_m"] - record.columns[f"obstacle.{spec.name}.pos_enu_m"]
        assert np.linalg.norm(apart, axis=1).min() > spec.radius_m + 0.5 * SPARE_M


@pytest.mark.parametrize("kind", ["lattice", "particle_swarm"])
def test_where_no_path_is_within_the_limits_there_is_none(kind: str) -> None:
    """Seen half a second before it is hit."""
    late = flown(kind, [sphere("A", [300, 0, 300], 30, 180)], sensor={"range_m": 70})
    (event,) = late.events
    assert (event.decision, event.method) == (Decision.NO_PATH, kind)
    assert "none is within the limits; the nearest misses the radius that is kept by" in event.reason
    assert len(late.paths) == 1


def test_back_to_the_route_it_goes_on_along_it() -> None:
    record = flown("lattice", [sphere("A", [300, 10, 303], 30, 150)], replan={"rejoin": {"to": "route"}})
    (event,) = record.events
    assert event.decision == Decision.PLANNED
    route, path = record.paths[0].chain, record.paths[1]
    last = path.curves[-1]
    _, aside = route.nearest(last.points(np.linspace(0.0, last.length_m, 20)))
    assert aside.max() < 1e-4
    assert event.path_clearance_m >= SPARE_M - 0.02


def test_without_its_package_the_tree_is_refused_by_the_extra_s_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ompl", None)
    with pytest.raises(ValidationError, match=r"the planner rrt needs a package that is not installed: pip install 'vosc-testbed\[rrt\]'"):
        PlannerSpec.model_validate({"kind": "rrt", "options": {"trees": 3}})


def test_a_place_has_its_time_in_the_wind() -> None:
    """Against, with and across a wind of 30 m/s at 50 m/s: 20, 80 and 40 m/s over the ground."""
    s = np.array([[0.0, 40.0, 80.0]])
    for tangent, lasts_s in (((-1, 0, 0), 4.0), ((1, 0, 0), 1.0), ((0, 1, 0), 2.0)):
        tangents = np.broadcast_to(np.array(tangent, dtype=float), (1, 3, 3))
        sampled = Sampled(s, s[..., None] * tangents, tangents, 0.0 * tangents)
        assert times(sampled, Pace(50.0, (30.0, 0.0, 0.0)), np.array([0.5]))[0, -1] == pytest.approx(0.5 + lasts_s)


def test_clearance_counts_between_samples() -> None:
    """A sphere that crosses in the middle of 100 m: 10 m aside at its closest, which no sample is near."""
    points, when = np.array([[[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]]]), np.array([[0.0, 2.0]])
    spheres = Spheres(np.array([[50.0, 40.0, 10.0]]), np.array([[0.0, -40.0, 0.0]]), np.array([8.0]))
    assert clearances(points, when, spheres)[0, 0] == pytest.approx(10.0 / 8.0 - 1.0)


def test_places_of_many_curves_are_those_of_each() -> None:
    ends = np.array([[200.0, 30.0, 5.0], [180.0, -60.0, 40.0]])
    for bend in (None, np.array([0.0, 4e-3, 1e-3])):
        curves = ph.hermite_many(np.zeros(3), np.array([190.0, 0.0, 0.0]), ends, np.array([170.0, 60.0, -10.0]), bend)
        points, s = curves.places(np.linspace(0.0, 1.0, 9))
        for k in range(2):
            one = curves.curve(k)
            assert s[k, -1] == pytest.approx(one.length_m, rel=1e-12)
            np.testing.assert_allclose(points[k], one.points(s[k]), atol=1e-6)
            np.testing.assert_allclose(points[k, -1], ends[k], atol=1e-8)
