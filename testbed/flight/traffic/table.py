"""A track file as columns: CSV or Parquet, one track of it, each row with its number so that a fault can be named."""

import csv
import io
from collections.abc import Mapping
from contextlib import suppress
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from testbed.core import datafiles
from testbed.core.kept import Kept
from testbed.core.utf8 import clipped
from testbed.flight.traffic.columns import Column, layout, listed, plain

if TYPE_CHECKING:
    import pyarrow as pa

Array = np.ndarray
MOST_ROWS = 5_000_000


class Table(NamedTuple):
    """One track: times (n,) s, coordinates (n,3) in m or in deg, deg, m as ``geodetic`` says, and the rows (n,) that they stand in.

    Rows are counted as a spreadsheet does: the headings of a CSV are row 1; a Parquet file has none.
    """

    time_s: Array
    place: Array
    rows: Array
    geodetic: bool


class _Read(NamedTuple):
    """A file as it is, and the numbers of its rows."""

    table: "pa.Table"
    rows: Array


_files: Kept[_Read] = Kept(40_000_000, lambda read: float(read.table.nbytes))
_tables: Kept[Table] = Kept(4_000_000, lambda table: float(len(table.rows)))


def table(name: str, sha256: str | None, columns: Mapping[str, str], track: str | None) -> Table:
    """That track of a file, rows as they are. Raises ``ValueError`` with the file, and the row where there is one."""
    sha256 = sha256 or datafiles.look_up(name).sha256
    return _tables.get((sha256, tuple(columns.items()), track), lambda: _table(name, sha256, columns, track))


def _table(name: str, sha256: str, columns: Mapping[str, str], track: str | None) -> Table:
    data = datafiles.content(name, sha256)
    try:
        read = _files.get(sha256, lambda: _parquet(data) if data[:4] == b"PAR1" else _csv(data))
        if len(read.rows) > MOST_ROWS:
            raise ValueError(f"has {len(read.rows):,} rows; at most {MOST_ROWS:,}")
        laid = layout(read.table.column_names, columns)
        read = _of_track(read, laid.track, track)
        with np.errstate(over="ignore"):
            place = np.column_stack([_numbers(read, column) * column.scale for column in laid.place])
            time_s = _times(read, laid.time)
        for column, values in zip((laid.time, *laid.place), (time_s, *place.T), strict=True):
            if len(values) and np.isnan(values).all():
                raise ValueError(_empty(column.heading, read.table.column_names))
        return Table(time_s, place, read.rows, laid.geodetic)
    except ValueError as problem:
        raise ValueError(f"{name}: {problem}") from None


def _empty(heading: str, headings: list[str]) -> str:
    instead = heading == "geoaltitude" and "baroaltitude" in headings
    return f"its column {plain(heading)} is empty" + ("; `columns` can name baroaltitude as the altitude_m instead" if instead else "")


def _csv(data: bytes) -> _Read:
    """All columns as text. Arrow reads most files in a tenth of the time; where it finds anything odd, rows are looked at one by one."""
    import pyarrow as pa
    from pyarrow import csv as quick

    if b"\n" not in data:  # lines end as they did on old Macintoshes
        data = data.replace(b"\r", b"\n")
    line = data[:10_000].partition(b"\n")[0]
    try:
        first = line.decode("utf-8-sig").rstrip("\r")
        text = data.decode("utf-8-sig") if not data.isascii() else ""
    except UnicodeDecodeError:
        raise ValueError("is neither text in UTF-8 nor a Parquet file") from None
    delimiter = max(",;\t", key=first.count)
    try:
        headings = [heading.strip() for heading in next(csv.reader([first], delimiter=delimiter), [])]
    except csv.Error as problem:
        raise ValueError(f"row 1: {_odd(problem)}") from None
    if twice := _twice(headings):
        raise ValueError(f"row 1: has two columns '{plain(twice)}'")
    if not any(headings):
        raise ValueError("is empty, or its first row has no headings")
    if not all(headings[1:]) or b'"' in line or b"\n\n" in data or b"\n\r\n" in data:
        return _row_by_row(text or data.decode("ascii"), delimiter)
    headings[0] = headings[0] or "(row)"  # of an index without a name, which pandas writes
    how = quick.ConvertOptions(column_types=dict.fromkeys(headings, pa.string()), strings_can_be_null=False)
    try:
        read = quick.read_csv(
            pa.BufferReader(data),
            quick.ReadOptions(use_threads=False, column_names=headings, skip_rows=1),
            quick.ParseOptions(delimiter=delimiter, ignore_empty_lines=False),
            how,
        )
    except (pa.ArrowException, ValueError):
        return _row_by_row(text or data.decode("ascii"), delimiter)
    return _Read(read.combine_chunks(), np.arange(2, read.num_rows + 2))


def _twice(headings: list[str]) -> str:
    return next((heading for heading in headings if headings.count(heading) > 1), "")


def _odd(problem: csv.Error) -> str:
    """What the csv module says, without its advice to programmers."""
    return f"is no row of a CSV file ({str(problem).partition(' - ')[0]})"


def _row_by_row(text: str, delimiter: str) -> _Read:
    import pyarrow as pa

    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    try:
        found = [(number, row) for number, row in enumerate(reader, 1) if row]
    except csv.Error as problem:
        raise ValueError(f"row {reader.line_num}: {_odd(problem)}") from None
    headings = [heading.strip() or f"(column {k + 1})" for k, heading in enumerate(found[0][1])]
    for row, values in found[1:]:
        if len(values) != len(headings):
            raise ValueError(f"row {row}: has {_counted(len(values), 'value')} under {_counted(len(headings), 'heading')}")
    columns = [pa.array([values[k] for _, values in found[1:]], pa.string()) for k in range(len(headings))]
    return _Read(pa.table(columns, names=headings), np.array([row for row, _ in found[1:]], dtype=int))


def _counted(count: int, what: str) -> str:
    return f"{count} {what}" + ("" if count == 1 else "s")


def _parquet(data: bytes) -> _Read:
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        twice = _twice(pq.read_schema(pa.BufferReader(data)).names)
        read = None if twice else pq.read_table(pa.BufferReader(data)).combine_chunks()
    except (pa.ArrowException, OSError, ValueError) as problem:
        why = str(problem).partition("\n")[0]
        raise ValueError(f"is no Parquet file that can be read: {clipped(why, 100)}") from None
    if read is None:
        raise ValueError(f"has two columns '{plain(twice)}'")
    return _Read(read, np.arange(1, read.num_rows + 1))


def _of_track(read: _Read, heading: str | None, track: str | None) -> _Read:
    """The rows of that track. Raises ``ValueError``."""
    import pyarrow as pa
    from pyarrow import compute as pc

    if heading is None:
        if track is not None:
            raise ValueError(f"has no column that tells tracks apart, of which '{track}' would be one; name it: columns: {{track: ...}}")
        return read
    names = pc.utf8_trim_whitespace(read.table.column(heading).cast(pa.string()))
    there = names.unique().to_pylist()
    if track is None and len(there) == 1:
        return read
    if track not in there:
        some = listed([str(one) for one in there], 5)
        missing = "name one of them with 'track'" if track is None else f"none is '{track}'"
        raise ValueError(f"has {len(there):,} tracks in its column {heading} ({some}); {missing}")
    mine = pc.fill_null(pc.equal(names, track), False)
    return _Read(read.table.filter(mine), read.rows[mine.to_numpy(zero_copy_only=False)])


def _times(read: _Read, column: Column) -> Array:
    """In seconds from some moment on; NaN for an empty field. Raises ``ValueError``."""
    import pyarrow as pa

    values = read.table.column(column.heading)
    if column.scale and not pa.types.is_timestamp(values.type):
        return _numbers(read, column) * column.scale
    if not pa.types.is_timestamp(values.type):
        for kind in (pa.timestamp("us", "UTC"), pa.timestamp("us")):
            try:
                values = values.cast(kind)
                break
            except pa.ArrowException:
                continue
        else:
            return np.array([_date(read, k, column.heading) for k in range(len(read.rows))])
    ticks = values.cast(pa.timestamp("us", values.type.tz), safe=False).cast(pa.int64())
    return np.asarray(ticks.to_numpy(), dtype=float) * 1e-6


def _date(read: _Read, k: int, heading: str) -> float:
    text = str(read.table.column(heading)[k].as_py() or "").strip()
    try:
        date = datetime.fromisoformat(text) if text else None
    except ValueError:
        raise _unreadable(read, k, heading, text, "no date and time such as 2024-05-31T12:00:00Z") from None
    return np.nan if date is None else (date if date.tzinfo else date.replace(tzinfo=UTC)).timestamp()


def _numbers(read: _Read, column: Column) -> Array:
    """NaN for an empty field. Raises ``ValueError`` with the row of anything else that is no number."""
    import pyarrow as pa

    values = read.table.column(column.heading)
    if not pa.types.is_boolean(values.type):  # which Arrow would make 0 and 1
        with suppress(pa.ArrowException):
            return np.asarray(values.cast(pa.float64(), safe=False).to_numpy(), dtype=float)
    return np.array([_number(read, k, column.heading, value) for k, value in enumerate(values.to_pylist())])


def _number(read: _Read, k: int, heading: str, value: Any) -> float:
    if value is None or not str(value).strip():
        return np.nan
    if not isinstance(value, bool):
        with suppress(ValueError, TypeError):
            return float(value)
    raise _unreadable(read, k, heading, str(value), "no number")


def _unreadable(read: _Read, k: int, heading: str, text: str, what: str) -> ValueError:
    return ValueError(f"row {read.rows[k]}: {plain(heading)} is {what}, but '{plain(clipped(text, 40))}'")
