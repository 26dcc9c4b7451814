import csv
import io
import math
from dataclasses import fields

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from testbed.flight.record import FlightMetrics
from testbed.results import tables

START = (
    "flight_id cell replicate seed plant aircraft method outcome least_clearance_m time_at_least_clearance_s replans deflection_deg "
    "path_length_m flight_time_s cross_track_rms_m cross_track_max_m schedule_error_s max_bank_deg max_load_factor max_roll_rate_dps "
    "min_airspeed_mps max_airspeed_mps"
).split()


def row(n=0, **changes):
    metrics = {field.name: {str: "x", int: n, float: n + 0.1}[field.type] for field in fields(FlightMetrics)}
    who = {"flight_id": f"f{n}", "cell": "a/b", "replicate": n, "seed": 7, "plant": "kinematic", "aircraft": "gtm_t2", "method": "none"}
    return who | metrics | {"labels": {"method": "none"}} | changes


def read_csv(data):
    return list(csv.DictReader(io.StringIO(data.decode(), newline="")))


def test_columns_start_as_published_and_then_hold_every_metric_once():
    names = tables.schema(["speed"]).names
    assert names[: len(START)] == START
    assert names[-1] == "label.speed"
    assert sorted(names[7:-1]) == sorted(field.name for field in fields(FlightMetrics))


@pytest.mark.parametrize(
    "value", [0.1 + 0.2, -0.0, 1e-308, 5e-324, 1.7976931348623157e308, math.inf, -math.inf, 1 / 3, 123456789012345680.0]
)
def test_floats_survive_both_files_to_the_last_bit(value):
    table = tables.table([row(least_clearance_m=value)])
    (from_csv,) = read_csv(tables.csv_bytes(table))
    assert float(from_csv["least_clearance_m"]).hex() == value.hex()
    from_parquet = pq.read_table(pa.BufferReader(tables.parquet_bytes(table)))
    assert from_parquet["least_clearance_m"][0].as_py().hex() == value.hex()
    assert from_parquet.schema == table.schema


def test_what_does_not_exist_is_an_empty_field_and_a_null():
    table = tables.table([row(deflection_deg=math.nan)])
    assert read_csv(tables.csv_bytes(table))[0]["deflection_deg"] == ""
    assert table["deflection_deg"].null_count == 1


def test_text_that_looks_like_csv_survives():
    cell = 'a,"b"\nmethod=c d\u00e9'
    (read,) = read_csv(tables.csv_bytes(tables.table([row(cell=cell)])))
    assert read["cell"] == cell


def test_labels_of_any_row_are_columns_and_missing_ones_are_empty():
    read = read_csv(tables.csv_bytes(tables.table([row(0, labels={"speed": "slow"}), row(1, labels={"wind": "west"})])))
    assert [(r["label.speed"], r["label.wind"]) for r in read] == [("slow", ""), ("", "west")]


def test_rows_keep_their_order_and_no_rows_are_a_table_too():
    assert [r["flight_id"] for r in read_csv(tables.csv_bytes(tables.table([row(2), row(0), row(1)])))] == ["f2", "f0", "f1"]
    empty = tables.table([])
    assert tables.csv_bytes(empty).decode().strip().split(",") == empty.column_names


def test_the_same_rows_are_the_same_bytes():
    first, second = (tables.table([row(n, deflection_deg=math.nan) for n in range(50)]) for _ in range(2))
    assert tables.csv_bytes(first) == tables.csv_bytes(second)
    assert tables.parquet_bytes(first) == tables.parquet_bytes(second)
