"""A campaign from file to run directory: continue what is there, fly what is missing, write down what came out."""

import shlex
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from testbed.campaign.words.settings import Campaign, FlightPlan
from testbed.flight.record import Outcome
from testbed.run import identity, journal, manifest, storing
from testbed.run import world as world_files
from testbed.run.directory import RunDirectory
from testbed.run.engines import Died, Engine
from testbed.run.job import Job, JobResult, crashed, run_job
from testbed.run.manifest import Manifest
from testbed.run.stored import existing, plan_of, rows_of
from testbed.run.world import World, world_of
from testbed.run.write import write_results

if TYPE_CHECKING:
    from testbed.results.checks import CheckResult

RUNS = Path("reports/runs")

Progress = Callable[[int, int, int], None]
"""Called with: flights done, flights in all, flights crashed."""


def _silent(_done: int, _total: int, _crashed: int) -> None:
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
    job: Callable[[Job], JobResult] = run_job


def run(order: Order) -> Summary:
    """Fly what is not yet flown of a campaign, and write the results."""
    from testbed.campaign import expand, load_campaign

    campaign = load_campaign(order.source, overrides=order.overrides)
    plans = list(expand(campaign))
    plan = {"campaign": campaign.model_dump(mode="json"), "flights": [flight.model_dump(mode="json") for flight in plans]}
    world = world_of(campaign, plans)
    text = order.source.read_bytes()  # before --fresh removes anything: the campaign may be the run's own copy
    directory = RunDirectory(order.out or RUNS / campaign.name)
    directory.claim()
    with directory.locked():
        if order.fresh:
            directory.clear()
        about = _open(directory, order, campaign, plan, world)
        # also when continuing: a run killed in its first moment has the manifest and not yet these
        directory.put("campaign.yaml", _note_overrides(order) + text)
        directory.put("plan.json", identity.canonical(plan))
        world_files.store(directory, world)
        flown = _fly(directory, order, campaign, plans, about, world)
        return _written(directory, flown)


def _open(directory: RunDirectory, order: Order, campaign: Campaign, plan: dict[str, Any], world: World) -> Manifest:
    """Begin a run, or make sure that the one in the directory is the same."""
    if directory.is_run:
        there = manifest.load(directory)
        manifest.refuse_another(directory, there, plan, world)
        there["identity"] |= {"plugins": {plugin.name: plugin.sha256 for plugin in world.plugins}}
        manifest.save(directory, there)
        return there
    begun = manifest.new(campaign, order.source.name, order.overrides, plan, world)
    manifest.save(directory, begun)
    return begun


def _note_overrides(order: Order) -> bytes:
    return "".join(f"# run with --set {shlex.quote(override)}\n" for override in order.overrides).encode()


def _fly(directory: RunDirectory, order: Order, campaign: Campaign, plans: Sequence[FlightPlan], about: Manifest, world: World) -> int:
    """Fly the plans that have no row yet, and again those that crashed: memory or disk may have been short."""
    done = {flight_id for flight_id, result in rows_of(directory).items() if result.row["outcome"] != Outcome.CRASHED.value}
    jobs = [job for job in storing.jobs(directory, campaign, plans, world) if job.plan.flight_id not in done]
    if not jobs:
        return 0
    how = {"command": shlex.join(order.command), "engine": order.engine.name, "workers": order.engine.workers}
    leg = how | {"started": _now(), "ended": None, "flights": len(jobs)}
    about["history"].append(leg)
    manifest.save(directory, about)
    already, bad = len(plans) - len(jobs), 0
    order.progress(already, len(plans), bad)
    try:
        with journal.appending(directory / "rows.jsonl") as rows, closing(order.engine.imap(order.job, jobs)) as results:
            for count, (number, result) in enumerate(results, 1):
                finished = crashed(jobs[number], result.reason, result.details) if isinstance(result, Died) else result
                rows.append(finished)
                bad += finished.row["outcome"] == Outcome.CRASHED.value
                order.progress(already + count, len(plans), bad)
        leg["ended"] = _now()
    finally:
        if identity.code_hash() != about["identity"]["code"]:
            about["identity"]["code"] = manifest.MIXED
        manifest.save(directory, about)
    return len(jobs)


def report(path: Path) -> Summary:
    """Write the results of a run directory again from its rows, without flying."""
    directory = existing(path)
    with directory.locked():
        return _written(directory)


def _written(directory: RunDirectory, flown: int = 0) -> Summary:
    """Write the results, and say what there is."""
    about, (campaign, plans) = manifest.load(directory), plan_of(directory)
    by_id = rows_of(directory)
    checks = write_results(directory, about, campaign, plans, by_id)
    rows = [by_id[plan.flight_id].row for plan in plans if plan.flight_id in by_id]
    crashes = (f"{row['flight_id']}: {row['message']}" for row in rows if row["outcome"] == Outcome.CRASHED.value)
    return Summary(
        directory.path,
        len(plans),
        dict(Counter(row["outcome"] for row in rows)),
        flown,
        about["identity"]["code"] == manifest.MIXED,
        checks,
        next(crashes, ""),
        campaign.plugins,
    )


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
