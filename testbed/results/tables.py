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
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any, BinaryIO

import pyarrow as pa
import pyarrow.parquet as pq

from testbed.results.columns import AXIS, COLUMNS, WEIGHT, Column, Kind, axis_column

Row = Mapping[str, Any]

_ARROW = {Kind.TEXT: pa.string(), Kind.WHOLE: pa.int64(), Kind.NUMBER: pa.float64(), Kind.FLAG: pa.bool_()}
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?inf")
_WHOLE = re.compile(r"[+-]?\d{1,18}")  # fits 64 bits
_FLAGS = {"true": True, "false": False}
_READ: dict[Kind, Callable[[str], Any]] = {Kind.TEXT: str, Kind.WHOLE: int, Kind.NUMBER: float, Kind.FLAG: _FLAGS.get}
NO_VALUE = "null"

AT_ONCE, ROW_GROUP = 500, 10_000
"""Rows that are held as they came, and rows that are held packed: what is written of one campaign needs no more memory than of another.
A Parquet file of more rows than the second has several row groups."""
COMPRESSION = "zstd"


def axis_kinds(labels: Iterable[Mapping[str, str]]) -> dict[str, Kind]:
    """What the column of each axis holds, by the labels of all flights of a campaign; axes in order of appearance."""
    texts: dict[str, set[str]] = {}
    for each in labels:
        for axis, label in each.items():
            texts.setdefault(axis, set()).add(label)
    return kinds_of(texts)


def kinds_of(labels: Mapping[str, Iterable[str]]) -> dict[str, Kind]:
    """The same, by all the labels of each axis."""
    return {axis: _kind(set(among) - {NO_VALUE}) for axis, among in labels.items()}


def _kind(labels: set[str]) -> Kind:
    if labels and labels <= _FLAGS.keys():
        return Kind.FLAG
    if labels and all(map(_NUMBER.fullmatch, labels)):
        return Kind.WHOLE if all(map(_WHOLE.fullmatch, labels)) else Kind.NUMBER
    return Kind.TEXT


def layout(axes: Mapping[str, Kind], more: Sequence[Column] = ()) -> tuple[Column, ...]:
    """The columns: who the flight is, its metrics, ``more`` that the campaign asks for, then ``label.<axis>`` for each axis."""
    return (*COLUMNS, *more, *(axis_column(axis, kind) for axis, kind in axes.items()))


def schema(axes: Mapping[str, Kind], more: Sequence[Column] = ()) -> pa.Schema:
    """The same for Arrow, with what each column means."""
    return pa.schema(
        [
            pa.field(column.name, _ARROW[column.kind], metadata={"unit": column.unit, "definition": column.definition})
            for column in layout(axes, more)
        ]
    )


def table(rows: Sequence[Row], axes: Mapping[str, Kind] | None = None, more: Sequence[Column] = ()) -> pa.Table:
    """The rows, in the given order, under the explicit schema. ``axes`` as ``axis_kinds`` finds them, by default in the rows alone."""
    axes = axis_kinds(row["labels"] for row in rows) if axes is None else axes
    fields, declared = schema(axes, more), layout(axes, more)
    columns = [pa.array([_cell(row, column) for row in rows], type=field.type) for column, field in zip(declared, fields, strict=True)]
    return pa.Table.from_arrays(columns, schema=fields)


def _cell(row: Row, column: Column) -> Any:
    if column.name.startswith(AXIS):
        return _axis_value(row["labels"].get(column.heading, NO_VALUE), column.kind)
    value = row.get(WEIGHT.name, 1.0) if column is WEIGHT else row[column.name]
    return None if isinstance(value, float) and math.isnan(value) else value


def _axis_value(label: str, kind: Kind) -> Any:
    if label == NO_VALUE:
        return None
    return _READ[kind](label)


def write(rows: Iterable[Row], axes: Mapping[str, Kind], csv_file: BinaryIO, parquet_file: BinaryIO, more: Sequence[Column] = ()) -> None:
    """Both files, of rows that need not fit into memory."""
    csv_file.write(_csv_line(schema(axes, more).names))
    with pq.ParquetWriter(parquet_file, schema(axes, more), compression=COMPRESSION) as writer:
        for group in _groups(rows, axes, more):
            writer.write_table(group)
            for batch in group.to_batches(max_chunksize=AT_ONCE):
                csv_file.write(_csv_lines(batch))


def _groups(rows: Iterable[Row], axes: Mapping[str, Kind], more: Sequence[Column]) -> Iterator[pa.Table]:
    """Tables of ``ROW_GROUP`` rows, the last of what is left; one without rows if there are none."""
    rest, held, made = iter(rows), [], 0
    while batch := list(islice(rest, AT_ONCE)):
        held.append(table(batch, axes, more))
        if len(held) * AT_ONCE >= ROW_GROUP:
            yield pa.concat_tables(held).combine_chunks()
            held, made = [], made + 1
    if held or not made:
        yield pa.concat_tables(held).combine_chunks() if held else table([], axes, more)


def csv_bytes(results: pa.Table) -> bytes:
    """The table as CSV in UTF-8; a float is written with the fewest digits that read back as the same float."""
    return _csv_line(results.column_names) + _csv_lines(results)


def _csv_line(names: Sequence[str]) -> bytes:
    out = io.StringIO(newline="")
    csv.writer(out, lineterminator="\n").writerow(names)
    return out.getvalue().encode()


def _csv_lines(results: "pa.Table | pa.RecordBatch") -> bytes:
    out = io.StringIO(newline="")
    texts = [
        [_label(value) if name.startswith(AXIS) else _text(value) for value in column.to_pylist()]
        for name, column in zip(results.schema.names, results.columns, strict=True)
    ]
    csv.writer(out, lineterminator="\n").writerows(zip(*texts, strict=True))
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
    pq.write_table(results, out, compression=COMPRESSION)
    return out.getvalue()
