"""From the rows of a run to its files: tables, page, checks, verdict. In plan order; the same bytes for the same rows."""

import csv
import io
import math
import statistics
from collections.abc import Sequence
from typing import TYPE_CHECKING

from testbed.campaign.words.settings import Campaign, FlightPlan
from testbed.run.directory import RunDirectory
from testbed.run.job import JobResult
from testbed.run.manifest import Manifest, provenance

if TYPE_CHECKING:
    from testbed.results.checks import CheckResult
    from testbed.show.assets import Lead


def write_results(
    directory: RunDirectory, about: Manifest, campaign: Campaign, plans: Sequence[FlightPlan], by_id: dict[str, JobResult]
) -> "tuple[CheckResult, ...]":
    """Write what follows from the rows there are; returns the lines of the campaign's check."""
    from testbed.results import tables
    from testbed.show.page import render_page

    flown = [plan for plan in plans if plan.flight_id in by_id]
    results = [by_id[plan.flight_id] for plan in flown]
    if any(plan.lead_time for plan in plans):
        directory.put("timings.csv", _timings(results))
        _lead_time(directory, about, campaign, flown, results, len(plans))
        return ()
    rows = [result.row for result in results]
    labels = [row["labels"] for row in rows] + [plan.labels for plan in plans]  # rows have the order of the axes, plans all their labels
    table = tables.table(rows, tables.axis_kinds(labels))
    directory.put("results.csv", tables.csv_bytes(table))
    directory.put("results.parquet", tables.parquet_bytes(table))
    directory.put("timings.csv", _timings(results))
    series = {result.row["flight_id"]: result.series for result in results if result.series is not None}
    checks = _check(directory, campaign, flown, results, len(plans))
    lead = _verdict(directory, campaign, results)
    page = render_page(campaign, rows, series, provenance(about, len(plans), len(rows)), checks, lead)
    directory.put("index.html", page.encode())
    return checks


def _check(
    directory: RunDirectory, campaign: Campaign, plans: Sequence[FlightPlan], results: Sequence[JobResult], planned: int
) -> "tuple[CheckResult, ...]":
    """The lines of the campaign's check, also written to ``checks.csv``; none if it has no check."""
    if campaign.check is None:
        return ()
    from testbed.results import checks

    flights = [checks.Flown(plan, result.row) for plan, result in zip(plans, results, strict=True)]
    lines = checks.judge(campaign.check, flights, planned)
    directory.put("checks.csv", checks.csv_bytes(campaign.check.kind, lines))
    return lines


def _verdict(directory: RunDirectory, campaign: Campaign, results: Sequence[JobResult]) -> "Lead | None":
    """What leads the page of a verdict, also written to ``verdict.csv``; nothing if none is asked for."""
    if campaign.verdict is None:
        return None
    from testbed.studies.scoam.page import render
    from testbed.studies.scoam.pose import event_reach
    from testbed.studies.scoam.verdict import csv_bytes, judge

    rows = [result.row for result in results]
    found = judge(rows, event_reach, _answer_ms(results))
    directory.put("verdict.csv", csv_bytes(found))
    return render(found, rows, {result.row["flight_id"]: result.series for result in results if result.series is not None})


def _lead_time(
    directory: RunDirectory, about: Manifest, campaign: Campaign, plans: Sequence[FlightPlan], results: Sequence[JobResult], planned: int
) -> None:
    """The lines and the page of a lead-time study: its flights are searches."""
    from testbed.studies.lead_time.line import Searches, csv_text, line_of
    from testbed.studies.lead_time.page import page_text

    found = zip(plans, results, strict=True)
    lines = tuple(line_of(plan, result.row) for plan, result in found if "lead" in result.row)
    study = Searches(campaign.question, campaign.seed, lines, provenance(about, planned, len(results)))
    directory.put("lead_time.csv", csv_text(lines).encode())
    directory.put("index.html", page_text(study).encode())


def _answer_ms(results: Sequence[JobResult]) -> float:
    """What an answer of the planner typically costs: the median over flights, rounded up to a power of ten, at least 10 ms.

    A time of the computer would make every page another one; its order of magnitude does not. NaN without answers.
    """
    costs = [result.timings["fly.answer"] for result in results if result.timings.get("fly.answer", 0.0) > 0.0]
    return 10.0 ** max(1, math.ceil(math.log10(1e3 * statistics.median(costs)))) if costs else math.nan


def _timings(results: Sequence[JobResult]) -> bytes:
    stages = list(dict.fromkeys(stage for result in results for stage in result.timings))
    out = io.StringIO(newline="")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["flight_id", *(f"{stage}_s" for stage in stages)])
    for result in results:
        writer.writerow([result.row["flight_id"], *(f"{result.timings[s]:.6f}" if s in result.timings else "" for s in stages)])
    return out.getvalue().encode()
