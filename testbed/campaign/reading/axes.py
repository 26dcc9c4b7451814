"""The axes of a sweep and the cells that are left out: read from the tree, with the place of each value."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from testbed.campaign.reading.document import Assignment
from testbed.campaign.reading.nodes import Tree
from testbed.campaign.reading.problems import NOWHERE, Problem, Spot, did_you_mean
from testbed.campaign.reading.vocabulary import path_fault
from testbed.campaign.words.settings import FlightSettings

MAX_AXES = 50
MAX_LABEL = 40


@dataclass(frozen=True)
class Level:
    """One value of an axis: its label, what it assigns, and where the label is written."""

    label: str
    assignments: tuple[Assignment, ...]
    spot: Spot = NOWHERE


@dataclass(frozen=True)
class Axis:
    """One axis of the sweep, with the place of its key."""

    name: str
    levels: tuple[Level, ...]
    spot: Spot


@dataclass(frozen=True)
class Skip:
    """Cells that are left out: axis to labels, all of which must match. An axis that is not named matches whatever its label."""

    labels: Mapping[str, frozenset[str]]
    spot: Spot
    name: str

    def matches(self, labels: Mapping[str, str]) -> bool:
        return all(labels[axis] in wanted for axis, wanted in self.labels.items())


def assignments_of(levels: Sequence[Level]) -> list[Assignment]:
    """What the levels assign, in order."""
    return [assignment for level in levels for assignment in level.assignments]


def axes_of(sweep: Tree, where: str = "sweep") -> tuple[list[Axis], list[Problem]]:
    """The axes of a sweep, and what is wrong with its shape and its paths (not yet with its values). ``where``: its name in messages."""
    axes: list[Axis] = []
    problems: list[Problem] = []
    if not isinstance(sweep.value, dict):
        return [], [Problem(sweep.spot, where, "must be a section: one axis per key")]
    if len(sweep.inside) > MAX_AXES:
        return [], [Problem(sweep.spot, where, f"has {len(sweep.inside)} axes; at most {MAX_AXES}")]
    for name, tree in sweep.inside.items():
        read = _list_axis if isinstance(tree.value, list | tuple) else _named_axis
        axis, found = read(str(name), tree, sweep.key_spot(name), f"{where}.{name}")
        axes.append(axis)
        problems += found
    return axes, problems + hidden(axes, where)


def _list_axis(path: str, tree: Tree, spot: Spot, where: str) -> tuple[Axis, list[Problem]]:
    """``dotted.path: [values]``."""
    problems: list[Problem] = []
    levels: list[Level] = []
    if wrong := path_fault(path, FlightSettings):
        problems.append(Problem(spot, where, *wrong))
        return Axis(path, (), spot), problems
    if not tree.inside:
        problems.append(Problem(spot, where, "an axis without values makes no flights"))
    seen: set[str] = set()
    taken: set[str] = set()
    for i, item in tree.inside.items():
        name = f"{where}[{i}]"
        text = _text(item.value)
        if text in seen and not item.broken:
            problems.append(Problem(item.spot, name, "this value is there twice"))
        seen.add(text)
        label = _label(text, taken)
        taken.add(label)
        levels.append(Level(label, (Assignment(path, item, name, spot, item.spot),), item.spot))
    return Axis(path, tuple(levels), spot), problems


def _named_axis(axis: str, tree: Tree, spot: Spot, where: str) -> tuple[Axis, list[Problem]]:
    """``axis_name: {label: {dotted.path: value}}``."""
    if tree.broken:
        return Axis(axis, (), spot), []
    if not isinstance(tree.value, dict) or not tree.value:
        return Axis(axis, (), spot), [Problem(spot, where, "must be a list of values, or a section of labels")]
    problems: list[Problem] = []
    levels: list[Level] = []
    for key, settings in tree.inside.items():
        label, label_spot = str(key), tree.key_spot(key)
        if not label or "/" in label or len(label) > MAX_LABEL or not label.isprintable():
            problems.append(Problem(label_spot, where, f"a label is a short text without '/', not '{label[:MAX_LABEL]}'"))
        if not isinstance(settings.value, dict):
            if not settings.broken:
                is_path = path_fault(f"{axis}.{label}", FlightSettings) is None
                hint = f"a path is one key: write '{axis}.{label}'" if is_path else "write {} for no change"
                problems.append(Problem(label_spot, f"{where}.{label}", "must be a section of dotted paths and their values", hint))
            continue
        assignments, found = settings_of(settings, f"{where}.{label}")
        problems += found
        levels.append(Level(label, tuple(assignments), label_spot))
    return Axis(axis, tuple(levels), spot), problems


def settings_of(settings: Tree, where: str) -> tuple[list[Assignment], list[Problem]]:
    """``{dotted.path: value}`` as assignments, and the paths that lead nowhere."""
    assignments: list[Assignment] = []
    problems: list[Problem] = []
    for path, value in settings.inside.items():
        path_spot = settings.key_spot(path)
        name = f"{where}.{path}"
        if wrong := path_fault(str(path), FlightSettings):
            problems.append(Problem(path_spot, name, *wrong))
            continue
        own = path_spot if isinstance(value.value, dict) or value.value is None else value.spot
        assignments.append(Assignment(str(path), value, name, path_spot, own))
    return assignments, problems


def hidden(axes: Sequence[Axis], where: str) -> list[Problem]:
    """An axis whose values a later axis overwrites would make flights that differ in name only."""
    problems = []
    for earlier, later in itertools.combinations(axes, 2):
        paths = [{assignment.path: assignment for assignment in assignments_of(axis.levels)}.values() for axis in (earlier, later)]
        for first, second in itertools.product(*paths):
            if f"{first.path}.".startswith(f"{second.path}."):
                message = f"overwrites '{first.path}', which the axis '{earlier.name}' sets"
                problems.append(Problem(second.path_spot, f"{where}.{later.name}", message))
                break
    return problems


def skips_of(tree: Tree, axes: Sequence[Axis], where: str) -> tuple[list[Skip], list[Problem]]:
    """The entries of a ``skip``, and those that name what the sweep does not have."""
    if not isinstance(tree.value, list | tuple):
        return [], [] if tree.broken else [Problem(tree.spot, where, "must be a list of sections {axis: label}")]
    skips: list[Skip] = []
    problems: list[Problem] = []
    labels_of = {axis.name: [level.label for level in axis.levels] for axis in axes}
    for i, entry in tree.inside.items():
        name = f"{where}[{i}]"
        if not isinstance(entry.value, dict) or not entry.value:
            message = "must be a section of axes, each with a label or a list of labels"
            problems += [] if entry.broken else [Problem(entry.spot, name, message)]
            continue
        wanted: dict[str, frozenset[str]] = {}
        for key, value in entry.inside.items():
            axis, spot = str(key), entry.key_spot(key)
            if axis not in labels_of:
                hint = did_you_mean(axis, labels_of) or (f"there are: {', '.join(labels_of)}" if labels_of else "there are none")
                problems.append(Problem(spot, f"{name}.{axis}", f"the sweep has no axis '{axis}'", hint))
                continue
            items = list(value.inside.values()) if isinstance(value.value, list | tuple) else [value]
            problems += [] if items else [Problem(spot, f"{name}.{axis}", "matches nothing: it lists no label")]
            for item in items:
                if labels_of[axis] and (label := _text(item.value)) not in labels_of[axis] and not item.broken:
                    hint = did_you_mean(label, labels_of[axis]) or f"there are: {', '.join(labels_of[axis])}"
                    problems.append(Problem(item.spot, f"{name}.{axis}", f"the axis '{axis}' has no label '{label[:MAX_LABEL]}'", hint))
            wanted[axis] = frozenset(_text(item.value) for item in items)
        skips.append(Skip(wanted, entry.spot, name))
    return skips, problems


def _text(value: Any) -> str:
    """A value as one line of text; numbers that are equal look equal."""
    if isinstance(value, dict):
        return ",".join(f"{key}={_text(item)}" for key, item in value.items())
    if isinstance(value, list | tuple):
        return f"[{','.join(map(_text, value))}]"
    if isinstance(value, bool) or value is None:
        return "null" if value is None else str(value).lower()
    if isinstance(value, int | float):
        return repr(float(value)).removesuffix(".0") if abs(value) < 1e300 else str(value)
    return str(value)


def _label(text: str, taken: set[str]) -> str:
    """A short label that no other value of the axis has; it holds no '/', which joins labels to a cell."""
    clean = "".join(character if character.isprintable() and character != "/" else "_" for character in text) or "_"
    if len(clean) <= MAX_LABEL and clean not in taken:
        return clean
    short = clean[: MAX_LABEL - 8]
    return next(label for n in itertools.count(1) if (label := f"{short}~{n}") not in taken)
