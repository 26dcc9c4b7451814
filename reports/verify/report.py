"""What came out, in words and a table."""

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from .arena import compare_arena
from .compare import AGREE, compare_counts, compare_flights
from .daa import compare_risk
from .paper.claims import compare_claims, compare_figures
from .run import BadInputError, Run, keeps, open_run

SHOWN = 12  # differences that are listed


def table(rows: Sequence[tuple[str, ...]]) -> str:
    """Lines of a table, its columns as wide as they need to be."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return "\n".join("  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows)


def unchecked(run: Run) -> str:
    """What was not checked and why, if anything."""
    told = {
        "not flown yet": sum(name not in run.rows for name in run.flights),
        "crashed": sum(row["outcome"] == "crashed" for row in run.rows.values()),
        "kept no raw columns": sum(not keeps(run.campaign, flight) for flight in run.flights.values()),
    }
    return "".join(f"; {count} {why}" for why, count in told.items() if count)


def verify(path: Path, say: Callable[[str], None]) -> bool:
    """Compare, and say what came out. Does everything agree?"""
    run = open_run(path)
    own, worst, differences = compare_flights(run)
    cells, unlike = compare_counts(run, own)
    differences += unlike
    say(f"{len(own)} flights checked of {len(run.flights)} planned, in {cells} cells{unchecked(run)}")
    lines = [("quantity", "flights", "worst difference", "in flight")]
    lines += [(name, str(one.compared), f"{one.worst:.1e}" if one.worst else "0", one.worst_flight) for name, one in worst.items()]
    say(table(lines))
    if (path / "verdict.csv").is_file():
        agreed, skipped, unlike = compare_claims(run, own)
        differences += unlike
        say(f"{agreed} claims of the verdict agree" + (f"; not judged here: {', '.join(skipped)}" if skipped else ""))
    if (path / "readings.csv").is_file():
        agreed, unlike = compare_figures(run, own)
        differences += unlike
        say(f"{agreed} lines of the readings agree")
    if (path / "arena.csv").is_file():
        agreed, unlike = compare_arena(run, own)
        differences += unlike
        say(f"{agreed} shares and ranks of the arena agree")
    if (path / "risk.csv").is_file():
        agreed, ahead, unlike = compare_risk(run, own)
        differences += unlike
        beside = f"; {ahead} of volumes that reach ahead are not judged here" if ahead else ""
        say(f"{agreed} shares and ratios of risk agree{beside}")
    if differences:
        differences.sort(key=lambda one: -one.size)
        say(f"{len(differences)} differences above {AGREE:g}" + (f", the first {SHOWN}:" if len(differences) > SHOWN else ":"))
        say(
            table(
                [("where", "quantity", "the run says", "computed again")]
                + [(d.where, d.quantity, d.said, d.found) for d in differences[:SHOWN]]
            )
        )
    else:
        say("everything agrees")
    return not differences


def main() -> int:
    """Verify the run that the command line names."""
    parser = argparse.ArgumentParser(prog="verify", description="Compute the results of a run again from its raw columns.")
    parser.add_argument("run_dir", metavar="RUN_DIR", type=Path, help="a run directory that kept raw columns (--set columns=all)")
    try:
        return 0 if verify(parser.parse_args().run_dir, print) else 1
    except BadInputError as problem:
        print(problem, file=sys.stderr)
        return 2
