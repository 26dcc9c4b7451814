"""What a run directory holds, read again: its plan and its rows."""

from pathlib import Path

from testbed.campaign.words.settings import Campaign, FlightPlan
from testbed.run import journal, manifest, world
from testbed.run.directory import MANIFEST, BadInputError, RunDirectory
from testbed.run.foreign import is_id
from testbed.run.job import JobResult
from testbed.run.world import World


def existing(path: Path) -> RunDirectory:
    """The run in a folder. Raises ``BadInputError`` if there is none."""
    directory = RunDirectory(path)
    if not path.is_dir():
        raise BadInputError(f"{path}: no such directory")
    if not directory.is_run:
        raise BadInputError(f"{path}: not a run directory (it has no {MANIFEST})")
    directory.refuse_strange()
    return directory


def plan_of(directory: RunDirectory) -> tuple[Campaign, list[FlightPlan]]:
    """What was to be flown."""
    plan = directory.load("plan.json")
    world.reenter(directory, world_of_run(directory))
    try:
        campaign, plans = Campaign.model_validate(plan["campaign"]), [FlightPlan.model_validate(flight) for flight in plan["flights"]]
        if wrong := [flight.flight_id for flight in plans if not is_id(flight.flight_id)]:
            raise ValueError(f"{wrong[0]!r} is no flight's id")
        return campaign, plans
    except (ValueError, TypeError, KeyError) as problem:
        raise BadInputError(f"{directory / 'plan.json'}: not a plan of this version of testbed ({problem})") from None


def world_of_run(directory: RunDirectory) -> World:
    """The plug-ins that the run stores, and where its aircraft were. Raises ``BadInputError``."""
    about = manifest.load(directory)
    return world.stored_world(directory, about["identity"]["plugins"], about["aircraft_path"])


def rows_of(directory: RunDirectory) -> dict[str, JobResult]:
    """By flight; of a flight that was flown again, the last."""
    try:
        return {result.row["flight_id"]: result for result in journal.read(directory / "rows.jsonl")}
    except journal.JournalError as problem:
        raise BadInputError(f"{problem}; mend or remove that line, or start again with --fresh") from None
