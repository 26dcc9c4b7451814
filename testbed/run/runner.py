"""A campaign from file to run directory: continue what is there, fly what is missing, write down what came out."""

import os
import shlex
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from testbed.campaign.words.settings import Campaign
from testbed.flight.record import Outcome
from testbed.run import identity, journal, listed, manifest, stopping, storing
from testbed.run import planned as planned_file
from testbed.run import world as world_files
from testbed.run.directory import RUNS, BadInputError, RunDirectory
from testbed.run.engines import Died, Engine, limited
from testbed.run.job import Job, JobResult, crashed, run_job
from testbed.run.manifest import Manifest
from testbed.run.planned import Planned, opened
from testbed.run.stored import PLAN, ROWS, existing, journal_read, plan_of, rows_of
from testbed.run.trial import load_tried
from testbed.run.world import World, world_of
from testbed.run.write import write_results

if TYPE_CHECKING:
    from testbed.results.checks import CheckResult
    from testbed.show.answer import Answer

Progress = Callable[[int, int, Mapping[str, int]], None]
"""Called with: flights done, flights in all, how those that are done ended."""


def _silent(*_: object) -> None:
    pass


@dataclass(frozen=True)
class Summary:
    """What a run directory holds."""

    directory: Path
    planned: int
    outcomes: dict[str, int]
    flown_now: int = 0
    mixed_code: bool = False
    checks: "tuple[CheckResult, ...]" = ()
    first_crash: str = ""
    """Flight id and message of the first flight, in plan order, that crashed; empty if none did."""
    plugins: tuple[str, ...] = ()
    """Files of the user's own that the campaign flies with."""
    answer: "Answer | None" = None

    @property
    def crashed(self) -> int:
        return self.outcomes.get(Outcome.CRASHED.value, 0)


@dataclass(frozen=True)
class Order:
    """What to run and how."""

    source: Path
    engine: Engine
    out: Path | None = None
    overrides: tuple[str, ...] = ()
    fresh: bool = False
    command: tuple[str, ...] = ()
    progress: Progress = field(default=_silent)
    writing: Callable[[], None] = field(default=_silent)
    """Called when the flights are done, before tables and page are written."""
    job: Callable[[Job], JobResult] = run_job


def run(order: Order) -> Summary:
    """Fly what is not yet flown of a campaign, and write the results."""
    campaign = load_tried(order.source, order.overrides)
    stopping.refuse(campaign)
    text = order.source.read_bytes()  # before --fresh removes anything: the campaign may be the run's own copy
    directory = RunDirectory(order.out or RUNS / campaign.name)
    directory.claim()
    with directory.locked():
        about, planned, world = _continued(directory, order, campaign) or _begun(directory, order, campaign)
        # also when continuing: a run killed in its first moment has the manifest and not yet these
        directory.put("campaign.yaml", _note_overrides(order) + text)
        world_files.store(directory, world)
        flown = _fly(directory, order, campaign, planned, about, world)
        order.writing()
        return _written(directory, campaign, planned, flown)


Open = tuple[Manifest, Planned, World]


def _continued(directory: RunDirectory, order: Order, campaign: Campaign) -> Open | None:
    """The run in the directory, if it can be told without expanding the campaign that it is the same: its plan is whole, and the campaign,
    the code and all that it uses are those that made the plan. Parts from elsewhere might make another one.
    """
    if order.fresh or not directory.is_run or not (directory / PLAN).is_file():
        return None
    there = manifest.load(directory)
    try:
        planned = opened(directory / PLAN)
    except BadInputError:
        return None  # it is written anew
    asked = manifest.question_hash(campaign)
    if planned.plugins or planned.hash != there["identity"]["plan"] or there.get(manifest.QUESTION) != asked:
        return None
    world = world_of(campaign, planned.aircraft, planned.plugins)
    return (_noted(directory, there, world), planned, world) if manifest.is_same(there, planned, world) else None


def _begun(directory: RunDirectory, order: Order, campaign: Campaign) -> Open:
    """A run that begins; or the one in the directory, if it is the same by every flight."""
    from testbed.campaign.reading.expand import each_plan

    draft = directory.draft_of(PLAN)
    try:
        draft.unlink(missing_ok=True)
        with draft.open("xb") as file:
            planned_file.write(file, campaign, each_plan(campaign))
            file.flush()
            os.fsync(file.fileno())
        planned = opened(draft)
        world = world_of(campaign, planned.aircraft, planned.plugins)
        if order.fresh:
            directory.clear()
        if directory.is_run:
            about = manifest.load(directory)
            manifest.refuse_another(directory, about, planned, world)
            about = _noted(directory, about, world)
        else:
            about = manifest.new(campaign, order.source.name, order.overrides, planned, world)
            manifest.save(directory, about)
        directory.keep(PLAN)
    finally:
        draft.unlink(missing_ok=True)
    return about, replace(planned, path=directory / PLAN), world


def _noted(directory: RunDirectory, about: Manifest, world: World) -> Manifest:
    """A study that only judges may be another one now."""
    about["identity"] |= {"plugins": {plugin.name: plugin.sha256 for plugin in world.plugins}}
    manifest.save(directory, about)
    return about


def _note_overrides(order: Order) -> bytes:
    return "".join(f"# run with --set {shlex.quote(override)}\n" for override in order.overrides).encode()


def _fly(directory: RunDirectory, order: Order, campaign: Campaign, planned: Planned, about: Manifest, world: World) -> int:
    """Fly the plans that have no row yet, and again those that crashed: memory or disk may have been short. Batch by batch, where the
    campaign says when to stop.
    """
    flown = 0
    for which in stopping.batches(campaign, planned):
        flown += _fly_these(directory, order, campaign, planned, about, world, which)
        if campaign.stop is not None and stopping.enough(campaign, planned, rows_of(directory), which):
            break
    return flown


def _fly_these(
    directory: RunDirectory, order: Order, campaign: Campaign, planned: Planned, about: Manifest, world: World, which: np.ndarray
) -> int:
    """Those of some numbers in the plan."""
    rows = rows_of(directory)
    done = rows.ids[~rows.crashed]
    left = which[~np.isin(planned.ids[which], done)]
    if not len(left):
        return 0
    how = {"command": shlex.join(order.command), "engine": order.engine.name, "workers": order.engine.workers}
    leg = how | {"started": _now(), "ended": None, "flights": len(left)}
    about["history"].append(leg)
    manifest.save(directory, about)
    already = len(which) - len(left)
    with journal_read():
        ended = Counter(rows.lines(np.flatnonzero(~rows.crashed), journal.outcome_of))
    order.progress(already, len(which), ended)
    out, engine = _Out(storing.jobs(directory, campaign, planned, world, left)), limited(order.engine, campaign.limits.wall_limit_s)
    try:
        with journal.appending(directory / ROWS, rows.end) as rows_file, closing(engine.imap(order.job, out)) as results:
            for count, (number, result) in enumerate(results, 1):
                job = out.back(number)
                finished = crashed(job, result.reason, result.details) if isinstance(result, Died) else result
                rows_file.append(finished)
                ended[finished.row["outcome"]] += 1
                order.progress(already + count, len(which), ended)
        leg["ended"] = _now()
    finally:
        if identity.code_hash() != about["identity"]["code"]:
            about["identity"]["code"] = manifest.MIXED
        manifest.save(directory, about)
    return len(left)


class _Out:
    """Jobs on their way through an engine: those that it has pulled, and has not answered yet."""

    def __init__(self, jobs: Iterator[Job]):
        self._jobs = jobs
        self._out: dict[int, Job] = {}

    def __iter__(self) -> Iterator[Job]:
        for number, job in enumerate(self._jobs):
            self._out[number] = job
            yield job

    def back(self, number: int) -> Job:
        return self._out.pop(number)


def report(path: Path, writing: Callable[[], None] = _silent) -> Summary:
    """Write the results of a run directory again from its rows, without flying."""
    directory = existing(path)
    with directory.locked():
        opened_plan = plan_of(directory)
        writing()
        return _written(directory, *opened_plan)


def _written(directory: RunDirectory, campaign: Campaign, planned: Planned, flown: int = 0) -> Summary:
    """Write the results, and say what there is."""
    about = manifest.load(directory)
    with journal_read():
        made = write_results(directory, about, campaign, planned, rows_of(directory))
    if campaign.stop is not None and about["flights"] != made.whole:
        about["flights"] = made.whole
        manifest.save(directory, about)
    mixed = about["identity"]["code"] == manifest.MIXED
    listed.refresh(directory.path)
    return Summary(directory.path, made.whole, made.outcomes, flown, mixed, made.checks, made.first_crash, campaign.plugins, made.answer)


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
