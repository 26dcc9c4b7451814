"""What a run directory holds may have been written by anybody: it is read as data, and nothing outside of the folder is touched for it.

Every rule about that is here. ``directory.py``, ``stored.py``, ``journal.py`` and ``manifest.py`` ask before they use what they read.
"""

import json
import os
import re
import stat
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Final

from pydantic_core import from_json

from testbed.core.utf8 import whole
from testbed.flight.record import Outcome
from testbed.results.columns import IDENTITY_COLUMNS, METRICS, WEIGHT, Kind
from testbed.show import close_up

FOLDERS: Final = ("recordings", "columns", "plugins")
"""Those of a run directory; everything else of ours in it is a file."""

_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}")
_TYPES: Final = {Kind.TEXT: (str,), Kind.WHOLE: (int,), Kind.NUMBER: (float, int, type(None)), Kind.FLAG: (bool, type(None))}
_WHO: Final = [(column.name, column.kind, _TYPES[column.kind]) for column in IDENTITY_COLUMNS]
_MEASURED: Final = [(column.name, column.kind, _TYPES[column.kind]) for column in METRICS]
_OUTCOMES: Final = frozenset(outcome.value for outcome in Outcome)
_CURVES: Final = ("time_s", "x", "y", "z", "clearance_m", "cross_track_m", "bank_deg", "airspeed_mps", "load_factor", "roll_rate_dps")
_LISTS: Final = ("paths", "obstacles", "decisions")


def is_plain(name: Any) -> bool:
    """Whether it names a file in the run directory itself, and none that is hidden."""
    return (
        isinstance(name, str)
        and name != ""
        and Path(name).name == name
        and not name.startswith(".")
        and "\0" not in name
        and whole(name) == name
    )


def is_id(name: Any) -> bool:
    """Whether it can be a flight's id, which files are named by."""
    return isinstance(name, str) and _ID.fullmatch(name) is not None


def loads(data: bytes) -> Any:
    """JSON that somebody else wrote. Raises ``ValueError`` for whatever cannot be read, too deep a nesting included."""
    try:
        return from_json(data)  # quicker, and rows that are kept share the names of their columns
    except ValueError:  # also for half a character
        pass
    try:
        found = json.loads(data)
    except RecursionError:
        raise ValueError("nested too deeply") from None
    # half a character comes in as an escape, and would go out as none
    return _whole(found) if b"\\ud" in data or b"\\uD" in data else found


def _whole(value: Any) -> Any:
    if isinstance(value, str):
        return whole(value)
    if isinstance(value, list):
        return [_whole(item) for item in value]
    return {whole(key): _whole(item) for key, item in value.items()} if isinstance(value, dict) else value


def strange(folder: Path, files: Iterable[str]) -> str:
    """What in a run directory is not what a run writes, and might lead out of it: a link, a pipe, a folder for a file. Empty if nothing."""
    for name in files:
        if (kind := _kind(folder / name)) not in ("", "file"):
            return f"{folder / name}: a {kind}, where a run has a file; it is not touched"
    for name in FOLDERS:
        inner = folder / name
        if (kind := _kind(inner)) not in ("", "folder"):
            return f"{inner}: a {kind}, where a run has a folder; it is not touched"
        if kind:
            with os.scandir(inner) as entries:
                for entry in entries:
                    if not entry.is_file(follow_symlinks=False):
                        return f"{entry.path}: a {_kind(Path(entry.path))}, where a run has a file; it is not touched"
    return ""


def _kind(path: Path) -> str:
    """What is there, links not followed; empty for nothing."""
    try:
        mode = path.lstat().st_mode
    except FileNotFoundError:
        return ""
    if stat.S_ISLNK(mode):
        return "link"
    if stat.S_ISDIR(mode):
        return "folder"
    return "file" if stat.S_ISREG(mode) else "pipe, socket or device"


def checked_row(data: Any) -> None:
    """Raise ``ValueError`` unless a line of the journal has everything that tables and page read of a row, of its type."""
    if not isinstance(data, dict) or not isinstance(row := data.get("row"), dict):
        raise ValueError("it has no row")
    if not is_id(row.get("flight_id")):
        raise ValueError("flight_id is no flight's id")
    for name, kind, types in (*_WHO, *(() if "found" in row else _MEASURED)):
        value = row.get(name, NotImplemented)
        if value.__class__ not in types and not (kind is Kind.NUMBER and value in ("inf", "-inf")):  # which is how that is written
            raise ValueError(f"{name} is no {kind}")
    if row.get(WEIGHT.name, 1.0).__class__ not in (float, int):
        raise ValueError(f"{WEIGHT.name} is no number")
    if "found" not in row and row["outcome"] not in _OUTCOMES:
        raise ValueError("outcome is none that there is")
    wrong = [
        name
        for name, kind in {"labels": dict, "events": list, "message": str, "traceback": str, "outcome": str}.items()
        if not isinstance(row.get(name), kind)
    ]
    if wrong or not all(isinstance(label, str) for label in row["labels"].values()) or not all(isinstance(e, dict) for e in row["events"]):
        raise ValueError(f"{', '.join(wrong) or 'a label or an event'} is not what a run writes")
    if row.get("recording") not in (None, f"recordings/{row['flight_id']}.rrd"):
        raise ValueError("recording names no file of this run")
    if not _is_series(data.get("series")) or not _are_times(data.get("timings")):
        raise ValueError("series or timings are not what a run writes")


def _is_series(series: Any) -> bool:
    if series is None:
        return True
    if not isinstance(series, Mapping):
        return False
    curves = [series.get(name, []) for name in _CURVES]
    numbers = all(isinstance(curve, list) and all(_is_number(value) for value in curve) for curve in curves)
    lists = all(isinstance(series.get(name, []), list) and all(isinstance(i, dict) for i in series.get(name, [])) for name in _LISTS)
    return numbers and lists and close_up.fits(series.get("close_up"))


def _are_times(timings: Any) -> bool:
    return isinstance(timings, Mapping) and all(_is_number(seconds) and seconds is not None for seconds in timings.values())


def _is_number(value: Any) -> bool:
    return value is None or (isinstance(value, int | float) and not isinstance(value, bool))
