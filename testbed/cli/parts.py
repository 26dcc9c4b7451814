"""Commands about what a campaign can name."""

from pathlib import Path
from typing import Annotated, Literal

import typer
import typer.core
import typer.main

from testbed.cli import completing
from testbed.cli.plain import examples
from testbed.cli.shell import CRASHED, app, bad_input, fail, say


@app.command(epilog=examples("testbed schema > campaigns/campaign.schema.json"))
def schema() -> None:
    """Print the JSON Schema of a campaign, for editors."""
    from testbed.campaign import schema as campaign_schema

    say(campaign_schema().rstrip("\n"))


@app.command("list", epilog=examples("testbed list", "testbed list methods", "testbed list aircraft"))
def list_parts(
    what: Annotated[
        Literal["aircraft", "methods", "planners", "guidance", "plants", "sensors", "trackers", "traffic", "studies"] | None,
        typer.Argument(help="aircraft, methods, planners, guidance, plants, sensors, trackers, traffic or studies; default all of them."),
    ] = None,
) -> None:
    """What a campaign can name: one name a line, or everything."""
    from testbed.core import registry
    from testbed.core.catalogue import aircraft_folders

    parts: dict[str, list[str]] = {"aircraft": list(aircraft_folders())}
    parts |= {family.plural: registry.names(family.name) for family in registry.FAMILIES.values()}
    say("\n".join(parts[what]) if what else "\n".join(f"{kind + ':':10} {', '.join(names)}" for kind, names in parts.items()))


@app.command(
    epilog=examples(
        "testbed check method scoam",
        "testbed check method tangent:avoid --set side=left     avoid in ./tangent.py, with an option",
        "testbed check guidance look_ahead",
    )
)
def check(
    family: Annotated[Literal["method", "guidance", "planner"], typer.Argument(metavar="FAMILY", help="method, guidance or planner.")],
    kind: Annotated[
        str,
        typer.Argument(
            help="A name, or FILE:NAME in a file of your own: tangent:avoid is avoid in ./tangent.py.", autocompletion=completing.kinds
        ),
    ],
    option: Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="An option of the part, YAML value.")] = None,
) -> None:
    """Try what a part promises, and say in words what it breaks; exit 1 when it breaks anything."""
    with bad_input():
        from testbed.contracts.check import CheckError, given_options
        from testbed.contracts.check import check as tried

        try:
            promised, lines = tried(family, kind, given_options(option or ()))
        except CheckError as problem:
            fail(str(problem))
    for line in lines:
        say(line)
    raise typer.Exit(0 if promised else CRASHED)


@app.command(epilog=examples("testbed bench", "testbed bench --pairs 5 --history bench.csv"))
def bench(
    history: Annotated[Path, typer.Option(help="CSV to which this run is added, and whose last runs are shown beside it.")] = Path(
        "reports/bench_history.csv"
    ),
    pairs: Annotated[int, typer.Option(min=1, help="Flights of each case, each with its physics alone.")] = 21,
) -> None:
    """Time flights of every plant and air against the physics alone, side by side, and say what has become dearer."""
    from testbed.run import bench_history
    from testbed.run.bench import bench as measure

    with bad_input():
        try:
            before = bench_history.read(history)
        except (OSError, ValueError) as problem:
            fail(str(problem))
    table, figures = measure(pairs)
    say(table)
    now = bench_history.today(figures)
    say(bench_history.beside(before, now))
    bench_history.append(history, now)
