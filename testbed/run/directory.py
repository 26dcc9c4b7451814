"""The run directory: whose it is, who may write to it, and how files get into it whole."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from filelock import FileLock, Timeout

from testbed.run import foreign
from testbed.run.foreign import is_plain

RUNS = Path("reports/runs")
"""Where runs go that are not sent elsewhere."""
LOCK = ".lock"
OURS = (
    "campaign.yaml",
    "plan.json",
    "rows.jsonl",
    "timings.csv",
    "results.csv",
    "results.parquet",
    "checks.csv",
    "risk.csv",
    "answer.json",
    "index.html",
)
MANIFEST = "manifest.json"
STUDY_FILES = "study_files"
"""Key of the manifest: names of the files that the campaign's study has written beside ours."""


class BadInputError(Exception):
    """What was asked for cannot be done; str() says why and what to do."""


def recording_file(path: Path) -> Path:
    """Where a recording is to be written, absolute, with its folder made. Raises ``BadInputError``, or ``OSError``, if it cannot be.

    To be asked before anything is flown: what writes recordings says of a place that refuses them nothing that helps.
    """
    recording = Path(os.path.realpath(path))
    if recording.exists() and not recording.is_file():
        raise BadInputError(f"{recording}: a directory; name a file with --out" if recording.is_dir() else f"{recording}: not a file")
    recording.parent.mkdir(parents=True, exist_ok=True)
    beside = recording.with_name(f"{recording.name}.{os.getpid()}.part")
    try:
        beside.touch()
    except OSError as problem:
        raise BadInputError(f"{recording}: {problem.strerror}") from None
    beside.unlink()
    return recording


@dataclass(frozen=True)
class RunDirectory:
    """Paths in a run directory. ``manifest.json`` is written first and removed last: a folder without it is not ours."""

    path: Path

    def __truediv__(self, name: str) -> Path:
        return self.path / name

    @property
    def recordings(self) -> Path:
        return self.path / "recordings"

    @property
    def columns(self) -> Path:
        return self.path / "columns"

    @property
    def is_run(self) -> bool:
        return _is_file(self / MANIFEST) or (self / MANIFEST).is_symlink()  # which is then refused by its name

    def load(self, name: str) -> Any:
        """A JSON file of the run."""
        try:
            return foreign.loads((self / name).read_bytes())
        except FileNotFoundError:
            raise BadInputError(f"{self.path}: no {name} here; is it a run directory?") from None
        except ValueError as problem:
            raise BadInputError(
                f"{self / name}: damaged ({problem}); start again with --fresh, or into another directory with --out"
            ) from None

    def claim(self) -> None:
        """Create the directory, or make sure that nothing of anybody else is in it."""
        if self.path.exists() and not self.path.is_dir():
            raise BadInputError(f"{self.path}: not a directory; choose another with --out")
        self.path.mkdir(parents=True, exist_ok=True)
        others = sorted(entry.name for entry in self.path.iterdir() if not entry.name.startswith("."))
        if others and not self.is_run:
            shown = ", ".join(others[:3]) + (", ..." if len(others) > 3 else "")
            raise BadInputError(f"{self.path}: holds files that are not of a run ({shown}); choose another directory with --out")
        self.refuse_strange()

    def refuse_strange(self) -> None:
        """Make sure that nothing in it leads elsewhere. Raises ``BadInputError``."""
        if what := foreign.strange(self.path, (*OURS, MANIFEST, LOCK, *(self._of_study() if _is_file(self / MANIFEST) else ()))):
            raise BadInputError(what)

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Be the only writer. The lock is the operating system's, not a mere file: it goes with the process, however that ends."""
        lock = FileLock(self / LOCK, blocking=False, fallback_to_soft=False)
        try:
            lock.acquire()
        except Timeout:
            raise BadInputError(f"{self.path}: another run is writing here; wait for it, or choose another directory with --out") from None
        except OSError as problem:
            if problem.errno != errno.ENOSYS:
                raise
            raise BadInputError(f"{self.path}: this disk cannot lock files, so two runs could mix; choose another with --out") from None
        try:
            yield
        finally:
            lock.release()

    def clear(self) -> None:
        """Remove a former run, and nothing else."""
        for stored in (*self.recordings.glob("*.rrd*"), *self.columns.glob("*.parquet*"), *(self / "plugins").glob("*.py")):
            stored.unlink()
        for name in (*self._of_study(), *OURS, MANIFEST):
            (self / name).unlink(missing_ok=True)

    def _of_study(self) -> list[str]:
        """What a study has written, as far as a manifest that may be damaged can tell."""
        try:
            said = self.load(MANIFEST)[STUDY_FILES]
            return [name for name in said if is_plain(name)]
        except (BadInputError, TypeError, KeyError):
            return []

    def put(self, name: str, data: bytes) -> None:
        """Write a file so that a reader, or the next run, sees the old one or the new one and nothing between."""
        with self.writing(name) as file:
            file.write(data)

    @contextmanager
    def writing(self, name: str) -> Iterator[BinaryIO]:
        """The same for a file that is written piece by piece; what raises inside leaves the old one."""
        draft = self.draft_of(name)
        try:
            draft.unlink(missing_ok=True)  # of a run that was killed, or a link of anybody's
            with draft.open("xb") as file:
                yield file
                file.flush()
                os.fsync(file.fileno())
            self.keep(name)
        finally:
            draft.unlink(missing_ok=True)

    def draft_of(self, name: str) -> Path:
        """What a file is called before it is whole; nobody takes a hidden file for one of a run."""
        target = self / name
        return target.with_name(f".{target.name}.new")

    def keep(self, name: str) -> None:
        """Let the draft of a file, which is whole, take its place."""
        os.replace(self.draft_of(name), self / name)
        _sync_names(self.path)


def _sync_names(folder: Path) -> None:
    """Make the names in a folder survive a power cut, where there is a way to ask for it (Windows has none)."""
    if not hasattr(os, "O_DIRECTORY"):
        return
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _is_file(path: Path) -> bool:
    """Whether a file is there, and not a link to one."""
    return path.is_file() and not path.is_symlink()
