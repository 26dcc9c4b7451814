"""Help and complaints of the command in plain words: no name of a Python type, no word of a library's own, and examples to copy."""

from contextlib import suppress
from typing import Any

import typer
import typer.core

TYPE_NAMES = {"int": "NUMBER", "float": "NUMBER", "int range": "NUMBER", "float range": "NUMBER", "bool": "", "str": "TEXT"}
"""What an option takes, to what its help calls it; a switch takes nothing."""


def examples(*lines: str) -> str:
    """The end of a command's help: what one may type."""
    return "\n".join(["[bold]Examples[/bold]", *(f"  {line}".replace("[", "\\[") for line in lines)])


class _InPlainWords:
    """What a command and a group of commands do alike."""

    def get_params(self, ctx: Any) -> list[Any]:
        params: list[Any] = super().get_params(ctx)  # type: ignore[misc]
        for param in params:
            if param.param_type_name == "argument":
                param.metavar = param.metavar or param.name.upper()
                param.display_type_rich = _nothing  # its name and its help say it
            elif param.metavar is None:
                param.metavar = _type_name(param.display_type(ctx))
        return params

    def collect_usage_pieces(self, ctx: Any) -> list[str]:
        pieces: list[str] = super().collect_usage_pieces(ctx)  # type: ignore[misc]
        return [piece.replace("{", "").replace("}", "").replace("......", "...") for piece in pieces]

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        self.get_params(ctx)  # a complaint, too, calls them by these names
        try:
            parsed: list[str] = super().parse_args(ctx, args)  # type: ignore[misc]
        except typer.BadParameter as problem:
            problem.message = _reworded(problem)
            raise
        return parsed


def _nothing(ctx: Any) -> None:
    """The type of an argument, in its help."""


def _type_name(shown: str) -> str:
    """``<path>`` as ``PATH``, ``<local|dask>`` as ``local|dask``."""
    bare = shown.strip("<>")
    return TYPE_NAMES.get(bare, bare if "|" in bare else bare.upper())


def _reworded(problem: typer.BadParameter) -> str:
    """What is wrong with a value, as it is said of a value in a campaign."""
    from testbed.campaign.reading.error_words import unfit

    errors = getattr(problem.__cause__, "errors", None)
    if errors is None:
        return problem.message
    first = errors()[0]
    with suppress(ValueError, TypeError):  # what is typed is text, also where it is read as a number
        first["input"] = int(first["input"])
    return unfit(first, "")[0]


class PlainCommand(_InPlainWords, typer.core.TyperCommand):
    """A command."""


class PlainGroup(_InPlainWords, typer.core.TyperGroup):
    """A command with commands below it."""


class PlainTyper(typer.Typer):
    """Where commands are added, each a ``PlainCommand``."""

    def command(self, name: str | None = None, **settings: Any) -> Any:
        return super().command(name, **{"cls": PlainCommand, **settings})
