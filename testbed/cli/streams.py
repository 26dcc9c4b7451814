"""What the command says, whatever its streams are: closed, a full disk, an encoding without the letters of a file's name."""

import codecs
import contextlib
import os
import sys
from typing import TextIO

CANNOT_WRITE = "written.as.it.can.be"
"""Name of what is done with characters that an encoding does not have."""


class UnsaidError(Exception):
    """What was to be said on stdout could not be written; str() says why."""


def prepare() -> None:
    """Make all three streams fit to be used.

    One that is closed becomes the null device: otherwise the next file that is opened takes its number, and what a library prints ends up
    in the results. A character that the encoding does not have is written as its number, a byte of a name as that byte.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)  # it takes the lowest free number, which is this one
    for name, number in (("stdout", 1), ("stderr", 2)):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(number, "w", encoding="utf-8", closefd=False))
    codecs.register_error(CANNOT_WRITE, _as_it_can_be)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors=CANNOT_WRITE)


def _as_it_can_be(error: UnicodeError) -> tuple[str | bytes, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    character = error.object[error.start]
    if "\udc80" <= character <= "\udcff":
        return bytes([ord(character) - 0xDC00]), error.start + 1
    return character.encode("ascii", "backslashreplace").decode(), error.start + 1


def say(text: str, stream: TextIO | None = None) -> None:
    """Print. A reader that has gone away (``| head``) is no reason to fail; a stdout that cannot be written is, at the end.

    What cannot be said on stderr is said to nobody. Raises ``UnsaidError``.
    """
    stream = stream or sys.stdout
    try:
        print(text, file=stream, flush=True)
    except BrokenPipeError:
        _say_no_more(stream)
    except OSError as problem:
        _say_no_more(stream)
        if stream is sys.stdout:
            raise UnsaidError(f"stdout cannot be written: {problem.strerror or problem}") from None


def at_the_end() -> str:
    """Write what waits to be written, now that somebody can still be told; why that fails, or an empty text."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except BrokenPipeError:
            _say_no_more(stream)
        except OSError as problem:
            _say_no_more(stream)
            if stream is sys.stdout:
                return f"stdout cannot be written: {problem.strerror or problem}"
    return ""


def _say_no_more(stream: TextIO) -> None:
    """Send what is left, and what else is said, to the null device."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
