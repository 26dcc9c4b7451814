"""A campaign's grid: axes, cells, replicates, and the identity of each flight."""

import hashlib
import itertools
import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from testbed.spec.document import Assignment, Document, Fault, NoSuchObstacleError, faults, faults_of
from testbed.spec.model import Campaign, FlightPlan, FlightSettings, Vary
from testbed.spec.nodes import Tree
from testbed.spec.problems import NOWHERE, Problem, SpecError, Spot
from testbed.spec.vocabulary import path_fault

MAX_FLIGHTS = 1_000_000
MAX_AXES = 50
MAX_LABEL = 40
ONLY_CELL = "base"
"""Name of the one cell of a campaign without a sweep."""


@dataclass(frozen=True)
class Level:
    """One value of an axis: its label and what it assigns."""

    label: str
    assignments: tuple[Assignment, ...]


@dataclass(frozen=True)
class Axis:
    """One axis of the sweep, with the place of its key."""

    name: str
    levels: tuple[Level, ...]
    spot: Spot


Cell = tuple[Level, ...]


def expand(campaign: Campaign) -> tuple[FlightPlan, ...]:
    """Every flight of a campaign: cells in the order of the sweep as written (last axis fastest), replicates innermost."""
    axes, problems = axes_of(Tree.plain(campaign.sweep))
    problems = problems or size_problems(axes, campaign.replicates, NOWHERE)
    if problems:
        raise SpecError(problems)
    plans: list[FlightPlan] = []
    for cell, document, plan in _plans_of_cells(campaign, axes, Tree({})):
        if not isinstance(plan, FlightPlan):
            raise SpecError(found for fault in plan if (found := document.problem(fault, _assignments(cell))))
        plans.extend(_replicates(plan, campaign.replicates))
    return tuple(plans)


def flight_id(plan: FlightPlan) -> str:
    """12 hexadecimal digits that stand for everything that the flight depends on, its cell and its replicate.

    The campaign's name is left out: renaming a campaign changes no flight.
    """
    return _hash(_identity(plan))


def _identity(plan: FlightPlan) -> dict[str, Any]:
    # a flight that varies nothing is the flight it was before there was anything to vary
    unsaid = {"vary"} if plan.vary == Vary() else set()
    return plan.model_dump(mode="json", exclude={"flight_id", "campaign"} | unsaid)


def _hash(identity: dict[str, Any]) -> str:
    canonical = json.dumps(identity, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(canonical.encode()).hexdigest()[:12]


def _replicates(plan: FlightPlan, count: int) -> Iterator[FlightPlan]:
    """Copies that share their (frozen) sections."""
    identity = _identity(plan)
    for replicate in range(count):
        identity["replicate"] = replicate
        yield plan.model_copy(update={"replicate": replicate, "flight_id": _hash(identity)})


def _cell_id(cell: Cell) -> str:
    return "/".join(level.label for level in cell) or ONLY_CELL


def _assignments(cell: Cell) -> list[Assignment]:
    return [assignment for level in cell for assignment in level.assignments]


def _plans_of_cells(campaign: Campaign, axes: Sequence[Axis], tree: Tree) -> Iterator[tuple[Cell, Document, FlightPlan | list[Fault]]]:
    """For each cell its plan (replicate 0, without an id), or what is wrong with the combination."""
    written = {name: getattr(campaign, name) for name in FlightSettings.model_fields if name in campaign.model_fields_set}
    base = Document(written, tree)
    for cell in itertools.product(*(axis.levels for axis in axes)):
        try:
            document = base.assign(_assignments(cell))
        except NoSuchObstacleError as error:
            at = ("obstacles",)
            yield cell, Document({}, tree, ((at, error.assignment),)), [Fault(at, error.message, error.hint)]
            continue
        who = {
            "flight_id": "",
            "campaign": campaign.name,
            "cell": _cell_id(cell),
            "labels": {axis.name: level.label for axis, level in zip(axes, cell, strict=True)},
            "replicate": 0,
            "seed": campaign.seed,
        }
        try:
            yield cell, document, FlightPlan.model_validate({**document.data, **who})
        except ValidationError as error:
            yield cell, document, faults_of(error)


def axes_of(sweep: Tree) -> tuple[list[Axis], list[Problem]]:
    """The axes of a sweep, and what is wrong with its shape and its paths (not yet with its values)."""
    axes: list[Axis] = []
    problems: list[Problem] = []
    if not isinstance(sweep.value, dict):
        return [], [Problem(sweep.spot, "sweep", "must be a section: one axis per key")]
    if len(sweep.inside) > MAX_AXES:
        return [], [Problem(sweep.spot, "sweep", f"has {len(sweep.inside)} axes; at most {MAX_AXES}")]
    for name, tree in sweep.inside.items():
        read = _list_axis if isinstance(tree.value, list | tuple) else _named_axis
        axis, found = read(str(name), tree, sweep.key_spot(name))
        axes.append(axis)
        problems += found
    return axes, problems + _hidden(axes)


def _list_axis(path: str, tree: Tree, spot: Spot) -> tuple[Axis, list[Problem]]:
    """``dotted.path: [values]``."""
    problems: list[Problem] = []
    levels: list[Level] = []
    if wrong := path_fault(path, FlightSettings):
        problems.append(Problem(spot, f"sweep.{path}", *wrong))
        return Axis(path, (), spot), problems
    if not tree.inside:
        problems.append(Problem(spot, f"sweep.{path}", "an axis without values makes no flights"))
    seen: set[str] = set()
    taken: set[str] = set()
    for i, item in tree.inside.items():
        name = f"sweep.{path}[{i}]"
        text = _text(item.value)
        if text in seen and not item.broken:
            problems.append(Problem(item.spot, name, "this value is there twice"))
        seen.add(text)
        label = _label(text, taken)
        taken.add(label)
        levels.append(Level(label, (Assignment(path, item, name, spot, item.spot),)))
    return Axis(path, tuple(levels), spot), problems


def _named_axis(axis: str, tree: Tree, spot: Spot) -> tuple[Axis, list[Problem]]:
    """``axis_name: {label: {dotted.path: value}}``."""
    where = f"sweep.{axis}"
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
        assignments: list[Assignment] = []
        for path, value in settings.inside.items():
            path_spot = settings.key_spot(path)
            name = f"{where}.{label}.{path}"
            if wrong := path_fault(str(path), FlightSettings):
                problems.append(Problem(path_spot, name, *wrong))
                continue
            own = path_spot if isinstance(value.value, dict) or value.value is None else value.spot
            assignments.append(Assignment(str(path), value, name, path_spot, own))
        levels.append(Level(label, tuple(assignments)))
    return Axis(axis, tuple(levels), spot), problems


def _hidden(axes: Sequence[Axis]) -> list[Problem]:
    """An axis whose values a later axis overwrites would make flights that differ in name only."""
    problems = []
    for earlier, later in itertools.combinations(axes, 2):
        paths = [{assignment.path: assignment for assignment in _assignments(axis.levels)}.values() for axis in (earlier, later)]
        for first, second in itertools.product(*paths):
            if f"{first.path}.".startswith(f"{second.path}."):
                message = f"overwrites '{first.path}', which the axis '{earlier.name}' sets"
                problems.append(Problem(second.path_spot, f"sweep.{later.name}", message))
                break
    return problems


def size_problems(axes: Sequence[Axis], replicates: int, spot: Spot) -> list[Problem]:
    """A refusal of a grid that nobody can mean."""
    flights = replicates * math.prod(len(axis.levels) for axis in axes)
    if flights <= MAX_FLIGHTS:
        return []
    return [Problem(spot, "sweep", f"makes {flights:,} flights; at most {MAX_FLIGHTS:,}")]


def level_problems(base: Document, known: Sequence[Fault], axes: Sequence[Axis]) -> list[Problem]:
    """What each value of each axis does wrong by itself, the base's own faults (``known``) apart."""
    problems: list[Problem] = []
    for level in (level for axis in axes for level in axis.levels):
        document = base
        for assignment in level.assignments:
            try:
                document = document.assign([assignment])
            except NoSuchObstacleError as error:
                problems.append(error.problem())
        new = [fault for fault in faults(document.data) if fault not in known]
        problems += [found for fault in new if (found := document.problem(fault, level.assignments))]
    return problems


def combination_problems(campaign: Campaign, tree: Tree, axes: Sequence[Axis]) -> list[Problem]:
    """What only goes wrong when the axes meet; each distinct fault once, with the first cell that has it."""
    problems: dict[Fault, Problem] = {}
    for cell, document, plan in _plans_of_cells(campaign, axes, tree):
        for fault in plan if isinstance(plan, list) else ():
            found = document.problem(fault, _assignments(cell)) if fault not in problems else None
            if found:
                problems[fault] = Problem(found.spot, found.path, f"{found.message} (in the cell '{_cell_id(cell)}')", found.hint)
    return list(problems.values())


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
