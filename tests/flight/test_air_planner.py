"""Planning in a wind: the frame of the decision, what is known of the wind, traffic in the wind, and invariance."""

import math

import numpy as np
import pytest

from testbed import fly, measure
from testbed.campaign.words.settings import FlightPlan
from testbed.core.frames import vec3, wind_enu_from_compass
from testbed.flight.fly import make_law, make_planner, make_plant, make_sensor, sensor_context, start_of
from testbed.flight.planning.context import Context, make_context
from testbed.flight.planning.rejoin import resized
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.plants.base import State
from testbed.flight.record import ReplanEvent
from testbed.flight.route.path import ActivePath
from testbed.flight.scene import make_scene
from tests.plans import KINEMATIC, paper_obstacle, plan
from vosc import ph

STRAIGHT = {"start_enu_m": [0, 0, 0], "goal_enu_m": [700, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
OBSTACLE = {"name": "O", "radius_m": 25, "position_enu_m": [290, 155, -6], "speed_mps": 25, "direction_deg": [-85, 4]}
WIND = {"kind": "steady", "speed_mps": 12, "from_deg": 215}
W = np.array(wind_enu_from_compass(12, 215))
DRIFTS = {"traffic": {"in_wind": "drifts"}, "air": {"wind": WIND}}
METHODS = ["scoam", "least_deflection", "droam_hp", "droam_vp"]


def decide(a_plan: FlightPlan, time_s: float = 3.2, shift: np.ndarray | None = None) -> ReplanEvent:
    """The event of a planner that sees the own aircraft at 50 m/s east through the air, on the route's line, carried by ``shift``."""
    shift = np.zeros(3) if shift is None else shift
    x, y, z = np.array([50.0 * time_s, 0.0, 0.0]) + shift * time_s
    vx, vy, vz = np.array([50.0, 0.0, 0.0]) + shift
    state = State(x, y, z, vx, vy, vz, *[0.0] * 4, 50.0, *[0.0] * 9)
    scene = make_scene(a_plan)
    planner, sensor = make_planner(a_plan), make_sensor(a_plan)
    _, seen = sensor.sense(sensor.start(sensor_context(a_plan)), time_s, state, scene.traffic)
    _, _, event = planner.step(planner.start(context(a_plan)), time_s, state, seen, ActivePath(scene.route.curves), 0.0)
    assert event is not None
    return event


def context(a_plan: FlightPlan) -> Context:
    return make_context(a_plan, make_scene(a_plan), load_aircraft(a_plan.aircraft))


def straight(**changes: object) -> FlightPlan:
    return plan(**({"route": STRAIGHT, "obstacles": [OBSTACLE], "sensor": {"range_m": 300}} | changes))


def seen_from_the_air(event: ReplanEvent, wind: np.ndarray, time_s: float) -> np.ndarray:
    """Everything that the event says, as a balloon that was at the origin at time 0 would write it down."""
    start, arrival = wind * time_s, wind * (time_s + event.insertion_time_s)
    places = [np.array(event.own_pos_enu_m) - start, np.array(event.obstacle_pos_enu_m) - start, np.array(event.insertion_enu_m) - arrival]
    velocities = [np.array(v) - wind for v in (event.own_vel_enu_mps, event.obstacle_vel_enu_mps, event.command_enu_mps)]
    cap = [event.cap_radius_mps, event.cap_azimuth_rad, event.cap_elevation_rad, event.cap_half_angle_rad]
    scalars = [event.alpha_rad, event.time_to_cpa_s, event.miss_m, event.deflection_rad, event.margin_rad, event.insertion_time_s]
    return np.concatenate([*places, *velocities, cap, scalars])


@pytest.mark.parametrize("method", METHODS)
def test_a_uniform_wind_changes_nothing_for_who_drifts_with_it(method: str) -> None:
    calm = decide(straight(method={"kind": method}))
    windy = decide(straight(method={"kind": method}, **DRIFTS), shift=W)
    assert windy.decision == calm.decision == "replanned"
    assert np.allclose(seen_from_the_air(windy, W, 3.2), seen_from_the_air(calm, np.zeros(3), 3.2), atol=1e-9)


@pytest.mark.parametrize("frame", ["air", "ground_naive"])
def test_only_the_air_frame_commands_a_velocity_that_can_be_flown(frame: str) -> None:
    """The airspeed of the commanded ground velocity: the own airspeed, or not."""
    event = decide(straight(replan={"vo_frame": frame}, **DRIFTS), shift=W)
    airspeed = np.linalg.norm(np.array(event.command_enu_mps) - W)
    if frame == "air":
        assert airspeed == pytest.approx(50.0)
    else:
        assert np.linalg.norm(event.command_enu_mps) == pytest.approx(np.linalg.norm(np.array([50.0, 0, 0]) + W))
        assert abs(airspeed - 50.0) > 0.5


def test_the_insertion_point_is_met_in_its_time_at_the_own_airspeed() -> None:
    """Straight from the aircraft to the point over the ground in the insertion time, less the wind, is 50 m/s; k R ahead in the air."""
    event = decide(straight(**DRIFTS), shift=W)
    to_point = (np.array(event.insertion_enu_m) - event.own_pos_enu_m) / event.insertion_time_s
    assert np.linalg.norm(to_point - W) == pytest.approx(50.0)
    there = np.array(event.obstacle_pos_enu_m) + event.insertion_time_s * np.array(event.obstacle_vel_enu_mps)
    ahead = np.array(event.obstacle_vel_enu_mps) - W
    assert np.allclose(np.array(event.insertion_enu_m) - there, 1.25 * 25 * ahead / np.linalg.norm(ahead))


def test_a_planner_that_knows_no_wind_is_the_naive_one() -> None:
    naive, blind = (
        decide(straight(replan=settings, **DRIFTS), shift=W) for settings in ({"vo_frame": "ground_naive"}, {"wind_known": "none"})
    )
    assert naive == blind
    assert naive.wind_known_enu_mps == (0.0, 0.0, 0.0)


def test_an_estimated_wind_has_the_error_that_was_asked_for() -> None:
    """The same for every method of a seed; over 400 seeds 1.5 m/s in each horizontal component, within four standard errors."""
    estimated = {"wind_known": "estimated", "wind_estimate_sigma_mps": 1.5}
    a, b = (decide(straight(replan=estimated, method={"kind": kind}, **DRIFTS), shift=W) for kind in ("scoam", "droam_hp"))
    assert a.wind_known_enu_mps == b.wind_known_enu_mps != tuple(W)
    scene, aircraft = make_scene(straight(**DRIFTS)), load_aircraft("gtm_t2")
    errors = []
    for seed in range(400):
        known = make_context(straight(replan=estimated, seed=seed, **DRIFTS), scene, aircraft).wind_known(0.0, (0.0, 0.0, 0.0))
        errors.append(np.array(known) - W)
    spread = np.array(errors).std(axis=0)
    assert spread[:2] == pytest.approx([1.5, 1.5], abs=4 * 1.5 / math.sqrt(800))
    assert spread[2] == 0.0


def test_in_shear_the_planner_knows_the_wind_of_its_own_height() -> None:
    sheared = {"wind": {"kind": "power_law", "speed_mps": 6, "from_deg": 270}}
    event = decide(straight(air=sheared), shift=np.zeros(3))
    assert event.wind_known_enu_mps == pytest.approx((6 * 20 ** (1 / 7), 0.0, 0.0))


def test_drifting_traffic_is_where_it_should_be_when_it_should() -> None:
    """At its ``when``, in the wind's own schedule, the obstacle is at its printed place; its ground velocity is the printed one plus W."""
    changes = {"obstacles": [paper_obstacle()], "air": {"wind": WIND}}
    fixed, drifting = (make_scene(plan(traffic={"in_wind": kind}, **changes)) for kind in ("ground_fixed", "drifts"))
    assert np.allclose(np.array(drifting.tracks[0].vel) - fixed.tracks[0].vel, W)
    meeting = np.linalg.lstsq(W[:, None], np.array(fixed.tracks[0].pos) - drifting.tracks[0].pos, rcond=None)[0][0]
    assert np.allclose(fixed.tracks[0].at(meeting)[0], (254, 63.6, 60.7), atol=1e-6)


def closest(a_plan: FlightPlan) -> tuple[float, np.ndarray, float]:
    """Time, miss vector and closing speed of a flown record, from its columns."""
    columns = fly(a_plan).columns
    time, own, other = columns["time_s"], columns["own.pos_enu_m"], columns["obstacle.O.pos_enu_m"]
    relative, step = other - own, 1 / 120
    k = int(np.argmin(np.linalg.norm(relative, axis=1)))
    velocity = (relative[k + 1] - relative[k - 1]) / (2 * step)
    shift = -(relative[k] @ velocity) / (velocity @ velocity)
    return time[k] + shift, relative[k] + shift * velocity, float(np.linalg.norm(velocity))


@pytest.mark.parametrize("from_deg", [0, 90, 215])
def test_an_anchored_encounter_is_the_calm_one(from_deg: float) -> None:
    case = KINEMATIC | {"method": {"kind": "none"}, "obstacles": [paper_obstacle()]}
    calm = closest(plan(**case))
    air = {"wind": {"kind": "steady", "speed_mps": 10, "from_deg": from_deg}}
    anchored = closest(plan(air=air, traffic={"in_wind": "anchored"}, **case))
    fixed = closest(plan(air=air, **case))
    assert anchored[0] == pytest.approx(calm[0], abs=2e-3)
    assert np.linalg.norm(anchored[1] - calm[1]) < 0.1
    assert anchored[2] == pytest.approx(calm[2], abs=0.1)
    assert abs(np.linalg.norm(fixed[1]) - np.linalg.norm(calm[1])) > 1.0, "the ground-fixed design is another question"


def test_in_calm_air_the_designs_are_the_same() -> None:
    fixed, drifting, anchored = (
        make_scene(plan(obstacles=[paper_obstacle()], traffic={"in_wind": kind})).tracks[0]
        for kind in ("ground_fixed", "drifts", "anchored")
    )
    assert drifting == fixed
    assert np.allclose([*anchored.pos, *anchored.vel], [*fixed.pos, *fixed.vel], atol=1e-9)


def flight_in_moving_air(a_plan: FlightPlan, wind: np.ndarray, seconds: float) -> tuple[np.ndarray, list[ReplanEvent]]:
    """The loop of a flight whose route and goal drift with the wind: positions (n,3) and events, seen from the air.

    Plant, traffic and planner live over the ground; the path moves with the air, as the planner's answer must for the comparison.
    """
    scene, aircraft = make_scene(a_plan), load_aircraft(a_plan.aircraft)
    velocity = np.array([50.0, 0.0, 0.0]) + wind
    start = start_of(a_plan, scene)._replace(tangent=vec3(velocity / np.linalg.norm(velocity)), wind=vec3(wind))
    plant = make_plant(a_plan, aircraft, start, scene)
    law, planner, sensor = make_law(a_plan, aircraft), make_planner(a_plan), make_sensor(a_plan)
    sensed, handled = sensor.start(sensor_context(a_plan)), planner.start(make_context(a_plan, scene, aircraft))
    path, memory = ActivePath(scene.route.curves), law.start(0.0)
    places, events = [], []
    for tick in range(round(seconds * 120)):
        state = plant.state(plant.sample())
        drift = wind * tick / 120
        in_air = state._replace(
            x=state.x - drift[0], y=state.y - drift[1], z=state.z - drift[2],
            vx=state.vx - wind[0], vy=state.vy - wind[1], vz=state.vz - wind[2],
        )  # fmt: skip
        places.append(in_air[:3])
        if tick % 2 == 0:
            sensed, seen = sensor.sense(sensed, tick / 120, state, scene.traffic)
            handled, new_path, event = planner.step(handled, tick / 120, state, seen, path, memory.s_m)
            if event:
                events.append(event)
            if new_path and event:
                middle = np.array(event.insertion_enu_m) - wind * (tick / 120 + event.insertion_time_s)
                command = vec3(np.array(event.command_enu_mps) - wind)
                first, second = math.dist(in_air[:3], middle), math.dist(middle, scene.goal)
                there = ph.hermite(in_air[:3], resized(in_air[3:6], first), middle, resized(command, first))
                on = ph.hermite(middle, resized(command, second), scene.goal, resized(scene.goal_tangent, second))
                path, memory = ActivePath((there, on)), law.start(0.0)
            command, memory, _ = law.step(memory, in_air, path)
            plant.command(state, command)
        plant.step()
    return np.array(places), events


@pytest.mark.parametrize(("kind", "tolerance"), [("point_mass", 1e-6), ("jsbsim", 0.05)])
def test_the_air_relative_record_of_a_flight_is_that_of_calm_air(kind: str, tolerance: float) -> None:
    """12 m/s: route, goal and traffic drift. The whole flight, avoidance included, seen from the air; JSBSim's Earth turns and is round."""
    flown = {"plant": {"kind": kind}, "sensor": {"range_m": 150}}
    calm = fly(straight(**flown))
    places, events = flight_in_moving_air(straight(**flown, **DRIFTS), W, 12.0)
    assert [event.decision for event in events] == [event.decision for event in calm.events] == ["replanned"]
    assert measure(calm).deflection_deg > 5.0
    difference = np.linalg.norm(places - calm.columns["own.pos_enu_m"][: len(places)], axis=1)
    assert difference.max() < tolerance


def test_a_naive_planner_does_not_fly_the_calm_record() -> None:
    """What the invariance test would say of a planner that forgets the wind."""
    flown = {"plant": {"kind": "point_mass"}, "sensor": {"range_m": 150}, "replan": {"vo_frame": "ground_naive"}}
    calm = fly(straight(**flown))
    places, _ = flight_in_moving_air(straight(**flown, **DRIFTS), W, 12.0)
    assert np.linalg.norm(places - calm.columns["own.pos_enu_m"][: len(places)], axis=1).max() > 1.0
