"""The command in this process, without the second that a process of its own takes to import everything.

Its streams are files that stand where a process has them, at numbers 1 and 2: what C++ or a worker prints is caught too. What is about
processes (signals, kills, streams that are closed) starts real ones: test_cli.py, test_odd_places.py, tests/kills.
"""

import contextlib
import io
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest import mock

from testbed.cli import main


@dataclass(frozen=True)
class Done:
    """How the command ended and what it said."""

    returncode: int
    stdout: str
    stderr: str


def testbed(*arguments: object, cwd: Path, **environment: str) -> Done:
    """``testbed`` with these arguments in a folder; variables of the environment can be changed for it."""
    return called(main, "testbed", *arguments, cwd=cwd, **environment)


def called(program: Callable[[], Any], *words: object, cwd: Path, **environment: str) -> Done:
    """The same of any program, whose name is the first word; what it returns is its exit code if it does not exit."""
    with contextlib.chdir(cwd), mock.patch.object(sys, "argv", [*map(str, words)]), mock.patch.dict(os.environ, environment):
        with _stream("stdout", 1) as out, _stream("stderr", 2) as err:
            try:
                code: Any = program()
            except SystemExit as end:
                code = end.code
        said = Done(code or 0, _read(out), _read(err))
    assert "Traceback" not in said.stderr, said.stderr
    return said


testbed.__test__ = False  # type: ignore[attr-defined]  # its name begins like a test's


@contextlib.contextmanager
def _stream(name: str, number: int) -> Iterator[io.BufferedRandom]:
    """Inside, a file is the stream of that name and number; it is given to be read afterwards."""
    file = tempfile.TemporaryFile()  # noqa: SIM115 (read, and closed, by whoever gets it)
    kept = os.dup(number)
    getattr(sys, name).flush()
    os.dup2(file.fileno(), number)
    stream = os.fdopen(number, "w", encoding="utf-8", closefd=False)
    try:
        with mock.patch.object(sys, name, stream):
            yield file
    finally:
        stream.close()
        os.dup2(kept, number)
        os.close(kept)


def _read(file: io.BufferedRandom) -> str:
    with file:
        file.seek(0)
        return file.read().decode("utf-8", "backslashreplace")
