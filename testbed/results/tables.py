"""Rows to ``results.csv`` and ``results.parquet``: one explicit schema, the same bytes for the same rows.

A quantity that does not exist for a flight is an empty field in the CSV and a null in the Parquet, whose fields carry unit and
definition of their column as metadata.

**Axes keep their type.** Labels are text; an axis whose labels are numbers all through the campaign is a column of numbers (whole ones
where all are), one whose labels are all ``true`` or ``false`` is a column of truth values, every other is text. That goes for the
values of ``dotted.path: [5, 10]`` and for the names of ``wind_mps: {"5": ..., "10": ...}`` alike, and is what pandas makes of the CSV,
so that the two files can be joined on any axis. The label ``null``, which YAML has for no value, is an empty field.
"""

import csv
import io
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from testbed.results.columns import AXIS, COLUMNS, Column, Kind, axis_column

Row = Mapping[str, Any]

_ARROW = {Kind.TEXT: pa.string(), Kind.WHOLE: pa.int64(), Kind.NUMBER: pa.float64(), Kind.FLAG: pa.bool_()}
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?inf")
_WHOLE = re.compile(r"[+-]?\d{1,18}")  # fits 64 bits
_FLAGS = {"true": True, "false": False}
_READ: dict[Kind, Callable[[str], Any]] = {Kind.TEXT: str, Kind.WHOLE: int, Kind.NUMBER: float, Kind.FLAG: _FLAGS.get}
NO_VALUE = "null"


def axis_kinds(labels: Iterable[Mapping[str, str]]) -> dict[str, Kind]:
    """What the column of each axis holds, by the labels of all flights of a campaign; axes in order of appearance."""
    texts: dict[str, set[str]] = {}
    for each in labels:
        for axis, label in each.items():
            texts.setdefault(axis, set()).add(label)
    return {axis: _kind(among - {NO_VALUE}) for axis, among in texts.items()}


def _kind(labels: set[str]) -> Kind:
    if labels and labels <= _FLAGS.keys():
        return Kind.FLAG
    if labels and all(map(_NUMBER.fullmatch, labels)):
        return Kind.WHOLE if all(map(_WHOLE.fullmatch, labels)) else Kind.NUMBER
    return Kind.TEXT


def layout(axes: Mapping[str, Kind]) -> tuple[Column, ...]:
    """The columns: who the flight is, its metrics, then ``label.<axis>`` for each axis of the sweep."""
    return (*COLUMNS, *(axis_column(axis, kind) for axis, kind in axes.items()))


def schema(axes: Mapping[str, Kind]) -> pa.Schema:
    """The same for Arrow, with what each column means."""
    return pa.schema(
        [
            pa.field(column.name, _ARROW[column.kind], metadata={"unit": column.unit, "definition": column.definition})
            for column in layout(axes)
        ]
    )


def table(rows: Sequence[Row], axes: Mapping[str, Kind] | None = None) -> pa.Table:
    """The rows, in the given order, under the explicit schema. ``axes`` as ``axis_kinds`` finds them, by default in the rows alone."""
    axes = axis_kinds(row["labels"] for row in rows) if axes is None else axes
    fields = schema(axes)
    columns = [pa.array([_cell(row, column) for row in rows], type=field.type) for column, field in zip(layout(axes), fields, strict=True)]
    return pa.Table.from_arrays(columns, schema=fields)


def _cell(row: Row, column: Column) -> Any:
    if column.name.startswith(AXIS):
        return _axis_value(row["labels"].get(column.heading, NO_VALUE), column.kind)
    value = row[column.name]
    return None if isinstance(value, float) and math.isnan(value) else value


def _axis_value(label: str, kind: Kind) -> Any:
    if label == NO_VALUE:
        return None
    return _READ[kind](label)


def csv_bytes(results: pa.Table) -> bytes:
    """The table as CSV in UTF-8; a float is written with the fewest digits that read back as the same float."""
    out = io.StringIO(newline="")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(results.column_names)
    texts = [
        [_label(value) if name.startswith(AXIS) else _text(value) for value in column.to_pylist()]
        for name, column in zip(results.column_names, results.columns, strict=True)
    ]
    writer.writerows(zip(*texts, strict=True))
    return out.getvalue().encode()


def _text(value: str | float | None) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    return value if isinstance(value, str) else repr(value)


def _label(value: str | float | None) -> str:
    """As the campaign labels it: a whole number among others has no decimals."""
    return _text(value).removesuffix(".0") if isinstance(value, float) else _text(value)


def parquet_bytes(results: pa.Table) -> bytes:
    """The table as Parquet; the bytes depend on the table and the version of Arrow only."""
    out = io.BytesIO()
    pq.write_table(results, out, compression="zstd")
    return out.getvalue()
