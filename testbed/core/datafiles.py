"""Data files that a campaign names, such as recorded tracks: found beside the campaign, known by what is in them.

A file is read by whoever flies with it, and is held then against the SHA-256 that it had when the campaign was read, which is part of
what the flight is: a file that was changed is another flight. Paths go with a flight to other processes; contents do not.
"""

import hashlib
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from testbed.core.utf8 import clipped

MOST_BYTES = 500_000_000


class DataFileError(ValueError):
    """A data file cannot be used; str() says which and why."""


@dataclass(frozen=True)
class DataFile:
    """``name``: what the campaign calls it."""

    name: str
    path: str
    sha256: str


_known: dict[tuple[str, str], DataFile] = {}
_latest: dict[str, DataFile] = {}
_hashes: dict[tuple[str, int, int], str] = {}  # by path, time and size: the cells of a campaign name few files very often
_of_a_run: set[str] = set()  # names known from a run, whose campaign was read before
_folder: list[Path] = []  # of the campaign that is being read


@contextmanager
def beside(folder: Path) -> Iterator[None]:
    """While a campaign of that folder is read, its files are looked up there, and looked at again."""
    _folder.append(folder)
    try:
        yield
    finally:
        _folder.pop()


def look_up(name: str) -> DataFile:
    """The file of that name: beside the campaign that is being read; else the one known last; else from here. ``DataFileError``."""
    if not _folder and name in _latest:
        return _latest[name]
    path = (_folder[-1] if _folder else Path()) / name
    if name in _latest and not os.path.exists(path):  # the copy of a campaign in a run directory, whose world was entered
        return _latest[name]
    sha256 = _hash(path, name)
    found = DataFile(name, str(path.resolve()), sha256)
    _known[name, found.sha256] = _latest[name] = found
    _of_a_run.discard(name)
    return found


def add(files: Iterable[DataFile]) -> None:
    """Make the files of a run known in this process without opening them: they may be gone."""
    for file in files:
        _known[file.name, file.sha256] = _latest[file.name] = file
        _of_a_run.add(file.name)


def is_of_a_run(name: str) -> bool:
    """Whether what is in the file was looked at when its campaign was read, and need not be again."""
    return name in _of_a_run


def known(pinned: Iterable[tuple[str, str]]) -> tuple[DataFile, ...]:
    """The files with these names and hashes; what is none of this process is passed over."""
    return tuple(_known[key] for key in pinned if key in _known)


def content(name: str, sha256: str | None) -> bytes:
    """What is in a file, which must have that hash; without one in the file known last. Raises ``DataFileError``."""
    file = _known.get((name, sha256)) if sha256 else look_up(name)
    if file is None:
        raise DataFileError(f"{name}: no such file is known here")
    data = _read(Path(file.path), name)
    if hashlib.sha256(data).hexdigest() != file.sha256:
        raise DataFileError(f"{name}: changed since the campaign was read ({file.path}; SHA-256 {file.sha256[:12]}... then)")
    return data


def _hash(path: Path, name: str) -> str:
    try:
        stat = path.stat()
    except (OSError, ValueError):  # the latter for a zero byte
        raise _absent(path, name) from None
    key = (str(path.resolve()), stat.st_mtime_ns, stat.st_size)
    if key not in _hashes:
        _hashes[key] = hashlib.sha256(_read(path, name)).hexdigest()
    return _hashes[key]


def _read(path: Path, name: str) -> bytes:
    try:
        if path.is_file() and path.stat().st_size > MOST_BYTES:
            raise DataFileError(f"{name}: has {path.stat().st_size:,} bytes; at most {MOST_BYTES:,}")
        if path.exists() and not path.is_file():
            raise DataFileError(f"{name}: is no file")
        return path.read_bytes()
    except (FileNotFoundError, NotADirectoryError):
        raise _absent(path, name) from None
    except OSError as problem:
        raise DataFileError(f"{name}: cannot be read: {problem.strerror}") from None


def _absent(path: Path, name: str) -> DataFileError:
    return DataFileError(f"{clipped(name, 80)}: no such file (looked for it in {path.absolute().parent})".replace("\0", "?"))
