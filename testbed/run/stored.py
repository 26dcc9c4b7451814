"""What a run directory holds, read again: its plan and its rows."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

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
        raise BadInputError(f"{directory / PLAN}: not a plan of this version of testbed ({problem})") from None


def world_of_run(directory: RunDirectory) -> World:
    """The plug-ins that the run stores, and where its aircraft were. Raises ``BadInputError``."""
    about = manifest.load(directory)
    return world.stored_world(directory, about["identity"]["plugins"], about["aircraft_path"])


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
