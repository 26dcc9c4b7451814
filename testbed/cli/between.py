"""Commands about runs that are there: which there are, looking at one, and what differs between two."""

import os
import shutil
import subprocess
import sys
import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from testbed.cli import completing
from testbed.cli.completing import run_folder
from testbed.cli.plain import examples
from testbed.cli.shell import app, bad_input, fail, say

RunDirectory = Annotated[
    Path, typer.Argument(metavar="RUN", help="A run directory, or its name in reports/runs.", autocompletion=completing.runs)
]
_NO_SCREEN = "no screen to show it on; "


@app.command(
    epilog=examples(
        "testbed runs                       those in reports/runs, the last one first",
        "testbed runs --page                the same as a page: reports/runs/index.html",
        "testbed runs /data/my_runs",
    )
)
def runs(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="Where the runs lie.")] = Path("reports/runs"),
    page: Annotated[bool, typer.Option("--page", help="Write FOLDER/index.html, which has a picture of each, and print its path.")] = False,
) -> None:
    """List the runs in a folder, each with its question and answer."""
    with bad_input():
        from testbed.run import listed

        if not folder.is_dir():
            fail(f"{folder}: no such directory; `testbed run campaigns/smoke.yaml` makes a first run")
        there = listed.runs_in(folder)
        if not there:
            say(f"{folder}: no run lies in it; `testbed run campaigns/smoke.yaml` makes a first one in reports/runs", sys.stderr)
        for run in there:
            say(f"{run.path}{f'  {run.when} UTC' if run.when else ''}")
            told = [run.question, run.state, *(run.answer.lines if run.answer else ())]
            say("".join(f"  {line}\n" for line in told if line))
        if page:
            say(str(listed.write_page(folder)))


@app.command(
    "open",
    epilog=examples(
        "testbed open smoke                 the page of reports/runs/smoke, in the browser",
        "testbed open smoke 3b1f            the recording of the flight whose id begins so, in the viewer",
        "testbed open reports/paper/index.html",
    ),
)
def open_(
    directory: RunDirectory,
    flight: Annotated[
        str | None, typer.Argument(metavar="FLIGHT", help="Its beginning is enough.", autocompletion=completing.flights)
    ] = None,
) -> None:
    """Look at a run: its page in the browser, or the recording of a flight in the viewer. Where there is no screen, say how to.

    RUN can also be a file, a page or a recording.
    """
    with bad_input():
        from testbed.run.stored import existing, flight_of

        if directory.is_file():
            _open_recording(directory) if directory.suffix == ".rrd" else _open_page(directory)
            return
        run = existing(run_folder(directory))
        if flight is None:
            _open_page(run.path / "index.html")
            return
        found = flight_of(run, flight)
        recording = run.recordings / f"{found}.rrd"
        if not recording.is_file():
            fail(f"{run.path}: flight {found} has no recording; to fly and record it again: testbed replay {run.path} {found}")
        _open_recording(recording)


def _has_screen() -> bool:
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _open_page(page: Path) -> None:
    if not page.is_file():
        fail(f"{page}: not there; a run writes it when it ends (testbed report {page.parent} writes it of the flights that are done)")
    address = page.resolve().as_uri()
    if not ((_has_screen() or os.environ.get("BROWSER")) and webbrowser.open(address)):
        say(f"{_NO_SCREEN}open in a browser:", sys.stderr)
    say(address)


def _open_recording(recording: Path) -> None:
    beside = Path(sys.executable).with_name("rerun")
    viewer = str(beside) if beside.exists() else shutil.which("rerun") or "rerun"
    command = [viewer, "--bind", "127.0.0.1", str(recording)]  # it would listen to the whole network otherwise
    if _has_screen():
        quiet = subprocess.DEVNULL
        subprocess.Popen(command, stdin=quiet, stdout=quiet, stderr=quiet, start_new_session=True)
    else:
        say(f"{_NO_SCREEN}to look at it elsewhere:", sys.stderr)
    say(" ".join(command))


@app.command(
    epilog=examples(
        "testbed compare paper-single windy",
        "testbed compare reports/runs/a reports/runs/b --out differences.html",
        "testbed compare scoam orca --on reading --on flown_by     pair by these axes, whatever else is swept",
    )
)
def compare(
    first: Annotated[
        Path, typer.Argument(metavar="A", help="A run directory, or its name in reports/runs.", autocompletion=completing.runs)
    ],
    second: Annotated[Path, typer.Argument(metavar="B", help="Another one.", autocompletion=completing.runs)],
    on: Annotated[
        list[str] | None,
        typer.Option("--on", metavar="AXIS", help="Pair by this axis and the replicate; default: every axis that both runs sweep."),
    ] = None,
    out: Annotated[Path | None, typer.Option(metavar="FILE.html", help="Write it as a page too, with a slope chart.")] = None,
) -> None:
    """Compare two runs flight by flight: those of the same cell and replicate are a pair. Also runs that are not finished."""
    with bad_input():
        from testbed.run.compared import compared
        from testbed.show import compare as told

        found = compared(run_folder(first), run_folder(second), on or ())
        say("\n".join(told.text(found)))
        if out is not None:
            from testbed.show.compare_page import render_comparison

            out.write_text(render_comparison(found), encoding="utf-8")
            say(str(out))
