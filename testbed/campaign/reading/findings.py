"""What is wrong with the values of a campaign's grids: each value by itself, then where axes, draws and encounters meet."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from testbed.campaign.reading.airworthy import unfit
from testbed.campaign.reading.axes import Level
from testbed.campaign.reading.blocks import Block, overwritten_draws, resolved_parts, skip_problems
from testbed.campaign.reading.document import MOST_FAULTS, Assignment, Document, Fault, NoSuchObstacleError, faults, faults_of
from testbed.campaign.reading.draws import DrawError, extremes
from testbed.campaign.reading.expand import plans_of_cells, suspects
from testbed.campaign.reading.nodes import Tree
from testbed.campaign.reading.possible import impossible, unseen
from testbed.campaign.reading.problems import Problem, SpecError, Spot
from testbed.campaign.words.encounters import Meetings
from testbed.campaign.words.grid import Draw, Grid, Part
from testbed.campaign.words.population import NoEncounterError
from testbed.campaign.words.settings import Campaign, FlightPlan, FlightSettings

ENCOUNTERS_TRIED = 500
"""Drawn before anything is flown: where these are found, so are the others."""


CELLS_TRIED, FEWEST_TRIED = 6_000, 50
"""Cells that are tried before anything is flown: of more than these, so many evenly spread, and a few at least of every part. What
they do not find, the run does before it flies.
"""


VALUES_TRIED = 5_000
"""Values of axes that are tried one by one, each with all the settings."""


def too_much(document: Document, blocks: Sequence[Block], spot: Spot) -> list[Problem]:
    """A refusal of grids that take longer to look through than anybody waits."""
    values = sum(2 + sum(len(axis.levels) for axis in block.axes) for block in blocks)
    most = round(VALUES_TRIED / _weight(document.data.get("obstacles")))
    if values <= most:
        return []
    message = f"has {values:,} values, each of which is tried with all the settings; at most {most:,}"
    return [Problem(spot, "parts" if len(blocks) > 1 else "sweep", message, "draw and replicates have as many as you like")]


def _weight(obstacles: Any) -> float:
    """How much longer it takes to try settings that have these obstacles."""
    return 1.0 + (len(obstacles) / 28.0 if isinstance(obstacles, list | tuple) else 0.0)


def level_problems(document: Document, block: Block) -> list[Problem]:
    """What a part's settings, and each value of each axis, do wrong by themselves, the campaign's own faults apart."""
    grid = ("parts", "draw", "encounters", "skip", "sweep")
    base = replace(document, data={key: value for key, value in document.data.items() if key not in grid})
    base, problems = _level(base, frozenset(faults(base.data)), Level("", block.set))
    if problems or not block.is_set:  # what axes do on top of it cannot be told
        return problems
    try:
        base = base.with_obstacles(encounters.placeholders()) if (encounters := _encounters(document.data, block)) else base
    except ValidationError:  # reported already; whether axes go with the obstacle cannot be told
        return problems
    known = frozenset(faults(base.data))
    for level in (level for axis in block.axes for level in axis.levels):
        problems += _level(base, known, level)[1]
        if len(problems) > MOST_FAULTS:
            break
    return problems


def _level(base: Document, known: Collection[Fault], level: Level) -> tuple[Document, list[Problem]]:
    document, problems = base, []
    for assignment in level.assignments:
        try:
            document = document.assign([assignment])
        except NoSuchObstacleError as error:
            problems.append(error.problem())
    new = [fault for fault in faults(document.data) if fault not in known] if level.assignments else []
    return document, problems + [found for fault in new if (found := document.problem(fault, level.assignments))]


def _encounters(data: dict[str, Any], block: Block) -> Meetings | None:
    """Of data that need not be valid. Raises ``ValidationError``."""
    parts = data.get("parts")
    part = parts.get(block.part) if isinstance(parts, dict) else None
    raw = (part.get("encounters") if isinstance(part, dict) else None) or data.get("encounters")
    return None if raw is None else Grid.model_validate({"encounters": raw}).encounters


def combination_problems(campaign: Campaign, tree: Tree, blocks: Sequence[Block]) -> list[Problem]:
    """What only goes wrong when axes, draws and encounters meet; each distinct fault once, with the first cell that has it."""
    problems: list[Problem] = []
    parts = resolved_parts(campaign)
    tried = CELLS_TRIED / _weight(campaign.obstacles)
    cells = max(tried, sum(block.size for block in blocks))
    for block in blocks:
        part = parts[block.part]
        found = skip_problems(block) + overwritten_draws(block, part)
        problems += found or _of_cells(campaign, tree, block, part, max(FEWEST_TRIED, round(tried * block.size / cells)))
    return problems


def _of_cells(campaign: Campaign, tree: Tree, block: Block, part: Part, most: int) -> list[Problem]:
    """``most``: so many cells are tried."""
    problems: dict[Fault | str, Problem] = {}
    speeds: dict[float, None] = {}
    for cell, document, plan in plans_of_cells(campaign, block, part, tree, block.some_cells(most)):
        found: dict[Fault | str, Problem | None] = {}
        if isinstance(plan, FlightPlan):
            speeds[plan.speed_mps] = None
            try:
                found = {fault: document.problem(fault) for fault in _amiss(plan, part) if fault not in problems}
            except SpecError as error:
                problems |= {str(problem): problem for problem in error.problems}
                continue
            for problem in _of_draws(part.draw, block, document, plan):
                found.setdefault(problem.path, problem)
        elif part.encounters and any(fault.message.startswith("obstacle names must differ") for fault in plan):
            return [Problem(*block.key("encounters"), f"draw the obstacle '{_twice(plan)}', and obstacles has one of that name")]
        else:
            found = {fault: document.problem(fault, suspects(block, cell)) for fault in plan if fault not in problems}
        for key, one in found.items():
            if one and key not in problems:
                problems[key] = replace(one, message=f"{one.message} (in the cell '{block.cell_id(cell)}')")
    return [*problems.values(), *_of_encounters(campaign, block, part, list(speeds))]


def _twice(faults: Sequence[Fault]) -> str:
    """The name that two obstacles have, of the fault that lists all names."""
    names = next(fault.message for fault in faults if fault.message.startswith("obstacle names must differ")).partition(": ")[2].split(", ")
    return next(name for name in names if names.count(name) > 1)


def _amiss(plan: FlightPlan, part: Part | None = None) -> list[Fault]:
    """What keeps a plan from being flown, by its aircraft or by anybody. Raises ``SpecError`` when the aircraft's files are wrong."""
    found = [*unfit(plan), *impossible(plan)]
    if part and part.encounters and not found and (why := unseen(plan, part.encounters.largest_m)):
        found = [Fault(("encounters", "radius_m"), why)]
    return found


def _of_draws(draws: dict[str, Draw], block: Block, document: Document, plan: FlightPlan) -> Iterator[Problem]:
    """Draws that the plan has no place for, or whose range leads out of what the setting may be."""
    tried: dict[str, Sequence[Any]] = {}
    for path, draw in draws.items():
        spot, name = block.key("draw", path)
        try:
            document.assign([Assignment(path, Tree(None), name, spot, spot)])
            tried[path] = extremes(draw, path, plan)
        except NoSuchObstacleError as error:
            yield error.problem()
        except DrawError as error:
            yield Problem(spot, name, str(error))
    who = {name: getattr(plan, name) for name in FlightPlan.model_fields if name not in FlightSettings.model_fields}
    for k in range(max(map(len, tried.values()), default=0)):
        made = []
        for path, values in tried.items():
            spot, name = block.key("draw", path)
            made.append(Assignment(path, Tree.plain(values[min(k, len(values) - 1)], spot), name, spot, spot))
        drawn = document.assign(made)
        try:
            flown = FlightPlan.model_validate({**drawn.data, **who})
            yield from (found for fault in _amiss(flown) if (found := drawn.problem(fault)))
        except ValidationError as error:
            yield from (found for fault in faults_of(error) if (found := drawn.problem(fault, made)))


def _of_encounters(campaign: Campaign, block: Block, part: Part, speeds: Sequence[float]) -> list[Problem]:
    if part.encounters is None:
        return []
    try:
        for speed in speeds:
            for replicate in range(min(part.replicates or 1, ENCOUNTERS_TRIED)):
                part.encounters.met(speed, campaign.seed, replicate)
    except NoEncounterError as error:
        return [Problem(*block.key("encounters"), str(error))]
    return []
