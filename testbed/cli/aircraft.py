"""Commands about aircraft."""

from pathlib import Path
from typing import Annotated, Literal

import typer
import typer.core
import typer.main

from testbed.cli import completing
from testbed.cli.plain import PlainGroup, PlainTyper, examples
from testbed.cli.shell import CRASHED, app, bad_input, fail, say


@app.command(epilog=examples("testbed tune gtm_t2 --dry-run", "testbed tune my_plane --accept"))
def tune(
    name: Annotated[str, typer.Argument(metavar="AIRCRAFT", help="Its name: `testbed list aircraft`.", autocompletion=completing.aircraft)],
    write: Annotated[bool, typer.Option("--write/--dry-run", help="Write the gains that were found into aircraft.yaml.")] = True,
    accept: Annotated[bool, typer.Option("--accept", help="Take the best gains even if none pass, and write what they missed.")] = False,
) -> None:
    """Find an aircraft's gains: linearise, place the loops, identify the lags, verify in steps; slower ones where that fails."""
    with bad_input():
        _need_aircraft(name)
        if write:
            _refuse_installed(name)
        from testbed.airframe.tune import TuneFailedError
        from testbed.airframe.tune import tune as find

        try:
            say(find(name, write, accept))
        except TuneFailedError as problem:
            fail(str(problem), CRASHED)


@app.command(epilog=examples("testbed identify gtm_t2", "testbed identify my_plane --air calm --encounters 100"))
def identify(
    name: Annotated[str, typer.Argument(metavar="AIRCRAFT", help="Its name: `testbed list aircraft`.", autocompletion=completing.aircraft)],
    air: Annotated[
        Literal["calm", "wind", "turbulence", "all"], typer.Option(help="Only this air; the margins of other air stay.")
    ] = "all",
    encounters: Annotated[int, typer.Option(metavar="N", help="Flights in each kind of air.")] = 200,
    seed: Annotated[int, typer.Option(min=0, help="Of the encounters.")] = 0,
) -> None:
    """Find how far flights differ from their predictions, for the planner `survivor`: into prediction.yaml beside aircraft.yaml."""
    with bad_input():
        _need_aircraft(name)
        _refuse_installed(name)
        from testbed.airframe.foresight import AIRS, IdentifyError
        from testbed.airframe.foresight import identify as find
        from testbed.flight.plants.base import TrimFailedError

        try:
            find(name, AIRS if air == "all" else (air,), encounters, seed, say)
        except (IdentifyError, TrimFailedError) as problem:
            fail(f"{name}: {problem}", CRASHED)


class _DataSheetFirst(PlainGroup):
    """``aircraft NAME`` is short for ``aircraft sheet NAME``."""

    def resolve_command(self, ctx, args):  # type: ignore[no-untyped-def]
        if args and args[0] not in self.commands:
            args = ["sheet", *args]
        return super().resolve_command(ctx, args)

    def shell_complete(self, ctx, incomplete):  # type: ignore[no-untyped-def]
        from typer._click.shell_completion import CompletionItem

        return [*super().shell_complete(ctx, incomplete), *map(CompletionItem, completing.aircraft(ctx, incomplete))]


aircraft = PlainTyper(
    cls=_DataSheetFirst,
    no_args_is_help=True,
    help="An aircraft's data sheet (`aircraft NAME`), or a new aircraft.",
    epilog=examples("testbed aircraft gtm_t2                      its data sheet", "testbed aircraft new my_plane --path my_plane.xml"),
)
app.add_typer(aircraft, name="aircraft")


@aircraft.command(epilog=examples("testbed aircraft gtm_t2", "testbed aircraft sheet c172p --out sheets"))
def sheet(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Its name: `testbed list aircraft`.", autocompletion=completing.aircraft)],
    out: Annotated[Path, typer.Option(help="Where the page goes.")] = Path("reports/runs/aircraft"),
) -> None:
    """Write an aircraft's data sheet: trims, limits, modes, step responses. `aircraft NAME` does the same."""
    with bad_input():
        _need_aircraft(name)
        from testbed.airframe.data_sheet import write_data_sheet
        from testbed.flight.plants.base import TrimFailedError

        try:
            say(str(write_data_sheet(name, out)))
        except TrimFailedError as problem:
            fail(f"{name}: {problem}", CRASHED)


@aircraft.command(
    epilog=examples(
        "testbed aircraft new cub --wheel J3Cub       a model that JSBSim brings along",
        "testbed aircraft new my_plane --path models/my_plane.xml --speed 40 --out aircraft/",
    )
)
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="What the aircraft is to be called here.")],
    wheel: Annotated[str | None, typer.Option(metavar="MODEL", help="An aircraft that JSBSim's wheel ships.")] = None,
    path: Annotated[Path | None, typer.Option(metavar="PATH", help="Or a JSBSim file of yours, or its folder.")] = None,
    speed: Annotated[float | None, typer.Option(metavar="MPS", help="Reference airspeed; default: picked from the trims.")] = None,
    out: Annotated[Path | None, typer.Option(metavar="DIR", help="Folder of aircraft to write into; default the project's.")] = None,
) -> None:
    """Write the aircraft.yaml of a JSBSim model: trims, limits, every number marked by where it is from. `tune` finds its gains."""
    with bad_input():
        from testbed.airframe.new import NewAircraftError, add_aircraft

        try:
            say(add_aircraft(name, wheel, path, speed, out))
        except NewAircraftError as problem:
            fail(str(problem))


def _need_aircraft(name: str) -> None:
    from testbed.core.catalogue import aircraft_folders

    if name not in (known := aircraft_folders()):
        fail(f"no aircraft '{name}'; there are: {', '.join(known) or 'none'} (`testbed --aircraft-path DIR` looks elsewhere too)")


def _refuse_installed(name: str) -> None:
    from testbed.core.catalogue import aircraft_folders, is_installed

    if is_installed(folder := aircraft_folders()[name]):
        fail(f"{name} belongs to the installed package, which is not written to: copy {folder} to aircraft/{name}, or take --dry-run")
