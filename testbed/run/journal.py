"""``rows.jsonl``: one line per finished flight, appended by the driver as flights end. All tables and pages follow from it.

A line is strict JSON: NaN is written as null and infinity as a string, and both come back as floats. Of a journal that may be larger
than memory only an ``Index`` is held: which flight's line begins where.
"""

import json
import math
import os
import re
import time
from array import array
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import MISSING, dataclass, fields
from functools import partial
from io import FileIO
from pathlib import Path
from typing import Any, TypeVar, get_args

import numpy as np
from pydantic_core import from_json

from testbed.core.frames import Vec3
from testbed.flight.record import Outcome, ReplanEvent
from testbed.results.columns import FlightMetrics
from testbed.results.plain import plain
from testbed.run import foreign
from testbed.run.job import JobResult, Row
from testbed.run.lines import Lines

T = TypeVar("T")

_ID = re.compile("[0-9a-f]{12}")
_ROW = re.compile(rb'\{"row":\{"flight_id":"([0-9a-f]{12})",')
_OUTCOME = re.compile(rb'"outcome":"(\w+)"')
_CRASHED, _NO_SERIES, _TIMINGS = b'"outcome":"crashed"', b'"series":null,"timings":', b'"timings":'  # in text a " has a \ before it
NOT_A_ROW = (ValueError, KeyError, TypeError, AttributeError, OverflowError)

SYNC_EVERY_S = 1.0
"""Between two calls of fsync, which takes about 10 ms, as long as several short flights: what a power cut may cost."""


class JournalError(Exception):
    """The journal holds something that is not a row; str() says where."""


class Journal:
    """An open journal, to append to."""

    def __init__(self, file: FileIO):
        self._file = file
        self._synced_at = time.monotonic()

    def append(self, result: JobResult) -> None:
        data = encode(result)
        while data:
            data = data[self._file.write(data) :]
        if time.monotonic() - self._synced_at >= SYNC_EVERY_S:
            self.sync()

    def sync(self) -> None:
        os.fsync(self._file.fileno())
        self._synced_at = time.monotonic()


@contextmanager
def appending(path: Path, end: int | None = None) -> Iterator[Journal]:
    """Open the journal for more rows, after cutting off a last line that was not finished. ``end``: of the last whole line, if known."""
    with path.open("ab", buffering=0) as file:
        file.truncate(index(path).end if end is None else end)
        journal = Journal(file)
        try:
            yield journal
        finally:
            journal.sync()


@dataclass(frozen=True)
class Index:
    """Where the lines of a journal are. Of a flight that was flown again, the last."""

    path: Path
    ids: np.ndarray
    """Of flights that have a row, as ``number_of`` has them, rising."""
    starts: np.ndarray
    """Where the line of each begins, in bytes."""
    crashed: np.ndarray
    """Whether it is the row of a flight that the program failed to fly."""
    curved: np.ndarray
    """Whether the line has a series."""
    end: int
    """Where the last whole line ends."""

    def places(self, ids: np.ndarray) -> np.ndarray:
        """For each flight its place in the arrays here; -1 where it has no row."""
        if not len(self.ids):
            return np.full(len(ids), -1)
        found = np.minimum(np.searchsorted(self.ids, ids), len(self.ids) - 1)
        return np.where(self.ids[found] == ids, found, -1)

    def lines(self, places: np.ndarray, read: Callable[[bytes], T]) -> Lines[T]:
        """What is read of the lines at these places, in their order."""
        return Lines(self.path, array("q", self.starts[places].tobytes()), partial(self._told, read))

    def _told(self, read: Callable[[bytes], T], line: bytes) -> T:
        try:
            return read(line)
        except NOT_A_ROW as problem:
            number = next(n for n, (_, each) in enumerate(_raw(self.path), 1) if each == line)
            raise JournalError(f"{self.path}:{number}: not a row of a run ({problem})") from None


def number_of(flight_id: str) -> int:
    """A flight's id, 12 hexadecimal digits, as a number: 8 bytes instead of 61. Raises ``ValueError``."""
    if not _ID.fullmatch(flight_id):
        raise ValueError(f"'{flight_id}' is no id of a flight")
    return int(flight_id, 16)


def index(path: Path) -> Index:
    """Look where the lines are, without reading what they say: of 200,000 flights in a second. Raises ``JournalError``.

    A line that looks like a row but for its inside is found out when it is read.
    """
    ids, starts = array("Q"), array("q")
    crashed, curved = bytearray(), bytearray()
    end = 0
    for start, line in _whole(path):
        end = start + len(line)
        ours = _looks_like_a_row(line)
        try:
            ids.append(number_of(id_of(line)))
        except ValueError:  # of another flight than those of a plan
            continue
        starts.append(start)
        crashed.append((not ours or _CRASHED in line) and decode(line).row["outcome"] == Outcome.CRASHED.value)
        curved.append(_NO_SERIES not in line)
    numbers = np.frombuffer(ids, dtype=np.uint64) if ids else np.zeros(0, np.uint64)
    backwards, first = np.unique(numbers[::-1], return_index=True)
    last = len(numbers) - 1 - first
    are_crashed, are_curved = (np.array(flag, dtype=bool)[last] for flag in (crashed, curved))
    return Index(path, backwards, np.array(starts, dtype=np.int64)[last], are_crashed, are_curved, end)


def read(path: Path) -> Iterator[JobResult]:
    """Every finished row; the last line may be torn and is then left out. No file, no rows."""
    return (decode(line) for _, line in _whole(path))


def _whole(path: Path) -> Iterator[tuple[int, bytes]]:
    """Where each line begins, and the line, without a last one that is torn: the driver was killed as it wrote, or the power went."""
    lines = _raw(path)
    here, number = next(lines, None), 1
    while here is not None:
        following = next(lines, None)
        try:
            if not here[1].endswith(b"\n"):
                raise ValueError("no end of line")
            if following is None or not _looks_like_a_row(here[1]):
                decode(here[1])
        except NOT_A_ROW as problem:
            if following is None:
                return
            raise JournalError(f"{path}:{number}: not a row of a run ({problem})") from None
        yield here
        here, number = following, number + 1


def _raw(path: Path) -> Iterator[tuple[int, bytes]]:
    start = 0
    if not path.exists():
        return
    with path.open("rb") as file:
        for line in file:
            yield start, line
            start += len(line)


def _looks_like_a_row(line: bytes) -> bool:
    """As ``encode`` writes it. What somebody else wrote is a row as well, and is read to the end."""
    return _ROW.match(line) is not None and line.endswith(b"}}\n") and b"\0" not in line


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
        for name, default in _SAID_LATER.items():
            event.setdefault(name, default)
        _restore(event, ReplanEvent)
    if row.get("evidence") is not None:
        row["evidence"] = {name: _numbers(value) for name, value in row["evidence"].items()}
    return JobResult(row, data["series"], data["timings"])


def row_of(line: bytes) -> Row:
    """The row of a line."""
    return decode(line).row


def id_of(line: bytes) -> str:
    """The flight of a line."""
    found = _ROW.match(line)
    return found.group(1).decode() if found else decode(line).row["flight_id"]


def outcome_of(line: bytes) -> str:
    """How the flight of a line ended."""
    found = _OUTCOME.search(line) if _looks_like_a_row(line) else None
    return found.group(1).decode() if found else decode(line).row["outcome"]


def timings_of(line: bytes) -> dict[str, float]:
    """The wall-clock seconds of a line, which are its end."""
    if not _looks_like_a_row(line):
        return decode(line).timings
    found: dict[str, float] = from_json(line[line.rindex(_TIMINGS) + len(_TIMINGS) : -2])
    return found


def _restore(target: dict[str, Any], kind: type[FlightMetrics] | type[ReplanEvent]) -> None:
    """Turn null and "inf" back into floats where the dataclass says that a float, or a vector of them, belongs."""
    numbers, vectors = _FLOATS[kind]
    for name in numbers:
        value = target[name]
        if value.__class__ is not float:
            target[name] = _number(value)
    for name in vectors:
        target[name] = [_number(item) for item in target[name]]


def _floats(kind: type[FlightMetrics] | type[ReplanEvent]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of the fields that hold a float, and of those that hold a vector."""
    vectors = tuple(field.name for field in fields(kind) if get_args(field.type) == get_args(Vec3))
    return tuple(field.name for field in fields(kind) if field.type is float), vectors


_SAID_LATER = {field.name: field.default for field in fields(ReplanEvent) if field.default is not MISSING}
"""What events did not always say: a run from before is read with what the record takes for unsaid."""

_FLOATS = {kind: _floats(kind) for kind in (FlightMetrics, ReplanEvent)}


def _number(value: Any) -> float:
    return math.nan if value is None else float(value)


def _numbers(value: Any) -> Any:
    """A number or a list of numbers; a whole one stays whole."""
    if isinstance(value, list):
        return [_numbers(item) for item in value]
    return value if isinstance(value, int) else _number(value)
