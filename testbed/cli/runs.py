"""Commands about campaigns and their runs."""

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer
import typer.core
import typer.main

from testbed.cli.shell import BAD_INPUT, CRASHED, INTERRUPTED, app, bad_input, fail, say

if TYPE_CHECKING:
    from testbed.run.engines import Engine
    from testbed.run.runner import Summary

Overrides = Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change a setting: dotted path, YAML value.")]


@app.command()
def run(
    file: Annotated[Path, typer.Argument(help="The campaign, a YAML file.")],
    out: Annotated[Path | None, typer.Option(help="Run directory; default reports/runs/<name>.")] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Worker processes; default one per core.")] = None,
    engine: Annotated[Literal["local", "dask"], typer.Option(help="Where flights are flown.")] = "local",
    scheduler: Annotated[str | None, typer.Option(help="With --engine dask: its address, or its scheduler file.")] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Remove a former run in the directory first.")] = False,
    override: Overrides = None,
) -> None:
    """Fly a campaign, or what is left of it; the last line on stdout is the run directory."""
    from testbed.core.catalogue import aircraft_beside

    with bad_input(), aircraft_beside(file.parent):
        from testbed.run import progress, runner
        from testbed.run.engines import EngineLostError, usable_cores

        overrides = tuple(override or ())
        try:
            with progress.progress() as show:
                order = runner.Order(
                    source=file,
                    out=out,
                    overrides=overrides,
                    engine=_engine(engine, workers or usable_cores(), scheduler),
                    fresh=fresh,
                    command=("testbed", *sys.argv[1:]),
                    progress=show,
                )
                summary = runner.run(order)
        except (KeyboardInterrupt, EngineLostError) as why:
            resume = _without_fresh(sys.argv[1:])
            fail(f"{str(why) or 'interrupted'}; what was flown is kept. To go on:\n  testbed {shlex.join(resume)}", INTERRUPTED)
    _summarise(summary)


def _engine(name: str, workers: int, scheduler: str | None) -> "Engine":
    from testbed.run.directory import BadInputError
    from testbed.run.engines import LocalEngine

    if name == "dask":
        from testbed.run.dask_engine import DaskEngine

        return DaskEngine(workers, scheduler)
    if scheduler is not None:
        raise BadInputError("--scheduler goes with --engine dask")
    return LocalEngine(workers)


def _without_fresh(arguments: list[str]) -> list[str]:
    return [argument for argument in arguments if argument != "--fresh"]


def _summarise(summary: "Summary") -> None:
    """What came out, on stderr; the run directory, on stdout; the exit code."""
    from testbed.show import words

    outcomes = words.outcomes(summary.outcomes)
    flown = sum(summary.outcomes.values())
    say(f"{flown} of {words.counted(summary.planned, 'flight')} ({summary.flown_now} flown now): {outcomes or 'none'}", sys.stderr)
    if summary.crashed:
        traceback = f"see 'traceback' in {summary.directory / 'rows.jsonl'}"
        say(f"{summary.crashed} crashed: {summary.first_crash.splitlines()[0]}; {traceback}", sys.stderr)
        if summary.plugins:
            say(f"  the fault may be in a file of the campaign's plug-ins: {', '.join(summary.plugins)}", sys.stderr)
    if summary.mixed_code:
        say("warning: the code changed during the run, so its flights may not be of one code; start again with --fresh", sys.stderr)
    for line in summary.checks:
        off = f"{line.measured:.6g} where {line.truth:.6g} is true: off by {line.off:.3g} of {line.tolerance:.3g} {line.unit}".rstrip()
        say(f"check {line.word}: {line.quantity}: {off}", sys.stderr)
    missed = sum(not line.passed for line in summary.checks)
    if missed:
        say(f"{missed} of {len(summary.checks)} checks missed", sys.stderr)
    say(str(summary.directory))
    raise typer.Exit(CRASHED if summary.crashed or missed else 0)


@app.command()
def validate(
    files: Annotated[list[Path], typer.Argument(metavar="FILE...", help="Campaigns.")],
    workers: Annotated[int | None, typer.Option(min=1, help="Worker processes of the run to come; default one per core.")] = None,
    no_estimate: Annotated[bool, typer.Option("--no-estimate", help="Fly nothing to see what the run will take.")] = False,
    override: Overrides = None,
) -> None:
    """Check campaigns, with the settings changed that are given; what each will take of disk and time, by a few flights flown to see."""
    with bad_input():
        from testbed.campaign import SpecError
        from testbed.core.catalogue import aircraft_beside
        from testbed.run import estimate
        from testbed.run.directory import BadInputError
        from testbed.run.engines import usable_cores
        from testbed.run.trial import load_tried

        bad = False
        for file in files:
            try:
                with aircraft_beside(file.parent):
                    campaign = load_tried(file, override or ())
                    counted = estimate.count(campaign)
                    say(f"{file}: {_counted(counted.flights, sum(counted.cells.values()))}")
                    for name in campaign.parts:
                        say(f"  {name}: {_counted(counted.flights_of[name], counted.cells[name])}")
                    if not no_estimate:
                        number = workers or usable_cores()
                        for line in estimate.told(counted, estimate.estimate(campaign, counted, number), number):
                            say(f"  {line}")
            except (SpecError, BadInputError) as problems:
                say(str(problems), sys.stderr)
                bad = True
    raise typer.Exit(BAD_INPUT if bad else 0)


def _counted(flights: int, cells: int) -> str:
    from testbed.show import words

    return f"{words.counted(flights, 'flight')} in {words.counted(cells, 'cell')}"


@app.command()
def report(directory: Annotated[Path, typer.Argument(metavar="DIR", help="A run directory.")]) -> None:
    """Write tables and page of a run again, without flying."""
    with bad_input():
        from testbed.run import runner

        summary = runner.report(directory)
    _summarise(summary)


@app.command()
def replay(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="A run directory.")],
    flight_id: Annotated[str, typer.Argument(help="Its beginning is enough.")],
    out: Annotated[Path | None, typer.Option(metavar="FILE.rrd", help="Default: DIR/recordings/FLIGHT_ID.rrd.")] = None,
) -> None:
    """Fly one flight of a run again, record it, and compare it with its row."""
    with bad_input():
        from testbed.run.replay import replay as fly_again

        again = fly_again(directory, flight_id, out)
    if again.differences:
        why = "" if again.same_code else " (code or package versions are not those of the run)"
        lines = "".join(f"\n  {line}" for line in again.differences)
        say(f"flight {again.flight_id} differs from its row in the run{why}:{lines}", sys.stderr)
    else:
        say(f"flight {again.flight_id}: metrics and events equal its row in the run", sys.stderr)
    say(str(again.recording))
    raise typer.Exit(CRASHED if again.differences else 0)


@app.command()
def init(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="A new folder, or one without files of these names.")],
    examples: Annotated[bool, typer.Option("--examples", help="The project's own campaigns too, to copy from: DIR/examples/.")] = False,
) -> None:
    """Begin a study of your own: write a first campaign, its schema for editors, and what to type next."""
    with bad_input():
        from testbed.run.init import begin_study

        for file in begin_study(directory, examples):
            say(str(file))
