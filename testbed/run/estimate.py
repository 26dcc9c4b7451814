"""What a run will leave on disk and how long it will take, from a few flights that are flown to see. Nothing of them is kept."""

import math
import time
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from testbed.campaign.reading.blocks import resolved_parts
from testbed.campaign.reading.expand import each_plan, sizes
from testbed.campaign.words.settings import Campaign, FlightPlan
from testbed.flight.record import Outcome
from testbed.run import journal, planned
from testbed.run.engines import Died, LocalEngine
from testbed.run.job import Job, JobResult, run_job
from testbed.run.storing import SERIES
from testbed.run.world import world_of
from testbed.studies.study import Study

if TYPE_CHECKING:
    from testbed.results.columns import Column

SAMPLE = 4
"""Flights that are flown to see, of cells evenly spread over the campaign."""
ENOUGH_S, LONGEST_S = 5.0, 30.0
"""After so long from the first flight on no other is begun; and one that takes so long is ended."""
START_S = 4.0
"""From the command to the first flight, and from the last to the page."""
DRIVER_S = 1.0e-3
"""What the driver does for each flight, tables and page included: a rough figure, of busy machines."""
COUNTED = 5_000
"""So many plans are made to see how long they are as text."""
JITTERED = 2_000
"""Made-up rows by which the size of a Parquet file is told."""


@dataclass
class Counted:
    """What a campaign is to fly, counted without holding it."""

    flights: int = 0
    cells: dict[str, int] = field(default_factory=dict)
    """Of each part (without parts of an empty name)."""
    flights_of: dict[str, int] = field(default_factory=dict)
    recordings: int = 0
    columns: int = 0
    firsts: int = 0
    """Flights that are the first of their cell."""
    pictured: int = 0
    plan_bytes: int = 0
    sample: list[FlightPlan] = field(default_factory=list)


def count(campaign: Campaign) -> Counted:
    """What there is to fly. Up to ``COUNTED`` plans are made to see, and let go; of more, the first of each cell. Raises ``SpecError``."""
    found = sizes(campaign)
    counted = Counted(sum(flights for _, flights in found.values()))
    counted.cells, counted.flights_of = ({name: size[k] for name, size in found.items()} for k in (0, 1))
    counted.firsts = sum(counted.cells.values())
    seen = _Seen(campaign.study.made())
    planned.write(seen, campaign, seen.through(campaign if counted.flights <= COUNTED else _first_replicates(campaign)))
    counted.plan_bytes = round(seen.plan_bytes * counted.flights / max(1, seen.plans))
    counted.pictured = round(seen.pictured * (1.0 if counted.flights <= COUNTED else counted.firsts / max(1, seen.plans)))
    of_all, of_first = counted.flights_of, counted.cells
    for name, part in resolved_parts(campaign).items():
        counted.columns += of_all[name] if part.columns == "all" else of_first[name] if part.columns == "selected" else 0
        counted.recordings += of_all[name] if part.recordings == "all" else of_first[name] if part.recordings == "selected" else 0
    if counted.pictured:  # a study's pictures take the place of first replicates
        selected = sum(of_first[name] for name, part in resolved_parts(campaign).items() if part.recordings == "selected")
        counted.recordings += counted.pictured - selected
    few = min(SAMPLE, len(seen.sample))
    counted.sample = [seen.sample[k * (len(seen.sample) - 1) // max(1, few - 1)] for k in range(few)]
    return counted


def _first_replicates(campaign: Campaign) -> Campaign:
    parts = {name: part.model_copy(update={"replicates": 1}) for name, part in campaign.parts.items()}
    return campaign.model_copy(update={"replicates": 1, "parts": parts})


class _Seen:
    """Plans that go by. As a file of the plan it keeps its length only."""

    def __init__(self, study: Study) -> None:
        self._pictures = study.pictures if type(study).pictures is not Study.pictures else None
        self.plans = self.pictured = self.plan_bytes = 0
        self.sample: list[FlightPlan] = []

    def write(self, data: bytes, /) -> int:
        self.plan_bytes += len(data)
        return len(data)

    def through(self, campaign: Campaign) -> Iterator[FlightPlan]:
        """Each plan, up to ``COUNTED``; the first of every so many cells is kept, of cells that are evenly spread."""
        step, cells, last_cell = 1, 0, ""
        for plan in islice(each_plan(campaign), COUNTED):
            self.plans += 1
            self.pictured += bool(self._pictures and self._pictures(plan))
            if plan.cell != last_cell:  # the flights of a cell follow each other
                last_cell = plan.cell
                if cells % step == 0:
                    self.sample.append(plan)
                cells += 1
                if len(self.sample) == 2 * SAMPLE:  # every other one of them is of as evenly spread cells
                    self.sample = self.sample[::2]
                    step *= 2
            yield plan


@dataclass(frozen=True)
class Estimate:
    """Of a whole campaign: bytes by what they are of, and seconds. Without flights both are empty."""

    flown: int
    bytes: dict[str, float]
    """Name of a file, or of a folder of files, to bytes in all."""
    seconds: float
    said: str = ""
    """What kept it from being an estimate, or what became of a flight that failed."""


def estimate(campaign: Campaign, counted: Counted, workers: int) -> Estimate:
    """Fly the sample, in a process of its own, and multiply."""
    world = world_of(
        campaign, {plan.aircraft for plan in counted.sample}, {name: one for plan in counted.sample for name, one in plan.plugins.items()}
    )
    with TemporaryDirectory(prefix="estimate-") as folder:
        here = Path(folder)
        jobs = [
            Job(
                plan,
                here / "recordings" / f"{k}.rrd" if counted.recordings else None,
                True,
                campaign.check,
                here / "columns" / f"{k}.parquet" if counted.columns else None,
                world,
                campaign.daa,
            )
            for k, plan in enumerate(counted.sample)
        ]
        results = _flown(jobs)
        if not results:
            return Estimate(0, {}, 0.0, f"the first flight was not done after {LONGEST_S:g} s, or its process died of it")
        crashes = [result.row for result in results if result.row["outcome"] == Outcome.CRASHED.value]
        said = f"flight {crashes[0]['flight_id']} crashed: {crashes[0]['message']}" if crashes else ""
        return Estimate(len(results), _bytes(campaign, counted, results, here), _seconds(counted, results, workers), said)


def _flown(jobs: Sequence[Job]) -> list[JobResult]:
    """Results of the first of them, as many as there is time for. The first is flown twice: before, a process has much to read."""
    results: list[JobResult] = []
    enough = math.inf
    with closing(LocalEngine(1, wall_limit_s=LONGEST_S).imap(run_job, [jobs[0], *jobs])) as flown:
        for _, result in flown:
            if isinstance(result, Died):
                break
            results.append(result)
            enough = min(enough, time.monotonic() + ENOUGH_S)
            if time.monotonic() > enough:
                break
    return results[1:] or results


def _asked(counted: Counted) -> dict[str, int]:
    """Stages of a flight that not every flight has, to how many have them."""
    return {"record": counted.recordings, "columns": counted.columns, "series": min(SERIES, counted.firsts)}


def _mean(amounts: Sequence[float]) -> float:
    return sum(amounts) / len(amounts) if amounts else 0.0


def _bytes(campaign: Campaign, counted: Counted, results: Sequence[JobResult], here: Path) -> dict[str, float]:
    """Each file by what one flight adds to it; the page apart, which has an upper end."""
    asked = _asked(counted)
    timed = [{s: 0.0123456789012345 for s in one.timings if asked.get(s, counted.flights) > counted.flights / 2} for one in results]
    steady = [replace(result, timings=stages) for result, stages in zip(results, timed, strict=True)]
    lines = [len(journal.encode(replace(result, series=None))) for result in steady]
    curves = [len(journal.encode(result)) - line for result, line in zip(steady, lines, strict=True)]
    pictured = min(max(SERIES, counted.pictured), counted.pictured + counted.firsts)
    found = {
        "plan.json": float(counted.plan_bytes),
        "rows.jsonl": counted.flights * _mean(lines) + pictured * _mean(curves),
        "timings.csv": counted.flights * (13 + _mean([8 * len(told) + len(one.timings) for told, one in zip(timed, results, strict=True)])),
    }
    if not campaign.study.part.flies:
        from testbed.results.daa.columns import daa_columns

        found |= _table_bytes([result.row for result in results], counted.flights, daa_columns(campaign.daa))
    for name, number in (("recordings", counted.recordings), ("columns", counted.columns)):
        sizes = [file.stat().st_size for file in (here / name).glob("*")] if number else []
        found |= {name: number * _mean(sizes)} if sizes else {}
    return found


def _table_bytes(rows: list[dict[str, Any]], flights: int, more: "tuple[Column, ...]") -> dict[str, float]:
    """Of both tables. What differs between the flights flown is taken to differ between all."""
    from testbed.results import tables

    table = tables.table(rows, more=more)
    one = (len(tables.csv_bytes(table)) - len(tables.csv_bytes(table.slice(0, 0)))) / len(rows)
    rng = np.random.default_rng(0)
    varied = [name for name in rows[0] if len({repr(row[name]) for row in rows}) > 1] if len(rows) > 1 else list(rows[0])
    differ = [name for name in varied if isinstance(rows[0][name], float)]
    jittered = []
    for k in range(JITTERED):
        row = rows[k % len(rows)]
        jittered.append(row | {"flight_id": rng.bytes(6).hex()} | {name: row[name] * (1.0 + 1e-6 * rng.random()) for name in differ})
    packed = (
        len(tables.parquet_bytes(tables.table(jittered, more=more))) - len(tables.parquet_bytes(tables.table([], more=more)))
    ) / JITTERED
    return {"results.csv": flights * one, "results.parquet": flights * packed + len(tables.parquet_bytes(tables.table([], more=more)))}


def _seconds(counted: Counted, results: Sequence[JobResult], workers: int) -> float:
    """What only some flights are asked for is counted for those alone."""
    stages = {name: _mean([result.timings.get(name, 0.0) for result in results]) for name in ("fly", "measure", "daa", "check")}
    some = sum(number * _mean([result.timings.get(name, 0.0) for result in results]) for name, number in _asked(counted).items())
    at_work = max(1, min(workers, counted.flights))
    return START_S + (counted.flights * sum(stages.values()) + some) / at_work + counted.flights * DRIVER_S


def told(counted: Counted, of: Estimate, workers: int) -> list[str]:
    """The estimate in lines for people."""
    from testbed.show import words

    if not of.flown:
        return [f"no estimate: {of.said}"]
    in_all = sum(of.bytes.values())
    each = ", ".join(f"{name} {words.size(size / counted.flights)}" for name, size in of.bytes.items())
    lines = [
        f"on disk about {words.size(in_all / counted.flights)} a flight, {words.size(in_all)} in all ({each}), and a page of at most 5 MB",
        f"about {words.duration(of.seconds)} with {words.counted(workers, 'worker')}, by {words.counted(of.flown, 'flight')} flown to see",
    ]
    return [*lines, *([of.said] if of.said else [])]
