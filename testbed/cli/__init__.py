# ruff: noqa: I001 (the commands are imported in the order of `testbed --help`)
"""The command line: parses, calls one function, turns what can go wrong into exit codes. A command is a function in a file here."""

from testbed.cli.shell import app
from testbed.cli import runs, parts, aircraft

__all__ = ["aircraft", "app", "main", "parts", "runs"]


def main() -> None:
    """Entry point of the ``testbed`` command."""
    app()
