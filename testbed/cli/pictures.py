"""Commands that make pictures: several flights in one recording."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from testbed.cli.completing import run_folder
from testbed.cli.shell import app, bad_input, say


@app.command()
def overlay(
    directory: Annotated[Path, typer.Argument(metavar="RUN", help="A run directory, or its name in reports/runs.")],
    cell: Annotated[str, typer.Argument(help="A cell of results.csv, or the beginning of one; or a flight's id, or the beginning of it.")],
    out: Annotated[Path | None, typer.Option(metavar="FILE.rrd", help="Default: RUN/recordings/overlay_FLIGHT_ID.rrd.")] = None,
    every: Annotated[
        bool, typer.Option("--every", help="Also the rungs with a limit switched off, and the direction flown at once.")
    ] = False,
) -> None:
    """Fly all rungs of one encounter and method again into one recording: the point on rails, the point mass, flown in calm air, in wind.

    They are aligned at the decision. Each rung is shown in the air of the flight asked for, if others were flown in it, else in calm air;
    of wind and of turbulence beside it the flight that came closest.

    Example: testbed overlay reports/runs/paper calm/single_106/scoam/gtm_t2
    """
    with bad_input():
        from testbed.run.overlay import overlay as fly_all
        from testbed.show import words
        from testbed.show.text_table import aligned

        found = fly_all(run_folder(directory), cell, out, every)
    say(f"{words.counted(len(found.names), 'flight')}:", sys.stderr)
    for line in aligned(("", "", ""), [(name, *told) for name, told in zip(found.names, found.told, strict=True)], right=(2,)):
        say(f"  {line}", sys.stderr)
    for line in found.differences:
        say(f"differs from the run (other code or packages?): {line}", sys.stderr)
    for line in found.left_out:
        say(f"left out: {line}", sys.stderr)
    say(str(found.recording))
