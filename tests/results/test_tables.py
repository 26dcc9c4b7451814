import csv
import io
import math
from dataclasses import fields

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from testbed.results import tables
from testbed.results.columns import BY_NAME, COLUMNS, METRICS, FlightMetrics, Kind

START = (
    "flight_id cell replicate seed plant aircraft method outcome least_clearance_m time_at_least_clearance_s replans deflection_deg "
    "path_length_m flight_time_s cross_track_rms_m cross_track_max_m schedule_error_s max_bank_deg max_load_factor max_roll_rate_dps "
    "min_airspeed_mps max_airspeed_mps nearest_obstacle trigger_time_s min_load_factor max_alpha_deg planned_length_m "
    "planned_min_radius_m planned_clearance_m schedule_part_m cross_track_part_m saturated_share limits_hit airspeed_rms_error_mps "
    "wind_along_std_mps begin_s_m route_miss_m deflection_ground_deg flown_deflection_deg flown_deflection_air_deg peak_deflection_deg "
    "peak_deflection_air_deg avoidance_time_s insertion_miss_m clear_time_s rejoin_time_s rejoin_length_m"
).split()
"""The columns before there were any of the encounter, in the order that scripts rely on."""


def row(n=0, **changes):
    metrics = {c.name: {Kind.TEXT: "x", Kind.WHOLE: n, Kind.NUMBER: n + 0.1, Kind.FLAG: bool(n)}[c.kind] for c in METRICS}
    who = {"flight_id": f"f{n}", "cell": "a/b", "replicate": n, "seed": 7, "plant": "kinematic", "aircraft": "gtm_t2", "method": "none"}
    return who | metrics | {"labels": {"method": "none"}} | changes


def read_csv(data):
    return list(csv.DictReader(io.StringIO(data.decode(), newline="")))


def test_columns_start_as_published_and_then_hold_every_metric_once():
    names = tables.schema({"speed": Kind.TEXT}).names
    assert names[: len(START)] == START
    assert names[len(START)] == "kept_clear"
    assert names[-1] == "label.speed"
    assert names[7:-1] == [field.name for field in fields(FlightMetrics)]


def test_every_column_says_what_it_is():
    for column in COLUMNS:
        assert column.definition.endswith("."), column.name
        assert column.heading, column.name
    units = {"_mps": "m/s", "_dps": "deg/s", "_deg": "deg", "_s": "s", "_m": "m"}
    for name, column in BY_NAME.items():
        ending = next((unit for suffix, unit in units.items() if name.endswith(suffix)), "")
        assert column.unit == ending, name


def test_parquet_says_unit_and_definition_of_each_column():
    read = pq.read_table(pa.BufferReader(tables.parquet_bytes(tables.table([row()]))))
    for column in COLUMNS:
        assert read.schema.field(column.name).metadata == {b"unit": column.unit.encode(), b"definition": column.definition.encode()}


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
    table = tables.table([row(deflection_deg=math.nan, kept_clear=None)])
    (read,) = read_csv(tables.csv_bytes(table))
    assert (read["deflection_deg"], read["kept_clear"]) == ("", "")
    assert table["deflection_deg"].null_count == table["kept_clear"].null_count == 1


def test_text_that_looks_like_csv_survives():
    cell = 'a,"b"\nmethod=c d\u00e9'
    (read,) = read_csv(tables.csv_bytes(tables.table([row(cell=cell)])))
    assert read["cell"] == cell


def test_labels_of_any_row_are_columns_and_missing_ones_are_empty():
    read = read_csv(tables.csv_bytes(tables.table([row(0, labels={"speed": "slow"}), row(1, labels={"wind": "west"})])))
    assert [(r["label.speed"], r["label.wind"]) for r in read] == [("slow", ""), ("", "west")]


AXES = {
    "whole": (["5", "10", "-3"], Kind.WHOLE, [5, 10, -3]),
    "number": (["0.5", "1", "inf"], Kind.NUMBER, [0.5, 1.0, math.inf]),
    "huge": (["1", "10000000000000000000", "2"], Kind.NUMBER, [1.0, 1e19, 2.0]),
    "flag": (["true", "false", "true"], Kind.FLAG, [True, False, True]),
    "mixed": (["5", "calm", "10"], Kind.TEXT, ["5", "calm", "10"]),
    "list": (["[1,2]", "[3,4]", "[1,2]"], Kind.TEXT, ["[1,2]", "[3,4]", "[1,2]"]),
    "gap": (["5", "null", "10"], Kind.WHOLE, [5, None, 10]),
}


@pytest.mark.parametrize("axis", AXES)
def test_an_axis_keeps_its_type_and_the_csv_its_text(axis):
    labels, kind, values = AXES[axis]
    assert tables.axis_kinds({axis: label} for label in labels) == {axis: kind}
    table = tables.table([row(n, labels={axis: label}) for n, label in enumerate(labels)])
    assert table[f"label.{axis}"].to_pylist() == values
    assert [r[f"label.{axis}"] for r in read_csv(tables.csv_bytes(table))] == ["" if label == "null" else label for label in labels] or (
        axis == "huge"
    )


def test_the_type_is_that_of_the_campaign_and_not_of_the_flights_that_are_done():
    axes = tables.axis_kinds([{"wind": "5"}, {"wind": "calm"}])
    assert tables.table([row(labels={"wind": "5"})], axes)["label.wind"].to_pylist() == ["5"]


numbers = st.one_of(st.integers(-(10**6), 10**6).map(str), st.floats(-1e6, 1e6).map(lambda x: repr(x).removesuffix(".0")))


@pytest.mark.slow
@given(st.lists(st.one_of(numbers, st.sampled_from(["true", "false", "calm", "north-east", "[1,2]"])), min_size=1, max_size=6))
def test_csv_and_parquet_read_by_pandas_agree_on_every_axis(labels):
    table = tables.table([row(n, labels={"axis": label}) for n, label in enumerate(labels)])
    one = pd.read_csv(io.BytesIO(tables.csv_bytes(table)))
    other = pd.read_parquet(io.BytesIO(tables.parquet_bytes(table)))
    assert one["label.axis"].dtype == other["label.axis"].dtype
    assert one["label.axis"].tolist() == other["label.axis"].tolist()
    assert len(one.merge(other, on=["label.axis", "flight_id"])) == len(labels)


def test_rows_keep_their_order_and_no_rows_are_a_table_too():
    assert [r["flight_id"] for r in read_csv(tables.csv_bytes(tables.table([row(2), row(0), row(1)])))] == ["f2", "f0", "f1"]
    empty = tables.table([])
    assert tables.csv_bytes(empty).decode().strip().split(",") == empty.column_names


def test_the_same_rows_are_the_same_bytes():
    first, second = (tables.table([row(n, deflection_deg=math.nan) for n in range(50)]) for _ in range(2))
    assert tables.csv_bytes(first) == tables.csv_bytes(second)
    assert tables.parquet_bytes(first) == tables.parquet_bytes(second)
