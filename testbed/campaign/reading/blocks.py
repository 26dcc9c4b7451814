"""The grids of a campaign as they are written: its own, or those of its parts, each with its settings, axes and cells left out."""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from testbed.campaign.reading.axes import Axis, Level, Skip, axes_of, hidden, settings_of, skips_of
from testbed.campaign.reading.document import Assignment
from testbed.campaign.reading.nodes import Tree
from testbed.campaign.reading.problems import Problem, Spot, did_you_mean
from testbed.campaign.reading.vocabulary import path_fault
from testbed.campaign.words.grid import PART, Grid, Part
from testbed.campaign.words.settings import Campaign, FlightSettings

GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0
ONLY_CELL = "base"
"""Name of the one cell of a campaign without a sweep."""
NO_SECTION = Tree({})

Cell = tuple[Level, ...]


@dataclass(frozen=True)
class Block:
    """One grid: of the part of that name, or the campaign's own (no name). ``where``: what its keys begin with in messages."""

    part: str
    where: str
    set: tuple[Assignment, ...]
    is_set: bool
    """Whether all of the part's settings lead somewhere."""
    axes: tuple[Axis, ...]
    skips: tuple[Skip, ...]
    trees: tuple[Tree, ...]
    """Where its keys may be written: in the part, then in the campaign."""

    def labels(self, cell: Cell) -> dict[str, str]:
        """Axis to label; the part comes first."""
        own = {PART: self.part} if self.part else {}
        return own | {axis.name: level.label for axis, level in zip(self.axes, cell, strict=True)}

    def cell_id(self, cell: Cell) -> str:
        return "/".join(self.labels(cell).values()) or ONLY_CELL

    @property
    def size(self) -> int:
        """How many cells there are, those that are skipped among them."""
        return math.prod(len(axis.levels) for axis in self.axes)

    def cells(self) -> Iterator[Cell]:
        """In the order of the sweep as written, the last axis fastest, without those that are skipped."""
        for cell in itertools.product(*(axis.levels for axis in self.axes)):
            if not self.is_skipped(cell):
                yield cell

    def some_cells(self, most: int) -> Iterator[Cell]:
        """All of them, or of more than ``most`` so many, evenly spread: each value of each axis beside the first of the others, and then
        cells a golden section of the grid apart, by which no axis stays where it is.
        """
        if self.size <= most:
            yield from self.cells()
            return
        step = next(n for n in itertools.count(round(self.size * GOLDEN)) if math.gcd(n, self.size) == 1)
        first = tuple(axis.levels[0] for axis in self.axes)
        alone = ((*first[:i], level, *first[i + 1 :]) for i, axis in enumerate(self.axes) for level in axis.levels)
        spread = (self._cell(k * step % self.size) for k in range(most))
        for cell in itertools.chain(alone, spread):
            if not self.is_skipped(cell):
                yield cell

    def _cell(self, number: int) -> Cell:
        """In the order of the sweep as written."""
        levels = []
        for axis in reversed(self.axes):
            number, k = divmod(number, len(axis.levels))
            levels.append(axis.levels[k])
        return tuple(reversed(levels))

    def is_skipped(self, cell: Cell) -> bool:
        """Is it left out?"""
        labels = self.labels(cell)
        return any(skip.matches(labels) for skip in self.skips)

    def left(self) -> int:
        """How many cells are flown: counted, not made."""
        return self.size if not self.skips else int(np.count_nonzero(_left_of(self)[0]))

    def hides(self, path: str) -> str | None:
        """What gives every flight of the block another value at ``path``: an axis, ``set``, or the part's key of that name."""
        if self.part and path in self.trees[0].inside:
            return path
        for name, made in [("set", [self.set]), *((axis.name, [level.assignments for level in axis.levels]) for axis in self.axes)]:
            if made and all(any(f"{path}.".startswith(f"{one.path}.") for one in assignments) for assignments in made):
                return name
        return None

    def key(self, *keys: str) -> tuple[Spot, str]:
        """Where a key of the block, or the campaign's in its place, is written, and what messages call it."""
        for tree, where in zip(self.trees, (self.where, ""), strict=False):
            for i, key in enumerate(keys):
                if key not in tree.inside:
                    break
                spot, tree = tree.key_spot(key), tree.inside[key]  # noqa: PLW2901 (descends)
                if i == len(keys) - 1:
                    return spot, where + ".".join(keys)
        return self.trees[0].spot, self.where + ".".join(keys)


def resolved_parts(campaign: Campaign) -> dict[str, Part]:
    """The parts with what they leave to the campaign filled in; without parts the campaign's own grid, under an empty name."""
    if not campaign.parts:
        own: dict[str, Any] = {name: getattr(campaign, name) for name in (*Grid.model_fields, "replicates", "recordings", "columns")}
        return {"": Part.model_construct(**own)}
    return {
        name: part.model_copy(
            update={
                "replicates": part.replicates or campaign.replicates,
                "recordings": part.recordings or campaign.recordings,
                "columns": part.columns or campaign.columns,
                "draw": {**campaign.draw, **part.draw},
                "encounters": part.encounters or campaign.encounters,
            }
        )
        for name, part in campaign.parts.items()
    }


def weighted(campaign: Campaign) -> bool:
    """Whether some of its encounters stand for more than others."""
    return any(part.encounters is not None and part.encounters.weighted for part in resolved_parts(campaign).values())


def blocks_of(campaign: Tree) -> tuple[list[Block], list[Problem]]:
    """The grids of a campaign, and what is wrong with their shape and their paths (not yet with their values)."""
    problems = _wrong_draws(campaign, "")
    parts = campaign.inside.get("parts", NO_SECTION)
    if not isinstance(parts.value, dict) or not parts.value:
        block, found = _block("", campaign, "", (campaign,))
        return [block], problems + found
    for own, empty in (("sweep", ({},)), ("skip", ([], ()))):
        if own in campaign.inside and campaign.inside[own].value not in empty:
            problems.append(Problem(campaign.key_spot(own), own, "goes into the parts: a campaign has a sweep or parts, not both"))
    blocks = []
    for key, tree in parts.inside.items():
        if isinstance(tree.value, dict):
            name = str(key)
            block, found = _block(name, tree, f"parts.{name}.", (tree, campaign))
            blocks.append(block)
            problems += found + _wrong_draws(tree, block.where)
    return blocks, problems


def _block(part: str, tree: Tree, where: str, trees: tuple[Tree, ...]) -> tuple[Block, list[Problem]]:
    axes, problems = axes_of(tree.inside.get("sweep", NO_SECTION), f"{where}sweep")
    skips, found = skips_of(tree.inside.get("skip", Tree([])), axes, f"{where}skip")
    problems += found
    made: list[Assignment] = []
    wrong: list[Problem] = []
    if part:
        made, wrong = _own_settings(tree, where)
        problems += wrong + hidden([Axis("set", (Level("", tuple(made)),), tree.spot), *axes], f"{where}sweep")
        problems += [Problem(axis.spot, f"{where}sweep.{PART}", "this label is the part's name") for axis in axes if axis.name == PART]
    return Block(part, where, tuple(made), not wrong, tuple(axes), tuple(skips), trees), problems


def _own_settings(tree: Tree, where: str) -> tuple[list[Assignment], list[Problem]]:
    settings, name = tree.inside.get("set", NO_SECTION), f"{where}set"
    if not isinstance(settings.value, dict):
        message = "must be a section of dotted paths and their values"
        return [], [] if settings.broken else [Problem(tree.key_spot("set"), name, message)]
    beside = {f"{name}.{key}": settings.key_spot(key) for key in settings.inside if key in Part.model_fields}
    made, problems = settings_of(settings, name)
    problems = [problem for problem in problems if problem.path not in beside]
    return made, problems + [Problem(spot, path, "is no setting of a flight", "write it beside 'set'") for path, spot in beside.items()]


def _wrong_draws(tree: Tree, where: str) -> list[Problem]:
    draws = tree.inside.get("draw", NO_SECTION)
    keys = draws.inside if isinstance(draws.value, dict) else ()
    wrong = [(key, path_fault(str(key), FlightSettings)) for key in keys]
    return [Problem(draws.key_spot(key), f"{where}draw.{key}", *fault) for key, fault in wrong if fault]


def size_problems(blocks: Sequence[Block], campaign: Campaign, spot: Spot) -> list[Problem]:
    """A refusal of grids that nobody can mean, skipped cells counted."""
    parts = resolved_parts(campaign)
    flights = sum((parts[block.part].replicates or 1) * block.size for block in blocks)
    most = campaign.limits.flights
    if flights <= most:
        return []
    message = f"makes {_long(flights)} flights; at most {most:,}"
    return [Problem(spot, "parts" if campaign.parts else "sweep", message, "limits.flights sets that")]


def _long(number: int) -> str:
    """A number with its thousands apart, or where nobody could read it, its size."""
    return f"{number:,}" if number < 10**15 else f"10^{math.log10(number):.0f}"


def skip_problems(block: Block) -> list[Problem]:
    """Entries of a skip that leave out nothing more, and a grid of which nothing is left."""
    if not block.skips:
        return []
    left, used = _left_of(block)
    message = "matches no cell that the entries before it leave"
    problems = [Problem(skip.spot, skip.name, message) for skip in block.skips if skip.name not in used]
    if not left.any():
        problems.append(Problem(*block.key("skip"), "leaves no cell to fly"))
    return problems


def _left_of(block: Block) -> tuple[np.ndarray, set[str]]:
    """(which cells are flown, one dimension an axis; names of the entries of the skip that leave one out)."""
    left, used = np.ones([len(axis.levels) for axis in block.axes], dtype=bool), set()
    for skip in block.skips:
        out = np.ones(left.ndim * (1,), dtype=bool)
        for i, axis in enumerate(block.axes):
            if axis.name in skip.labels:
                named = np.array([level.label in skip.labels[axis.name] for level in axis.levels], dtype=bool)
                out = out & named.reshape([-1 if k == i else 1 for k in range(left.ndim)])
        if (left & out).any():
            used.add(skip.name)
            left &= ~out
    return left, used


def overwritten_draws(block: Block, part: Part) -> list[Problem]:
    """A draw that takes the place of what an axis sets: the cells would differ in name only."""
    problems = []
    for path, draw in part.draw.items():
        for axis in block.axes if draw.within is None else ():
            if any(f"{made.path}.".startswith(f"{path}.") for level in axis.levels for made in level.assignments):
                spot, name = block.key("draw", path)
                problems.append(
                    Problem(spot, name, f"overwrites what the axis '{axis.name}' of the sweep sets", "within is about what it sets")
                )
    return problems


def no_such_part(name: str, known: Sequence[str]) -> tuple[str, str]:
    """(message, hint) about the name of a part."""
    hint = did_you_mean(name, known) or (f"there are: {', '.join(known)}" if known else "there are none")
    return f"there is no part '{name}'", hint
