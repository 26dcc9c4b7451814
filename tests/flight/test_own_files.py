"""The files of docs/plugins, each copied to a folder outside the repository and flown from a campaign there, by every plant."""

import inspect
import math
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from testbed import expand, fly, load_campaign, measure
from testbed.campaign.words.settings import FlightPlan
from testbed.core.units import DEG
from testbed.flight.record import FlightRecord, Outcome
from tests.plans import KINEMATIC, plan

FILES = Path(__file__).parents[2] / "docs/plugins"
PLANTS = ["kinematic", "point_mass", "jsbsim"]
HEAD_ON = "{name: O, radius_m: 25, position_enu_m: [420, 6, 4], speed_mps: 20, direction_deg: [180, 0]}"
CAMPAIGN = """
name: own
question: Does a file of one's own act?
plugins: [./{file}]
route: {{start_enu_m: [0, 0, 0], goal_enu_m: [900, 0, 0], start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}}
sensor: {{range_m: 180}}
obstacles: [{obstacle}]
plant: {{kind: {plant}}}
{more}
"""


def planned(tmp_path: Path, file: str, more: str = "", plant: str = "kinematic", obstacle: str = HEAD_ON) -> tuple[FlightPlan, ...]:
    shutil.copy(FILES / file, tmp_path)
    written = CAMPAIGN.format(file=file, more=more, plant=plant, obstacle=obstacle)
    if "sensor:" in more:
        written = written.replace("sensor: {range_m: 180}\n", "")
    (tmp_path / "own.yaml").write_text(written)
    return expand(load_campaign(tmp_path / "own.yaml"))


def flown(*args: str | Path, **kwargs: str) -> FlightRecord:
    (only,) = planned(*args, **kwargs)  # type: ignore[arg-type]
    assert only.plugins, "the file is part of what the flight is"
    return fly(only)


@pytest.mark.parametrize("plant", PLANTS)
def test_a_direction_turns_to_its_side(tmp_path: Path, plant: str) -> None:
    for side, sign in (("left", 1.0), ("right", -1.0)):
        record = flown(tmp_path, "tangent.py", f'method: {{kind: "tangent:avoid", options: {{side: {side}}}}}', plant=plant)
        (event,) = record.events
        assert (event.decision, event.method) == ("replanned", "tangent:avoid")
        assert event.status in ("avoided", "leads_through_the_sphere")
        assert sign * event.command_enu_mps[1] > 1.0
        assert record.outcome in (Outcome.REACHED, Outcome.COLLIDED)
        aside = sign * record.columns["own.pos_enu_m"][:, 1]
        assert aside.max() > 5.0


@pytest.mark.parametrize("plant", PLANTS)
def test_a_law_over_time_steers_until_the_flight_is_clear(tmp_path: Path, plant: str) -> None:
    more = 'method: {kind: "pn:Law"}\nreplan: {rejoin: {to: route}}'
    record = flown(tmp_path, "pn.py", more, plant=plant)
    first, back = record.events
    assert (first.decision, back.decision) == ("steered", "rejoined")
    assert record.outcome is Outcome.REACHED
    assert [path.from_time_s for path in record.paths] == [0.0, back.time_s]  # what is steered is no path
    metrics = measure(record)
    assert metrics.replans == 1
    assert metrics.least_clearance_m > 3.0, "straight on it would have passed 7 m from the centre"
    row = slice(round(first.time_s * 120), round(back.time_s * 120))
    turned = np.diff(record.columns["own.vel_enu_mps"][row], axis=0) * 120
    assert 5.0 < np.linalg.norm(turned, axis=1).max() < 45.0
    assert np.ptp(np.linalg.norm(record.columns["own.vel_enu_mps"][row], axis=1)) < (0.001 if plant == "kinematic" else 8.0)
    assert (np.diff(record.columns["guidance.s_m"][row]) >= 0.0).all()


@pytest.mark.parametrize("plant", PLANTS)
def test_a_planner_with_memory_has_another_path(tmp_path: Path, plant: str) -> None:
    record = flown(tmp_path, "holder.py", 'planner: {kind: "holder:Planner", options: {aside_deg: 50.0}}', plant=plant)
    (event,) = record.events
    assert (event.decision, event.method, event.obstacle) == ("planned", "holder:Planner", "O")
    assert math.isfinite(event.alpha_rad)
    assert record.outcome is Outcome.REACHED
    assert len(record.paths) == 2
    assert measure(record).least_clearance_m > 5.0
    assert record.columns["own.pos_enu_m"][:, 1].max() > 50.0


@pytest.mark.parametrize("plant", PLANTS)
def test_a_sensor_is_late_and_off_and_the_same_for_every_method(tmp_path: Path, plant: str) -> None:
    more = """sensor: {kind: "noisy:Noisy", range_m: 180, options: {position_m: 3.0, late_s: 0.1}}
sweep: {method.kind: [none, scoam, droam_hp]}"""
    records = [fly(one) for one in planned(tmp_path, "noisy.py", more, plant=plant)]
    told = {(e.time_s, e.obstacle_pos_enu_m, e.obstacle_vel_enu_mps) for e in (record.events[0] for record in records)}
    assert len(told) == 1
    ((time_s, pos, _),) = told
    truth = records[0].columns["obstacle.O.pos_enu_m"][round(time_s * 120)]
    assert 0.5 < math.dist(truth, pos) < 20.0
    assert {record.events[0].decision for record in records} == {"none", "replanned"}


@pytest.mark.parametrize("plant", PLANTS)
def test_a_guidance_law_follows_the_path_in_its_own_way(tmp_path: Path, plant: str) -> None:
    more = 'guidance: {kind: "pure_pursuit:Pursuit", options: {ahead_s: 1.0}}\nmethod: {kind: scoam}'
    record = flown(tmp_path, "pure_pursuit.py", more, plant=plant)
    assert record.events[0].decision == "replanned"
    assert record.outcome in (Outcome.REACHED, Outcome.COLLIDED)
    metrics = measure(record)
    assert metrics.cross_track_rms_m < (1e-6 if plant == "kinematic" else 15.0)
    assert plant == "kinematic" or metrics.cross_track_max_m > 0.1


@pytest.mark.parametrize("plant", PLANTS)
def test_a_law_steers_through_the_guidance_of_ones_own_too(tmp_path: Path, plant: str) -> None:
    shutil.copy(FILES / "pure_pursuit.py", tmp_path)
    more = 'guidance: {kind: "pure_pursuit:Pursuit"}\nmethod: {kind: "pn:Law"}'
    shutil.copy(FILES / "pn.py", tmp_path)
    text = CAMPAIGN.format(file="pn.py, ./pure_pursuit.py", more=more, plant=plant, obstacle=HEAD_ON)
    (tmp_path / "own.yaml").write_text(text)
    record = fly(expand(load_campaign(tmp_path / "own.yaml"))[0])
    assert [event.decision for event in record.events] == ["steered", "rejoined"]
    assert measure(record).least_clearance_m > 0.0


TURNING = '{name: O, kind: "turning:Turning", options: {rate_dps: -6.0%s}, radius_m: 25, position_enu_m: [420, -60, 4], speed_mps: 20, direction_deg: [180, 0]}'  # noqa: E501


@pytest.mark.parametrize("plant", PLANTS)
def test_a_track_that_turns_is_logged_and_met_as_it_is(tmp_path: Path, plant: str) -> None:
    record = flown(tmp_path, "turning.py", "method: {kind: none}", plant=plant, obstacle=TURNING % "")
    pos, vel = (record.columns[f"obstacle.O.{name}"] for name in ("pos_enu_m", "vel_enu_mps"))
    heading = np.unwrap(np.arctan2(vel[:, 1], vel[:, 0]))
    assert np.diff(heading) * 120 == pytest.approx(np.full(len(heading) - 1, -6.0 * DEG))
    assert np.allclose(np.diff(pos, axis=0) * 120, 0.5 * (vel[1:] + vel[:-1]), atol=1e-3)
    assert np.allclose(pos[0], (420.0, -60.0, 4.0))


def test_an_obstacle_that_has_left_is_neither_seen_nor_met(tmp_path: Path) -> None:
    stays, leaves = (
        flown(tmp_path, "turning.py", "method: {kind: scoam}", obstacle=(TURNING % after).replace("-60, 4", "6, 4").replace("-6.0", "-0.5"))
        for after in ("", ", leaves_s: 2.0")
    )
    assert [event.decision for event in stays.events] == ["replanned"]
    assert leaves.events == ()
    assert np.isnan(leaves.columns["obstacle.O.clearance_m"][241:]).all()
    metrics = measure(leaves)
    assert metrics.least_clearance_m == pytest.approx(float(leaves.columns["obstacle.O.clearance_m"][240]))
    assert metrics.outcome == "reached"


def test_every_file_says_how_it_is_named_in_a_campaign() -> None:
    for file in FILES.glob("*.py"):
        assert f"plugins: [./{file.name}]" in file.read_text()
        assert file.name in (FILES / "README.md").read_text()


def test_the_imports_and_fields_that_the_docs_name_are_there() -> None:
    text = (FILES / "README.md").read_text()
    names: dict[str, type] = {}
    imports = re.findall(r"`(from [\w.]+ import [\w, ]+)`", text)
    assert len(imports) > 10
    for line in imports:
        exec(line, names)
    for name in ("Own", "Obstacle", "State", "Seen"):
        told = re.search(rf"^\| `{name}` \| (.*?)[;|]", text, re.MULTILINE)
        assert told
        fields = " ".join(re.findall("`([^`]*)`", told[1])).split()
        assert fields == list(inspect.signature(names[name]).parameters), name


def test_considering_all_acts_in_a_flight() -> None:
    """An obstacle that is no threat to the present velocity, where the way round the threat leads: with consider: all it is in the way."""
    route = {"start_enu_m": [0, 0, 0], "goal_enu_m": [900, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
    ahead = {"name": "A", "radius_m": 25, "position_enu_m": [250, -4, 0], "speed_mps": 0, "direction_deg": [180, 0]}
    beside = {"name": "B", "radius_m": 25, "position_enu_m": [240, 40, 0], "speed_mps": 0, "direction_deg": [180, 0]}
    case = {"route": route, "obstacles": [ahead, beside], "sensor": {"range_m": 150}} | KINEMATIC
    threats, everything = (
        fly(plan(method={"kind": "scoam", "options": {"boundary": "exact", "consider": which}}, **case)).events[0]
        for which in ("threats", "all")
    )
    assert threats.command_enu_mps != everything.command_enu_mps
    assert everything.deflection_rad > threats.deflection_rad
