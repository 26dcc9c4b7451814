"""Laws that steer and planners of one's own: what they answer, in what words they are refused, and who is remembered."""

import math

import numpy as np
import pytest

from testbed.core.chain import Chain
from testbed.core.units import DEG
from testbed.flight.fly import make_planner
from testbed.flight.planning import Context, Steer
from testbed.flight.planning.context import make_context
from testbed.flight.planning.own import OwnPlanner, asked, path_of
from testbed.flight.planning.replan import Replanner
from testbed.flight.planning.steering import arc
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.plants.base import State
from testbed.flight.route.path import ActivePath
from testbed.flight.scene import make_scene
from testbed.flight.sensing import Seen
from tests.plans import KINEMATIC, plan
from vosc import ph

ROUTE = {"start_enu_m": [0, 0, 0], "goal_enu_m": [900, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
EAST = State(100.0, 2.0, 3.0, 50.0, 0.0, 0.0, *[0.0] * 14)


def context(**changes: object) -> Context:
    a_plan = plan(route=ROUTE, **(KINEMATIC | changes))
    return make_context(a_plan, make_scene(a_plan), load_aircraft(a_plan.aircraft))


def test_an_acceleration_is_a_curvature_across_the_velocity() -> None:
    path = arc(Steer(acceleration_enu_mps2=np.array([7.0, 5.0, 0.0])), EAST, 30.0)
    point, tangent, curvature = path.frame(30.0)
    assert point == (100.0, 2.0, 3.0)
    assert tangent == (1.0, 0.0, 0.0)
    assert curvature == pytest.approx((0.0, 5.0 / 50.0**2, 0.0))


def test_a_velocity_is_a_direction_at_most_85_deg_aside() -> None:
    assert arc(Steer(velocity_enu_mps=(30.0, 40.0, 0.0)), EAST, 0.0).frame(0.0)[1] == pytest.approx((0.6, 0.8, 0.0))
    for back in ((-1.0, 0.1, 0.0), (-1.0, 0.0, 0.0)):
        tangent = arc(Steer(velocity_enu_mps=back), EAST, 0.0).frame(0.0)[1]
        assert math.acos(tangent[0]) / DEG == pytest.approx(85.0)
        assert tangent[1] > 0.9


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (None, "must return"),
        (Steer(), "an acceleration or a velocity"),
        (Steer((1, 2, 3), (1, 2, 3)), "an acceleration or a velocity"),
        (Steer(acceleration_enu_mps2=(1.0, 2.0)), "Steer.acceleration_enu_mps2: give three numbers"),
        (Steer(velocity_enu_mps=(math.nan, 0.0, 0.0)), "Steer.velocity_enu_mps: all three numbers must be finite"),
        (Steer(velocity_enu_mps=(0.0, 0.0, 0.0)), "a velocity of zero has no direction"),
    ],
)
def test_what_is_no_steer_is_refused_in_words(answer: object, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        arc(answer, EAST, 0.0)  # type: ignore[arg-type]


CURVE = ph.hermite((50.0, 0.0, 3.0), (400.0, 0.0, 0.0), (450.0, 40.0, 3.0), (400.0, 0.0, 0.0))
NEXT = ph.hermite((450.0, 40.0, 3.0), (400.0, 0.0, 0.0), (850.0, 0.0, 3.0), (400.0, 0.0, 0.0))


@pytest.mark.parametrize("answer", [CURVE, [CURVE, NEXT], (CURVE, NEXT), Chain([CURVE, NEXT]), [EAST[:3], (300, 60, 3), (900, 0, 0)]])
def test_curves_and_points_are_paths_that_begin_where_the_aircraft_is(answer: object) -> None:
    path = path_of(answer, EAST)
    assert isinstance(path, ActivePath)
    assert math.dist(path.frame(path.begin_s_m)[0], EAST[:3]) < 3.0
    if isinstance(answer, list) and not isinstance(answer[0], ph.Curve):
        assert path.frame(0.0)[1] == pytest.approx((1.0, 0.0, 0.0))  # along the velocity
        assert min(math.dist(path.frame(s)[0], (300, 60, 3)) for s in np.linspace(0, path.length_m, 800)) < 1.0


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        ("home", "PH curves or finite points"),
        ([(0, 0, 0)], "at least two"),
        ([(0, 0, 0), (math.nan, 0, 0)], "finite points"),
        ([(0, 0, 0), (1, 1)], "PH curves or finite points"),
        ([(0, 0, 0), (0, 0, 0)], "the same point twice"),
        ([NEXT, CURVE], "a gap of"),
        (NEXT, "must begin where the aircraft is, or pass there .within 20 m., not 352.1 m from it"),
        ([(100, 25, 3), (900, 25, 3)], "or pass there .within 20 m., not 23.0 m from it"),
        ([(0, 2, 3), (60, 2, 3)], "not 40.0 m from it"),  # it ends before the aircraft
        ([(100 * k, 2, 3) for k in range(12)], "begin where the aircraft is: it has many pieces"),
    ],
)
def test_what_is_no_path_is_refused_in_words(answer: object, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        path_of(answer, EAST)


def test_a_path_may_have_begun_behind_the_aircraft() -> None:
    assert path_of([(0, 0, 3), (900, 0, 3)], EAST).begin_s_m == pytest.approx(100.0, abs=1.0)
    assert path_of([(100 + 100 * k, 0, 3) for k in range(12)], EAST).begin_s_m == 0.0


class Wanderer:
    """Asks for the goal at its third look, with nothing in sight."""

    def start(self, told: Context) -> tuple[int, Context]:
        return 0, told

    def step(self, memory: tuple[int, Context], time_s: float, state: State, seen: tuple[Seen, ...]):  # noqa: ARG002
        looks, told = memory
        return (looks + 1, told), ([state[:3], told.goal] if looks == 2 else None)


def test_a_planner_is_asked_for_what_it_takes() -> None:
    paper = make_planner(plan(**KINEMATIC))
    assert isinstance(paper, Replanner)  # it asks for path and arc length, and is asked without a go-between
    own = asked("w:Wanderer", Wanderer())
    assert isinstance(own, OwnPlanner)
    told = context()
    memory, route = own.start(told), ActivePath(told.route.curves)
    answers = []
    for look in range(4):
        memory, path, event = own.step(memory, look / 60, EAST, (), route, 100.0)
        answers.append((path, event))
    ((_, event),) = [answer for answer in answers if answer[0] is not None]
    assert (event.decision, event.obstacle, event.time_s) == ("planned", "", 2 / 60)
    assert math.isnan(event.miss_m)
    assert own.slowest_s > 0.0


def test_a_planner_that_answers_otherwise_is_told_so() -> None:
    class Wrong(Wanderer):
        def step(self, memory, time_s, state, seen):  # noqa: ARG002
            return None

    own = asked("w:Wrong", Wrong())
    told = context()
    with pytest.raises(ValueError, match=r"w:Wrong must return \(memory, path or None\)"):
        own.step(own.start(told), 0.0, EAST, (), ActivePath(told.route.curves), 0.0)


def test_who_is_out_of_sight_is_taken_to_go_straight_on() -> None:
    """A flight that holds its direction comes back although the sensor no longer sees what it avoided; the planner cannot peek."""
    replan = {"answer": "direct", "rejoin": {"when": "clear", "margin_m": 5}, "swell_m": 5}
    told = context(replan=replan)
    planner = Replanner()
    seen = Seen("O", 25.0, (200.0, 5.0, 4.0), (-30.0, 0.0, 0.0), 0.0)
    memory, path, event = planner.step(planner.start(told), 0.0, EAST, (seen,), ActivePath(told.route.curves), 100.0)
    assert event is not None
    assert event.decision == "replanned"
    assert path is not None
    assert memory.known == {"O": seen}
    passed = EAST._replace(x=190.0, y=60.0)  # out of sight from here on: predicted at x = 200 - 30 * 4 = 80, it is behind
    memory, back, event = planner.step(memory, 4.0, passed, (), path, 50.0)
    assert back is not None
    assert event.decision == "rejoined"
    assert event.obstacle_pos_enu_m == pytest.approx((80.0, 5.0, 4.0))
    before = EAST._replace(x=60.0, y=60.0)
    memory = memory._replace(hold_from_s_m=0.0)
    assert planner.step(memory, 4.0, before, (), path, 50.0)[1] is None  # it would still be ahead
