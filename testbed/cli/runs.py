"""Commands about campaigns and their runs."""

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer
import typer.core
import typer.main

from testbed.cli import completing
from testbed.cli.completing import run_folder
from testbed.cli.ending import summarise
from testbed.cli.plain import examples
from testbed.cli.shell import BAD_INPUT, CRASHED, INTERRUPTED, app, bad_input, fail, say

if TYPE_CHECKING:
    from testbed.run.engines import Engine

Overrides = Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change a setting: dotted path, YAML value.")]
RunDirectory = Annotated[
    Path, typer.Argument(metavar="DIR", help="A run directory, or its name in reports/runs.", autocompletion=completing.runs)
]


@app.command(
    epilog=examples(
        "testbed run campaigns/smoke.yaml",
        "testbed run campaigns/smoke.yaml --fresh --workers 1 --out reports/runs/mine",
        "testbed run campaigns/paper_single.yaml --set air.wind='{kind: steady, speed_mps: 10, from_deg: 240}' --out reports/runs/windy",
        "testbed run campaigns/smoke.yaml --set replicates=20 --set sweep.plant.kind=[kinematic]",
    )
)
def run(
    file: Annotated[Path, typer.Argument(help="The campaign, a YAML file.")],
    out: Annotated[Path | None, typer.Option(help="Run directory; default reports/runs/NAME, by the campaign.")] = None,
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
                    writing=show.writing,
                )
                summary = runner.run(order)
        except (KeyboardInterrupt, EngineLostError) as why:
            resume = _without_fresh(sys.argv[1:])
            fail(f"{str(why) or 'interrupted'}; what was flown is kept. To go on:\n  testbed {shlex.join(resume)}", INTERRUPTED)
    summarise(summary)


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


@app.command(
    epilog=examples(
        "testbed validate campaigns/*.yaml --no-estimate   every problem of each, with file:line:column",
        "testbed validate campaigns/paper.yaml             and what its run will take of disk and time",
        "testbed validate campaigns/smoke.yaml --set replicates=1000 --workers 8",
    )
)
def validate(
    files: Annotated[list[Path], typer.Argument(metavar="FILE...", help="Campaigns, YAML files.")],
    workers: Annotated[int | None, typer.Option(min=1, help="Worker processes of the run to come; default one per core.")] = None,
    no_estimate: Annotated[bool, typer.Option("--no-estimate", help="Fly nothing to see what the run will take.")] = False,
    override: Overrides = None,
) -> None:
    """Check campaigns, with the settings changed that are given; what each will take of disk and time, by a few flights flown to see."""
    with bad_input():
        from testbed.campaign import SpecError
        from testbed.core.catalogue import aircraft_beside
        from testbed.run import estimate, power, stopping
        from testbed.run.directory import BadInputError
        from testbed.run.engines import usable_cores
        from testbed.run.trial import load_tried

        bad = False
        for file in files:
            try:
                with aircraft_beside(file.parent):
                    campaign = load_tried(file, override or ())
                    stopping.refuse(campaign)
                    counted = estimate.count(campaign)
                    say(f"{file}: {_counted(counted.flights, sum(counted.cells.values()))}")
                    for name in campaign.parts:
                        say(f"  {name}: {_counted(counted.flights_of[name], counted.cells[name])}")
                    for line in power.told(campaign):
                        say(f"  {line}")
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


@app.command(epilog=examples("testbed report reports/runs/smoke"))
def report(directory: RunDirectory) -> None:
    """Write tables and page of a run again, without flying."""
    with bad_input():
        from testbed.run import progress, runner

        summary = runner.report(run_folder(directory), progress.PlainLines().writing)
    summarise(summary)


@app.command(
    epilog=examples(
        "testbed replay smoke 3b1f                    the flight whose id begins so",
        "testbed replay reports/runs/smoke 3b1f --out again.rrd",
    )
)
def replay(
    directory: RunDirectory,
    flight_id: Annotated[str, typer.Argument(help="Its beginning is enough.", autocompletion=completing.flights)],
    out: Annotated[Path | None, typer.Option(metavar="FILE.rrd", help="Default: DIR/recordings/FLIGHT_ID.rrd.")] = None,
) -> None:
    """Fly one flight of a run again, record it, and compare it with its row."""
    with bad_input():
        from testbed.run.replay import replay as fly_again

        again = fly_again(run_folder(directory), flight_id, out)
    if again.differences:
        why = "" if again.same_code else " (code or package versions are not those of the run)"
        lines = "".join(f"\n  {line}" for line in again.differences)
        say(f"flight {again.flight_id} differs from its row in the run{why}:{lines}", sys.stderr)
    else:
        say(f"flight {again.flight_id}: metrics and events equal its row in the run", sys.stderr)
    say(str(again.recording))
    raise typer.Exit(CRASHED if again.differences else 0)


@app.command(
    epilog=examples("testbed init study/                          then: testbed run study/first.yaml", "testbed init study/ --examples")
)
def init(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="A new folder, or one without files of these names.")],
    examples: Annotated[bool, typer.Option("--examples", help="The project's own campaigns too, to copy from: DIR/examples/.")] = False,
) -> None:
    """Begin a study of your own: write a first campaign, its schema for editors, and what to type next."""
    with bad_input():
        from testbed.run.init import begin_study

        for file in begin_study(directory, examples):
            say(str(file))
