"""A campaign file, with ``--set`` on top, to a validated ``Campaign``; or all that is wrong with it, at once."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from testbed.campaign.reading.blocks import Block, blocks_of, no_such_part, size_problems
from testbed.campaign.reading.document import Assignment, Document, Fault, NoSuchObstacleError, faults
from testbed.campaign.reading.findings import combination_problems, level_problems, too_much
from testbed.campaign.reading.labels import label_problems
from testbed.campaign.reading.nodes import Tree, parse, read_text
from testbed.campaign.reading.problems import Problem, Source, SpecError, Spot
from testbed.campaign.reading.vocabulary import path_fault
from testbed.campaign.words.settings import Campaign
from testbed.core import datafiles, plugins

STORED_PLUGINS = "plugins"
"""Folder of a run directory in which the campaign's plug-ins are stored."""

GRIDS = ("sweep", "skip", "draw", "encounters", "parts")
DOTTED = ("sweep", "set", "draw")


def load_campaign(path: str | Path, overrides: Sequence[str] = ()) -> Campaign:
    """Read, override, validate.  ``overrides``: ``a.b=value`` each, a dotted path and a YAML value.

    Raises ``SpecError`` with every problem of the file, of the overrides and of every cell of the sweep.
    """
    with datafiles.beside(Path(path).parent):
        return _loaded(path, overrides)


def _loaded(path: str | Path, overrides: Sequence[str]) -> Campaign:
    tree, problems = parse(read_text(Path(path)))
    if not isinstance(tree.value, dict):
        if tree.value is None and not problems:
            raise SpecError([Problem(tree.spot, "", "the file is empty", "`testbed init DIR` writes one to begin with")])
        raise SpecError(problems or [Problem(tree.spot, "", "must be a section: 'key: value' lines at the top, not a list or a text")])
    sets, more = _read_overrides(overrides)
    tree, sets, unmade = _with_grids(tree, sets)
    written = Document(tree.value, tree)
    document, unknown = _overridden(written, sets)
    if faulty := _plug_in(document, Path(path).parent):
        raise SpecError([*problems, *more, *faulty])
    blocks, shape = blocks_of(tree)
    problems += more + unmade + unknown + shape + _without_effect(sets, blocks)

    before, now = faults(written.data), faults(document.data)
    new = [fault for fault in now if fault not in before]
    made = [assignment for _, assignment in document.layers]
    problems += [found for fault in now if (found := document.problem(fault, made if fault in new else ()))]
    at = next((tree.key_spot(grid) for grid in ("parts", "sweep") if grid in tree.inside), tree.spot)
    problems += too_much(document, blocks, at) or [found for block in blocks for found in level_problems(document, block)]
    if problems:
        raise SpecError(problems)

    campaign = Campaign.model_validate(document.data)
    if too_many := size_problems(blocks, campaign, at):
        raise SpecError(too_many)
    if found_late := label_problems(campaign, tree, blocks) + combination_problems(campaign, _with_sets(tree, sets), blocks):
        raise SpecError(found_late)
    return campaign


def _plug_in(document: Document, folder: Path) -> list[Problem]:
    """Make the parts in the campaign's own files known, before anything is held against them."""
    written = document.data.get("plugins", ())
    problems: list[Problem | None] = []
    taken: dict[str, int] = {}
    for i, name in enumerate(written if isinstance(written, list | tuple) else ()):
        if not isinstance(name, str) or not name:  # told with the rest of the data
            continue
        try:
            plugin = plugins.read(_found(folder, name))
            if taken.setdefault(plugin.name, i) != i:
                raise plugins.PluginError(f"there are two plug-ins '{plugin.name}'")
            plugins.add([plugin])
        except plugins.PluginError as error:
            problems.append(document.problem(Fault(("plugins", i), str(error))))
    return [problem for problem in problems if problem]


def _found(folder: Path, name: str) -> Path:
    """A plug-in's file beside the campaign; or, for the copy of a campaign in a run directory, where a run stores it."""
    file = folder / name
    stored = folder / STORED_PLUGINS / file.name
    return stored if stored.is_file() and not file.is_file() else file


def _read_overrides(overrides: Sequence[str]) -> tuple[list[Assignment], list[Problem]]:
    """Each ``a.b=value`` as an assignment; those that cannot be read are problems."""
    sets: list[Assignment] = []
    problems: list[Problem] = []
    for override in overrides:
        spot = Spot(Source(f"--set {override}", is_file=False))
        path, equals, text = (part.strip() for part in override.partition("="))
        if not equals or not path:
            problems.append(Problem(spot, "", "expected KEY=VALUE, for example method.kind=none"))
            continue
        keys = _keys(path)
        if wrong := path_fault(".".join(keys[:-1] if "." in keys[-1] else keys), Campaign):
            problems.append(Problem(spot, "", *wrong))
            continue
        try:
            tree, found = parse(Source(spot.source.label, text, is_file=False))
        except SpecError as error:
            problems += [replace(problem, spot=spot) for problem in error.problems]
            continue
        problems += [replace(problem, spot=spot) for problem in found]
        sets.append(Assignment(path, tree, "", spot, spot))
    return sets, problems


def _keys(path: str) -> list[str]:
    """The keys of a dotted path. After ``sweep``, ``set`` and ``draw`` comes one key, which has dots itself."""
    keys = path.split(".")
    at = 2 if keys[0] == "parts" else 0
    return [*keys[: at + 1], ".".join(keys[at + 1 :])] if keys[at : at + 1] and keys[at] in DOTTED and keys[at + 1 :] else keys


def _with_grids(tree: Tree, sets: Sequence[Assignment]) -> tuple[Tree, list[Assignment], list[Problem]]:
    """(the tree with the overrides of what is no setting of a flight, the other overrides, parts that are not there)."""
    problems, others = [], []
    for assignment in sets:
        keys = _keys(assignment.path)
        known = tree.inside["parts"].inside if "parts" in tree.inside else {}
        if keys[0] not in GRIDS:
            others.append(assignment)
        elif keys[0] == "parts" and len(keys) > 2 and keys[1] not in known:
            problems.append(Problem(assignment.spot, "", *no_such_part(keys[1], list(map(str, known)))))
        else:
            tree = tree.put(keys, assignment.tree, assignment.spot)
    return tree, others, problems


def _overridden(written: Document, sets: Sequence[Assignment]) -> tuple[Document, list[Problem]]:
    """(the settings, overrides that lead nowhere)."""
    document, problems = written, []
    for assignment in sets:
        try:
            document = document.assign([assignment])
        except NoSuchObstacleError as error:
            problems.append(error.problem())
    return document, problems


def _with_sets(tree: Tree, sets: Sequence[Assignment]) -> Tree:
    """The tree with the overrides in it, so that a fault that one of them makes is shown at it; those of obstacles apart, a list."""
    for assignment in sets:
        keys = assignment.path.split(".")
        if keys[0] != "obstacles":
            tree = tree.put(keys, assignment.tree, assignment.spot)
    return tree


def _without_effect(sets: Sequence[Assignment], blocks: Sequence[Block]) -> list[Problem]:
    """An override that is overwritten for every flight would be silently ignored."""
    problems = []
    for assignment in sets:
        if not blocks or not all(block.hides(assignment.path) for block in blocks):
            continue
        message, hint = "has no effect: every part sets it", ""
        if not blocks[0].part:
            axis = blocks[0].hides(assignment.path)
            message = f"has no effect: the sweep's axis '{axis}' sets it for every flight"
            hint = f"set sweep.{axis} instead" if axis == assignment.path else ""
        problems.append(Problem(assignment.spot, "", message, hint))
    return problems
