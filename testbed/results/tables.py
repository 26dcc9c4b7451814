"""Rows to ``results.csv`` and ``results.parquet``: one explicit schema, the same bytes for the same rows.

A quantity that does not exist for a flight (NaN in ``FlightMetrics``) is an empty field in the CSV and a null in the Parquet.
"""

import csv
import io
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from testbed.flight.record import FlightMetrics

Row = Mapping[str, Any]

IDENTITY = {
    "flight_id": pa.string(),
    "cell": pa.string(),
    "replicate": pa.int64(),
    "seed": pa.int64(),
    "plant": pa.string(),
    "aircraft": pa.string(),
    "method": pa.string(),
}

HEADLINE = (
    "outcome least_clearance_m time_at_least_clearance_s replans deflection_deg path_length_m flight_time_s cross_track_rms_m "
    "cross_track_max_m schedule_error_s max_bank_deg max_load_factor max_roll_rate_dps min_airspeed_mps max_airspeed_mps"
).split()
"""The metrics that come first, in this order, because scripts rely on it; the other ones follow as FlightMetrics lists them."""

_ARROW = {str: pa.string(), int: pa.int64(), float: pa.float64()}


def schema(axes: Iterable[str] = ()) -> pa.Schema:
    """The columns: who the flight is, its metrics, then ``label.<axis>`` for each axis of the sweep."""
    metrics = {field.name: _ARROW[field.type] for field in fields(FlightMetrics)}  # type: ignore[index]
    order = [*HEADLINE, *(name for name in metrics if name not in HEADLINE)]
    columns = IDENTITY | {name: metrics[name] for name in order} | {f"label.{axis}": pa.string() for axis in axes}
    return pa.schema(list(columns.items()))


def axes_of(rows: Iterable[Row]) -> list[str]:
    """The axes that label any of the rows, in order of appearance."""
    return list(dict.fromkeys(axis for row in rows for axis in row["labels"]))


def table(rows: Sequence[Row]) -> pa.Table:
    """The rows, in the given order, under the explicit schema."""
    layout = schema(axes_of(rows))
    columns = [pa.array([_cell(row, field.name) for row in rows], type=field.type) for field in layout]
    return pa.Table.from_arrays(columns, schema=layout)


def _cell(row: Row, name: str) -> Any:
    value = row["labels"].get(name.removeprefix("label.")) if name.startswith("label.") else row[name]
    return None if isinstance(value, float) and math.isnan(value) else value


def csv_bytes(results: pa.Table) -> bytes:
    """The table as CSV in UTF-8; a float is written with the fewest digits that read back as the same float."""
    out = io.StringIO(newline="")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(results.column_names)
    writer.writerows(zip(*(map(_text, column.to_pylist()) for column in results.columns), strict=True))
    return out.getvalue().encode()


def _text(value: str | float | None) -> str:
    if value is None:
        return ""
    return value if isinstance(value, str) else repr(value)


def parquet_bytes(results: pa.Table) -> bytes:
    """The table as Parquet; the bytes depend on the table and the version of Arrow only."""
    out = io.BytesIO()
    pq.write_table(results, out, compression="zstd")
    return out.getvalue()
