"""The paper's point: exact arrival, exact time, and the encounter of section 5.1."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from testbed import fly, measure
from testbed.core.units import G0_MPS2
from testbed.flight.air import AirModel, ground_speed_along
from testbed.flight.plants.base import Start
from testbed.flight.plants.kinematic import BLOCK, DRIVEN_BLOCK, KinematicPlant, coordinated, coordinated_columns
from testbed.flight.record import Outcome
from testbed.flight.route.path import ActivePath, Arc
from tests.plans import KINEMATIC, paper_obstacle, plan
from vosc import ph


def test_arrives_at_the_goal_in_length_over_speed() -> None:
    record = fly(plan(**KINEMATIC))
    assert record.outcome is Outcome.REACHED
    assert math.dist(record.columns["own.pos_enu_m"][-1], (500, 200, 100)) < 1e-6
    metrics = measure(record)
    assert abs(metrics.flight_time_s - record.paths[0].length_m / 50.0) <= 1.0 / 120.0
    assert metrics.cross_track_max_m < 1e-9
    assert metrics.schedule_error_s == pytest.approx(0.0, abs=1e-4)


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(
    goal=st.tuples(*[st.floats(-800, 800)] * 2, st.floats(-100, 300)).filter(lambda p: math.hypot(*p) > 100),
    start=st.tuples(st.floats(-180, 180), st.floats(-60, 60)),
    end=st.tuples(st.floats(-180, 180), st.floats(-60, 60)),
    speed=st.floats(20, 120),
)
def test_arrives_on_any_route(goal: tuple, start: tuple, end: tuple, speed: float) -> None:
    route = {"start_enu_m": [0, 0, 0], "goal_enu_m": goal, "start_direction_deg": start, "goal_direction_deg": end}
    record = fly(plan(route=route, speed_mps=speed, terrain_z_m=-5000.0, **KINEMATIC))
    assert record.outcome is Outcome.REACHED, record.message
    crossing = measure(record).flight_time_s
    # a route may cross the goal's plane near the goal before it arrives; it never arrives late
    assert crossing <= record.paths[0].length_m / speed + 1.0 / 120.0 + 1e-9


def test_constant_speed_and_the_bank_of_a_steady_turn() -> None:
    """tan(bank) = V^2 / (g R) on a level circle, load factor 1/cos(bank)."""
    bank, load_factor = coordinated((50.0, 0.0, 0.0), (0.0, -(50.0**2) / 300.0, 0.0))
    assert math.tan(bank) == pytest.approx(50.0**2 / (G0_MPS2 * 300.0))
    assert load_factor == pytest.approx(1.0 / math.cos(bank))
    assert bank > 0.0, "a turn to the right is a positive bank"


@pytest.mark.parametrize(("reading", "threat"), [("as_printed", False), ("azimuth_106", True), ("direction_106_10", True)])
def test_the_readings_differ_in_the_threat(reading: str, threat: bool) -> None:
    record = fly(plan(obstacles=[paper_obstacle(reading)], **KINEMATIC))
    assert [event.decision for event in record.events] == (["replanned"] if threat else [])


def test_the_planner_keeps_the_sphere_clear_and_its_absence_does_not() -> None:
    with_planner, without = (
        measure(fly(plan(obstacles=[paper_obstacle()], method={"kind": kind}, **KINEMATIC))) for kind in ("scoam", "none")
    )
    assert with_planner.least_clearance_m + 25.0 == pytest.approx(27.25, abs=0.1)
    assert without.least_clearance_m + 25.0 == pytest.approx(8.4, abs=0.1)
    assert without.outcome == "collided"


def test_least_clearance_is_that_of_the_straight_lines_for_a_straight_route() -> None:
    """Closed form: own along +x at 50 m/s, obstacle along +y at 30 m/s that passes 8 m behind."""
    straight = {"start_enu_m": [0, 0, 0], "goal_enu_m": [600, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
    obstacle = {"name": "O", "radius_m": 5, "position_enu_m": [300, -188, 3], "speed_mps": 30, "direction_deg": [90, 0]}
    metrics = measure(fly(plan(route=straight, obstacles=[obstacle], method={"kind": "none"}, **KINEMATIC)))
    p, v = np.array([300.0, -188.0, 3.0]), np.array([-50.0, 30.0, 0.0])
    t = -(p @ v) / (v @ v)
    assert metrics.least_clearance_m == pytest.approx(np.linalg.norm(p + t * v) - 5.0, abs=1e-9)
    assert metrics.time_at_least_clearance_s == pytest.approx(t, abs=1e-9)


def test_steady_wind_changes_the_ground_speed_of_a_point_that_holds_airspeed() -> None:
    straight = {"start_enu_m": [0, 0, 0], "goal_enu_m": [600, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
    wind = {"wind": {"kind": "steady", "speed_mps": 10, "from_deg": 270}}
    tail = measure(fly(plan(route=straight, air=wind, **KINEMATIC)))
    hold = measure(fly(plan(route=straight, air=wind, speed_hold="groundspeed", **KINEMATIC)))
    assert tail.flight_time_s == pytest.approx(600 / 60, abs=1 / 120)
    assert hold.flight_time_s == pytest.approx(600 / 50, abs=1 / 120)
    assert hold.max_airspeed_mps == pytest.approx(40.0)


STILL = (0.0, 0.0, 0.0)
WINDY = (6.0, -3.0, 0.0)


def sheared(time_s: float, pos: tuple) -> tuple:
    return 0.02 * pos[2] + 0.01 * time_s, -4.0, 0.0


def gusty(time_s: float, pos: tuple) -> tuple:
    return 6.0 + math.sin(3.0 * time_s), -3.0 + 0.01 * pos[0], 0.3


AIRS = {
    "calm": AirModel(STILL, STILL, lambda _t, _p: STILL, lambda _t, _p: STILL),
    "steady": AirModel(WINDY, WINDY, lambda _t, _p: WINDY, lambda _t, _p: WINDY),
    "gusty": AirModel(None, WINDY, lambda _t, _p: WINDY, gusty),
    "sheared": AirModel(None, None, sheared, sheared),
}


class OneByOne:
    """The point on rails as its rule is written: sample by sample, with the scalar kernel."""

    def __init__(self, start: Start, air: AirModel, hz: int, hold_airspeed: bool) -> None:
        self.air, self.hz, self.tick, self.on_path = air, hz, 0, 0
        self.even = not hold_airspeed or air.uniform == STILL
        self.speed = start.speed if hold_airspeed else ground_speed_along(start.tangent, start.speed, start.wind)

    def follow(self, path: ActivePath | Arc, s_m: float) -> None:
        self.path, self.from_s, self.on_path = path, s_m, 0

    def step(self) -> None:
        self.tick += 1
        self.on_path += self.even
        if not self.even:
            half = self.from_s + 0.5 * self.ground_speed(self.from_s) / self.hz
            self.from_s += self.ground_speed(half) / self.hz

    def ground_speed(self, s: float) -> float:
        point, tangent, _ = self.path.frame(s)
        return self.speed if self.even else ground_speed_along(tangent, self.speed, self.air.mean(self.tick / self.hz, point))

    def sample(self) -> tuple[float, ...]:
        s = min(self.from_s + self.speed * self.on_path / self.hz, self.path.length_m)
        point, tangent, bend = self.path.frame(s)
        v, air = self.ground_speed(s), self.air.at(self.tick / self.hz, point)
        velocity = tuple(v * t for t in tangent)
        bank, load_factor = coordinated(velocity, tuple(v * v * k for k in bend))
        heading = math.atan2(velocity[0] - air[0], velocity[1] - air[1]) % math.tau
        angles = bank, math.asin(tangent[2]), heading
        return (*point, *velocity, *angles, load_factor, math.dist(velocity, air), *[math.nan] * 9, *air)


@pytest.mark.parametrize("hold_airspeed", [True, False])
@pytest.mark.parametrize("air", AIRS.values(), ids=AIRS)
def test_samples_many_at_a_time_are_those_of_one_by_one(air: AirModel, hold_airspeed: bool) -> None:
    """To the last bit: across blocks, changes of path, paths that last for a step, and the end of a path."""
    first = ActivePath([ph.hermite((0, 0, 0), (600, 200, 60), (500, 100, 50), (500, -100, 0))])
    second = ActivePath(
        [
            ph.hermite((100, 20, 10), (300, 60, 0), (300, 60, 20), (200, -50, 0)),
            ph.hermite((300, 60, 20), (200, -50, 0), (450, 0, 0), (150, 0, 0)),
        ]
    )
    arc = Arc((400.0, 0.0, 9.0), (1.0, 0.0, 0.0), (0.0, 0.004, 0.0), 40.0, 600.0)
    start = Start((0.0, 0.0, 0.0), first.frame(0.0)[1], first.frame(0.0)[2], 50.0, air.mean(0.0, STILL))
    plants = KinematicPlant(start, air, 120, hold_airspeed), OneByOne(start, air, 120, hold_airspeed)
    changes = {0: (first, 3.0), DRIVEN_BLOCK + 7: (second, 0.0), 2 * DRIVEN_BLOCK: (arc, 40.0), 2 * DRIVEN_BLOCK + 2: (arc, 41.0)}
    changes[2 * DRIVEN_BLOCK + 9] = (second, 5.0)
    for tick in range(2 * DRIVEN_BLOCK + BLOCK + 500):  # past the end of the second path
        for plant in plants:
            if tick:
                plant.step()
            if tick == 0:
                plant.follow(*changes[0])
        ours, theirs = (plant.sample() for plant in plants)
        assert np.array(ours).tobytes() == np.array(theirs).tobytes(), tick
        if tick and tick in changes:
            for plant in plants:
                plant.follow(*changes[tick])


vectors = st.tuples(*[st.floats(-80, 80)] * 3)


@given(rows=st.lists(st.tuples(vectors, vectors), min_size=1, max_size=6))
def test_columns_of_coordinated_flight_are_its_rows(rows: list) -> None:
    """Straight up and a standstill among them."""
    rows = [*rows, ((0.0, 0.0, 50.0), (3.0, 0.0, 0.0)), (STILL, (1.0, 0.0, 0.0))][: len(rows) + len(rows) % 3]
    velocity, acceleration = ([np.array(column) for column in zip(*each, strict=True)] for each in zip(*rows, strict=True))
    banks, load_factors = coordinated_columns(velocity, acceleration)
    assert list(zip(banks, load_factors, strict=True)) == [coordinated(*row) for row in rows]
