"""The recording of a flight: complete, readable, right at known times, and cheap to write a thousand times."""

import math
import os
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
from testbed.show.recording import write_recording
from tests.plans import plan

MakeRecord = Callable[..., FlightRecord]
MakeMetrics = Callable[[FlightRecord], FlightMetrics]
RERUN = Path(sys.executable).with_name("rerun")


def read(path: Path, entity: str) -> dict[str, Any]:
    """The temporal columns of one entity, by the last part of their name, as lists."""
    from rerun.chunk import RrdReader

    columns: dict[str, Any] = {}
    for chunk in RrdReader(str(path)).stream().filter(content=entity, is_static=False).to_chunks():
        batch = chunk.to_record_batch()
        for name, column in zip(batch.schema.names, batch.columns, strict=True):
            columns.setdefault(name.rsplit(":", 1)[-1], []).extend(column.to_pylist())
    return columns


def entities(path: Path) -> set[str]:
    from rerun.chunk import RrdReader

    return {str(chunk.entity_path) for chunk in RrdReader(str(path)).stream().to_chunks()}


@pytest.fixture(autouse=True)
def _unknown_to_the_viewer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every start is the viewer's first, and a first start sends no usage data."""
    for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME"):
        monkeypatch.setenv(name, str(tmp_path / "viewer" / name))


@pytest.fixture
def flown(tmp_path: Path, make_record: MakeRecord, make_metrics: MakeMetrics) -> tuple[FlightRecord, Path]:
    record = make_record(plant={"kind": "jsbsim"})
    path = tmp_path / "recordings" / "flight.rrd"
    write_recording(record, make_metrics(record), path)
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


@pytest.mark.slow
@pytest.mark.viewer
def test_the_viewer_shows_it_without_complaint(flown: tuple[FlightRecord, Path], tmp_path: Path) -> None:
    if not list(Path("/usr/share/vulkan/icd.d").glob("*.json")):
        pytest.skip("no Vulkan driver (Debian: mesa-vulkan-drivers)")
    import socket
    import time

    from rerun.experimental import ViewerClient

    local = tmp_path / "rerun"  # spawn() cannot say that the viewer shall listen on loopback only
    local.write_text(f'#!/bin/sh\nexec "{RERUN}" --bind 127.0.0.1 "$@"\n')
    local.chmod(0o755)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with ViewerClient.spawn(headless=True, port=port, executable_path=str(local)) as viewer:
        viewer.open(str(flown[1]))
        pictures = []
        for at_s in (0.5, 4.6):
            viewer.set_time("sim_time", duration=at_s, play_state="paused")
            time.sleep(1.5)
            pictures.append(viewer.take_screenshot(max_size=900))
        views = viewer.get_state().views
    assert {"Scene (ENU, m)", "Velocity space (m/s)", "Summary", "Modes", "Events", "Clearance, m"} <= {view.name for view in views}
    assert [(view.name, report.summary) for view in views for report in view.reports] == []
    assert pictures[0] != pictures[1]
    assert min(map(len, pictures)) > 20_000
