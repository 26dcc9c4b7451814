# ruff: noqa: I001, E402 (the commands are imported in the order of `testbed --help`)
"""The command line: parses, calls one function, turns what can go wrong into exit codes. A command is a function in a file here."""

from testbed.core import one_thread

one_thread.ask()

from testbed.cli.shell import app
from testbed.cli import runs, parts, aircraft

__all__ = ["aircraft", "app", "main", "parts", "runs"]


def main() -> None:
    """Entry point of the ``testbed`` command."""
    app()
