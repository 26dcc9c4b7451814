"""What a campaign can plug in, by name: built in, installed with another package, or in a file of the user's own.

A *family* is a plug point: methods, planners, guidance, plants, sensors, trackers, traffic, studies. What it has built in stands in one
table beside the parts (``vosc.methods.METHODS``, ``testbed.flight.plants.PLANTS``, ...), each line a name and the part or its
``"module:attribute"``, which is imported on first use. An installed distribution adds names by an entry point of the group
``testbed.<plural>``. A campaign adds files by ``plugins: [./tangent.py]`` and names what is in them ``"tangent:avoid"``.

A part is a callable. The testbed gives it its first parameters (``given``); the others are the options that a campaign may set.
"""

from __future__ import annotations

import importlib
import inspect
from collections import ChainMap
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from typing import Any

from testbed.core import plugins
from testbed.core.utf8 import reason

PACKAGE = "=="
"""Ends the name of a distribution among the origins of parts; a plug-in's file has no such name."""


@dataclass(frozen=True)
class Family:
    """One plug point. ``tables`` is where its built-in parts stand; ``given`` how many parameters of a part are no options.

    ``given_to_class`` is the same for a part that is a class, where that differs.
    """

    name: str
    plural: str
    tables: tuple[str, ...]
    given: int
    given_to_class: int | None = None

    @property
    def group(self) -> str:
        """Its entry points."""
        return f"testbed.{self.plural}"


METHOD_TABLES = ("vosc.methods:METHODS", "testbed.flight.laws:LAWS")
"""Directions, and laws over time."""
PLANNER_TABLES = ("testbed.flight.planning:PLANNERS", "testbed.flight.paths:PATHS")
"""Those that ask a method or predict the aircraft, and searches for a path in space and time."""

FAMILIES: dict[str, Family] = {
    family.name: family
    for family in (
        Family("method", "methods", METHOD_TABLES, given=2, given_to_class=0),  # own, obstacles; a law over time
        Family("planner", "planners", PLANNER_TABLES, given=0),
        Family("guidance", "guidance", ("testbed.flight.guidance:GUIDANCE",), given=1),  # its setting: aircraft, speed, step
        Family("plant", "plants", ("testbed.flight.plants:PLANTS",), given=1),  # its setting: aircraft, start, scene, rates
        Family("sensor", "sensors", ("testbed.flight.sensing:SENSORS",), given=0),
        Family("tracker", "trackers", ("testbed.flight.tracking:TRACKERS",), given=0),
        Family("traffic", "traffic", ("testbed.flight.traffic:TRACKS",), given=1),  # the obstacle's setting
        Family("study", "studies", ("testbed.studies:STUDIES",), given=0),
        Family("command", "commands", ("testbed.studies:COMMANDS",), given=0),  # of `testbed`; what it returns are lines to print
    )
}


class UnknownPartError(ValueError):
    """No part has that name; ``known`` lists those there are."""

    def __init__(self, family: Family, kind: str, known: list[str]) -> None:
        self.family, self.kind, self.known = family, kind, known
        super().__init__(f"no {family.name} '{kind}'; there are: {', '.join(known)}")


def given(family: str, found: Any) -> int:
    """How many leading parameters of a part the testbed gives it; the others are its options."""
    of = FAMILIES[family]
    return of.given_to_class if of.given_to_class is not None and inspect.isclass(found) else of.given


def names(family: str) -> list[str]:
    """Every name that needs no file: built in first, then installed."""
    return list(dict.fromkeys([*_built_in(family), *_installed(family)]))


def part(family: str, kind: str, pinned: Mapping[str, str] | None = None) -> Any:
    """The part of that name. ``pinned``: plug-in to the hash of the file it must come from (a plan's); default: the one added last.

    Raises ``UnknownPartError``; ``plugins.PluginError`` when it is in a file that does not work.
    """
    if ":" in kind:
        file, _, attribute = kind.partition(":")
        return plugins.attribute(file, attribute, (pinned or {}).get(file))
    if kind in (table := _built_in(family)):
        return _imported(table[kind]) if isinstance(table[kind], str) else table[kind]
    if kind in (installed := _installed(family)):
        try:
            return installed[kind].load()
        except Exception as bug:
            raise plugins.PluginError(f"'{kind}' of {_whose(installed[kind])} cannot be imported: {reason(bug)}") from bug
    raise UnknownPartError(FAMILIES[family], kind, names(family))


def origins(kinds: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Of parts (family, kind) that are not built in: plug-in file to its SHA-256, distribution to its version. In order of their names."""
    found = {}
    for family, kind in kinds:
        if ":" in kind:
            file = kind.partition(":")[0]
            found[file] = plugins.sha256_of(file)
        elif kind not in _built_in(family) and kind in (installed := _installed(family)):
            dist = installed[kind].dist
            if dist is not None:
                found[f"{dist.name}{PACKAGE}"] = dist.version
    return dict(sorted(found.items()))


@cache
def once_said() -> Mapping[str, Any]:
    """What studies had a plan of an ordinary flight say in former versions, so that its id is that of before."""
    said: Mapping[str, Any] = _imported("testbed.studies:ONCE_SAID")
    return said


@cache
def _built_in(family: str) -> Mapping[str, Any]:
    return ChainMap(*(_imported(table) for table in reversed(FAMILIES[family].tables)))  # which lists the last of its maps first


@cache
def _installed(family: str) -> Mapping[str, metadata.EntryPoint]:
    return {entry.name: entry for entry in metadata.entry_points(group=FAMILIES[family].group)}


def _whose(entry: metadata.EntryPoint) -> str:
    return f"the installed package {entry.dist.name}" if entry.dist else "an installed package"


def _imported(place: str) -> Any:
    module, _, attribute = place.partition(":")
    return getattr(importlib.import_module(module), attribute)
