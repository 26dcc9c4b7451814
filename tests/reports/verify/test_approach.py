"""Closest approach to obstacles that turn, come and go, against closed forms; read from files that the testbed wrote."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from reports.verify.approach import clear_at, closest
from reports.verify.metrics import metrics_of
from reports.verify.raw import Raw, read_raw
from reports.verify.run import BadInputError
from testbed.flight.record import FlightRecord
from testbed.results.avoidance import clear_row
from testbed.results.quantities import closest_approach
from testbed.results.raw import write_columns
from tests import made
from tests.made import HZ

POS, VEL, CLEARANCE = "obstacle.O.pos_enu_m", "obstacle.O.vel_enu_mps", "obstacle.O.clearance_m"
ABEAM_S, ABOVE_M, ROUND_M, OBSTACLE_M = 4.004, 40.0, 30.0, 25.0  # abeam between two ticks


def going(record: FlightRecord, pos: np.ndarray, vel: np.ndarray) -> FlightRecord:
    """The same flight with its obstacle on another way."""
    clearance = np.linalg.norm(record.columns["own.pos_enu_m"] - pos, axis=1) - OBSTACLE_M
    return replace(record, columns=record.columns | {POS: pos, VEL: vel, CLEARANCE: clearance})


def in_calm_air() -> FlightRecord:
    """The made-up flight, which has its obstacle on a straight line."""
    record = made.record()
    return replace(record, columns=record.columns | {"air.wind_enu_mps": np.zeros_like(record.columns["own.pos_enu_m"])})


def circling() -> FlightRecord:
    """A flight with an obstacle that goes round beside it, ``ABOVE_M`` higher, once in 2 pi s, and is straight above at ``ABEAM_S``."""
    record = in_calm_air()
    phase = record.columns["time_s"] - ABEAM_S
    flat = np.zeros_like(phase)
    pos = np.column_stack([ROUND_M * (np.cos(phase) - 1.0), ROUND_M * np.sin(phase), flat + ABOVE_M])
    vel = ROUND_M * np.column_stack([-np.sin(phase), np.cos(phase), flat])
    return going(record, record.columns["own.pos_enu_m"] + pos, record.columns["own.vel_enu_mps"] + vel)


def without(record: FlightRecord, rows: np.ndarray) -> FlightRecord:
    """The obstacle is not there in these rows."""
    return going(record, *(np.where(rows[:, None], math.nan, record.columns[name]) for name in (POS, VEL)))


def true_clearance_m(time_s: float) -> float:
    """Of the circle, in closed form: its chord is 2 r |sin(angle / 2)|."""
    return math.hypot(ABOVE_M, 2.0 * ROUND_M * math.sin((time_s - ABEAM_S) / 2.0)) - OBSTACLE_M


def kept(record: FlightRecord, folder: Path) -> Raw:
    write_columns(record, folder / "f.parquet")
    return read_raw(folder / "f.parquet")


def test_an_obstacle_that_turns_is_nearest_where_its_circle_is(tmp_path: Path) -> None:
    record = circling()
    clearance, at, who = closest(kept(record, tmp_path))
    assert who == "O"
    assert clearance == pytest.approx(ABOVE_M - OBSTACLE_M, abs=1e-6)  # the chord of a tick is 0.3 mm off its arc, 40 m away
    assert at == pytest.approx(ABEAM_S, abs=1e-4)
    assert (clearance, at) == pytest.approx(closest_approach(record)[:2], abs=1e-9)


def test_columns_of_an_obstacle_come_before_its_line(tmp_path: Path) -> None:
    line = kept(in_calm_air(), tmp_path)
    table, (way,) = pq.read_table(tmp_path / "f.parquet"), line.obstacles
    for name, vectors in ((POS, way.pos), (VEL, way.vel)):
        for k, axis in enumerate("xyz"):
            table = table.append_column(f"{name}.{axis}", pa.array(vectors[:, k] + 1.0))  # not the line: they are what counts
    pq.write_table(table, tmp_path / "g.parquet")
    read = read_raw(tmp_path / "g.parquet").obstacles[0]
    np.testing.assert_array_equal(read.pos, way.pos + 1.0)
    np.testing.assert_array_equal(read.vel, way.vel + 1.0)


def test_what_happens_while_an_obstacle_is_not_there_is_not_made_up(tmp_path: Path) -> None:
    """Absent while it is nearest: what counts is the last tick before, and no chord over the gap."""
    record = circling()
    time_s = record.columns["time_s"]
    clearance, at, _ = closest(kept(without(record, (time_s > ABEAM_S - 0.1) & (time_s < ABEAM_S + 0.2)), tmp_path))
    assert at == math.floor((ABEAM_S - 0.1) * HZ) / HZ
    assert clearance == pytest.approx(true_clearance_m(at), abs=1e-9)


def test_an_obstacle_that_is_there_for_one_tick_counts_in_it(tmp_path: Path) -> None:
    record = circling()
    rows = np.arange(len(record.columns["time_s"]))
    clearance, at, _ = closest(kept(without(record, rows != 300), tmp_path))
    assert at == 300 / HZ
    assert clearance == pytest.approx(true_clearance_m(at), abs=1e-9)
    never = closest(kept(without(record, rows >= 0), tmp_path))
    assert math.isnan(never[0])
    assert never[2] == ""


def test_a_flight_is_clear_when_the_distance_grows_or_the_obstacle_is_gone(tmp_path: Path) -> None:
    record = circling()
    last = len(record.columns["time_s"]) - 1
    assert clear_at(kept(record, tmp_path), 300, last) == math.ceil(ABEAM_S * HZ) == clear_row(record, 300, last)
    gone = without(record, record.columns["time_s"] > 3.0)
    assert clear_at(kept(gone, tmp_path), 300, last) == 3 * HZ + 1


def test_the_figures_of_an_avoidance_exist_beside_a_turning_obstacle(tmp_path: Path) -> None:
    found = metrics_of(kept(circling(), tmp_path))
    assert found["nearest_obstacle"] == "O"
    assert found["clear_time_s"] == pytest.approx(math.ceil(ABEAM_S * HZ) / HZ - made.TRIGGER_S)


@pytest.mark.parametrize("lost", [f"{POS}.x", f"{POS}.y", f"{VEL}.z"])
def test_an_obstacle_with_neither_line_nor_whole_columns_is_refused(tmp_path: Path, lost: str) -> None:
    kept(circling(), tmp_path)
    pq.write_table(pq.read_table(tmp_path / "f.parquet").drop_columns([lost]), tmp_path / "g.parquet")
    with pytest.raises(BadInputError, match=r"g\.parquet: not the raw columns of a flight"):
        read_raw(tmp_path / "g.parquet")
