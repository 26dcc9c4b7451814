"""One flight of a campaign from plan to row: fly, measure, record. A bug becomes a row too."""

import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from testbed.campaign.words.check import Check
from testbed.campaign.words.daa import Daa
from testbed.campaign.words.settings import FlightPlan
from testbed.core.utf8 import reason, shortened, whole
from testbed.flight.record import FlightRecord, Outcome
from testbed.results.columns import WEIGHT, FlightMetrics, nothing_measured
from testbed.run.world import NOTHING_MORE, World

Row = dict[str, Any]


@dataclass(frozen=True)
class Job:
    """A plan, and what to store of its flight."""

    plan: FlightPlan
    recording_path: Path | None = None  # absolute: workers need not share the driver's current folder
    want_series: bool = False
    check: Check | None = None
    columns_path: Path | None = None
    world: World = NOTHING_MORE
    daa: Daa | None = None


@dataclass(frozen=True)
class JobResult:
    """What a job gives back. ``row`` and ``series`` follow from the plan alone; ``timings`` are wall-clock seconds."""

    row: Row
    series: dict[str, Any] | None
    timings: dict[str, float]


MOST_DETAILS = 10_000
"""Characters of a traceback that are kept, the last ones: a message may be as long as memory."""


def run_job(job: Job) -> JobResult:
    """Fly, measure and record one plan; a failure of the program is a row with outcome ``crashed``."""
    try:
        job.world.enter()
        return _run(job)
    except Exception as bug:
        return crashed(job, reason(bug), traceback.format_exc())


def crashed(job: Job, message: str, details: str) -> JobResult:
    """The row of a flight that the program failed to fly."""
    metrics = nothing_measured() | {"outcome": Outcome.CRASHED.value}
    if job.daa is not None:
        from testbed.results.daa.columns import no_daa

        metrics |= no_daa(job.daa)
    story = _story([], shortened(message), whole(details[-MOST_DETAILS:]), None)
    return JobResult(_identity(job.plan) | metrics | story, None, {})


def _flown_by_study(plan: FlightPlan) -> JobResult:
    """Of a study whose unit is not one flight: its row has ``found`` in the place of the metrics of a flight."""
    timings: dict[str, float] = {}
    outcome, found = _timed(timings, "fly", lambda: plan.study.made(plan.plugins).fly(plan))
    return JobResult(_identity(plan) | {"outcome": outcome, "found": found} | _story([], "", "", None), None, timings)


def _run(job: Job) -> JobResult:
    if job.plan.study.part.flies:
        return _flown_by_study(job.plan)
    from testbed.flight.fly import fly
    from testbed.results.metrics import measure

    timings: dict[str, float] = {}
    record: FlightRecord = _timed(timings, "fly", lambda: fly(job.plan))
    metrics: FlightMetrics = _timed(timings, "measure", lambda: measure(record))
    series = None
    if job.want_series:
        from testbed.show.series import flight_series

        series = _timed(timings, "series", lambda: flight_series(record))
    recording = None
    if job.recording_path is not None:
        from testbed.show.recording import write_recording

        path = job.recording_path
        path.parent.mkdir(parents=True, exist_ok=True)
        _timed(timings, "record", lambda: write_recording(record, metrics, path))
        recording = f"{path.parent.name}/{path.name}"
    if job.columns_path is not None:
        from testbed.results.raw import write_columns

        raw = job.columns_path
        _timed(timings, "columns", lambda: write_columns(record, raw))
    daa: Row = {}
    if job.daa is not None:
        from testbed.results.daa.columns import measure_daa

        asked = job.daa
        daa = _timed(timings, "daa", lambda: measure_daa(record, asked))
    row = row_of(record, metrics, recording) | daa
    if job.check is not None:
        from testbed.results.checks import evidence

        check = job.check
        row["evidence"] = _timed(timings, "check", lambda: evidence(check, record))
    return JobResult(row, series, timings | {f"fly.{stage.removesuffix('_s')}": seconds for stage, seconds in record.timings})


def row_of(record: FlightRecord, metrics: FlightMetrics, recording: str | None = None) -> Row:
    """The row of a flight that was flown."""
    events = [dict(vars(event)) for event in record.events]
    return _identity(record.plan) | vars(metrics) | _story(events, record.message, "", recording)


def _timed(timings: dict[str, float], stage: str, work: Callable[[], Any]) -> Any:
    start = time.perf_counter()
    try:
        return work()
    finally:
        timings[stage] = time.perf_counter() - start


def _identity(plan: FlightPlan) -> Row:
    return {
        "flight_id": plan.flight_id,
        "cell": plan.cell,
        "labels": dict(plan.labels),
        "replicate": plan.replicate,
        "seed": plan.seed,
        "plant": plan.plant.kind,
        "aircraft": plan.aircraft,
        "method": plan.avoids_by,
    } | ({WEIGHT.name: plan.weight} if plan.weight != 1.0 else {})


def _story(events: list[dict[str, Any]], message: str, details: str, recording: str | None) -> Row:
    return {"events": events, "message": whole(message), "traceback": whole(details), "recording": recording}
