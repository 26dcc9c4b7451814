"""Two run directories, opened to be compared: their flights, what they were given, and how they were judged. Half-finished ones too."""

import csv
import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, Final

import numpy as np

from testbed.campaign.words.daa import Daa
from testbed.core.canonical import canonical
from testbed.core.utf8 import clipped
from testbed.results.columns import METRICS, Column, Kind
from testbed.results.compare import FOUND, Compared, Flight, NotComparableError, Swept, compare, flight, swept
from testbed.results.daa.columns import checked, daa_columns
from testbed.run import identity, journal, listed, manifest, planned
from testbed.run.directory import BadInputError, RunDirectory
from testbed.run.planned import Planned
from testbed.run.stored import PLAN, existing, journal_read, rows_of
from testbed.show import words
from testbed.show.compare import Change, Comparison, Side
from testbed.show.gathered import HEADLINES

MEASURED: Final = tuple(column.name for column in METRICS if column.kind in (Kind.NUMBER, Kind.WHOLE))
ENCOUNTER: Final = ("route", "geometry", "obstacles")
"""Keys of a flight's plan that say what it meets."""
LONGEST: Final = 60


@dataclass(frozen=True)
class _Opened:
    """A run, with what is compared of it."""

    directory: RunDirectory
    about: Mapping[str, Any]
    plan: Planned
    flights: Sequence[Flight]
    swept: Swept
    encounters: Mapping[str, bytes]
    """Flight id to a digest of what is met."""
    searched: bool
    """Whether a study has searched, and not flown once, in the place of each flight."""


def compared(first: Path, second: Path, on: Sequence[str] = ()) -> Comparison:
    """What differs between two runs. Raises ``BadInputError`` for what is no run, and for two that cannot be compared."""
    if first.resolve() == second.resolve():
        raise BadInputError(f"{first}: is the same run as {second}; give two")
    runs = [_opened(path) for path in (first, second)]
    for run in runs:
        if not run.flights:
            raise BadInputError(f"{run.directory.path}: no flight of it is done yet")
    if runs[0].searched != runs[1].searched:
        which = [run.directory.path for run in sorted(runs, key=lambda run: run.searched)]
        raise BadInputError(f"{which[1]} holds searches of a study, {which[0]} flights: there is nothing that both have")
    try:
        found = compare(runs[0].flights, runs[1].flights, on, HEADLINES, (runs[0].swept, runs[1].swept))
    except NotComparableError as problem:
        raise BadInputError(f"{first} and {second} cannot be compared: {problem}") from None
    names = _names(first, second)
    judged, changed, in_both = _judgements(runs)
    settings = _settings(runs)
    sides = [_side(run, name) for run, name in zip(runs, names, strict=True)]
    return Comparison(sides[0], sides[1], found, _notes(runs, names, found), settings, judged, changed, in_both)


def _opened(path: Path) -> _Opened:
    directory = existing(path)
    about = manifest.load(directory)
    if not (directory / PLAN).is_file():
        raise BadInputError(f"{path}: no {PLAN} here; its run ended before it began")
    plan = planned.opened(directory / PLAN)
    if not isinstance(plan.campaign, dict):
        raise BadInputError(f"{directory / PLAN}: damaged, or not a plan of this version of testbed (its campaign is no section)")
    index = rows_of(directory)
    places = index.places(plan.ids)
    with journal_read():
        rows = index.lines(places[np.flatnonzero(places >= 0)], journal.row_of)
        searched = any(FOUND in row for row in islice(rows, 1))
        more = _more(plan.campaign)
        asked = (*MEASURED, *(column.name for column in more if column.kind in (Kind.NUMBER, Kind.WHOLE)))
        flights = [flight(checked(row, more), asked) for row in rows]
    encounters: dict[str, bytes] = {}
    try:
        planned_axes = swept(_labels(plan, encounters))
    except planned.NOT_A_PLAN as problem:
        raise BadInputError(f"{plan.path}: damaged, or not a plan of this version of testbed ({problem})") from None
    return _Opened(directory, about, plan, flights, planned_axes, encounters, searched)


def _more(campaign: Mapping[str, Any]) -> tuple[Column, ...]:
    """The columns of detect and avoid, where a campaign asks for them, of a plan that anybody may have written."""
    try:
        return daa_columns(Daa.model_validate(campaign["daa"])) if campaign.get("daa") is not None else ()
    except ValueError:
        return ()


def _labels(plan: Planned, encounters: dict[str, bytes]) -> Iterator[Mapping[str, str]]:
    """Those of each planned flight. What each meets goes into ``encounters``: the plan is read once for both, and not held."""
    for one in plan.flights:
        met = canonical({key: one.get(key) for key in ENCOUNTER})
        encounters[one["flight_id"]] = hashlib.blake2b(met, digest_size=8).digest()
        yield one["labels"]


def _names(first: Path, second: Path) -> tuple[str, str]:
    """As short as tells them apart."""
    one, other = first.resolve(), second.resolve()
    return (one.name, other.name) if one.name != other.name else (f"{one.parent.name}/{one.name}", f"{other.parent.name}/{other.name}")


def _side(run: _Opened, name: str) -> Side:
    path = run.directory.path
    page = (path / "index.html").resolve().as_uri() if (path / "index.html").is_file() else ""
    question = run.plan.campaign.get("question", "")
    return Side(
        name, str(path), question if isinstance(question, str) else "", listed.when(run.about), len(run.plan), len(run.flights), page
    )


def _notes(runs: Sequence[_Opened], names: Sequence[str], found: Compared) -> list[str]:
    """What a reader has to know before the figures."""
    said = []
    for run, name in zip(runs, names, strict=True):
        if len(run.flights) < len(run.plan):
            said.append(f"{name} is not finished: {len(run.flights)} of {words.counted(len(run.plan), 'flight')}")
        if run.about["identity"]["code"] == manifest.MIXED:
            said.append(f"the code changed while {name} was flown, so its flights may not be of one code")
    if alone := [f"{count} of {name}" for count, name in ((found.only_first, names[0]), (found.only_second, names[1])) if count]:
        said.append(f"without a partner, and left out: {words.listed(alone)}")
    if left := [
        axis for axis in dict.fromkeys(axis for run in runs for axes in run.swept.values() for axis in axes) if axis not in found.axes
    ]:
        said.append(f"paired by {', '.join([*found.axes, 'replicate'])}; not by {', '.join(left)}")
    if runs[0].about["seed"] != runs[1].about["seed"]:
        said.append("the seeds differ, so that whatever is drawn is drawn otherwise: pairs are not of the same draw")
    other = _other_encounters(runs, found)
    if other:
        said.append(f"in {other} of {words.counted(len(found.pairs), 'pair')} the two fly another route or meet other obstacles")
    return said


def _other_encounters(runs: Sequence[_Opened], found: Compared) -> int:
    """In how many pairs the two flights were given different encounters."""
    mine, theirs = (run.encounters for run in runs)
    return sum(mine[pair.first.flight_id] != theirs[pair.second.flight_id] for pair in found.pairs)


def _settings(runs: Sequence[_Opened]) -> list[Change]:
    """Settings of the campaigns, code and versions that are not the same."""
    campaigns = [identity.flat(run.plan.campaign) for run in runs]
    origins = [identity.flat(_origin(run.about)) for run in runs]
    return [*_changes(*campaigns), *_changes(*origins)]


def _origin(about: Mapping[str, Any]) -> dict[str, Any]:
    names = about["identity"]
    return {
        "code": names["code"],
        "revision": about["revision"],
        "version": names["versions"],
        "plug-in": names["plugins"],
        "package": names["packages"],
        "aircraft": {name: files.get("aircraft.yaml") for name, files in about["aircraft"].items()},
    }


def _changes(first: Mapping[str, Any], second: Mapping[str, Any]) -> list[Change]:
    absent = object()
    return [
        Change(key, _shown(first, key), _shown(second, key))
        for key in dict.fromkeys([*first, *second])
        if key and first.get(key, absent) != second.get(key, absent)
    ]


def _shown(leaves: Mapping[str, Any], key: str) -> str:
    if key not in leaves or leaves[key] is None:
        return words.DASH
    leaf = leaves[key]
    text = leaf if isinstance(leaf, str) else json.dumps(leaf)
    return clipped(text, LONGEST)


JUDGED: Final = (("key", "word", ("condition",), "text"), ("quantity", "verdict", (), "quantity"))
"""Columns by which a file is one of judgements, a study's or the checks': what is judged, the word, what completes it, its name."""


def _judgements(runs: Sequence[_Opened]) -> tuple[str, list[Change], int]:
    """The file in which both runs are judged, the words that differ, and how many are in both."""
    names = [{file.name for file in run.directory.path.glob("*.csv")} for run in runs]
    for name in sorted(names[0] & names[1]):
        found = [_table(run.directory / name) for run in runs]
        if found[0] is None or found[1] is None or found[0][0] != found[1][0]:
            continue
        _, word, more, text = found[0][0]
        tables = [found[0][1], found[1][1]]
        both = [one for one in tables[0] if one in tables[1]]
        said = [[" ".join(filter(None, (table[one].get(column) for column in (word, *more)))) for one in both] for table in tables]
        changed = [
            Change(one, first, second, tables[0][one].get(text) or "")
            for one, first, second in zip(both, *said, strict=True)
            if tables[0][one].get(word) != tables[1][one].get(word)
        ]
        return name, changed, len(both)
    return "", [], 0


def _table(file: Path) -> tuple[tuple[str, str, tuple[str, ...], str], dict[str, dict[str, str]]] | None:
    """Its columns, and its rows by what is judged; none where it judges nothing, or cannot be read."""
    try:
        with file.open(encoding="utf-8", newline="") as lines:
            reader = csv.DictReader(lines)
            head = reader.fieldnames or []
            columns = next((one for one in JUDGED if {one[0], one[1], one[3]} <= set(head)), None)
            if columns is None:
                return None
            rows = {row[columns[0]]: row for row in reader if row.get(columns[0])}
    except (OSError, UnicodeDecodeError, csv.Error):
        return None
    return (columns, rows) if rows else None
