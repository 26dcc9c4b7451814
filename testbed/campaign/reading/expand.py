"""A campaign's flights: the plan of every cell and replicate, and the identity of each."""

import hashlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache
from typing import Any

from pydantic import ValidationError

from testbed.campaign.reading.axes import assignments_of
from testbed.campaign.reading.blocks import Block, Cell, blocks_of, overwritten_draws, resolved_parts, size_problems, skip_problems
from testbed.campaign.reading.document import Assignment, Document, Fault, NoSuchObstacleError, faults_of
from testbed.campaign.reading.draws import DrawError, drawn
from testbed.campaign.reading.nodes import Tree
from testbed.campaign.reading.problems import NOWHERE, Problem, SpecError
from testbed.campaign.words.grid import PART, Part
from testbed.campaign.words.limits import Limits
from testbed.campaign.words.obstacles import ObstacleSpec
from testbed.campaign.words.planning import PlannerSpec, Replan, TrackerSpec
from testbed.campaign.words.pluggable import Pluggable
from testbed.campaign.words.population import Met, NoEncounterError
from testbed.campaign.words.settings import Campaign, FlightPlan, FlightSettings, Vary
from testbed.core import datafiles, registry
from testbed.core.canonical import canonical, cut

Encounter = Callable[[float, int, int], Met]
"""From own speed (m/s), seed and replicate to what is met."""

KEPT_ENCOUNTERS = 5_000
"""Drawn encounters that wait for the next cell, 1 kB each; of more replicates each cell draws its own again, which are the same."""

PlannedCell = tuple[Cell, Document, FlightPlan | list[Fault]]


def expand(campaign: Campaign) -> tuple[FlightPlan, ...]:
    """Every flight of a campaign: parts and cells in the order as written (last axis fastest), replicates innermost."""
    return tuple(each_plan(campaign))


def each_plan(campaign: Campaign) -> Iterator[FlightPlan]:
    """The same, each made when it is asked for: there may be more of them than memory holds. Raises ``SpecError`` on the way."""
    blocks, parts = _sound_blocks(campaign)
    for block in blocks:
        part = parts[block.part]
        encounter = lru_cache(KEPT_ENCOUNTERS)(part.encounters.met) if part.encounters else None  # every cell meets the same
        for planned in plans_of_cells(campaign, block, part, Tree({})):
            yield from _flights(campaign, block, part, encounter, planned, range(part.replicates or 1))


def cell_names(campaign: Campaign) -> Iterator[str]:
    """What the cells are called, in the order of their flights. Raises ``SpecError``."""
    blocks, _ = _sound_blocks(campaign)
    return (block.cell_id(cell) for block in blocks for cell in block.cells())


def replicates_of(campaign: Campaign, name: str) -> Callable[[int], FlightPlan]:
    """Any replicate of a cell, by its number, past those of the campaign too, which has them by the same rule.

    Raises ``KeyError`` where there is no such cell, ``SpecError`` then or later.
    """
    blocks, parts = _sound_blocks(campaign)
    try:
        block, cell = next((block, cell) for block in blocks for cell in block.cells() if block.cell_id(cell) == name)
    except StopIteration:
        raise KeyError(name) from None
    part = parts[block.part]
    encounter = part.encounters.met if part.encounters else None
    (planned,) = plans_of_cells(campaign, block, part, Tree({}), [cell])
    return lambda replicate: next(_flights(campaign, block, part, encounter, planned, [replicate]))


def _sound_blocks(campaign: Campaign) -> tuple[list[Block], dict[str, Part]]:
    """The blocks of a campaign and its parts by name. Raises ``SpecError``."""
    blocks, problems = blocks_of(_tree_of(campaign))
    parts = resolved_parts(campaign)
    problems = problems or size_problems(blocks, campaign, NOWHERE)
    problems = problems or [found for b in blocks for found in skip_problems(b) + overwritten_draws(b, parts[b.part])]
    if problems:
        raise SpecError(problems)
    return blocks, parts


def _flights(
    campaign: Campaign, block: Block, part: Part, encounter: Encounter | None, planned: PlannedCell, replicates: Iterable[int]
) -> Iterator[FlightPlan]:
    """Those replicates of a cell."""
    cell, document, plan = planned
    if not isinstance(plan, FlightPlan):
        raise SpecError(found for fault in plan if (found := document.problem(fault, suspects(block, cell))))
    if part.draw or encounter:
        return _drawn_replicates(campaign, block, part, encounter, (cell, document, plan), replicates)
    return _replicates(plan, replicates)


def axes_in_order(campaign: Campaign) -> dict[str, tuple[str, ...]]:
    """Of each part (without parts of an empty name) the axes of its flights as they were written, the part's own name first."""
    blocks, _ = blocks_of(_tree_of(campaign))
    return {block.part: (*([PART] if block.part else []), *(axis.name for axis in block.axes)) for block in blocks}


def sizes(campaign: Campaign) -> dict[str, tuple[int, int]]:
    """Part (an empty name without parts) to its cells and its flights: counted, without making any."""
    blocks, _ = blocks_of(_tree_of(campaign))
    parts = resolved_parts(campaign)
    return {block.part: ((cells := block.left()), cells * (parts[block.part].replicates or 1)) for block in blocks}


SAID_LATER = ("insertion_side", "arrival_root", "path", "search", "again")
"""Settings of ``replan`` that there were not always: a flight that keeps their defaults has the id that it had without them."""


def _tree_of(campaign: Campaign) -> Tree:
    """What ``blocks_of`` reads, of a campaign that may never have been text."""
    keys = ("sweep", "skip", "draw")
    parts = {name: {key: getattr(part, key) for key in (*keys, "set")} for name, part in campaign.parts.items()}
    return Tree.plain({**{key: getattr(campaign, key) for key in keys}, "parts": parts})


def flight_id(plan: FlightPlan) -> str:
    """12 hexadecimal digits that stand for everything that the flight depends on, its cell and its replicate.

    The campaign's name is left out: renaming a campaign changes no flight.
    """
    return _short(canonical(_identity(plan)))


def with_origins(plan: FlightPlan) -> FlightPlan:
    """The plan with the hash or version of every part that is not built in, and the hash of every data file."""
    found = registry.origins((section.family, section.kind) for section in plan.plugged)
    found |= {name: datafiles.look_up(name).sha256 for obstacle in plan.obstacles for name in obstacle.files}
    return plan.model_copy(update={"plugins": {**plan.plugins, **found}}) if found else plan


def _identity(plan: FlightPlan) -> dict[str, Any]:
    """All that is flown. A study that only judges is no part of it: the same flight can be judged by another."""
    said = plan.model_dump(mode="json", exclude={"flight_id": True, "campaign": True, **_unsaid(plan)})
    return said if "study" in said else {**said, **registry.once_said()}


def _unsaid(plan: FlightPlan) -> dict[str, Any]:
    """What is not said of a flight that does without: it is the flight it was before there was such a thing."""
    unsaid: dict[str, Any] = {}
    if plan.weight == 1.0:
        unsaid["weight"] = True
    if plan.vary == Vary():
        unsaid["vary"] = True
    if not plan.plugins:
        unsaid["plugins"] = True
    unsaid["limits"] = True if plan.limits.of_a_flight() == Limits().of_a_flight() else {"wall_limit_s", "flights"}
    if not plan.study.part.flies:
        unsaid["study"] = True
    for name, default in (("planner", PlannerSpec()), ("tracker", TrackerSpec())):
        if getattr(plan, name) == default:
            unsaid[name] = True
    if plain := {k: names for k, spec in enumerate(plan.obstacles) if (names := _unsaid_of(spec))}:
        unsaid["obstacles"] = plain
    if as_before := {name for name in SAID_LATER if getattr(plan.replan, name) == Replan.model_fields[name].default}:
        unsaid["replan"] = as_before
    for name in FlightSettings.model_fields:
        section = getattr(plan, name)
        if isinstance(section, Pluggable) and name not in ("method", *unsaid) and not section.options:
            unsaid[name] = {"options"}
    return unsaid


def _unsaid_of(obstacle: ObstacleSpec) -> set[str]:
    """The same of an obstacle."""
    plain = {"kind", "options"} if obstacle.kind == "straight" and not obstacle.options else set()
    return plain | {name for name in ("appears_at_s", "leaves_at_s") if getattr(obstacle, name) is None}


def _short(identity: bytes) -> str:
    return hashlib.sha256(identity).hexdigest()[:12]


def _replicates(plan: FlightPlan, replicates: Iterable[int]) -> Iterator[FlightPlan]:
    """Copies that share their (frozen) sections."""
    before, after = cut(_identity(plan), "replicate")
    for replicate in replicates:
        yield plan.model_copy(update={"replicate": replicate, "flight_id": _short(before + canonical(replicate) + after)})


def _drawn_replicates(
    campaign: Campaign,
    block: Block,
    part: Part,
    encounter: Encounter | None,
    planned: tuple[Cell, Document, FlightPlan],
    replicates: Iterable[int],
) -> Iterator[FlightPlan]:
    """Each with its own encounter and its own draws. Replicate 0 has what is drawn about a value at that value."""
    cell, document, plan = planned
    who = {name: getattr(plan, name) for name in FlightPlan.model_fields if name not in FlightSettings.model_fields}
    for replicate in replicates:
        name = f"{plan.cell}, replicate {replicate}"
        try:
            if encounter:
                met = encounter(plan.speed_mps, campaign.seed, replicate)
                document = cell_document(campaign, block, cell, Tree({}), met)
                who = who | {"weight": met.weight, "plugins": {**plan.plugins, **dict(met.files)}}
                made = FlightPlan.model_validate({**document.data, **who, "replicate": replicate})
            else:
                made = plan.model_copy(update={"replicate": replicate})
            if replicate and part.draw:
                values = {path: drawn(draw, path, made, campaign.seed, replicate) for path, draw in part.draw.items()}
                assignments = [Assignment(path, Tree.plain(value), path, NOWHERE, NOWHERE) for path, value in values.items()]
                made = FlightPlan.model_validate({**document.assign(assignments).data, **who, "replicate": replicate})
                made = with_origins(made)
        except ValidationError as error:
            raise SpecError(
                Problem(NOWHERE, name, f"{_dotted(fault)}: {fault.message}", fault.hint) for fault in faults_of(error)
            ) from error
        except DrawError as error:
            raise SpecError([Problem(NOWHERE, name, f"draw.{error.path}: {error}")]) from error
        except (NoEncounterError, NoSuchObstacleError) as error:
            raise SpecError([Problem(NOWHERE, name, str(error))]) from error
        yield made.model_copy(update={"flight_id": flight_id(made)})


def _dotted(fault: Fault) -> str:
    return ".".join(map(str, fault.loc))


def suspects(block: Block, cell: Cell) -> Sequence[Assignment]:
    """All that a cell has on top of the campaign's settings."""
    return [*block.set, *assignments_of(cell)]


def cell_document(campaign: Campaign, block: Block, cell: Cell, tree: Tree, met: Met | None) -> Document:
    """Settings of a cell: the campaign's, the part's, those of the encounter, the axes' values, in this order.

    Raises ``NoSuchObstacleError``.
    """
    written = {name: getattr(campaign, name) for name in FlightSettings.model_fields if name in campaign.model_fields_set}
    base = Document(written, tree).assign(block.set)
    if met:
        base = base.assign([Assignment(path, Tree.plain(value), path, NOWHERE, NOWHERE) for path, value in met.settings])
        base = base.with_obstacles(met.obstacles)
    return base.assign(assignments_of(cell))


def plans_of_cells(campaign: Campaign, block: Block, part: Part, tree: Tree, cells: Iterable[Cell] | None = None) -> Iterator[PlannedCell]:
    """For each cell its plan (replicate 0 without an id, any obstacles for the drawn ones), or what is wrong with the combination.

    ``cells``: which; all where none are given.
    """
    met = Met(tuple(part.encounters.placeholders())) if part.encounters else None
    for cell in block.cells() if cells is None else cells:
        try:
            document = cell_document(campaign, block, cell, tree, met)
        except NoSuchObstacleError as error:
            at = ("obstacles",)
            yield cell, Document({}, tree, ((at, error.assignment),)), [Fault(at, error.message, error.hint)]
            continue
        who = {
            "flight_id": "",
            "campaign": campaign.name,
            "cell": block.cell_id(cell),
            "labels": block.labels(cell),
            "replicate": 0,
            "seed": campaign.seed,
        }
        try:
            yield cell, document, with_origins(FlightPlan.model_validate({**document.data, **who}))
        except ValidationError as error:
            yield cell, document, faults_of(error)
