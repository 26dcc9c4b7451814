"""``plan.json``: what a run is to fly, one flight a line, so that neither writing it nor reading it holds more than one of them.

It is the canonical JSON of the campaign and its flights with line ends between them; the plan's hash is of it without those.
"""

import atexit
import hashlib
import re
import shutil
from array import array
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import mkdtemp
from typing import Any, Protocol

import numpy as np
from pydantic_core import from_json

from testbed.campaign.reading.document import in_words
from testbed.campaign.words.grid import PART
from testbed.campaign.words.settings import Campaign, FlightPlan
from testbed.core.canonical import canonical, cut
from testbed.run import foreign, identity
from testbed.run.directory import BadInputError
from testbed.run.journal import number_of
from testbed.run.lines import Lines

MOST_FIRSTS = 64
_LINE = re.compile(rb'(.*?"flight_id":")([0-9a-f]{12})(".*,"replicate":)([0-9]{1,6})(,"route".*,\n)')
"""A line as it is written here. What differs in the second and fourth part alone says the same but for those."""

BETWEEN, END = b",\n", b"\n]}"
NOT_A_PLAN = (ValueError, TypeError, KeyError, AttributeError)
_WHO_TYPES = {"flight_id": str, "replicate": int}
_WHO = tuple(_WHO_TYPES)
"""In what the replicates of a cell differ, unless something is drawn."""


class Writable(Protocol):
    """A file to write to, or what only looks at what is written."""

    def write(self, data: bytes, /) -> int: ...


@dataclass(frozen=True)
class Planned:
    """The flights of a plan, in its order: of each its id and where its line is; the rest is read when it is asked for."""

    path: Path
    campaign: dict[str, Any]
    hash: str
    ids: np.ndarray
    """As ``journal.number_of`` has them."""
    starts: "array[int]"
    aircraft: frozenset[str]
    plugins: dict[str, str]
    """Where parts come from that are not built in, over all flights."""
    labels: dict[str, dict[str, None]]
    """Axis to its labels, over all flights."""
    firsts: dict[str, list[str]]
    """Part (without parts an empty name) to the first replicates of its first cells, ``MOST_FIRSTS`` at most."""
    axes: "array[int]"
    """Of each flight a number for the axes that it has: the same for the same."""

    def __len__(self) -> int:
        return len(self.ids)

    @property
    def flights(self) -> Lines[dict[str, Any]]:
        """As they are written."""
        return Lines(self.path, self.starts, _flight)

    @property
    def plans(self) -> Lines[FlightPlan]:
        """Each validated when it is read. Raises ``BadInputError`` for one that is not of this version."""
        return self.some(slice(None))

    def some(self, which: Any) -> Lines[FlightPlan]:
        """Those of some numbers in the plan."""
        starts = np.frombuffer(self.starts, dtype=np.int64)[which] if self.starts else np.zeros(0, np.int64)
        return Lines(self.path, array("q", starts.tobytes()), partial(_read, self.path, _Validated().plan))


def write(file: Writable, campaign: Campaign, plans: Iterable[FlightPlan]) -> None:
    """The plan file."""
    file.write(b'{"campaign":' + canonical(campaign.model_dump(mode="json")) + b',"flights":[\n')
    for number, line in enumerate(_lines(plans)):
        file.write(BETWEEN + line if number else line)
    file.write(END)


def _lines(plans: Iterable[FlightPlan]) -> Iterator[bytes]:
    """Of each flight its canonical JSON. What a flight shares with the one before is not written out anew."""
    before, pieces = None, [b""]
    for plan in plans:
        if before is None or any(a is not b for name, a, b in _beside(plan, before) if name not in _WHO):
            pieces = cut(plan.model_dump(mode="json"), *_WHO)
        yield b"".join((pieces[0], canonical(plan.flight_id), pieces[1], canonical(plan.replicate), pieces[2]))
        before = plan


def _beside(plan: FlightPlan, other: FlightPlan) -> Iterator[tuple[str, Any, Any]]:
    return ((name, value, other.__dict__[name]) for name, value in plan.__dict__.items())


def opened(path: Path) -> Planned:
    """A plan file. Raises ``BadInputError``."""
    try:
        return _opened(path)
    except NOT_A_PLAN as problem:
        raise BadInputError(f"{path}: damaged, or not a plan of this version of testbed ({problem})") from None


def _opened(path: Path) -> Planned:
    digest = hashlib.sha256()
    ids, starts = array("Q"), array("q")
    aircraft: set[str] = set()
    plugins: dict[str, str] = {}
    labels: dict[str, dict[str, None]] = {}
    axes, kinds_of_axes = array("H"), dict[tuple[str, ...], int]()
    firsts: dict[str, list[str]] = {}
    before, flight = None, dict[str, Any]()
    with path.open("rb") as file:
        first = file.readline()
        if not first.endswith(b'"flights":[\n'):
            return _laid_out_anew(path)
        campaign = from_json(first + b"]}")["campaign"]
        digest.update(first[:-1])
        start, line = len(first), b""
        for line in file:
            digest.update(line.removesuffix(b"\n"))
            if line != b"]}":
                alike = _LINE.fullmatch(line)
                if alike is None or alike.group(1, 3, 5) != before:
                    flight = _flight(line)
                    before = alike.group(1, 3, 5) if alike and _who(alike) == {name: flight[name] for name in _WHO} else None
                    aircraft.add(flight["aircraft"])
                    plugins |= flight["plugins"]
                    kind = kinds_of_axes.setdefault(tuple(flight["labels"]), len(kinds_of_axes))
                    for axis, label in flight["labels"].items():
                        labels.setdefault(axis, {})[label] = None
                else:
                    flight |= _who(alike)
                ids.append(number_of(flight["flight_id"]))
                starts.append(start)
                axes.append(kind)
                if flight["replicate"] == 0 and len(first_of := firsts.setdefault(flight["labels"].get(PART, ""), [])) < MOST_FIRSTS:
                    first_of.append(flight["flight_id"])
            start += len(line)
        if line != b"]}":
            raise ValueError("its end is missing")
    numbers = np.frombuffer(ids, dtype=np.uint64) if ids else np.zeros(0, np.uint64)
    return Planned(
        path, campaign, identity.short(digest), numbers, starts, frozenset(aircraft), dict(sorted(plugins.items())), labels, firsts, axes
    )


def _who(line: "re.Match[bytes]") -> dict[str, Any]:
    return {"flight_id": line.group(2).decode(), "replicate": int(line.group(4))}


def _laid_out_anew(path: Path) -> Planned:
    """A plan that is written in some other way, by a former version or by hand, in a file of ours that goes with the process."""
    plan = foreign.loads(path.read_bytes())
    folder = mkdtemp(prefix="plan-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    ours = Path(folder) / path.name
    lines = BETWEEN.join(map(canonical, plan["flights"]))
    ours.write_bytes(b'{"campaign":' + canonical(plan["campaign"]) + b',"flights":[\n' + lines + END)
    return _opened(ours)


def _flight(line: bytes) -> dict[str, Any]:
    flight: dict[str, Any] = from_json(line.removesuffix(b"\n").removesuffix(b","))
    return flight


@dataclass
class _Validated:
    """Plans from lines; one that differs from the one before in who it is alone has its sections, which are frozen."""

    before: dict[str, Any] | None = None
    last: FlightPlan | None = None

    def plan(self, line: bytes) -> FlightPlan:
        flight = _flight(line)
        who = {name: flight.pop(name) for name in _WHO}
        if self.last is None or flight != self.before or {name: type(value) for name, value in who.items()} != _WHO_TYPES:
            self.last = FlightPlan.model_validate(flight | who)
            self.before = flight
        else:
            self.last = self.last.model_copy(update=who)
        return self.last


def _read(path: Path, read: Callable[[bytes], Any], line: bytes) -> Any:
    try:
        return read(line)
    except NOT_A_PLAN as problem:
        raise BadInputError(f"{path}: not a plan of this version of testbed ({in_words(problem, FlightPlan)})") from None
