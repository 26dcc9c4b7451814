"""The command line: parses, calls one function, turns what can go wrong into exit codes.

0: all ran. 1: some flight crashed, a check was missed, or a replay differs. 2: bad input. 130: interrupted.
"""

import contextlib
import functools
import os
import shlex
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NoReturn, TextIO

import typer
import typer.core
import typer.main

if TYPE_CHECKING:
    from testbed.campaign import FlightPlan
    from testbed.run.engines import Engine
    from testbed.run.runner import Summary


class _WithPlugged(typer.core.TyperGroup):
    """The commands below, and those that are plugged in, which are looked for only where no other has the name."""

    def list_commands(self, ctx: typer.Context) -> list[str]:  # type: ignore[override]
        from testbed.core import registry

        return list(dict.fromkeys([*super().list_commands(ctx), *registry.names("command")]))

    def get_command(self, ctx: typer.Context, cmd_name: str) -> Any:  # type: ignore[override]
        from testbed.core import plugins, registry

        if (own := super().get_command(ctx, cmd_name)) is not None:
            return own
        with contextlib.suppress(registry.UnknownPartError, plugins.PluginError):
            plugged = typer.Typer(pretty_exceptions_enable=False, add_completion=False)
            plugged.command(cmd_name)(_printing(registry.part("command", cmd_name)))
            return typer.main.get_command(plugged)
        return None


def _printing(command: Callable[..., Iterable[str]]) -> Callable[..., None]:
    """A command that is plugged in, with its lines printed, and its bad input told like everybody's."""

    @functools.wraps(command)
    def call(*arguments: Any, **options: Any) -> None:
        with _bad_input():
            for line in command(*arguments, **options):
                _say(line)

    return call


app = typer.Typer(
    cls=_WithPlugged, pretty_exceptions_enable=False, no_args_is_help=True, help="Fly avoidance campaigns and look at what came out."
)

CRASHED, BAD_INPUT, INTERRUPTED = 1, 2, 130


def main() -> None:
    """Entry point of the ``testbed`` command."""
    app()


def _say(text: str, stream: TextIO | None = None) -> None:
    """Print; a reader that has gone away (``| head``) is no reason to fail."""
    stream = stream or sys.stdout
    try:
        print(text, file=stream, flush=True)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _fail(text: str, code: int = BAD_INPUT) -> NoReturn:
    _say(text, sys.stderr)
    raise typer.Exit(code)


@contextlib.contextmanager
def _bad_input() -> Iterator[None]:
    """Say what is wrong with the input, without a traceback."""
    from testbed.campaign import SpecError
    from testbed.run.directory import BadInputError
    from testbed.run.engines import EngineError

    try:
        yield
    except (SpecError, BadInputError, EngineError) as problem:
        _fail(str(problem))
    except OSError as problem:  # a disk that is full, a folder that is read-only
        _fail(": ".join(str(part) for part in (problem.filename, problem.strerror or problem) if part is not None))


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        _say(f"testbed {version('vosc-testbed')}")
        raise typer.Exit


@app.callback()
def _options(
    context: typer.Context,
    _: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")] = False,
    aircraft_path: Annotated[
        list[Path] | None, typer.Option(metavar="DIR", help="Look for aircraft here too: folders with an aircraft.yaml in them.")
    ] = None,
) -> None:
    from testbed.core.catalogue import add_aircraft_path, aircraft_beside

    context.with_resource(aircraft_beside(Path()))
    if aircraft_path:
        with _bad_input():
            for root in aircraft_path:
                try:
                    add_aircraft_path(root)
                except FileNotFoundError as problem:
                    _fail(str(problem))


@app.command()
def run(
    file: Annotated[Path, typer.Argument(help="The campaign, a YAML file.")],
    out: Annotated[Path | None, typer.Option(help="Run directory; default reports/runs/<name>.")] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Worker processes; default one per core.")] = None,
    engine: Annotated[Literal["local", "dask"], typer.Option(help="Where flights are flown.")] = "local",
    scheduler: Annotated[str | None, typer.Option(help="With --engine dask: its address, or its scheduler file.")] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Remove a former run in the directory first.")] = False,
    override: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change a setting: dotted path, YAML value.")
    ] = None,
) -> None:
    """Fly a campaign, or what is left of it; the last line on stdout is the run directory."""
    from testbed.core.catalogue import aircraft_beside

    with _bad_input(), aircraft_beside(file.parent):
        from testbed.run import progress, runner
        from testbed.run.engines import usable_cores

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
        except KeyboardInterrupt:
            resume = _without_fresh(sys.argv[1:])
            _fail(f"interrupted; what was flown is kept. To go on:\n  testbed {shlex.join(resume)}", INTERRUPTED)
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
    _say(f"{flown} of {summary.planned} flights ({summary.flown_now} flown now): {outcomes or 'none'}", sys.stderr)
    if summary.crashed:
        _say(
            f"{summary.crashed} crashed: the program failed to fly them; see 'traceback' in {summary.directory / 'rows.jsonl'}", sys.stderr
        )
    if summary.mixed_code:
        _say("warning: the code changed during the run, so its flights may not be of one code; start again with --fresh", sys.stderr)
    for line in summary.checks:
        off = f"{line.measured:.6g} where {line.truth:.6g} is true: off by {line.off:.3g} of {line.tolerance:.3g} {line.unit}".rstrip()
        _say(f"check {line.word}: {line.quantity}: {off}", sys.stderr)
    missed = sum(not line.passed for line in summary.checks)
    if missed:
        _say(f"{missed} of {len(summary.checks)} checks missed", sys.stderr)
    _say(str(summary.directory))
    raise typer.Exit(CRASHED if summary.crashed or missed else 0)


@app.command()
def validate(files: Annotated[list[Path], typer.Argument(metavar="FILE...", help="Campaigns.")]) -> None:
    """Check campaigns without flying them."""
    with _bad_input():
        from testbed.campaign import SpecError, expand, load_campaign
        from testbed.campaign.words.grid import PART
        from testbed.core.catalogue import aircraft_beside

        bad = False
        for file in files:
            try:
                with aircraft_beside(file.parent):
                    campaign = load_campaign(file)
                    plans = expand(campaign)
            except SpecError as problems:
                _say(str(problems), sys.stderr)
                bad = True
            else:
                _say(f"{file}: {_counted(plans)}")
                for name in campaign.parts:
                    _say(f"  {name}: {_counted([plan for plan in plans if plan.labels[PART] == name])}")
    raise typer.Exit(BAD_INPUT if bad else 0)


def _counted(plans: "Sequence[FlightPlan]") -> str:
    return f"{len(plans)} flights in {len({plan.cell for plan in plans})} cells"


@app.command()
def report(directory: Annotated[Path, typer.Argument(metavar="DIR", help="A run directory.")]) -> None:
    """Write tables and page of a run again, without flying."""
    with _bad_input():
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
    with _bad_input():
        from testbed.run.replay import replay as fly_again

        again = fly_again(directory, flight_id, out)
    if again.differences:
        why = "" if again.same_code else " (code or package versions are not those of the run)"
        lines = "".join(f"\n  {line}" for line in again.differences)
        _say(f"flight {again.flight_id} differs from its row in the run{why}:{lines}", sys.stderr)
    else:
        _say(f"flight {again.flight_id}: metrics and events equal its row in the run", sys.stderr)
    _say(str(again.recording))
    raise typer.Exit(CRASHED if again.differences else 0)


@app.command()
def init(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="A new folder, or one without files of these names.")],
    examples: Annotated[bool, typer.Option("--examples", help="The project's own campaigns too, to copy from: DIR/examples/.")] = False,
) -> None:
    """Begin a study of your own: write a first campaign, its schema for editors, and what to type next."""
    with _bad_input():
        from testbed.run.init import begin_study

        for file in begin_study(directory, examples):
            _say(str(file))


@app.command()
def schema() -> None:
    """Print the JSON Schema of a campaign, for editors."""
    from testbed.campaign import schema as campaign_schema

    _say(campaign_schema().rstrip("\n"))


@app.command("list")
def list_parts(
    what: Annotated[Literal["aircraft", "methods", "planners", "guidance", "plants", "sensors", "traffic"] | None, typer.Argument()] = None,
) -> None:
    """What a campaign can name: one name a line, or everything."""
    from testbed.core import registry
    from testbed.core.catalogue import aircraft_folders

    parts: dict[str, list[str]] = {"aircraft": list(aircraft_folders())}
    parts |= {family.plural: registry.names(family.name) for family in registry.FAMILIES.values() if family.name != "study"}
    _say("\n".join(parts[what]) if what else "\n".join(f"{kind + ':':10} {', '.join(names)}" for kind, names in parts.items()))


@app.command()
def check(
    family: Annotated[Literal["method", "guidance", "planner"], typer.Argument(metavar="FAMILY", help="method, guidance or planner.")],
    kind: Annotated[str, typer.Argument(help="A name, or FILE:NAME in a file of your own: tangent:avoid is avoid in ./tangent.py.")],
    option: Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="An option of the part, YAML value.")] = None,
) -> None:
    """Try what a part promises, and say in words what it breaks; exit 1 when it breaks anything."""
    with _bad_input():
        from testbed.contracts.check import CheckError, given_options
        from testbed.contracts.check import check as tried

        try:
            promised, lines = tried(family, kind, given_options(option or ()))
        except CheckError as problem:
            _fail(str(problem))
    for line in lines:
        _say(line)
    raise typer.Exit(0 if promised else CRASHED)


@app.command()
def bench() -> None:
    """Time a flight against the bare stepping of its plant, side by side."""
    from testbed.run.bench import bench as measure

    _say(measure())


@app.command()
def tune(
    name: Annotated[str, typer.Argument(metavar="AIRCRAFT")],
    write: Annotated[bool, typer.Option("--write/--dry-run", help="Write the gains that were found into aircraft.yaml.")] = True,
    accept: Annotated[bool, typer.Option("--accept", help="Take the best gains even if none pass, and write what they missed.")] = False,
) -> None:
    """Find an aircraft's gains: linearise, place the loops, identify the lags, verify in steps; slower ones where that fails."""
    with _bad_input():
        _need_aircraft(name)
        if write:
            _refuse_installed(name)
        from testbed.airframe.tune import TuneFailedError
        from testbed.airframe.tune import tune as find

        try:
            _say(find(name, write, accept))
        except TuneFailedError as problem:
            _fail(str(problem), CRASHED)


class _DataSheetFirst(typer.core.TyperGroup):
    """``aircraft NAME`` is short for ``aircraft sheet NAME``."""

    def resolve_command(self, ctx, args):  # type: ignore[no-untyped-def]
        if args and args[0] not in self.commands:
            args = ["sheet", *args]
        return super().resolve_command(ctx, args)


aircraft = typer.Typer(cls=_DataSheetFirst, no_args_is_help=True, help="An aircraft's data sheet (`aircraft NAME`), or a new aircraft.")
app.add_typer(aircraft, name="aircraft")


@aircraft.command()
def sheet(
    name: Annotated[str, typer.Argument(metavar="NAME")],
    out: Annotated[Path, typer.Option(help="Where the page goes.")] = Path("reports/runs/aircraft"),
) -> None:
    """Write an aircraft's data sheet: trims, limits, modes, step responses. `aircraft NAME` does the same."""
    with _bad_input():
        _need_aircraft(name)
        from testbed.airframe.data_sheet import write_data_sheet
        from testbed.flight.plants.base import TrimFailedError

        try:
            _say(str(write_data_sheet(name, out)))
        except TrimFailedError as problem:
            _fail(f"{name}: {problem}", CRASHED)


@aircraft.command()
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="What the aircraft is to be called here.")],
    wheel: Annotated[str | None, typer.Option(metavar="MODEL", help="An aircraft that JSBSim's wheel ships.")] = None,
    path: Annotated[Path | None, typer.Option(metavar="PATH", help="Or a JSBSim file of yours, or its folder.")] = None,
    speed: Annotated[float | None, typer.Option(metavar="MPS", help="Reference airspeed; default: picked from the trims.")] = None,
    out: Annotated[Path | None, typer.Option(metavar="DIR", help="Folder of aircraft to write into; default the project's.")] = None,
) -> None:
    """Write the aircraft.yaml of a JSBSim model: trims, limits, every number marked by where it is from. `tune` finds its gains."""
    with _bad_input():
        from testbed.airframe.new import NewAircraftError, add_aircraft

        try:
            _say(add_aircraft(name, wheel, path, speed, out))
        except NewAircraftError as problem:
            _fail(str(problem))


def _need_aircraft(name: str) -> None:
    from testbed.core.catalogue import aircraft_folders

    if name not in (known := aircraft_folders()):
        _fail(f"no aircraft '{name}'; there are: {', '.join(known) or 'none'} (`testbed --aircraft-path DIR` looks elsewhere too)")


def _refuse_installed(name: str) -> None:
    from testbed.core.catalogue import aircraft_folders, is_installed

    if is_installed(folder := aircraft_folders()[name]):
        _fail(f"{name} belongs to the installed package, which is not written to: copy {folder} to aircraft/{name}, or take --dry-run")
