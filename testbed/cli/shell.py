"""The command itself: its options, how it speaks, and how what goes wrong becomes an exit code.

0: all ran. 1: some flight crashed, a check was missed, or a replay differs. 2: bad input. 130: interrupted, or a cluster was lost.
"""

import contextlib
import errno
import functools
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer
import typer.main

from testbed.cli.plain import PlainGroup, PlainTyper, examples
from testbed.cli.streams import UnsaidError, say


class _WithPlugged(PlainGroup):
    """The commands below, and those that are plugged in, which are looked for only where no other has the name."""

    def list_commands(self, ctx: typer.Context) -> list[str]:  # type: ignore[override]
        from testbed.core import registry

        return list(dict.fromkeys([*super().list_commands(ctx), *registry.names("command")]))

    def get_command(self, ctx: typer.Context, cmd_name: str) -> Any:  # type: ignore[override]
        from testbed.core import plugins, registry

        if (own := super().get_command(ctx, cmd_name)) is not None:
            return own
        with contextlib.suppress(registry.UnknownPartError, plugins.PluginError):
            command = registry.part("command", cmd_name)
            plugged = PlainTyper(pretty_exceptions_enable=False, add_completion=False)
            said = getattr(command, "examples", ())
            plugged.command(cmd_name, epilog=examples(*said) if said else None)(_printing(command))
            return typer.main.get_command(plugged)
        return None


def _printing(command: Callable[..., Iterable[str]]) -> Callable[..., None]:
    """A command that is plugged in, with its lines printed, and its bad input told like everybody's."""

    @functools.wraps(command)
    def call(*arguments: Any, **options: Any) -> None:
        with bad_input():
            for line in command(*arguments, **options):
                say(line)

    return call


app = PlainTyper(
    cls=_WithPlugged,
    pretty_exceptions_enable=False,
    no_args_is_help=True,
    help="Fly avoidance campaigns and look at what came out.",
    epilog=examples(
        "testbed run campaigns/smoke.yaml              fly a campaign",
        "testbed open reports/runs/smoke               look at its page",
        "testbed compare reports/runs/A reports/runs/B what differs between two runs",
        "testbed COMMAND --help                        more of each, with examples",
    ),
)

CRASHED, BAD_INPUT, INTERRUPTED = 1, 2, 130


def told(problem: OSError) -> str:
    """What the system says of which file."""
    if problem.filename is None and problem.errno == errno.ENOENT and not _has_current_folder():
        return "the current folder was removed: change to another"
    return ": ".join(str(part) for part in (problem.filename, problem.strerror or problem) if part is not None)


def _has_current_folder() -> bool:
    try:
        os.getcwd()
    except OSError:
        return False
    return True


def fail(text: str, code: int = BAD_INPUT) -> NoReturn:
    """Say what is wrong, and exit."""
    say(text, sys.stderr)
    raise typer.Exit(code)


@contextlib.contextmanager
def bad_input() -> Iterator[None]:
    """Say what is wrong with the input, without a traceback."""
    from testbed.campaign import SpecError
    from testbed.run.directory import BadInputError
    from testbed.run.engines import EngineError

    try:
        yield
    except (SpecError, BadInputError, EngineError) as problem:
        fail(str(problem))
    except UnsaidError as problem:
        fail(str(problem), CRASHED)
    except OSError as problem:  # a disk that is full, a folder that is read-only
        fail(told(problem))


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        say(f"testbed {version('vosc-testbed')}")
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
        with bad_input():
            for root in aircraft_path:
                try:
                    add_aircraft_path(root)
                except FileNotFoundError as problem:
                    fail(str(problem))
