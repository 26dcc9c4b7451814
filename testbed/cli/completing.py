"""What the shell offers when the Tab key is pressed: aircraft, methods, runs and their flights. Whatever fails offers nothing."""

import re
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

import typer

_RUNS: Final = Path("reports/runs")  # as testbed.run.directory has it, which takes longer to import than a key press may
_ID = re.compile(rb'"flight_id":"([0-9a-f]{12})"')
MOST_FLIGHTS: Final = 200
OF_FAMILIES: Final = ("method", "guidance", "planner")


def _beginning(names: Iterable[str], incomplete: str) -> list[str]:
    return [name for name in names if name.startswith(incomplete)]


def _quiet(offered: Callable[[typer.Context, str], list[str]]) -> Callable[[typer.Context, str], list[str]]:
    """Nothing, where the answer cannot be had: a traceback would end up in the line that is being typed."""

    def offer(ctx: typer.Context, incomplete: str) -> list[str]:
        with suppress(Exception):
            return offered(ctx, incomplete)
        return []

    return offer


@_quiet
def aircraft(_ctx: typer.Context, incomplete: str) -> list[str]:
    """Names of aircraft."""
    from testbed.core.catalogue import aircraft_folders

    return _beginning(aircraft_folders(), incomplete)


@_quiet
def kinds(ctx: typer.Context, incomplete: str) -> list[str]:
    """Names of the parts of the family that was typed before."""
    from testbed.core import registry

    family = ctx.params.get("family")
    return _beginning(registry.names(family), incomplete) if family in OF_FAMILIES else []


@_quiet
def runs(_ctx: typer.Context, incomplete: str) -> list[str]:
    """Run directories: those of the folder where runs go, by path or by name, and those below the path that is being typed."""
    typed = Path(incomplete)
    roots = {_RUNS, typed if incomplete.endswith("/") else typed.parent} if "/" in incomplete else {_RUNS}
    found = sorted(str(one.parent) for root in roots for one in root.glob("*/manifest.json"))
    by_path = _beginning(found, incomplete)
    return by_path or _beginning((Path(one).name for one in found), incomplete)


@_quiet
def flights(ctx: typer.Context, incomplete: str) -> list[str]:
    """Flights of the run that was typed before: those with a recording, or any if there is none."""
    folder = run_folder(Path(_params(ctx)["directory"]))
    recorded = sorted(file.stem for file in folder.glob("recordings/*.rrd"))
    with (folder / "plan.json").open("rb") as plan:
        every = recorded or [
            found.group(1).decode() for line, _ in zip(plan, range(MOST_FLIGHTS), strict=False) if (found := _ID.search(line))
        ]
    return _beginning(every, incomplete)


def _params(ctx: typer.Context) -> dict[str, Any]:
    return dict(ctx.params)


def run_folder(given: Path) -> Path:
    """The run that is meant: a folder, or the name of one where runs go."""
    by_name = _RUNS / given
    return by_name if not given.exists() and given.parent == Path() and by_name.is_dir() else given
