"""The raw columns of a flight, read back from the file with Arrow alone."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from testbed import fly
from testbed.flight.record import FlightRecord
from testbed.results.raw import raw_table, write_columns
from tests.plans import KINEMATIC, paper_obstacle, plan

WIND = {"wind": {"kind": "steady", "speed_mps": 10, "from_deg": 240}}


@pytest.fixture(scope="module")
def record() -> FlightRecord:
    return fly(plan(obstacles=[paper_obstacle()], air=WIND, labels={"method": "scoam"}, **KINEMATIC))


@pytest.fixture(scope="module")
def table(record: FlightRecord, tmp_path_factory: pytest.TempPathFactory) -> pa.Table:
    path = tmp_path_factory.mktemp("raw") / "columns" / "test.parquet"
    write_columns(record, path)
    assert [entry.name for entry in path.parent.iterdir()] == ["test.parquet"], "no draft is left"
    return pq.read_table(path)


def about(table: pa.Table) -> dict[str, Any]:
    return json.loads(table.schema.metadata[b"flight"])


def test_every_row_of_a_flight_is_kept_to_the_last_bit(record: FlightRecord, table: pa.Table) -> None:
    assert set(map(str, table.schema.types)) == {"double"}
    assert table["time_s"].to_numpy().tobytes() == record.columns["time_s"].tobytes()
    for name in ("own.pos_enu_m", "own.vel_enu_mps", "air.wind_enu_mps"):
        kept = np.column_stack([table[f"{name}.{axis}"].to_numpy() for axis in "xyz"])
        assert kept.tobytes() == np.ascontiguousarray(record.columns[name]).tobytes()


def test_obstacles_fly_on_from_where_they_are_said_to_be(record: FlightRecord, table: pa.Table) -> None:
    (obstacle,) = about(table)["obstacles"]
    centre = np.array(obstacle["pos_enu_m"]) + np.outer(table["time_s"].to_numpy(), obstacle["vel_enu_mps"])
    np.testing.assert_array_equal(centre, record.columns["obstacle.O.pos_enu_m"])
    assert (obstacle["name"], obstacle["radius_m"]) == ("O", 25.0)
    assert math.hypot(*obstacle["vel_enu_mps"]) == pytest.approx(40.0)


def with_way(record: FlightRecord, pos: np.ndarray, vel: np.ndarray) -> FlightRecord:
    return replace(record, columns=record.columns | {"obstacle.O.pos_enu_m": pos, "obstacle.O.vel_enu_mps": vel})


def way(record: FlightRecord) -> tuple[np.ndarray, np.ndarray]:
    return record.columns["obstacle.O.pos_enu_m"], record.columns["obstacle.O.vel_enu_mps"]


def bent(record: FlightRecord, how: str) -> FlightRecord:
    pos, vel = (vectors.copy() for vectors in way(record))
    if how == "a place":
        pos[700] += (0.0, 2e-9, 0.0)
    elif how == "a velocity":
        vel[700] += (2e-9, 0.0, 0.0)
    else:
        gone = slice(None, 100) if how == "late" else slice(500, 600)
        pos[gone], vel[gone] = math.nan, math.nan
    return with_way(record, pos, vel)


@pytest.mark.parametrize("how", ["a place", "a velocity", "a while", "late"])
def test_an_obstacle_that_does_not_fly_straight_on_all_the_time_has_columns(record: FlightRecord, how: str) -> None:
    other = bent(record, how)
    table = raw_table(other)
    assert about(table)["obstacles"] == [{"name": "O", "radius_m": 25.0}]
    for name, vectors in zip(("pos_enu_m", "vel_enu_mps"), way(other), strict=True):
        kept = np.column_stack([table[f"obstacle.O.{name}.{axis}"].to_numpy() for axis in "xyz"])
        np.testing.assert_array_equal(kept, vectors)


def test_one_that_flies_straight_has_its_line_and_no_columns_whatever_rounding_did(record: FlightRecord) -> None:
    pos, vel = way(record)
    for one in (record, with_way(record, pos + np.linspace(0.0, 9e-10, len(pos))[:, None], vel)):
        table = raw_table(one)
        assert not [name for name in table.column_names if name.startswith("obstacle.")]
        assert about(table)["obstacles"][0]["vel_enu_mps"] == list(vel[0])


def test_who_flew_and_what_was_decided_is_in_the_metadata(record: FlightRecord, table: pa.Table) -> None:
    said = about(table)
    assert (said["flight_id"], said["labels"], said["plant_hz"]) == ("test", {"method": "scoam"}, 120)
    assert said["goal_enu_m"] == pytest.approx([500.0, 200.0, 100.0])
    azimuth, elevation = math.radians(10.0), math.radians(2.84)
    flat = math.cos(elevation)
    assert said["goal_direction"] == pytest.approx([flat * math.cos(azimuth), flat * math.sin(azimuth), math.sin(elevation)])
    (decision,) = said["decisions"]
    assert decision["decision"] == "replanned"
    for key in ("own_pos_enu_m", "own_vel_enu_mps", "command_enu_mps", "insertion_enu_m", "wind_known_enu_mps"):
        assert decision[key] == list(getattr(record.events[0], key)), key


def test_the_same_flight_is_the_same_bytes(record: FlightRecord, tmp_path: Path) -> None:
    for name in ("one", "two"):
        write_columns(record, tmp_path / name)
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes()


def test_a_flight_that_never_began_has_a_file_without_rows(tmp_path: Path) -> None:
    unbuilt = fly(plan(obstacles=[paper_obstacle()], begin={"at_route_s_m": 1e5}, **KINEMATIC))
    write_columns(unbuilt, tmp_path / "none.parquet")
    empty = pq.read_table(tmp_path / "none.parquet")
    assert empty.num_rows == 0
    assert (about(empty)["obstacles"], about(empty)["goal_enu_m"]) == ([], None)


def test_a_file_that_cannot_be_finished_leaves_the_old_one(record: FlightRecord, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "kept.parquet"
    path.write_bytes(b"old")

    def full(*_: object, **__: object) -> None:
        raise OSError("No space left on device")

    monkeypatch.setattr(pq, "write_table", full)
    with pytest.raises(OSError, match="No space left"):
        write_columns(record, path)
    assert {entry.name: entry.read_bytes() for entry in tmp_path.iterdir()} == {"kept.parquet": b"old"}
