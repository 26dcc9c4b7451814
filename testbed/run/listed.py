"""The runs in a folder, each with its question and answer: for `testbed runs`, and for the page of runs beside them."""

import os
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

from testbed.core.utf8 import utf8
from testbed.run import manifest
from testbed.run.directory import RUNS, BadInputError, RunDirectory
from testbed.run.stored import existing
from testbed.run.write import ANSWER
from testbed.show.answer import Answer, read
from testbed.show.runs_page import MARK, Link, Told, render_runs

PAGE: Final = "index.html"
_HEAD = 2_000  # characters in which a page of ours says so


@dataclass(frozen=True)
class Listed:
    """A run directory, in short. ``state``: empty if it is whole; otherwise what it lacks."""

    path: Path
    question: str
    when: str
    """When its last flights ended, or began; of UTC. Empty if that is not known."""
    planned: int
    outcomes: dict[str, int]
    answer: Answer | None
    state: str

    @property
    def has_page(self) -> bool:
        return (self.path / PAGE).is_file()


def runs_in(folder: Path) -> list[Listed]:
    """Those that lie in a folder, the last one first. A folder that is no run is left out, one that is damaged says so."""
    try:
        inside = sorted(entry for entry in folder.iterdir() if RunDirectory(entry).is_run)
    except OSError:
        return []
    return sorted(map(_listed, inside), key=lambda run: run.when, reverse=True)


def _listed(path: Path) -> Listed:
    try:
        directory = existing(path)
        about = manifest.load(directory)
        said = _answer_of(directory)
    except (BadInputError, OSError) as problem:
        return Listed(path, "", "", 0, {}, None, f"cannot be read: {problem}")
    answer = read(said)
    flights = about.get("flights")
    planned = flights if isinstance(flights, int) else 0
    question, outcomes = said.get("question"), said.get("outcomes")
    counted = outcomes if isinstance(outcomes, dict) and all(isinstance(n, int) for n in outcomes.values()) else {}
    state = "" if answer else "finished, without an answer (testbed report writes it)" if (path / PAGE).is_file() else "not finished"
    if answer and sum(counted.values()) < planned:
        state = f"not finished: {sum(counted.values())} of {planned} flights"
    return Listed(path, question if isinstance(question, str) else "", when(about), planned, counted, answer, state)


def _answer_of(directory: RunDirectory) -> dict[str, Any]:
    with suppress(BadInputError):
        said = directory.load(ANSWER)
        return said if isinstance(said, dict) else {}
    return {}


def when(about: Mapping[str, Any]) -> str:
    """When the last flights of a run ended, or began, in UTC; empty if its manifest does not tell."""
    history = about["history"]
    said = (history[-1].get("ended") or history[-1].get("started")) if history else None
    with suppress(TypeError, ValueError, OverflowError):
        return datetime.fromisoformat(said).astimezone(UTC).strftime("%Y-%m-%d %H:%M")  # type: ignore[arg-type]
    return ""


def write_page(folder: Path) -> Path:
    """The page of the runs in a folder. Raises ``BadInputError`` where a page of somebody else's has its name."""
    file = folder / PAGE
    if not folder.is_dir():
        raise BadInputError(f"{folder}: no such directory")
    if RunDirectory(folder).is_run:
        raise BadInputError(f"{folder}: is a run itself; name the folder of runs that it lies in")
    if (file.exists() or file.is_symlink()) and not _is_ours(file):
        raise BadInputError(f"{file}: is not a page of runs, and is not overwritten")
    draft = folder / f".{PAGE}.{os.getpid()}"  # other runs may end at the same moment
    try:
        draft.write_bytes(utf8(render_runs(_told(runs_in(folder)))))
        os.replace(draft, file)
    finally:
        draft.unlink(missing_ok=True)
    return file


def refresh(run: Path) -> None:
    """Write the page of runs again after one of them: in the folder where runs go by default, or where there is such a page already.

    It is an extra, which must not cost a run its end: where it cannot be written, the old one stays.
    """
    folder = run.absolute().parent
    with suppress(OSError, BadInputError):
        if folder == RUNS.absolute() or _is_ours(folder / PAGE):
            write_page(folder)


def _tables(run: Path) -> list[str]:
    """Its CSV files by name, that of the flights first."""
    return sorted((file.name for file in run.glob("*.csv")), key=lambda name: (name != "results.csv", name))


def _is_ours(file: Path) -> bool:
    if file.is_symlink() or not file.is_file():
        return False
    with file.open(encoding="utf-8", errors="replace") as text:
        return MARK in text.read(_HEAD)


def _told(runs: Iterable[Listed]) -> list[Told]:
    """What the page says of each."""
    return [
        Told(
            name=run.path.name,
            question=run.question,
            when=run.when,
            outcomes=run.outcomes,
            answer=run.answer,
            state=run.state,
            page=f"{run.path.name}/{PAGE}" if run.has_page else "",
            links=[Link(file, f"{run.path.name}/{file}") for file in _tables(run.path)],
            recordings=sum(1 for _ in (run.path / "recordings").glob("*.rrd")),
        )
        for run in runs
    ]
