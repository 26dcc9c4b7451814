"""A flight of a run flown again, and compared with its row."""

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from testbed.campaign.words.daa import Daa
from testbed.core import datafiles
from testbed.results.columns import METRICS
from testbed.results.daa.columns import daa_columns
from testbed.run import identity, journal, manifest
from testbed.run.directory import BadInputError, recording_file
from testbed.run.engines import Died, LocalEngine, limited
from testbed.run.job import Job, JobResult, Row, crashed, run_job
from testbed.run.stored import existing, journal_read, number_in, plan_of, rows_of, world_of_run


@dataclass(frozen=True)
class Replay:
    """A flight flown again, and how it compares with its row in the run."""

    recording: Path
    flight_id: str
    differences: list[str]
    same_code: bool


def replay(path: Path, flight_id: str, out: Path | None = None, job: Callable[[Job], JobResult] = run_job) -> Replay:
    """Fly one plan of a run again and record it; ``flight_id`` may be shortened as long as it fits one flight only."""
    directory = existing(path)
    about, (campaign, planned) = manifest.load(directory), plan_of(directory)
    number = number_in(directory, planned, flight_id)
    plan = planned.plans[number]
    if plan.study.part.flies:
        raise BadInputError(f"{path}: '{plan.flight_id}' is what the study '{plan.study.kind}' flies, and cannot be replayed as one flight")
    for name, sha256 in plan.plugins.items():
        if datafiles.known([(name, sha256)]):
            try:
                datafiles.content(name, sha256)
            except datafiles.DataFileError as problem:
                raise BadInputError(f"{path}: {problem}") from None
    recording = recording_file(out or directory.recordings / f"{plan.flight_id}.rrd")
    rows = rows_of(directory)
    places = rows.places(planned.ids[[number]])
    with journal_read():
        stored = rows.lines(places, journal.row_of)[0] if places[0] >= 0 else None
    engine = limited(LocalEngine(1), campaign.limits.wall_limit_s)  # in a worker, as it was flown the first time
    ((_, again),) = engine.imap(job, [Job(plan, recording, world=world_of_run(directory), daa=campaign.daa)])
    if isinstance(again, Died):
        again = crashed(Job(plan, daa=campaign.daa), again.reason, again.details)
    of_run = replace(again, row=again.row | {"recording": None})  # it may be anywhere, and a run's own is where a run has it
    row = journal.decode(journal.encode(of_run)).row
    same_code = about["identity"]["code"] == identity.code_hash() and about["identity"]["versions"] == identity.versions()
    return Replay(recording, plan.flight_id, _changes(stored, row, campaign.daa), same_code)


def _changes(stored: Row | None, row: Row, daa: Daa | None) -> list[str]:
    if stored is None:
        return ["the run has no row of this flight yet"]
    names = [*(column.name for column in (*METRICS, *daa_columns(daa))), "events", "message", "traceback"]
    return [
        line for name in names for line in identity.differences({name: _comparable(stored.get(name))}, {name: _comparable(row.get(name))})
    ]


def _comparable(value: Any) -> Any:
    """With NaN as text, since a NaN is not equal to itself."""
    return json.loads(json.dumps(value), parse_constant=str)
