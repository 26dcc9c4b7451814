"""What a run directory holds, read again: its plan and its rows."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from testbed.campaign.reading.document import in_words
from testbed.campaign.words.settings import Campaign
from testbed.run import journal, manifest, planned, world
from testbed.run.directory import MANIFEST, BadInputError, RunDirectory
from testbed.run.planned import Planned
from testbed.run.world import World

PLAN, ROWS = "plan.json", "rows.jsonl"


def existing(path: Path) -> RunDirectory:
    """The run in a folder. Raises ``BadInputError`` if there is none."""
    directory = RunDirectory(path)
    if not path.is_dir():
        raise BadInputError(f"{path}: no such directory")
    if not directory.is_run:
        raise BadInputError(f"{path}: not a run directory (it has no {MANIFEST})")
    directory.refuse_strange()
    return directory


def plan_of(directory: RunDirectory) -> tuple[Campaign, Planned]:
    """What was to be flown."""
    if not (directory / PLAN).is_file():
        raise BadInputError(f"{directory.path}: no {PLAN} here; is it a run directory?")
    plan = planned.opened(directory / PLAN)
    world.reenter(directory, world_of_run(directory))
    try:
        return Campaign.model_validate(plan.campaign), plan
    except ValueError as problem:
        raise BadInputError(f"{directory / PLAN}: not a plan of this version of testbed ({in_words(problem)})") from None


def number_in(directory: RunDirectory, plan: Planned, flight_id: str) -> int:
    """Which flight of a plan is meant; its id may be shortened as long as it fits one flight only. Raises ``BadInputError``."""
    ids = [f"{number:012x}" for number in plan.ids.tolist()]
    matches = [n for n, one in enumerate(ids) if one == flight_id] or [n for n, one in enumerate(ids) if one.startswith(flight_id)]
    if len(matches) != 1:
        shown = [ids[n] for n in matches] or ids
        hint = "there are " + ", ".join(shown[:5]) + (", ..." if len(shown) > 5 else "")
        raise BadInputError(f"{directory.path}: {'several flights begin with' if matches else 'no flight'} '{flight_id}'; {hint}")
    return matches[0]


def flight_of(directory: RunDirectory, flight_id: str) -> str:
    """The whole id of a flight; nothing of the run is imported for it, which may have plug-ins of anybody's."""
    plan = planned.opened(directory / PLAN)
    return f"{plan.ids[number_in(directory, plan, flight_id)]:012x}"


def world_of_run(directory: RunDirectory) -> World:
    """The plug-ins that the run stores, and where its aircraft were. Raises ``BadInputError``."""
    about = manifest.load(directory)
    return world.stored_world(directory, about["identity"]["plugins"], about["aircraft_path"], about[manifest.FILES])


def rows_of(directory: RunDirectory) -> journal.Index:
    """Which flights have a row, and where; of a flight that was flown again, the last."""
    with journal_read():
        return journal.index(directory / ROWS)


@contextmanager
def journal_read() -> Iterator[None]:
    """Whatever is wrong with a journal that is read inside is bad input."""
    try:
        yield
    except journal.JournalError as problem:
        raise BadInputError(f"{problem}; mend or remove that line, or start again with --fresh") from None
