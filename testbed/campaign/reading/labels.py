"""A campaign's labels against those that its study selects flights by: one that is misspelt would be judged by nobody."""

import math
from collections.abc import Collection, Sequence

from testbed.campaign.reading.axes import Axis
from testbed.campaign.reading.blocks import Block
from testbed.campaign.reading.nodes import Tree
from testbed.campaign.reading.problems import Problem, did_you_mean
from testbed.campaign.words.settings import Campaign
from testbed.campaign.words.study import Axes, LabelKind
from testbed.core.catalogue import aircraft_folders


def label_problems(campaign: Campaign, tree: Tree, blocks: Sequence[Block]) -> list[Problem]:
    """Parts, axes and labels that the study does not know, and axes that it needs."""
    study, labels = campaign.study.kind, campaign.study.part.labels
    if labels is None:
        return []
    problems: list[Problem] = []
    for block in blocks:
        if block.part in labels:
            problems += _of_block(study, labels[block.part], block)
        elif block.part:
            message = f"the study '{study}' knows no part '{block.part}'"
            problems.append(Problem(tree.inside["parts"].key_spot(block.part), block.where[:-1], message, _known(block.part, labels)))
        else:
            spot = tree.key_spot("study") if "study" in tree.inside else tree.spot
            message = f"the study '{study}' judges a campaign by its parts, and there are none"
            problems.append(Problem(spot, "study", message, _known("", labels)))
    return problems


def _of_block(study: str, known: Axes, block: Block) -> list[Problem]:
    scope = f"the part '{block.part}'" if block.part else "the sweep"
    problems = [found for axis in block.axes for found in _of_axis(study, known, block, axis)]
    missing = [name for name in known if name not in {axis.name for axis in block.axes}]
    spot, where = block.key("sweep")
    return problems + [Problem(spot, where, f"{scope} has no axis '{name}', which the study '{study}' needs") for name in missing]


def _of_axis(study: str, known: Axes, block: Block, axis: Axis) -> list[Problem]:
    where = f"{block.where}sweep.{axis.name}"
    if axis.name not in known:
        scope = f" in the part '{block.part}'" if block.part else ""
        return [Problem(axis.spot, where, f"the study '{study}' knows no axis '{axis.name}'{scope}", _known(axis.name, known))]
    allowed = known[axis.name]
    if allowed is LabelKind.ANY:
        return []
    if allowed is LabelKind.AIRCRAFT:
        allowed = list(aircraft_folders())
    if isinstance(allowed, LabelKind):
        message = f"the study '{study}' needs labels that are numbers, not '{{}}'"
        return [Problem(level.spot, where, message.format(level.label)) for level in axis.levels if not _is_number(level.label)]
    return [
        Problem(level.spot, where, f"the study '{study}' knows no {axis.name} '{level.label}'", _known(level.label, allowed))
        for level in axis.levels
        if level.label not in allowed
    ]


def _known(name: str, known: Collection[str]) -> str:
    return did_you_mean(name, known) or f"it knows: {', '.join(known)}"


def _is_number(label: str) -> bool:
    try:
        return math.isfinite(float(label))
    except ValueError:
        return False
