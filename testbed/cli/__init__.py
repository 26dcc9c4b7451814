# ruff: noqa: I001, E402 (the commands are imported in the order of `testbed --help`)
"""The command line: parses, calls one function, turns what can go wrong into exit codes. A command is a function in a file here."""

import sys

from testbed.core import one_thread

one_thread.ask()

from testbed.cli.shell import BAD_INPUT, CRASHED, INTERRUPTED, app, told
from testbed.cli import runs, between, pictures, parts, aircraft, streams

__all__ = ["aircraft", "app", "between", "main", "parts", "pictures", "runs"]


def main() -> None:
    """Entry point of the ``testbed`` command."""
    streams.prepare()
    code = _called()
    if unsaid := streams.at_the_end():
        streams.say(unsaid, sys.stderr)
        code = code or CRASHED
    streams.at_the_end()
    sys.exit(code)


def _called() -> int:
    """The command's exit code; whatever happens outside of any command's own care is a sentence too."""
    try:
        app()
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else CRASHED if end.code else 0
    except streams.UnsaidError as problem:
        streams.say(str(problem), sys.stderr)
        return CRASHED
    except KeyboardInterrupt:
        return INTERRUPTED
    except OSError as problem:  # the help on a full disk, which the command line's own library prints
        streams.say(told(problem), sys.stderr)
        return CRASHED if problem.filename is None else BAD_INPUT
    return 0
