"""Settings with assignments on top: what ``--set`` and a sweep do, without losing where each value was written."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from pydantic import BaseModel, ValidationError

from testbed.campaign.reading.error_words import follows, of_unions, worded
from testbed.campaign.reading.nodes import Tree
from testbed.campaign.reading.problems import Problem, Spot, did_you_mean
from testbed.campaign.reading.vocabulary import Loc
from testbed.campaign.words.settings import Campaign
from testbed.campaign.words.study import spelt_out

MOST_FAULTS = 500
"""Errors of one validation that are put into words, which takes longer than finding them."""
UNKNOWN = ("extra_forbidden", "unknown_option")
"""Faults of a key rather than of what it leads to."""


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong with the data, wherever the data came from."""

    loc: Loc
    message: str
    hint: str = ""
    at_key: bool = False


@dataclass(frozen=True, eq=False)
class Assignment:
    """A value for a dotted path. ``name``: what messages call it; empty for ``--set``, which is its own place."""

    path: str
    tree: Tree
    name: str
    path_spot: Spot
    spot: Spot


class NoSuchObstacleError(Exception):
    """An assignment names an obstacle that the data does not have."""

    def __init__(self, assignment: Assignment, known: Sequence[str]) -> None:
        name = assignment.path.split(".")[1]
        self.assignment = assignment
        self.message = f"there is no obstacle '{name}'"
        self.hint = did_you_mean(name, known) or (f"there are: {', '.join(known)}" if known else "there are none")
        super().__init__(self.message)

    def problem(self) -> Problem:
        return Problem(self.assignment.path_spot, self.assignment.name, self.message, self.hint)


class _NoSuchNameError(Exception):
    """None of the items of a list has the name that a path asks for; the message is not for users."""

    def __init__(self, known: Sequence[str]) -> None:
        self.known = known
        super().__init__()


@dataclass(frozen=True)
class Document:
    """Plain data (or sections validated already), the tree it came from, and what was assigned later."""

    data: dict[str, Any]
    tree: Tree
    layers: tuple[tuple[Loc, Assignment], ...] = ()

    def assign(self, assignments: Sequence[Assignment]) -> "Document":
        """A copy with the assignments made in order. What a path leads to is replaced as a whole."""
        data, layers = self.data, list(self.layers)
        for assignment in assignments:
            try:
                data, loc = _put(data, assignment.path.split("."), assignment.tree.value)
            except _NoSuchNameError as error:
                raise NoSuchObstacleError(assignment, error.known) from error
            layers.append((loc, assignment))
        return replace(self, data=data, layers=tuple(layers))

    def with_obstacles(self, more: Sequence[dict[str, Any]]) -> "Document":
        """A copy with more obstacles, the last ones."""
        obstacles = self.data.get("obstacles", ())
        return replace(self, data={**self.data, "obstacles": [*(obstacles if isinstance(obstacles, list | tuple) else ()), *more]})

    def problem(self, fault: Fault, suspects: Sequence[Assignment] = ()) -> Problem | None:
        """The fault at its place; None if that place is known to be broken.

        A fault outside of what the suspects assign, but which only they can have caused, is shown at the nearest of them.
        """
        for loc, assignment in reversed(self.layers):
            if fault.loc[: len(loc)] == loc and not (suspects and assignment not in suspects):
                rest = fault.loc[len(loc) :]
                path = assignment.name + self._dotted(rest, assignment.tree.value, first=not assignment.name)
                if not assignment.name:
                    path = self._dotted(fault.loc, self.data) if rest else ""
                return _placed(fault, assignment.tree, rest, assignment.spot, path)
        path = self._dotted(fault.loc, self.data)
        if not suspects:
            return _placed(fault, self.tree, fault.loc, self.tree.spot, path)
        made = [(loc, assignment) for loc, assignment in self.layers if assignment in suspects]
        # Of several as near, one whose key the message names, then the last.
        _, nearest = max(reversed(made), key=lambda layer: (_common(layer[0], fault.loc), str(layer[0][-1]) in fault.message))
        return Problem(nearest.spot, nearest.name, f"{path}: {fault.message}" if path else fault.message, fault.hint)

    @staticmethod
    def _dotted(loc: Loc, value: Any, first: bool = True) -> str:
        """A location as users write it: obstacles by name, items of other lists by index."""
        text = ""
        for part in loc:
            item = value[part] if isinstance(value, list | tuple) and isinstance(part, int) and part < len(value) else None
            if isinstance(part, int) and not _name(item):
                text += f"[{part}]"
            else:
                text += f"{'' if first and not text else '.'}{_name(item) or part}"
            value = item if isinstance(part, int) else (value.get(part) if isinstance(value, dict) else None)
        return text


def _common(a: Loc, b: Loc) -> int:
    return next((i for i, (left, right) in enumerate(zip(a, b, strict=False)) if left != right), min(len(a), len(b)))


def _placed(fault: Fault, tree: Tree, loc: Loc, spot: Spot, path: str) -> Problem | None:
    """The fault in a tree. Sections are shown at their key, values at themselves, a missing key at its section."""
    for i, part in enumerate(loc):
        if part not in tree.inside:
            break
        key_spot, tree = tree.key_spot(part), tree.inside[part]
        at_key = isinstance(tree.value, dict) or tree.value is None or (fault.at_key and i == len(loc) - 1)
        spot = key_spot if at_key else tree.spot
    return None if tree.broken else Problem(spot, path, fault.message, fault.hint)


def _name(item: Any) -> str:
    name = item.get("name") if isinstance(item, dict) else getattr(item, "name", None)
    return name if isinstance(name, str) else ""


def _put(node: Any, keys: Sequence[str], value: Any) -> tuple[Any, Loc]:
    """(``node`` with the value at ``keys``, location of the value); ``node`` itself is left as it is."""
    key, rest = keys[0], keys[1:]
    if isinstance(node, list | tuple):
        names = [_name(item) for item in node]
        if key not in names:
            raise _NoSuchNameError([name for name in dict.fromkeys(names) if name])
        i = names.index(key)
        if rest:
            item, below = _put(node[i], rest, value)
        else:
            item, below = {"name": key, **value} if isinstance(value, dict) else value, ()
        return [*node[:i], item, *node[i + 1 :]], (i, *below)
    section = _opened(node)
    if not rest:
        return {**section, key: value}, (key,)
    there = section.get(key, [] if key == "obstacles" else {})
    item, below = _put(spelt_out(there) if key == "study" else there, rest, value)
    return {**section, key: item}, (key, *below)


def _opened(node: Any) -> dict[str, Any]:
    """What was written of a section, defaults left out: a default must not stand in the way of its alternative."""
    if isinstance(node, BaseModel):
        return {name: getattr(node, name) for name in type(node).model_fields if name in node.model_fields_set or name == "kind"}
    return node if isinstance(node, dict) else {}


def faults(data: dict[str, Any]) -> list[Fault]:
    """Everything that keeps ``data`` from being a campaign, sweeps and what goes with them apart: ``blocks_of`` reads those."""
    blank: dict[str, Any] = {"sweep": {}, "skip": ()}
    parts = data.get("parts")
    if isinstance(parts, dict):
        told = {name: {**part, **blank, "set": {}} if isinstance(part, dict) else part for name, part in parts.items()}
        blank = {**blank, "parts": told}
    try:
        Campaign.model_validate({**data, **blank})
    except ValidationError as error:
        return faults_of(error)
    return []


def faults_of(error: ValidationError, root: type[BaseModel] = Campaign) -> list[Fault]:
    """Pydantic's errors as faults; ``root`` is what was validated. A misspelt key is one fault, not an unknown key and a missing one."""
    found: dict[Fault, None] = {}
    misspelt: set[Loc] = set()
    for item in of_unions(error.errors(include_url=False)[:MOST_FAULTS]):
        if follows(item):
            continue
        loc, message, hint = worded(item, root)
        found[Fault(loc, message, hint, at_key=item["type"] in UNKNOWN)] = None
        if item["type"] == "extra_forbidden" and hint.startswith("did you mean"):
            misspelt.add((*loc[:-1], hint.split("'")[1]))
    return [fault for fault in found if not (fault.loc in misspelt and fault.message == "this key is missing")]


MOST_TOLD = 3


def in_words(problem: Exception, root: type[BaseModel] = Campaign) -> str:
    """What is wrong with data that did not fit ``root``, on one line; another exception says it itself."""
    if not isinstance(problem, ValidationError):
        return str(problem)
    faults = faults_of(problem, root)
    more = f"; and {len(faults) - MOST_TOLD} more" if len(faults) > MOST_TOLD else ""
    return "; ".join(f"{'.'.join(map(str, one.loc))}: {one.message}" for one in faults[:MOST_TOLD]) + more
