"""The sensor with errors: what is in sight, when it is told, how far it is off; the same noise for all that is compared."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from testbed import fly, load_campaign
from testbed.campaign import SpecError
from testbed.flight.fly import make_sensor, sensor_context
from testbed.flight.plants.base import State
from testbed.flight.scene import make_scene
from testbed.flight.sensing import Seen, SensorContext
from testbed.flight.sensing.imperfect import Imperfect
from testbed.flight.sensing.truth import Truth
from testbed.flight.traffic import Traffic
from testbed.flight.traffic.straight import Straight
from tests.plans import KINEMATIC, paper_obstacle, plan

coordinate = st.floats(-200, 200)
vector = st.tuples(coordinate, coordinate, coordinate)
angle = st.floats(-3.1, 3.1)


def state(pos: Any = (0, 0, 0), bank: float = 0.0, pitch: float = 0.0, heading: float = 0.0) -> State:
    return State(*map(float, pos), 50.0, 0.0, 0.0, bank, pitch, heading, *[0.0] * 11)


def looks(sensor: Any, traffic: Traffic, count: int, hz: int = 60, range_m: float = 500.0, own: Any = None, seed: int = 0) -> list:
    """What is told at each of so many looks, from one place or from that of ``own(time_s)``."""
    memory, told = sensor.start(SensorContext(range_m, hz, np.random.default_rng(seed))), []
    for k in range(count):
        memory, seen = sensor.sense(memory, k / hz, own(k / hz) if own else state(), traffic)
        told.append(seen)
    return told


@settings(max_examples=50)
@given(own=vector, places=st.lists(st.tuples(vector, vector), max_size=3), range_m=st.floats(1, 300), surface=st.booleans())
def test_without_errors_it_is_the_truth(own: tuple, places: list, range_m: float, surface: bool) -> None:
    tracks = Traffic(tuple(Straight(f"O{k}", 30.0, pos, vel) for k, (pos, vel) in enumerate(places)))
    range_to = "surface" if surface else "centre"
    within = [one for one in tracks.at(0.0) if math.dist(one.pos, own) <= range_m + 30.0 * surface]
    assert looks(Truth(range_to), tracks, 1, range_m=range_m, own=lambda _: state(own)) == [tuple(within)]
    (seen,) = looks(Imperfect(range_to=range_to), tracks, 1, range_m=range_m, own=lambda _: state(own))
    assert [one.name for one in seen] == [one.name for one in within]
    for one, true in zip(seen, within, strict=True):
        assert one.pos == pytest.approx(true.pos, abs=1e-9)
        assert (one.vel, one.time_s, one.covariance) == (true.vel, 0.0, ((0.0,) * 6,) * 6)


@settings(max_examples=100)
@given(place=vector, bank=angle, pitch=st.floats(-1.5, 1.5), heading=angle, width=st.floats(5, 359), height=st.floats(5, 179))
def test_the_field_of_view_turns_with_the_aircraft(
    place: tuple, bank: float, pitch: float, heading: float, width: float, height: float
) -> None:
    """Against rotations of scipy: body axes are NED turned by heading, pitch and bank."""
    ahead, right, down = Rotation.from_euler("ZYX", [heading, pitch, bank]).inv().apply([place[1], place[0], -place[2]])
    azimuth, elevation = math.degrees(math.atan2(right, ahead)), math.degrees(math.atan2(-down, math.hypot(ahead, right)))
    if min(abs(abs(azimuth) - width / 2), abs(abs(elevation) - height / 2), math.hypot(ahead, right)) < 1e-6:
        return
    sensor = Imperfect(azimuth_width_deg=width, elevation_width_deg=height)
    (seen,) = looks(sensor, Traffic((Straight("O", 1.0, place, (0, 0, 0)),)), 1, own=lambda _: state((0, 0, 0), bank, pitch, heading))
    assert bool(seen) == (abs(azimuth) <= width / 2 and abs(elevation) <= height / 2)


def test_a_measurement_is_made_at_its_rate_and_told_after_its_delay() -> None:
    line = Traffic((Straight("O", 5.0, (100.0, 0.0, 0.0), (-20.0, 0.0, 0.0)),))
    told = looks(Imperfect(update_hz=10.0, latency_s=0.25), line, 60)
    assert not any(told[:15])
    for k, seen in enumerate(told[15:], 15):
        made_s = math.floor((k / 60 - 0.25) * 10 + 1e-6) / 10
        assert seen[0].time_s == pytest.approx(made_s)
        assert seen[0].pos == pytest.approx((100.0 - 20.0 * made_s, 0.0, 0.0))


def test_noise_is_as_large_as_was_asked_for_and_as_its_covariance_says() -> None:
    place = np.array([120.0, -160.0, 50.0])
    body = Traffic((Straight("O", 5.0, tuple(place), (0, 0, 0)),))
    sensor = Imperfect(position_noise_m=2.0, velocity_noise_mps=0.5, bearing_noise_deg=1.0)
    seen = [one for (one,) in looks(sensor, body, 3000)]
    errors = np.array([(*np.subtract(one.pos, place), *one.vel) for one in seen])
    claimed = np.mean([one.covariance for one in seen], axis=0)
    along = place / np.linalg.norm(place)
    across = np.cross(along, [0, 0, 1.0]) / np.linalg.norm(np.cross(along, [0, 0, 1.0]))
    wide = math.hypot(2.0, math.radians(1.0) * float(np.linalg.norm(place)))
    for axis, sigma in ((along, 2.0), (across, wide), (np.cross(along, across), wide)):
        assert np.std(errors[:, :3] @ axis) == pytest.approx(sigma, rel=0.04)
        assert math.sqrt(axis @ claimed[:3, :3] @ axis) == pytest.approx(sigma, rel=0.01)
    assert np.std(errors[:, 3:], axis=0) == pytest.approx([0.5] * 3, rel=0.04)
    assert np.abs(np.mean(errors, axis=0)).max() < 0.2


def test_gaps_and_false_tracks_come_as_often_and_last_as_long_as_asked_for() -> None:
    line = Traffic((Straight("O", 5.0, (100.0, 0.0, 0.0), (0, 0, 0)),))
    here = [bool(seen) for seen in looks(Imperfect(dropouts_per_s=0.5, dropout_lasts_s=0.5), line, 6000, hz=10)]
    assert 1.0 - np.mean(here) == pytest.approx(1.0 - math.exp(-0.5 * 0.5), rel=0.15)  # of a train of even chance, gaps that overlap
    field = {"azimuth_width_deg": 120.0, "elevation_width_deg": 40.0}
    false = looks(Imperfect(false_tracks_per_s=0.4, false_lasts_s=2.0, false_speed_mps=0.0, **field), Traffic(()), 6000, hz=5)
    assert np.mean([len(seen) for seen in false]) == pytest.approx(0.4 * 2.0, rel=0.1)
    first = {one.name: one for seen in reversed(false) for one in seen}
    assert len(first) == pytest.approx(0.4 * 1200, rel=0.15)
    assert all(50.0 <= math.hypot(*one.pos) <= 500.0 + 1e-9 for one in first.values())
    azimuths = [math.degrees(math.atan2(one.pos[0], one.pos[1])) for one in first.values()]  # the nose points north
    assert max(map(abs, azimuths)) <= 60.0
    assert np.std(azimuths) == pytest.approx(120.0 / math.sqrt(12.0), rel=0.1)


def test_errors_of_the_own_state_are_common_to_all_and_change_slowly() -> None:
    places = ((100.0, 0.0, 0.0), (0.0, -50.0, 0.0))
    bodies = Traffic(tuple(Straight(f"O{k}", 5.0, place, (0, 0, 0)) for k, place in enumerate(places)))
    sensor = Imperfect(own_position_noise_m=3.0, own_velocity_noise_mps=1.0, own_correlation_s=0.5)
    seen = looks(sensor, bodies, 6000, hz=10)
    off = np.array([[np.subtract(one.pos, place) for one, place in zip(both, places, strict=True)] for both in seen])
    np.testing.assert_allclose(off[:, 0], off[:, 1], atol=1e-9)
    assert np.std(off[:, 0]) == pytest.approx(3.0, rel=0.08)
    later = np.mean(off[:-5, 0] * off[5:, 0]) / np.mean(off[:, 0] ** 2)
    assert later == pytest.approx(math.exp(-1.0), rel=0.15)
    (tilted,) = {one.pos for one in looks(Imperfect(own_attitude_noise_deg=1.0, own_correlation_s=3600.0), bodies, 1)[0][:1]}
    assert tilted[0] == pytest.approx(100.0)
    assert 0.0 < math.hypot(*tilted[1:]) < 10.0


NOISE = {"position_noise_m": 4.0, "velocity_noise_mps": 2.0, "bearing_noise_deg": 1.0, "dropouts_per_s": 1.0, "false_tracks_per_s": 0.5}


def test_what_is_compared_meets_the_same_noise() -> None:
    """Methods, plants and aircraft fly elsewhere and see more or less; what they see of one thing at one time is off by the same."""
    options = NOISE | {"bearing_noise_deg": 0.0}  # which is larger farther away
    given = {"obstacles": [paper_obstacle()], "sensor": {"kind": "imperfect", "range_m": 200, "options": options}}
    cells = (
        KINEMATIC | {"method": {"kind": "none"}},
        KINEMATIC | {"replan": {"answer": "direct"}},
        {"plant": {"kind": "point_mass"}, "aircraft": "c172p"},
    )
    found = []
    for cell, aside in zip(cells, (0.0, 40.0, 90.0), strict=True):
        made, off = plan(replicate=3, **given, **cell), {}
        traffic, sensor = make_scene(made).traffic, make_sensor(made)
        memory = sensor.start(sensor_context(made))
        for k in range(300):
            memory, seen = sensor.sense(memory, k / 60, state((50.0 * k / 60, 60.0 + aside, 60.0)), traffic)
            (true,) = traffic.at(k / 60)
            for one in (one for one in seen if one.name == "O"):
                off[k] = np.round(np.subtract((one.pos, one.vel), (true.pos, true.vel)), 9)
        found.append(off)
    assert len({len(off) for off in found}) == 3
    for off in found[1:]:
        shared = off.keys() & found[0].keys()
        assert len(shared) > 100
        assert all((off[k] == found[0][k]).all() for k in shared)


def test_a_flight_with_all_of_it_is_the_same_again_and_may_be_led_astray() -> None:
    made = plan(
        obstacles=[paper_obstacle()],
        sensor={"kind": "imperfect", "range_m": 150, "options": NOISE | {"false_tracks_per_s": 8.0, "update_hz": 10, "latency_s": 0.1}},
        tracker={"kind": "imm"},
        **KINEMATIC,
    )
    first, again = fly(made), fly(made)
    assert first.events == again.events
    assert any(event.obstacle.startswith("false track") for event in first.events)
    np.testing.assert_array_equal(first.columns["own.pos_enu_m"], again.columns["own.pos_enu_m"])


CAMPAIGN = """name: x
question: y
route: {start_enu_m: [0, 0, 0], goal_enu_m: [900, 0, 0], start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}
obstacles: [{name: W, radius_m: RADIUS, position_enu_m: [900, 0, 0], speed_mps: 20, direction_deg: [180, 0]}]
plant: {kind: kinematic}
SENSOR
"""


@pytest.mark.parametrize(
    ("radius_m", "said", "words"),
    [
        (
            130,
            "",
            "obstacles.W.radius_m: 'W' can never be seen before it is entered: radius_m 130, sensor.range_m 100, which is to the centre",
        ),
        (130, "planner: {kind: survivor}", "can never be seen before it is entered"),
        (100, "sensor: {kind: imperfect}", "can never be seen before it is entered"),
        (130, "sensor: {options: {range_to: surface}}", ""),
        (130, "sensor: {kind: imperfect, options: {range_to: surface}}", ""),
        (130, "method: {kind: none}", ""),
        (20, "draw: {obstacles.W.radius_m: {between: [20, 130]}}\nreplicates: 3", "can never be seen before it is entered"),
        (20, "sweep: {sensor.kind: [truth, imperfect], obstacles.W.radius_m: [20, 100]}", "can never be seen before it is entered"),
        (
            20,
            "sensor: {kind: imperfect, options: {update_hz: 100}}",
            "update_hz: 100 measurements a second are more than the planner looks",
        ),
        (20, "sensor: {kind: imperfect, options: {velocity_noise_mps: unmeasured}}", "is unmeasured, and without one no planner can do"),
        (20, "sensor: {kind: imperfect, options: {velocity_noise_mps: unmeasured}}\ntracker: {kind: kalman}", ""),
        (20, "sensor: {kind: imperfect, options: {azimuth_width_deg: 400}}", "azimuth_width_deg: must be at most 360"),
        (20, "sensor: {kind: imperfect, options: {noise_m: 4}}", "unknown option 'noise_m' of the sensor 'imperfect'; it has: range_to,"),
        (20, "sensor: {kind: imperfect, options: {latency_s: -1}}", "latency_s: must be at least 0"),
        (20, "sensor: {options: {range_to: middle}}", "range_to: must be one of 'centre', 'surface'"),
        (20, "tracker: {kind: kalmann}", "no tracker 'kalmann'; there are: none, alpha_beta, kalman, imm"),
        (20, "tracker: {kind: imm, options: {quiet_mps2: 20}}", "quiet_mps2: must be less than manoeuvre_mps2, which is 10"),
        (20, "tracker: {kind: alpha_beta, options: {alpha: 0}}", "alpha: must be more than 0"),
    ],
)
def test_what_cannot_be_sensed_or_tracked_is_refused_in_one_sentence(radius_m: float, said: str, words: str, tmp_path: Any) -> None:
    file = tmp_path / "x.yaml"
    file.write_text(CAMPAIGN.replace("RADIUS", str(radius_m)).replace("SENSOR", said))
    if not words:
        load_campaign(file)
        return
    with pytest.raises(SpecError) as caught:
        load_campaign(file)
    (problem,) = caught.value.problems
    assert words in str(problem)
    assert "\n" not in problem.message


def test_seen_has_no_covariance_unless_somebody_knows_it() -> None:
    assert Seen("O", 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0).covariance is None
