"""``rows.jsonl``: one line per finished flight, appended by the driver as flights end. All tables and pages follow from it.

A line is strict JSON: NaN is written as null and infinity as a string, and both come back as floats.
"""

import json
import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields
from io import FileIO
from pathlib import Path
from typing import Any, get_args

from testbed.core.frames import Vec3
from testbed.flight.record import ReplanEvent
from testbed.results.columns import FlightMetrics
from testbed.results.plain import plain
from testbed.run import foreign
from testbed.run.job import JobResult, Row

SYNC_EVERY = 16
"""Rows between two calls of fsync: what a power cut may cost."""


class JournalError(Exception):
    """The journal holds something that is not a row; str() says where."""


class Journal:
    """An open journal, to append to."""

    def __init__(self, file: FileIO):
        self._file = file
        self._unsynced = 0

    def append(self, result: JobResult) -> None:
        data = encode(result)
        while data:
            data = data[self._file.write(data) :]
        self._unsynced += 1
        if self._unsynced >= SYNC_EVERY:
            self.sync()

    def sync(self) -> None:
        os.fsync(self._file.fileno())
        self._unsynced = 0


@contextmanager
def appending(path: Path) -> Iterator[Journal]:
    """Open the journal for more rows, after cutting off a last line that was not finished."""
    with path.open("ab", buffering=0) as file:
        file.truncate(sum(len(line) for line, _ in _lines(path)))
        journal = Journal(file)
        try:
            yield journal
        finally:
            journal.sync()


def read(path: Path) -> list[JobResult]:
    """Every finished row; the last line may be torn and is then left out. No file, no rows."""
    return [result for _, result in _lines(path)]


def _lines(path: Path) -> Iterator[tuple[bytes, JobResult]]:
    lines = path.read_bytes().splitlines(keepends=True) if path.exists() else []
    for number, line in enumerate(lines, 1):
        try:
            if not line.endswith(b"\n"):
                raise ValueError("no end of line")
            result = decode(line)
        except (ValueError, KeyError, TypeError, AttributeError, OverflowError) as problem:
            if number == len(lines):
                return  # the driver was killed while it wrote, or the power went
            raise JournalError(f"{path}:{number}: not a row of a run ({problem})") from None
        yield line, result


def encode(result: JobResult) -> bytes:
    """One line of the journal."""
    line = {"row": result.row, "series": result.series, "timings": result.timings}
    return json.dumps(plain(line), allow_nan=False, separators=(",", ":")).encode() + b"\n"


def decode(line: bytes) -> JobResult:
    """The inverse of ``encode``, apart from tuples, which come back as lists."""
    data = foreign.loads(line)
    foreign.checked_row(data)
    row: Row = data["row"]
    if "found" in row:
        row["found"] = {name: _numbers(value) for name, value in row["found"].items()}
    else:
        _restore(row, FlightMetrics)
    for event in row["events"]:
        _restore(event, ReplanEvent)
    if row.get("evidence") is not None:
        row["evidence"] = {name: _numbers(value) for name, value in row["evidence"].items()}
    return JobResult(row, data["series"], data["timings"])


def _restore(target: dict[str, Any], kind: type[FlightMetrics] | type[ReplanEvent]) -> None:
    """Turn null and "inf" back into floats where the dataclass says that a float, or a vector of them, belongs."""
    for field in fields(kind):
        value = target[field.name]
        if field.type is float:
            target[field.name] = _number(value)
        elif get_args(field.type) == get_args(Vec3):
            target[field.name] = [_number(item) for item in value]


def _number(value: Any) -> float:
    return math.nan if value is None else float(value)


def _numbers(value: Any) -> Any:
    """A number or a list of numbers; a whole one stays whole."""
    if isinstance(value, list):
        return [_numbers(item) for item in value]
    return value if isinstance(value, int) else _number(value)
