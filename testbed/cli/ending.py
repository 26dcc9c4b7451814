"""What a run says when it ends: how its flights ended, what is wrong, the answer, and where to look."""

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from testbed.cli.shell import CRASHED
from testbed.cli.streams import say

if TYPE_CHECKING:
    from testbed.results.checks import CheckResult
    from testbed.run.runner import Summary


def summarise(summary: "Summary") -> None:
    """What came out, on stderr; the run directory, the last line on stdout; the exit code."""
    from testbed.show import words

    outcomes = words.outcomes(summary.outcomes)
    flown = sum(summary.outcomes.values())
    told = f": {outcomes}" if outcomes else ""
    say(f"{flown} of {words.counted(summary.planned, 'flight')} ({summary.flown_now} flown now){told}", sys.stderr)
    if summary.crashed:
        traceback = f"see 'traceback' in {summary.directory / 'rows.jsonl'}"
        say(f"{summary.crashed} crashed: {summary.first_crash.splitlines()[0]}; {traceback}", sys.stderr)
        if summary.plugins:
            say(f"  the fault may be in a file of the campaign's plug-ins: {', '.join(summary.plugins)}", sys.stderr)
    if summary.mixed_code:
        say("warning: the code changed during the run, so its flights may not be of one code; start again with --fresh", sys.stderr)
    missed = sum(not line.passed for line in summary.checks)
    _tell_checks(summary.checks, missed)
    if summary.answer and summary.answer.lines:
        say("\n".join(["", *summary.answer.lines, ""]), sys.stderr)
    _tell_where(summary)
    say(str(summary.directory))
    raise typer.Exit(CRASHED if summary.crashed or missed else 0)


def _tell_checks(checks: "Sequence[CheckResult]", missed: int) -> None:
    """A line for each check, numbers below each other."""
    from testbed.show.text_table import aligned

    if not checks:
        return
    rows = [
        (
            line.word,
            line.quantity,
            *(f"{x:.6g}" for x in (line.measured, line.truth)),
            f"{line.off:.3g}",
            f"{line.tolerance:.3g}",
            line.unit,
        )
        for line in checks
    ]
    headings = ("check", "quantity", "measured", "true", "off by", "allowed", "unit")
    say("\n".join(aligned(headings, rows, right=(2, 3, 4, 5))), sys.stderr)
    if missed:
        say(f"{missed} of {len(checks)} checks missed", sys.stderr)


def _tell_where(summary: "Summary") -> None:
    """Page and recording, with the commands that open them."""
    import shlex

    name = shlex.quote(str(summary.directory))
    say(f"page       {link(summary.directory / 'index.html')}", sys.stderr)
    say(f"           testbed open {name}", sys.stderr)
    flight = summary.answer.flight if summary.answer else ""
    if flight:
        recorded = (summary.directory / "recordings" / f"{flight}.rrd").is_file()
        again = f"testbed open {name} {flight}" if recorded else f"testbed replay {name} {flight}"
        say(f"{'recording' if recorded else 'record it'}  {again}", sys.stderr)


def link(file: Path) -> str:
    """A file as it is told on stderr: on a terminal an address that can be clicked, elsewhere its path."""
    if not sys.stderr.isatty():
        return str(file)
    address = Path(os.path.abspath(file)).as_uri()
    return f"\x1b]8;;{address}\x1b\\{address}\x1b]8;;\x1b\\" if os.environ.get("TERM", "dumb") != "dumb" else address
