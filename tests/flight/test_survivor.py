"""The planner that predicts the aircraft: what it decides in odd states, what it keeps where a cone does not, what it says."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from testbed.campaign.words.population import Encounters
from testbed.campaign.words.settings import FlightPlan
from testbed.flight.fly import fly
from testbed.flight.planning import survivor
from testbed.flight.planning.context import make_context
from testbed.flight.planning.decided import Decided
from testbed.flight.planning.foresight import Choice, Held, chosen
from testbed.flight.planning.prediction import UNIDENTIFIED_M, AirKind, Lags, Margin, Prediction, air_kind
from testbed.flight.planning.survivor import Survivor, lift
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.plants.base import State
from testbed.flight.record import Decision, FlightRecord, Outcome
from testbed.flight.route.path import ActivePath
from testbed.flight.scene import make_scene
from testbed.flight.sensing import Seen
from testbed.flight.traffic.track import least_clearance
from tests.plans import plan

ROUTE = {"start_enu_m": [0, 0, 0], "goal_enu_m": [700, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
MEETS = Encounters.model_validate(
    {
        "own_at_enu_m": [150, 0, 0],
        "own_direction_deg": [0, 0],
        "trigger": {"range_m": 100},
        "obstacle_speed_mps": [20, 50],
        "radius_m": [25, 30],
        "longest_s": 6,
    }
)
DIRECT = {"answer": "direct", "rejoin": {"when": "clear"}}
SHAPES = ("directions", "programmes")
SEED = 77


def met(number: int, **changes: object) -> FlightPlan:
    """A straight flight in JSBSim that sees its obstacle from 100 m."""
    fixed = {"route": ROUTE, "obstacles": MEETS.drawn(50.0, SEED, number), "sensor": {"range_m": 100}, "plant": {"kind": "jsbsim"}}
    return plan(**(fixed | {"aircraft": "gtm_t2", "speed_mps": 50, "replan": DIRECT, "method": {"kind": "none"}} | changes))


def with_shape(shape: str, **options: object) -> dict[str, object]:
    return {"kind": "survivor", "options": {"shape": shape, **options}}


def clearance_m(record: FlightRecord) -> float:
    columns, obstacle = record.columns, record.plan.obstacles[0]
    track = columns[f"obstacle.{obstacle.name}.pos_enu_m"]
    return least_clearance(columns["time_s"], columns["own.pos_enu_m"], track, obstacle.radius_m).clearance_m


LOST_BY_A_CONE = (4, 5, 9)


@pytest.mark.parametrize("number", LOST_BY_A_CONE)
def test_it_keeps_the_radius_where_the_least_deflection_at_once_does_not(number: int) -> None:
    cone = fly(met(number, method={"kind": "least_deflection"}), until=Decided)
    assert clearance_m(cone) < 0.0
    for shape in SHAPES:
        record = fly(met(number, planner=with_shape(shape)), until=Decided)
        assert clearance_m(record) > 0.0
        first = record.events[0]
        assert (first.decision, first.method) == (Decision.STEERED, "survivor")
        assert clearance_m(record) == pytest.approx(first.path_clearance_m, abs=1.5)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("plant", ["kinematic", "point_mass"])
def test_it_keeps_its_margin_on_the_other_rungs(plant: str, shape: str) -> None:
    """Head-on. A point on rails takes at once what an aeroplane takes a second for: predicted as one it would come back too early."""
    ahead = [
        {"name": "O", "radius_m": 25, "position_enu_m": [330, 2, 0], "speed_mps": 30, "direction_deg": [180, 0], "when": {"time_s": 6}}
    ]
    record = fly(met(0, obstacles=ahead, sensor={"range_m": 200}, planner=with_shape(shape), plant={"kind": plant}))
    assert record.outcome is Outcome.REACHED
    assert clearance_m(record) > 1.0
    assert record.events[-1].decision is Decision.REJOINED


def test_the_same_plan_flies_the_same_flight_and_says_what_it_could_not_keep() -> None:
    """Asked for 40 m to spare from 100 m away it takes the most there is, and says so once."""
    a_plan = met(LOST_BY_A_CONE[0], planner=with_shape("programmes", margin_m=40))
    records = [fly(a_plan, until=Decided) for _ in range(2)]
    for name, column in records[0].columns.items():
        assert np.array_equal(column, records[1].columns[name], equal_nan=True), name
    reasons = [event.reason for event in records[0].events if event.reason]
    assert len(reasons) == 1
    assert reasons[0].startswith("no manoeuvre keeps the margin of 40.0 m: the one with the most clearance")
    assert clearance_m(records[0]) == pytest.approx(records[0].events[0].path_clearance_m, abs=3.0)


def test_a_pass_with_room_to_spare_is_left_alone() -> None:
    beside = [{"name": "O", "radius_m": 25, "position_enu_m": [300, 60, 0], "speed_mps": 0, "direction_deg": [0, 0]}]
    record = fly(met(0, obstacles=beside, planner=with_shape("directions"), plant={"kind": "kinematic"}))
    assert record.events == ()


NUMBER = st.floats(-300, 300)
VECTOR = st.tuples(NUMBER, NUMBER, NUMBER)
OBSTACLE = st.tuples(VECTOR, VECTOR, st.floats(0.1, 200))


@settings(max_examples=60, deadline=None)
@given(
    pos=VECTOR, vel=VECTOR, bank=st.floats(-3.2, 3.2), load=st.floats(-8, 8), airspeed=st.floats(0, 400),
    p=st.floats(-9, 9) | st.just(math.nan),
    others=st.lists(OBSTACLE, min_size=1, max_size=5), shape=st.sampled_from(SHAPES),
)  # fmt: skip
def test_odd_states_are_answered(
    pos: tuple[float, float, float], vel: tuple[float, float, float], bank: float, load: float, airspeed: float, p: float,
    others: list[tuple[tuple[float, float, float], tuple[float, float, float], float]], shape: str,
) -> None:  # fmt: skip
    a_plan = met(0)
    planner = Survivor(shape=shape)  # type: ignore[arg-type]
    scene = make_scene(a_plan)
    memory = planner.start(make_context(a_plan, scene, load_aircraft("gtm_t2")))
    state = State(*pos, *vel, bank, 0.0, 0.0, load, airspeed, 0.0, 0.0, p, *[0.0] * 6)
    seen = [Seen(f"o{k}", radius, where, to, 0.0) for k, (where, to, radius) in enumerate(others)]
    path: object = ActivePath(scene.route.curves)
    for time_s in (0.0, 1.0 / 60.0, 0.2):
        answer = planner.step(memory, time_s, state, seen, path, 100.0)  # type: ignore[arg-type]
        memory, path = answer.memory, answer.path or path
        if answer.path is not None:
            assert np.isfinite(answer.path.frame(answer.path.begin_s_m)).all()
        if memory.choice is not None:
            assert np.isfinite(memory.choice.place).all()
            assert not math.isnan(memory.choice.clearance_m)


def test_a_decision_is_the_least_deviation_that_keeps_the_margin_or_else_the_most_clearance() -> None:
    fast = np.ones(3, dtype=bool)
    turns = np.array([0.5, 0.1, 0.3])

    def taken(spare: list[float], deviation: np.ndarray = turns, fast: np.ndarray = fast, flies: bool = False) -> tuple[int, bool]:
        return chosen(np.array(spare), np.array(spare) - 1.0, deviation, fast, flies)

    assert taken([1.0, -1.0, 2.0]) == (2, True)
    assert taken([-1.0, -3.0, -2.0]) == (0, False)
    assert taken([1.0, 1.0, 1.0], fast=np.array([True, False, True])) == (2, True)
    assert taken([1.0, 2.0, 1.0], deviation=np.array([0.11, 0.10, 0.3]), flies=True) == (0, True)  # kept: it is hardly worse
    assert taken([0.1, 2.0, 0.5], flies=True) == (1, True)
    assert taken([0.1, 0.9, 0.5], flies=True) == (0, True)  # kept: the others do not keep what was asked for at first
    assert taken([-0.1, 0.9, 0.5], flies=True) == (1, True)
    assert taken([-1.2, -1.0, -9.0], flies=True) == (0, False)


def test_the_lift_of_a_programme_in_level_flight_and_in_a_climb() -> None:
    held = Held(None, bank=math.radians(60), load=2.0)
    assert lift(held, (0.0, 50.0, 0.0)) == pytest.approx((9.80665 * math.sqrt(3.0), 0.0, 0.0))  # a level turn to the right of north
    straight = lift(Held(None, 0.0, math.cos(0.4)), (50 * math.cos(0.4), 0.0, 50 * math.sin(0.4)))
    assert straight == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
    pulled = np.array(lift(Held(None, 0.3, 2.0), (40.0, 10.0, 20.0)))
    assert pulled @ (40.0, 10.0, 20.0) == pytest.approx(0.0, abs=1e-9)


def test_the_margin_is_the_identified_one_of_the_air_or_a_number(monkeypatch: pytest.MonkeyPatch) -> None:
    lags = Lags(bank_lag_s=0.1, roll_start_s=0.1, load_lag_s=0.1, load_start_s=0.0)
    calm = Margin(flights=9, within_s=(1.0, 2.0), margin_m=(0.5, 2.5), median_m=(0.0, 0.1), predictions=(50, 50))
    found = Prediction(found_by="", lags=lags, margins={"calm": calm})
    monkeypatch.setattr(survivor, "read_prediction", lambda _folder: found)

    a_plan = met(0)
    told = make_context(a_plan, make_scene(a_plan), load_aircraft("gtm_t2"))

    def margins(planner: Survivor, air: AirKind) -> list[float]:
        planner.start(replace(told, air=air))
        return planner._margin(np.array([0.5, 1.0, 1.1, 9.0])).tolist()

    assert margins(Survivor(), "calm") == [0.5, 0.5, 2.5, 2.5]
    assert margins(Survivor(margin_m=1.0), "calm") == [1.0] * 4
    assert margins(Survivor(), "wind") == [UNIDENTIFIED_M] * 4
    assert told.air == "calm"
    assert air_kind(met(0, air={"turbulence": {"kind": "dryden", "severity": "light"}})) == "turbulence"
    assert air_kind(met(0, air={"wind": {"kind": "steady", "speed_mps": 5, "from_deg": 0}})) == "wind"


def test_what_was_expected_is_looked_up_between_its_times() -> None:
    track = np.array([[0.0, 50.0], [0.0, 10.0], [0.0, 0.0]])
    choice = Choice(Held((1.0, 0.0, 0.0)), 1.0, 0.5, 2.0, 0.0, True, np.array([3.0, 4.0]), track, np.array([0.0, 2.0]))
    assert choice.expected(3.5) == ((25.0, 5.0, 0.0), 1.0)
