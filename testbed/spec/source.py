"""A campaign file, with ``--set`` on top, to a validated ``Campaign``; or all that is wrong with it, at once."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from testbed.spec.document import Assignment, Document, NoSuchObstacleError, faults
from testbed.spec.expand import Axis, axes_of, combination_problems, level_problems, size_problems
from testbed.spec.model import Campaign
from testbed.spec.nodes import Tree, parse, read_text
from testbed.spec.problems import Problem, Source, SpecError, Spot
from testbed.spec.vocabulary import path_fault

SWEEP = "sweep."


def load_campaign(path: str | Path, overrides: Sequence[str] = ()) -> Campaign:
    """Read, override, validate.  ``overrides``: ``a.b=value`` each, a dotted path and a YAML value.

    Raises ``SpecError`` with every problem of the file, of the overrides and of every cell of the sweep.
    """
    tree, problems = parse(read_text(Path(path)))
    if not isinstance(tree.value, dict):
        if tree.value is None and not problems:
            raise SpecError([Problem(tree.spot, "", "the file is empty", "campaigns/ has examples")])
        raise SpecError(problems or [Problem(tree.spot, "", "must be a section: 'key: value' lines at the top, not a list or a text")])
    written = Document(tree.value, tree)
    sets, more = _read_overrides(overrides)
    document, sweep, unmade = _overridden(written, sets)
    axes, shape = axes_of(sweep)
    problems += more + unmade + shape + _without_effect(sets, axes)

    before, now = faults(written.data), faults(document.data)
    new = [fault for fault in now if fault not in before]
    made = [assignment for _, assignment in document.layers]
    problems += [found for fault in now if (found := document.problem(fault, made if fault in new else ()))]
    problems += level_problems(document, now, axes)
    if problems:
        raise SpecError(problems)

    campaign = Campaign.model_validate({**document.data, "sweep": sweep.value})
    too_many = size_problems(axes, campaign.replicates, tree.key_spot("sweep") if "sweep" in tree.inside else tree.spot)
    if found_late := too_many or combination_problems(campaign, tree, axes):
        raise SpecError(found_late)
    return campaign


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
        if not (path == "sweep" or path.startswith(SWEEP)) and (wrong := path_fault(path, Campaign)):
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


def _overridden(written: Document, sets: Sequence[Assignment]) -> tuple[Document, Tree, list[Problem]]:
    """(the settings, the sweep, overrides that lead nowhere).  The name of an axis has dots, so the sweep is treated apart."""
    document, problems = written, []
    sweep = written.tree.inside.get("sweep", Tree({}))
    for assignment in sets:
        if assignment.path == "sweep":
            sweep = assignment.tree
        elif assignment.path.startswith(SWEEP):
            axis = assignment.path.removeprefix(SWEEP)
            value = {**sweep.value, axis: assignment.tree.value} if isinstance(sweep.value, dict) else sweep.value
            sweep = Tree(value, sweep.spot, {**sweep.inside, axis: assignment.tree}, {**sweep.key_spots, axis: assignment.spot})
        else:
            try:
                document = document.assign([assignment])
            except NoSuchObstacleError as error:
                problems.append(error.problem())
    return document, sweep, problems


def _without_effect(sets: Sequence[Assignment], axes: Sequence[Axis]) -> list[Problem]:
    """An override that every value of an axis overwrites would be silently ignored."""
    problems = []
    for assignment in sets:
        for axis in axes:
            hiding = [any(f"{assignment.path}.".startswith(f"{made.path}.") for made in level.assignments) for level in axis.levels]
            if hiding and all(hiding):
                message = f"has no effect: the sweep's axis '{axis.name}' sets it for every flight"
                hint = f"set sweep.{axis.name} instead" if axis.name == assignment.path else ""
                problems.append(Problem(assignment.spot, "", message, hint))
    return problems
