"""A campaign from file to run directory: continue what is there, fly what is missing, write down what came out."""

import json
import shlex
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from testbed.run import identity, journal, keep, manifest
from testbed.run.directory import MANIFEST, BadInputError, RunDirectory
from testbed.run.engines import Died, Engine, LocalEngine
from testbed.run.job import Job, JobResult, Row, crashed, run_job
from testbed.run.manifest import Manifest
from testbed.run.write import write_results
from testbed.spec.model import Campaign, FlightPlan
from testbed.types import FlightMetrics, Outcome

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
    from testbed.spec import expand, load_campaign

    campaign = load_campaign(order.source, overrides=order.overrides)
    plans = list(expand(campaign))
    plan = {"campaign": campaign.model_dump(mode="json"), "flights": [flight.model_dump(mode="json") for flight in plans]}
    text = order.source.read_bytes()  # before --fresh removes anything: the campaign may be the run's own copy
    directory = RunDirectory(order.out or RUNS / campaign.name)
    directory.claim()
    with directory.locked():
        if order.fresh:
            directory.clear()
        about = _open(directory, order, campaign, plan)
        # also when continuing: a run killed in its first moment has the manifest and not yet these
        directory.put("campaign.yaml", _note_overrides(order) + text)
        directory.put("plan.json", identity.canonical(plan))
        flown = _fly(directory, order, campaign, plans, about)
        return _written(directory, flown)


def _open(directory: RunDirectory, order: Order, campaign: Campaign, plan: dict[str, Any]) -> Manifest:
    """Begin a run, or make sure that the one in the directory is the same."""
    if directory.is_run:
        there = manifest.load(directory)
        manifest.refuse_another(directory, there, plan)
        return there
    begun = manifest.new(campaign, order.source.name, order.overrides, plan)
    manifest.save(directory, begun)
    return begun


def _note_overrides(order: Order) -> bytes:
    return "".join(f"# run with --set {shlex.quote(override)}\n" for override in order.overrides).encode()


def _fly(directory: RunDirectory, order: Order, campaign: Campaign, plans: Sequence[FlightPlan], about: Manifest) -> int:
    """Fly the plans that have no row yet, and again those that crashed: memory or disk may have been short."""
    done = {flight_id for flight_id, result in _rows(directory).items() if result.row["outcome"] != Outcome.CRASHED.value}
    jobs = [job for job in keep.jobs(directory, campaign, plans) if job.plan.flight_id not in done]
    if not jobs:
        return 0
    how = {"command": shlex.join(order.command), "engine": order.engine.name, "workers": order.engine.workers}
    leg = how | {"started": _now(), "ended": None, "flights": len(jobs)}
    about["history"].append(leg)
    manifest.save(directory, about)
    kept, bad = len(plans) - len(jobs), 0
    order.progress(kept, len(plans), bad)
    try:
        with journal.appending(directory / "rows.jsonl") as rows, closing(order.engine.imap(order.job, jobs)) as results:
            for count, (number, result) in enumerate(results, 1):
                finished = crashed(jobs[number], result.reason, result.details) if isinstance(result, Died) else result
                rows.append(finished)
                bad += finished.row["outcome"] == Outcome.CRASHED.value
                order.progress(kept + count, len(plans), bad)
        leg["ended"] = _now()
    finally:
        if identity.code_hash() != about["identity"]["code"]:
            about["identity"]["code"] = manifest.MIXED
        manifest.save(directory, about)
    return len(jobs)


def report(path: Path) -> Summary:
    """Write the results of a run directory again from its rows, without flying."""
    directory = _existing(path)
    with directory.locked():
        return _written(directory)


def _written(directory: RunDirectory, flown: int = 0) -> Summary:
    """Write the results, and say what there is."""
    about, (campaign, plans) = manifest.load(directory), _plan(directory)
    by_id = _rows(directory)
    checks = write_results(directory, about, campaign, plans, by_id)
    outcomes = dict(Counter(by_id[plan.flight_id].row["outcome"] for plan in plans if plan.flight_id in by_id))
    return Summary(directory.path, len(plans), outcomes, flown, about["identity"]["code"] == manifest.MIXED, checks)


@dataclass(frozen=True)
class Replay:
    """A flight flown again, and how it compares with its row in the run."""

    recording: Path
    flight_id: str
    differences: list[str]
    same_code: bool


def replay(path: Path, flight_id: str, out: Path | None = None, job: Callable[[Job], JobResult] = run_job) -> Replay:
    """Fly one plan of a run again and record it; ``flight_id`` may be shortened as long as it fits one flight only."""
    directory = _existing(path)
    about, (_, plans) = manifest.load(directory), _plan(directory)
    matches = [plan for plan in plans if plan.flight_id == flight_id] or [plan for plan in plans if plan.flight_id.startswith(flight_id)]
    if len(matches) != 1:
        hint = "there are " + ", ".join(plan.flight_id for plan in (matches or plans)[:5]) + (", ..." if len(matches or plans) > 5 else "")
        raise BadInputError(f"{path}: {'several flights begin with' if matches else 'no flight'} '{flight_id}'; {hint}")
    plan = matches[0]
    recording = (out or directory.recordings / f"{plan.flight_id}.rrd").resolve()
    stored = _rows(directory).get(plan.flight_id)
    ((_, again),) = LocalEngine(1).imap(job, [Job(plan, recording)])  # in a worker, as it was flown the first time
    if isinstance(again, Died):
        again = crashed(Job(plan), again.reason, again.details)
    row = journal.decode(journal.encode(again)).row
    same_code = about["identity"]["code"] == identity.code_hash() and about["identity"]["versions"] == identity.versions()
    return Replay(recording, plan.flight_id, _changes(stored.row if stored else None, row), same_code)


def _changes(stored: Row | None, row: Row) -> list[str]:
    if stored is None:
        return ["the run has no row of this flight yet"]
    names = [*FlightMetrics.__dataclass_fields__, "events", "message", "traceback"]
    return [line for name in names for line in identity.differences({name: _comparable(stored[name])}, {name: _comparable(row[name])})]


def _comparable(value: Any) -> Any:
    """With NaN as text, since a NaN is not equal to itself."""
    return json.loads(json.dumps(value), parse_constant=str)


def _existing(path: Path) -> RunDirectory:
    directory = RunDirectory(path)
    if not path.is_dir():
        raise BadInputError(f"{path}: no such directory")
    if not directory.is_run:
        raise BadInputError(f"{path}: not a run directory (it has no {MANIFEST})")
    return directory


def _plan(directory: RunDirectory) -> tuple[Campaign, list[FlightPlan]]:
    plan = directory.load("plan.json")
    try:
        return Campaign.model_validate(plan["campaign"]), [FlightPlan.model_validate(flight) for flight in plan["flights"]]
    except (ValueError, TypeError, KeyError) as problem:
        raise BadInputError(f"{directory / 'plan.json'}: not a plan of this version of testbed ({problem})") from None


def _rows(directory: RunDirectory) -> dict[str, JobResult]:
    """By flight; of a flight that was flown again, the last."""
    try:
        return {result.row["flight_id"]: result for result in journal.read(directory / "rows.jsonl")}
    except journal.JournalError as problem:
        raise BadInputError(f"{problem}; mend or remove that line, or start again with --fresh") from None


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
