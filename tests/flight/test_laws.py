"""The guidance laws that are built in: each against its own condition, in closed form or by another optimiser; and flown.

Flights are on rails and stop when they are clear; a law keeps the radius exactly (``spare_m: 0``) where its condition is looked at.
"""

import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy import optimize

from testbed.campaign.words.settings import FlightPlan
from testbed.core import registry
from testbed.flight.fly import fly
from testbed.flight.laws import LAWS
from testbed.flight.laws.constant_curvature import after, turning_axis
from testbed.flight.laws.effort_plan import Condition, Plan
from testbed.flight.laws.meeting import Meeting
from testbed.flight.laws.planes import larger_component
from testbed.flight.planning.context import Context, make_context
from testbed.flight.planning.decided import Decided
from testbed.flight.planning.steering import arc
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.plants.base import State
from testbed.flight.record import FlightRecord, Outcome
from testbed.flight.scene import make_scene
from testbed.flight.sensing.base import Seen
from testbed.flight.traffic.track import least_clearance
from vosc.methods.potential_field import force

PAGES = Path(__file__).parents[2] / "docs" / "methods"
MOVING = {"radius_m": 20, "position_enu_m": [400, 6, 304], "speed_mps": 30, "direction_deg": [130, 5], "when": {"time_s": 3.2}}
STANDING = {"radius_m": 20, "position_enu_m": [400, 6, 304], "speed_mps": 0, "direction_deg": [0, 0]}
HEAD_ON = {"radius_m": 25, "position_enu_m": [400, 0, 300], "speed_mps": 30, "direction_deg": [180, 0], "when": {"time_s": 3.2}}
TANGENT_LAWS = ["geometric_guidance", "proportional_navigation", "constant_curvature", "extended_navigation"]


def planned(law: str, options: dict[str, Any], obstacle: dict[str, Any], **more: Any) -> FlightPlan:
    who = {"flight_id": "", "campaign": "laws", "cell": "", "labels": {}, "replicate": 0, "seed": 0}
    ends = {"start_enu_m": [0, 0, 300], "goal_enu_m": [1000, 0, 300], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
    scene = {"route": ends, "begin": {"at_route_s_m": 240}, "obstacles": [{"name": "O", **obstacle}], "sensor": {"range_m": 400}}
    parts = {"plant": {"kind": "kinematic"}, "method": {"kind": law, "options": {"most_mps2": 500.0, **options}}}
    return FlightPlan.model_validate(who | scene | parts | more)


class Steered:
    """What was flown from the decision to the closest approach: p, w, |p|, |w|, delta, L, the acceleration across the velocity."""

    def __init__(self, record: FlightRecord) -> None:
        self.record, columns, (spec,) = record, record.columns, record.plan.obstacles
        self.radius_m, self.hz = spec.radius_m, record.plan.rates.plant_hz
        from_obstacle = columns["own.pos_enu_m"] - columns["obstacle.O.pos_enu_m"]
        self.clearance_m = least_clearance(columns["time_s"], columns["own.pos_enu_m"], columns["obstacle.O.pos_enu_m"], 0.0).clearance_m
        self.clearance_m -= self.radius_m
        obstacle_vel = np.diff(columns["obstacle.O.pos_enu_m"], axis=0)[0] * self.hz
        first = round(record.events[0].time_s * self.hz)
        last = int(np.argmin(np.linalg.norm(from_obstacle, axis=1)))
        rows = slice(first + 1, last)
        self.time_s = columns["time_s"][rows] - record.events[0].time_s
        self.left_s = columns["time_s"][last] - columns["time_s"][rows]
        self.vel = columns["own.vel_enu_mps"][rows]
        self.p, self.w = -from_obstacle[rows], self.vel - obstacle_vel
        self.d, self.speed = np.linalg.norm(self.p, axis=1), np.linalg.norm(self.w, axis=1)
        alpha = np.arctan2(np.linalg.norm(np.cross(self.p, self.w), axis=1), np.sum(self.p * self.w, axis=1))
        self.delta = np.arcsin(np.minimum(self.radius_m / self.d, 1.0)) - alpha
        self.tangent_m = np.sqrt(np.maximum(self.d**2 - self.radius_m**2, 0.0))
        change = np.gradient(columns["own.vel_enu_mps"], axis=0)[rows] * self.hz
        ahead = self.vel / np.linalg.norm(self.vel, axis=1)[:, None]
        self.across = change - np.sum(change * ahead, axis=1)[:, None] * ahead
        self.pull = np.linalg.norm(self.across, axis=1)


@cache
def steered(law: str, moving: bool, guidance_hz: int = 120, **options: Any) -> Steered:
    rates = {"plant_hz": 2 * guidance_hz, "guidance_hz": guidance_hz, "planner_hz": 60}
    obstacle = MOVING if moving else STANDING
    return Steered(fly(planned(law, {"spare_m": 0.0, **options}, obstacle, rates=rates), until=Decided))


def test_every_law_is_a_method_that_a_campaign_can_name() -> None:
    assert list(registry.names("method"))[-len(LAWS) :] == list(LAWS)
    assert all(registry.given("method", registry.part("method", law)) == 0 for law in LAWS)


@pytest.mark.parametrize("law", LAWS)
def test_every_law_has_its_page_a_picture_and_a_row_of_the_table(law: str) -> None:
    page = (PAGES / f"{law}.md").read_text(encoding="utf-8")
    assert page.startswith(f"# {law}\n")
    for part in (f"]({law}.svg)", "**Assumes.**", "**Formula.**", "**Notes.**", "**Source.**"):
        assert part in page
    assert (PAGES / f"{law}.svg").read_text(encoding="utf-8").count("<polyline") == 4
    assert f"| [{law}]({law}.md) |" in (PAGES / "laws.md").read_text(encoding="utf-8")
    assert f"]({law}.md)" in (PAGES / "README.md").read_text(encoding="utf-8")


def test_differential_geometric_guidance_inverts_the_motion_of_delta() -> None:
    """Then delta = delta_0 exp(-K t) against an obstacle that crosses; what is left over is of the first order in the step."""
    off = []
    for hz in (60, 120):
        flown = steered("geometric_guidance", moving=True, guidance_hz=hz, form="differential", gain_1ps=2.0)
        early = flown.left_s > 0.5
        off.append(np.abs(np.log(flown.delta / flown.delta[0]) + 2.0 * (flown.time_s - flown.time_s[0]))[early].max())
        assert abs(flown.clearance_m) < 0.05
    assert off[1] < 0.06
    assert 1.6 < off[0] / off[1] < 2.5


def test_nonlinear_geometric_guidance_asks_for_k_v_sine_delta_and_falls_short_as_it_says() -> None:
    flown = steered("geometric_guidance", moving=False, gain_1ps=3.0)
    early = flown.left_s > 0.5
    asked = 3.0 * 50.0 * np.sin(flown.delta)
    assert np.abs(flown.pull / asked - 1.0)[early][2:].max() < 0.03
    missed = flown.radius_m - flown.d[0] * math.sin(math.asin(flown.radius_m / flown.d[0]) - flown.delta[0])
    assert -flown.clearance_m == pytest.approx(missed * math.exp(-3.0 * flown.left_s[0]), rel=0.25)


@pytest.mark.parametrize("gain", [3.0, 4.0])
def test_proportional_navigation_reaches_the_tangent_as_a_power_of_its_length(gain: float) -> None:
    """As L^(N-1), for small delta: the relative velocity is a tangent when the sphere is reached."""
    flown = steered("proportional_navigation", moving=True, plane="free", gain=gain)
    near = (flown.tangent_m < 0.5 * flown.tangent_m[0]) & (flown.left_s > 0.2)
    slope, _ = np.polyfit(np.log(flown.tangent_m[near]), np.log(flown.delta[near]), 1)
    assert slope == pytest.approx(gain - 1.0, rel=0.03)
    assert abs(flown.clearance_m) < 0.01


def test_constant_curvature_is_one_arc_to_the_tangent() -> None:
    flown = steered("constant_curvature", moving=True, share=0.6)
    event = flown.record.events[0]
    turning = (flown.time_s > 0.02) & (flown.time_s < 0.6 * event.time_to_cpa_s - 0.02)
    assert np.ptp(flown.pull[turning]) < 1e-4 * flown.pull[turning].mean()
    normals = np.cross(flown.vel[turning], flown.across[turning])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    assert np.abs(normals - normals[0]).max() < 1e-3
    after_it = flown.time_s > 0.6 * event.time_to_cpa_s + 0.02
    assert flown.pull[after_it].max() < 1e-6
    assert flown.delta[turning].min() >= 0.0
    assert -1e-6 < flown.clearance_m < 0.3  # the turn ends a step after the tangent


def test_the_arc_that_is_solved_for_is_the_arc() -> None:
    """``after`` against small steps of the same turn."""
    meeting = Meeting("O", (50.0, 3.0, -2.0), (100.0, 20.0, 5.0), (70.0, -10.0, 4.0), 20.0, 1.4)
    axis = np.array(turning_axis(meeting))
    place, u, dt, turn = np.zeros(3), np.array(meeting.air_mps), 1e-3, 0.7
    for _ in range(1000):
        half = u + 0.5 * dt * turn * np.cross(axis, u)
        place, u = place + dt * half, u + dt * turn * np.cross(axis, half)
    sight, relative = after(meeting, tuple(axis), turn, 1.0)
    obstacle = np.array(meeting.air_mps) - np.array(meeting.relative_mps)
    assert np.array(sight) == pytest.approx(np.array(meeting.sight_m) + obstacle - place, abs=1e-4)
    assert np.array(relative) == pytest.approx(u - obstacle, abs=1e-4)


def test_extended_navigation_keeps_its_angle_and_reaches_the_tangent_in_finite_time() -> None:
    """Then delta = delta_0 exp(-d t) - (N - 1) (theta - theta_0) in the horizontal plane, until it is zero well before the sphere."""
    flown = steered("extended_navigation", moving=True, gain=2.0, decay_1ps=2.0)
    p, w = flown.p[:, :2], flown.w[:, :2]
    angle = np.unwrap(np.arctan2(w[:, 1], w[:, 0]))
    sight = np.unwrap(np.arctan2(p[:, 1], p[:, 0]))
    side = np.sign(angle[0] - sight[0])
    shown = np.arcsin(np.minimum(flown.radius_m / np.linalg.norm(p, axis=1), 1.0)) - side * (angle - sight)
    theta = side * angle + shown
    steering = flown.delta > 0.0
    law = shown[0] * np.exp(-2.0 * (flown.time_s - flown.time_s[0])) - (theta - theta[0])
    assert np.abs(shown - law)[steering].max() < 0.02 * shown[0]
    assert flown.left_s[~steering].max() > 0.3
    assert flown.clearance_m > -1e-6
    assert np.abs(flown.vel[:, 2]).max() < 1e-9


@pytest.mark.parametrize(("plane", "kept"), [("horizontal", 2), ("vertical", 1)])
def test_in_a_plane_the_flight_stays_in_it(plane: str, kept: int) -> None:
    flown = steered("proportional_navigation", moving=True, plane=plane)
    assert np.abs(flown.vel[:, kept]).max() < 1e-6
    assert flown.clearance_m > -0.01


def test_the_plane_is_that_of_the_larger_component() -> None:
    assert larger_component((30.0, 30.0, -40.0)) == "horizontal"
    assert larger_component((10.0, -10.0, 20.0)) == "vertical"


def effort_conditions() -> tuple[Condition, ...]:
    across = [(0.0, math.cos(a), math.sin(a)) for a in (0.3, 2.0)]
    tilted = (0.6, 0.0, 0.8)
    return (
        Condition(1.5, across[0], 18.0),
        Condition(2.5, tilted, -9.0),
        Condition(6.0, across[1], 5.0),
        Condition(6.0, (0.0, 1.0, 0.0), 0.0),
    )


def test_the_plan_of_least_effort_is_that_of_a_numerical_optimiser() -> None:
    """A thousand steps of constant acceleration across the velocity, the least sum of squares with the same conditions."""
    conditions, steps = effort_conditions(), 1000
    plan = Plan((1.0, 2.0, 3.0), (50.0, 0.0, 0.0), (1.0, 0.0, 0.0), conditions)
    edges = np.linspace(0.0, 6.0, steps + 1)
    rows = []
    for one in conditions:
        reach = np.maximum(one.due_s - edges, 0.0) ** 2 / 2.0
        rows.append(np.concatenate([(reach[:-1] - reach[1:]) * way for way in one.way[1:]]))
    found = np.linalg.lstsq(np.array(rows), [one.short_m for one in conditions], rcond=None)[0].reshape(2, steps)
    assert plan.effort() == pytest.approx(float(np.sum(found**2)) * 6.0 / steps, rel=1e-4)
    assert plan.acceleration() == pytest.approx((0.0, *found[:, 0]), rel=5e-3)  # the mean of the first step
    for one in conditions:
        (place,) = plan.points(np.array([one.due_s]))
        free = np.array([1.0, 2.0, 3.0]) + one.due_s * np.array([50.0, 0.0, 0.0])
        assert (place - free) @ one.way == pytest.approx(one.short_m, abs=1e-6)


def test_what_is_flown_is_the_least_effort_round_a_sphere() -> None:
    """It is 3 z / t^2 and none at the sphere; and no more than an optimiser needs that may pass on any side at any time."""
    flown = steered("minimum_effort", moving=False, then="nothing")
    line = flown.pull[2] * flown.left_s / flown.left_s[2]
    acting = flown.left_s > 0.5
    assert np.abs(flown.pull - line)[acting].max() < 0.03 * flown.pull[2]
    assert abs(flown.clearance_m) < 0.02

    n, lasts = 24, float(flown.left_s[0])
    edges = np.linspace(0.0, lasts, n + 1)
    x = np.linspace(0.0, 1.0, 49) * lasts
    reach = [np.maximum(x[:, None] - edges[None, :], 0.0) ** 2 / 2.0][0]
    moved = reach[:, :-1] - reach[:, 1:]
    centre = np.array(STANDING["position_enu_m"]) - (flown.record.columns["own.pos_enu_m"][round(flown.record.events[0].time_s * flown.hz)])

    def spare(a: np.ndarray) -> np.ndarray:
        y, z = moved @ a[:n], moved @ a[n:]
        return np.sqrt((50.0 * x - centre[0]) ** 2 + (y - centre[1]) ** 2 + (z - centre[2]) ** 2) - flown.radius_m

    side = flown.across[2, 1:] / flown.pull[2]
    guess = np.concatenate([side[0] * np.linspace(4.0, 0.0, n), side[1] * np.linspace(4.0, 0.0, n)])
    least = optimize.minimize(
        lambda a: float(a @ a) * lasts / n,
        guess,
        jac=lambda a: 2.0 * a * lasts / n,
        constraints={"type": "ineq", "fun": spare},
        method="SLSQP",
    )
    assert least.success
    assert float(np.sum(flown.pull[1:] ** 2)) / flown.hz == pytest.approx(least.fun, rel=0.05)


def test_the_field_is_the_slope_of_its_potential_and_is_what_is_flown() -> None:
    goal, spheres, gain, reach = np.array([300.0, 40.0, 20.0]), [((60.0, 5.0, -3.0), 15.0), ((40.0, -30.0, 10.0), 12.0)], 1.3, 4.0

    def potential(x: np.ndarray) -> float:
        depth = [(reach * r / (np.linalg.norm(x - c) - r) - 1.0, reach * r) for c, r in spheres]
        return float(np.linalg.norm(x - goal)) + sum(0.5 * gain * rho0 * max(q, 0.0) ** 2 for q, rho0 in depth)

    x = np.array([20.0, 3.0, 2.0])
    slope = [(potential(x + h) - potential(x - h)) / 2e-5 for h in 1e-5 * np.eye(3)]
    down = force(tuple(x), tuple((goal - x) / np.linalg.norm(goal - x)), spheres, gain, reach)
    assert down == pytest.approx([-s for s in slope], rel=1e-6)
    flown = steered("field_guidance", moving=False)
    k = int(np.argmax(flown.pull > 1.0))
    away, centre = -flown.p[k], np.array(STANDING["position_enu_m"])
    towards = np.array([1000.0, 0.0, 300.0]) - (centre + away)
    pull = 15.0 * np.array(force(tuple(away), tuple(towards / np.linalg.norm(towards)), [((0.0, 0.0, 0.0), 20.0)], 1.0, 4.0))
    ahead = flown.vel[k] / np.linalg.norm(flown.vel[k])
    assert flown.across[k] == pytest.approx(pull - (pull @ ahead) * ahead, rel=0.06, abs=0.05)


@cache
def context(wind: tuple[float, float, float] = (0.0, 0.0, 0.0), replanned: str = "air") -> Context:
    plan = planned("geometric_guidance", {}, MOVING, replan={"vo_frame": replanned})
    made = make_context(plan, make_scene(plan), load_aircraft(plan.aircraft))
    return Context(**{**vars(made), "wind_known": lambda *_: wind})


def state(pos: tuple[float, ...], vel: tuple[float, ...]) -> State:
    rest = dict.fromkeys(State._fields[6:], 0.0)
    return State(*pos, *vel, **rest)


def asked(law: str, where: Context, own: State, seen: list[Seen], **options: Any) -> tuple[float, float, float]:
    """Two steps at one instant, the second with the memory of the first."""
    made = registry.part("method", law)(**options)
    memory, _ = made.steer(made.start(where), 0.0, own, seen)
    _, answer = made.steer(memory, 0.0, own, seen)
    path = arc(answer, own, 0.0)
    assert all(math.isfinite(c) for row in path.frame(1.0) for c in row)
    assert answer.velocity_enu_mps is None
    return answer.acceleration_enu_mps2


@pytest.mark.parametrize(("law", "options"), [*((law, {}) for law in TANGENT_LAWS), ("minimum_effort", {"then": "nothing"})])
def test_a_known_steady_wind_changes_nothing_through_the_air(law: str, options: dict[str, Any]) -> None:
    """The same encounter carried along by the air is answered alike, across the velocity through the air; taken for calm, it is not."""
    wind, vel, other = (6.0, -9.0, 1.0), (50.0, 0.0, 2.0), (-20.0, 10.0, 0.0)
    carried = tuple(np.add(vel, wind)), tuple(np.add(other, wind))
    calm = asked(law, context(), state((0, 0, 300), vel), [Seen("O", 20.0, (150.0, -20.0, 306.0), other, 0.0)], **options)
    moved = [Seen("O", 20.0, (150.0, -20.0, 306.0), carried[1], 0.0)]
    assert asked(law, context(wind), state((0, 0, 300), carried[0]), moved, **options) == pytest.approx(calm, abs=1e-9)
    assert abs(np.dot(calm, vel)) < 1e-9 * np.linalg.norm(calm) * 50.0
    assert np.linalg.norm(calm) > 0.1
    naive = asked(law, context(wind, "ground_naive"), state((0, 0, 300), carried[0]), moved, **options)
    assert naive != pytest.approx(calm, rel=1e-3)


number = st.one_of(st.sampled_from([0.0, -0.0, 1e-9, 50.0, -50.0]), st.floats(-3000.0, 3000.0))
vector = st.tuples(number, number, number)
near = st.tuples(*[st.one_of(st.sampled_from([0.0, 20.0, 1e-7]), st.floats(-300.0, 300.0))] * 3)
sphere = st.tuples(near, vector, st.floats(0.01, 500.0))


@pytest.mark.parametrize("law", LAWS)
@settings(max_examples=40, deadline=None)
@example(own=((0.0, 0.0, 0.0), (0.0, 0.0, 1e-291)), others=[], twice=False, wind=(0.0, 0.0, 0.0))  # a goal an age away
@given(own=st.tuples(near, vector), others=st.lists(sphere, max_size=3), twice=st.booleans(), wind=vector)
def test_no_physical_input_stops_a_law(law: str, own: Any, others: list[Any], twice: bool, wind: Any) -> None:
    """Standing still, straight up, at the goal, inside spheres, at their centres, one of them twice: an acceleration within bounds."""
    seen = [Seen(f"O{k}", radius, pos, vel, 0.0) for k, (pos, vel, radius) in enumerate(others)]
    seen += [one._replace(name="again") for one in seen[:1] if twice]
    found = asked(law, context(wind), state(*own), seen, most_mps2=25.0)
    assert np.linalg.norm(found) <= 25.0 * (1.0 + 1e-9)


@pytest.mark.parametrize("plant", ["kinematic", "point_mass"])
@pytest.mark.parametrize("law", LAWS)
def test_a_head_on_encounter_is_kept_clear_of_and_the_goal_reached(law: str, plant: str) -> None:
    """Straight at the centre, where no side is nearer. The field does not know that the sphere is coming, and may hit it."""
    record = fly(planned(law, {"most_mps2": 25.0}, HEAD_ON, plant={"kind": plant}))
    assert [event.decision for event in record.events][:1] == ["steered"]
    assert record.outcome in ((Outcome.REACHED, Outcome.COLLIDED) if law == "field_guidance" else (Outcome.REACHED,)), record.message
    if law != "field_guidance":
        places = (record.columns[name] for name in ("time_s", "own.pos_enu_m", "obstacle.O.pos_enu_m"))
        assert least_clearance(*places, 25.0).clearance_m > 0.0
