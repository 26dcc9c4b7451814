"""The recording of a flight: complete, readable, right at known times, and cheap to write a thousand times."""

import contextlib
import math
import os
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from testbed import fly, measure
from testbed.flight.record import FlightRecord, Outcome
from testbed.results.columns import FlightMetrics
from testbed.show.recording import layout, write_recording
from testbed.show.recording.file import readable
from testbed.show.recording.overlay import Flown, write_overlay
from tests import made
from tests.plans import KINEMATIC, paper_obstacle, plan
from vosc import Obstacle, Own, cap

MakeRecord = Callable[..., FlightRecord]
MakeMetrics = Callable[[FlightRecord], FlightMetrics]
RERUN = Path(sys.executable).with_name("rerun")


def read(path: Path, entity: str) -> dict[str, Any]:
    """The temporal columns of one entity, by the last part of their name, as lists; None where a chunk has no such column."""
    from rerun.chunk import RrdReader

    columns: dict[str, Any] = {}
    rows = 0
    for chunk in RrdReader(str(path)).stream().filter(content=entity, is_static=False).to_chunks():
        batch = chunk.to_record_batch()
        for name, column in zip(batch.schema.names, batch.columns, strict=True):
            kept = columns.setdefault(name.rsplit(":", 1)[-1], [])
            kept.extend([None] * (rows - len(kept)))
            kept.extend(column.to_pylist())
        rows += batch.num_rows
    return {name: kept + [None] * (rows - len(kept)) for name, kept in columns.items()}


def entities(path: Path) -> set[str]:
    from rerun.chunk import RrdReader

    return {str(chunk.entity_path) for chunk in RrdReader(str(path)).stream().to_chunks()}


@pytest.fixture(autouse=True)
def _unknown_to_the_viewer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every start is the viewer's first, and a first start sends no usage data."""
    for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME"):
        monkeypatch.setenv(name, str(tmp_path / "viewer" / name))


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> tuple[FlightRecord, Path]:
    record = made.record(plant={"kind": "jsbsim"})
    path = tmp_path_factory.mktemp("run") / "recordings" / "flight.rrd"
    write_recording(record, made.metrics(record), path)
    return record, path


def test_the_viewers_own_check_finds_nothing_wrong(flown: tuple[FlightRecord, Path]) -> None:
    found = subprocess.run([str(RERUN), "rrd", "verify", str(flown[1])], capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr
    assert "without error" in found.stdout + found.stderr


def test_only_the_finished_file_is_left(flown: tuple[FlightRecord, Path]) -> None:
    assert [file.name for file in flown[1].parent.iterdir()] == ["flight.rrd"]


def test_telemetry_is_the_record_in_double_precision(flown: tuple[FlightRecord, Path]) -> None:
    record, path = flown
    telemetry = read(path, "/telemetry")
    assert [round(step.total_seconds() * 120) for step in telemetry["sim_time"]] == list(range(len(record.columns["time_s"])))
    for row in (0, 360, 959):
        assert telemetry["own.pos_enu_m.x"][row] == [record.columns["own.pos_enu_m"][row, 0]]
        assert telemetry["own.load_factor"][row] == [record.columns["own.load_factor"][row]]
        assert telemetry["obstacle.O.clearance_m"][row] == [record.columns["obstacle.O.clearance_m"][row]]


def test_pose_and_sphere_are_where_the_closed_form_says(flown: tuple[FlightRecord, Path]) -> None:
    path = flown[1]
    own, sphere = read(path, "/world/own"), read(path, "/world/obstacle/O")
    at = [step.total_seconds() for step in own["sim_time"]].index(4.0)
    angle = 4.0 * 50.0 / 400.0
    assert own["translation"][at][0] == pytest.approx([400 * math.sin(angle), 400 * (1 - math.cos(angle)), 0], abs=1e-3)
    x, y, z, w = own["quaternion"][at][0]
    nose = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)]  # the body's x axis in ENU
    assert nose == pytest.approx([math.cos(angle), math.sin(angle), 0.0], abs=1e-6)
    right = [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)]  # left turn: left wing down, right wing up
    assert right[2] == pytest.approx(math.sin(math.atan(50.0**2 / (400.0 * 9.80665))), abs=1e-6)
    five = [step.total_seconds() for step in sphere["sim_time"]].index(5.0)
    assert sphere["centers"][five][0] == pytest.approx([236.0, 110.0, 8.0], abs=1e-3)


def test_new_path_and_insertion_point_appear_with_the_decision(flown: tuple[FlightRecord, Path]) -> None:
    for entity in ("/world/plan/replanned_1", "/world/plan/insertion_1", "/velocity/command/arrow"):
        times = [step.total_seconds() for step in read(flown[1], entity)["sim_time"]]
        assert times == [3.0], entity
    legs = read(flown[1], "/modes/leg")
    assert [state for (state,) in legs["state"]] == ["route", "avoid", "rejoin"]
    assert [step.total_seconds() for step in legs["sim_time"]] == [0.0, 3.0, 4.75]


def test_cone_opens_by_alpha_0_and_ends_on_the_velocity_sphere(flown: tuple[FlightRecord, Path]) -> None:
    record, path = flown
    cone = read(path, "/velocity/obstacle/O/cone")
    shown = [k for k, points in enumerate(cone["vertex_positions"]) if points]
    assert shown
    assert not cone["vertex_positions"][0]  # out of range at the start
    k = shown[0]
    row = round(cone["sim_time"][k].total_seconds() * 120)
    apex, *rim = np.array(cone["vertex_positions"][k])
    sight = record.columns["obstacle.O.pos_enu_m"][row] - record.columns["own.pos_enu_m"][row]
    distance = float(np.linalg.norm(sight))
    assert distance <= 100.0
    assert apex == pytest.approx(record.columns["obstacle.O.vel_enu_mps"][row], abs=1e-4)
    for point in rim:
        side = point - apex
        assert math.acos(side @ sight / np.linalg.norm(side) / distance) == pytest.approx(math.asin(25.0 / distance), abs=1e-4)
        assert np.linalg.norm(point) == pytest.approx(50.0, abs=1e-3)


def seconds(column: list[Any]) -> np.ndarray:
    return np.array([step.total_seconds() for step in column])


def test_it_opens_on_the_encounter_which_begins_at_the_decision(flown: tuple[FlightRecord, Path]) -> None:
    record, path = flown
    own = read(path, "/world/own")
    whole, encounter = seconds(own["sim_time"]), seconds([step for step in own["encounter"] if step is not None])
    assert whole[0] == 0.0
    assert whole[-1] == record.columns["time_s"][-1]
    assert encounter[0] == 0.0  # where the viewer begins to play
    inside = np.array([step is not None for step in own["encounter"]])
    assert whole[inside] - encounter == pytest.approx(np.full(inside.sum(), 3.0))
    assert encounter[-1] < whole[-1] - 3.0 + 1e-9


def test_words_and_line_in_the_picture_tell_the_clearance_of_the_record(flown: tuple[FlightRecord, Path]) -> None:
    record, path = flown
    clearance, own = record.columns["obstacle.O.clearance_m"], record.columns["own.pos_enu_m"]
    line, words = read(path, "/world/clearance"), read(path, "/world/close/words/own")
    for k, row in enumerate(np.rint(seconds(line["sim_time"]) * 120).astype(int)):
        first, way = np.array(line["origins"][k][0]), np.array(line["vectors"][k][0])
        assert first == pytest.approx(own[row], abs=1e-3)
        assert np.linalg.norm(first + way - record.columns["obstacle.O.pos_enu_m"][row]) == pytest.approx(25.0, abs=1e-3)
        assert (line["colors"][k] == [0xFF4B4BFF]) == (clearance[row] < 0.0)
    rows = np.rint(seconds(words["sim_time"]) * 120).astype(int)
    assert inside_somewhere(clearance[rows])
    for k, row in enumerate(rows):
        assert words["labels"][k] == [f"{abs(clearance[row]):.1f} m {'inside' if clearance[row] < 0 else 'clear of'} O"]
        assert (words["colors"][k] == [0xFF4B4BFF]) == (clearance[row] < 0.0)


def inside_somewhere(clearance: np.ndarray) -> bool:
    return bool((clearance < 0.0).any() and (clearance > 0.0).any())


def test_velocity_space_has_the_papers_parts(flown: tuple[FlightRecord, Path]) -> None:
    record, path = flown
    centre = read(path, "/velocity/obstacle/O/cap/centre")
    shown = [k for k, points in enumerate(centre["positions"]) if points]
    assert shown
    for k in (shown[0], shown[-1]):
        row = round(centre["sim_time"][k].total_seconds() * 120)
        own = Own(tuple(record.columns["own.pos_enu_m"][row]), tuple(record.columns["own.vel_enu_mps"][row]))
        body = Obstacle(tuple(record.columns["obstacle.O.pos_enu_m"][row]), tuple(record.columns["obstacle.O.vel_enu_mps"][row]), 25.0)
        found = cap(own, body)
        assert found is not None
        assert centre["positions"][k][0] == pytest.approx(0.5 * (found.nearest_mps + found.farthest_mps), abs=1e-4)
        for name, truth in (("nearest", found.nearest_mps), ("farthest", found.farthest_mps)):
            assert read(path, f"/velocity/obstacle/O/cap/{name}")["positions"][k][0] == pytest.approx(truth, abs=1e-4)
        at, label = centre["sim_time"][k], read(path, "/velocity/obstacle/O/cap/centre/label")
        said = dict(zip(label["sim_time"], label["labels"], strict=True))
        if at in said:  # names follow more slowly
            assert said[at] == [
                f"M of SC: r {found.radius_mps:.1f} m/s, \N{GREEK SMALL LETTER PSI}_r {angle(found.azimuth_rad)}, "
                f"\N{GREEK SMALL LETTER THETA}_r {angle(found.elevation_rad)}, "
                f"\N{GREEK SMALL LETTER GAMMA} {angle(found.half_angle_rad)} deg"
            ]
        absolute, relative = (read(path, f"/velocity/obstacle/O/{name}") for name in ("cone/rim", "relative_cone"))
        moved = np.array(absolute["strips"][k][0]) - record.columns["obstacle.O.vel_enu_mps"][row]
        assert np.array(relative["strips"][k][0])[0] == pytest.approx(moved[0], abs=1e-4)
    label = read(path, "/velocity/obstacle/O/cap/centre/label")
    assert len([texts for texts in label["labels"] if texts]) > 3
    command = read(path, "/velocity/command/label")
    first = next(k for k, texts in enumerate(command["labels"]) if texts)
    assert command["sim_time"][first].total_seconds() == pytest.approx(3.0, abs=0.11)
    assert command["labels"][first] == ["v\N{COMBINING CIRCUMFLEX ACCENT}_u, chosen by SCOAM"]
    assert {"/velocity/axes/VS", "/velocity/obstacle/O/relative/arrow", "/velocity/obstacle/O/relative_cone/label"} <= entities(path)


def angle(value_rad: float) -> str:
    return f"{math.degrees(value_rad):.1f}".replace("-", "\N{MINUS SIGN}")


def test_two_threats_have_s_and_s_prime_on_both_caps(tmp_path: Path) -> None:
    first = paper_obstacle(name="A", position_enu_m=[254, 63.8, 59.8], speed_mps=35, direction_deg=[106, 11.4])
    second = paper_obstacle(name="B", position_enu_m=[208, 186, 42.5], speed_mps=32, direction_deg=[-50.3, 15.4], radius_m=30)
    obstacles = [first, second]  # of section 5.2, the second climbing
    record = fly(plan(method={"kind": "scoam"}, obstacles=obstacles, **KINEMATIC))
    write_recording(record, measure(record), tmp_path / "two.rrd")
    corners = [read(tmp_path / "two.rrd", f"/velocity/corners/A_B/{n}")["positions"] for n in (1, 2)]
    k = next(k for k, points in enumerate(corners[0]) if points)
    caps = [read(tmp_path / "two.rrd", f"/velocity/obstacle/{name}/cap/centre")["positions"][k][0] for name in "AB"]
    for place in (corners[0][k][0], corners[1][k][0]):
        assert np.linalg.norm(place) == pytest.approx(50.0, abs=1e-2)
        for middle in caps:  # eq. 29, 30: at right angles
            assert np.dot(np.array(place) - middle, middle) == pytest.approx(0.0, abs=0.1)
    command = read(tmp_path / "two.rrd", "/velocity/command/label")["labels"]
    assert next(texts for texts in reversed(command) if texts)[0].startswith("K = ")  # B came in sight one look before A


def test_wind_and_streaks_are_shown_in_wind_only(flown: tuple[FlightRecord, Path], tmp_path: Path) -> None:
    assert not {"/world/close/wind", "/world/streaks"} & entities(flown[1])
    record = fly(plan(method={"kind": "scoam"}, obstacles=[paper_obstacle()], air={"wind": WIND}, **KINEMATIC))
    write_recording(record, measure(record), tmp_path / "wind.rrd")
    wind = read(tmp_path / "wind.rrd", "/world/close/wind")
    row = round(wind["sim_time"][0].total_seconds() * 120)
    blows, tip = np.array(wind["vectors"][0][0]), np.array(wind["origins"][0][0]) + wind["vectors"][0][0]
    assert tip == pytest.approx(record.columns["own.pos_enu_m"][row], abs=1e-3)  # it ends at the aircraft
    assert blows / np.linalg.norm(blows) == pytest.approx([0.0, -1.0, 0.0], abs=1e-6)
    ground, through = (
        np.array(read(tmp_path / "wind.rrd", f"/world/close/{name}")["vectors"][0][0]) for name in ("velocity", "air_velocity")
    )
    assert ground - through == pytest.approx(blows, abs=1e-3)  # all on one scale
    assert read(tmp_path / "wind.rrd", "/world/close/words/wind")["labels"][0] == ["wind 8.0 m/s from 000 deg"]


WIND = {"kind": "steady", "speed_mps": 8, "from_deg": 0}


def test_events_are_told_as_to_a_pilot(flown: tuple[FlightRecord, Path]) -> None:
    told = read(flown[1], "/events")
    lines = {text[0]: step.total_seconds() for text, step in zip(told["text"], told["sim_time"], strict=True)}
    assert any(re.fullmatch(r"O in sight: \d+ o'clock, 100 m, \d+ m high", text) for text in lines), lines
    assert lines["O is a threat: straight on would pass 10.8 m from its centre (radius 25 m) in 1.3 s"] == 3.0
    assert lines["Insertion point passed: on the way to the goal"] == 4.75
    assert "Collision: inside O" in lines
    assert any(text.startswith("Closest approach: ") and text.endswith(" m inside O") for text in lines)
    assert lines["End: Reached the goal"] == 8.0


def test_a_letter_that_the_viewer_cannot_show_is_not_given_to_it() -> None:
    assert (
        readable("v_uo \N{ELEMENT OF} RCC, \N{GREEK SMALL LETTER ALPHA} = 3 \N{SNOWMAN}\n")
        == "v_uo ? RCC, \N{GREEK SMALL LETTER ALPHA} = 3 ?\n"
    )


def test_many_recordings_leave_no_threads(tmp_path: Path, make_record: MakeRecord, make_metrics: MakeMetrics) -> None:
    def threads() -> int:
        return len(os.listdir("/proc/self/task"))

    record = make_record(5.0)
    metrics = make_metrics(record)
    write_recording(record, metrics, tmp_path / "first.rrd")
    before = threads()
    for _ in range(8):
        write_recording(record, metrics, tmp_path / "again.rrd")
    assert threads() <= before


def test_what_a_point_does_not_have_is_left_out(tmp_path: Path, make_record: MakeRecord, make_metrics: MakeMetrics) -> None:
    record = make_record()
    write_recording(record, make_metrics(record), tmp_path / "point.rrd")
    assert "/signals/throttle" not in entities(tmp_path / "point.rrd")
    assert "own.throttle" not in read(tmp_path / "point.rrd", "/telemetry")


def test_a_flight_without_obstacle_or_decision(tmp_path: Path, make_record: MakeRecord, make_metrics: MakeMetrics) -> None:
    record = make_record(obstacles=[], method={"kind": "none"})
    write_recording(record, make_metrics(record), tmp_path / "alone.rrd")
    assert "/world/trail" in entities(tmp_path / "alone.rrd")


def test_a_flight_that_never_began(tmp_path: Path, make_record: MakeRecord, make_metrics: MakeMetrics) -> None:
    whole = make_record()
    empty = replace(
        whole,
        outcome=Outcome.TRIM_FAILED,
        columns={name: column[:0] for name, column in whole.columns.items()},
        events=(),
        message="no trim",
    )
    metrics = replace(make_metrics(whole), outcome="trim_failed", least_clearance_m=math.nan, time_at_least_clearance_s=math.nan)
    write_recording(empty, metrics, tmp_path / "empty.rrd")
    assert "/summary" in entities(tmp_path / "empty.rrd")


def test_a_flight_without_a_route_shows_where_it_would_have_begun(tmp_path: Path) -> None:
    record = fly(plan(speed_mps=35, air={"wind": {"kind": "steady", "speed_mps": 39, "from_deg": 0}}))
    assert (record.outcome, record.paths) == (Outcome.NO_PATH, ())
    write_recording(record, measure(record), tmp_path / "none.rrd")
    assert "/summary" in entities(tmp_path / "none.rrd")


def test_a_diverged_flight_is_shown_up_to_its_last_finite_row(tmp_path: Path, make_record: MakeRecord, make_metrics: MakeMetrics) -> None:
    whole = make_record()
    broken = {name: column.copy() for name, column in whole.columns.items()}
    for name, column in broken.items():
        if name.startswith("own."):
            column[500:] = math.nan
    record = replace(whole, outcome=Outcome.DIVERGED, columns=broken)
    write_recording(record, make_metrics(whole), tmp_path / "broken.rrd")
    assert len(read(tmp_path / "broken.rrd", "/telemetry")["sim_time"]) == 500


def pictured(viewer: Any) -> bytes:
    """What the viewer shows, when it has drawn it: without a graphics card, on a busy machine, it gives up waiting for itself at first."""
    for _ in range(5):
        with contextlib.suppress(TimeoutError):
            return bytes(viewer.take_screenshot(max_size=900))
    raise TimeoutError("the viewer draws no picture")


@pytest.mark.slow
@pytest.mark.viewer
def test_the_viewer_shows_it_without_complaint(
    tmp_path: Path, make_record: MakeRecord, make_metrics: MakeMetrics, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As it opens, and from behind; and several flights in one scene. The pictures are kept below tmp_path to be looked at."""
    if not list(Path("/usr/share/vulkan/icd.d").glob("*.json")):
        pytest.skip("no Vulkan driver (Debian: mesa-vulkan-drivers)")
    import socket
    import time

    from rerun.experimental import ViewerClient

    record = make_record(plant={"kind": "jsbsim"})
    metrics = make_metrics(record)
    write_recording(record, metrics, tmp_path / "opens.rrd")
    monkeypatch.setattr(layout, "OPENS_WITH", 1)
    chased = replace(record, plan=record.plan.model_copy(update={"flight_id": "c0123456789a"}))
    write_recording(chased, metrics, tmp_path / "chase.rrd")
    write_overlay([Flown("flown", record, metrics), Flown("point on rails", make_record(), metrics)], "both", tmp_path / "overlay.rrd")
    local = tmp_path / "rerun"  # spawn() cannot say that the viewer shall listen on loopback only
    local.write_text(f'#!/bin/sh\nexec "{RERUN}" --bind 127.0.0.1 "$@"\n')
    local.chmod(0o755)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    pictures, views, complaints = {}, {}, []
    with ViewerClient.spawn(headless=True, port=port, executable_path=str(local)) as viewer:
        for name in ("opens", "chase", "overlay"):
            viewer.open(str(tmp_path / f"{name}.rrd"))
            time.sleep(1.5)
            now = next(one for one in viewer.get_state().recordings if one.current_timeline == "encounter")
            assert now.current_time is not None  # it opened on the encounter
            viewer.set_time("encounter", duration=1.4, play_state="paused")
            time.sleep(1.5)
            pictures[name] = pictured(viewer)
            (tmp_path / f"{name}.png").write_bytes(pictures[name])
            shown = viewer.get_state().views
            views[name] = {view.name for view in shown}
            complaints += [(name, view.name, report.summary) for view in shown for report in view.reports]
    assert {"Encounter (aircraft at its true size)", "Chase", "Events", "Clearance, m"} <= views["opens"]
    assert {"All flights (at their true size), aligned at the decision", "As seen from the obstacle"} <= views["overlay"]
    assert complaints == []
    assert len(set(pictures.values())) == 3
    assert min(map(len, pictures.values())) > 20_000
