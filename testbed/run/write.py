"""From the rows of a run to its files: tables, checks, page, those of its study. In plan order; the same bytes for the same rows."""

import csv
import io
from collections.abc import Sequence
from typing import TYPE_CHECKING

from testbed.campaign.words.settings import Campaign, FlightPlan
from testbed.core.utf8 import utf8
from testbed.run import manifest
from testbed.run.directory import MANIFEST, OURS, BadInputError, RunDirectory
from testbed.run.foreign import is_plain
from testbed.run.job import JobResult
from testbed.run.manifest import Manifest, provenance
from testbed.studies.study import Run, Written

if TYPE_CHECKING:
    from testbed.results.checks import CheckResult


def write_results(
    directory: RunDirectory, about: Manifest, campaign: Campaign, plans: Sequence[FlightPlan], by_id: dict[str, JobResult]
) -> "tuple[CheckResult, ...]":
    """Write what follows from the rows there are; returns the lines of the campaign's check."""
    flown = [plan for plan in plans if plan.flight_id in by_id]
    results = [by_id[plan.flight_id] for plan in flown]
    rows = [result.row for result in results]
    series = {result.row["flight_id"]: result.series for result in results if result.series is not None}
    told = provenance(about, plans, len(rows))
    directory.put("timings.csv", _timings(results))
    checks: tuple[CheckResult, ...] = ()
    if not campaign.study.part.flies:
        from testbed.results import tables

        # rows have the order of the axes, plans all their labels
        table = tables.table(rows, tables.axis_kinds([row["labels"] for row in rows] + [plan.labels for plan in plans]))
        directory.put("results.csv", tables.csv_bytes(table))
        directory.put("results.parquet", tables.parquet_bytes(table))
        checks = _check(directory, campaign, flown, results, len(plans))
    made = _studied(campaign, Run(campaign, flown, rows, [result.timings for result in results], series, told))
    manifest.own(directory, about, list(made.files))
    for name, data in made.files.items():
        directory.put(name, data)
    page = made.page
    if page is None:
        from testbed.show.page import render_page

        page = render_page(campaign, rows, series, told, checks, made.head)
    directory.put("index.html", utf8(page))
    return checks


def _studied(campaign: Campaign, run: Run) -> Written:
    """What the campaign's study makes of the run. One in a file of the user's own may do so wrongly."""
    study, kind = campaign.study.made(), campaign.study.kind
    try:
        made = study.write(run)
    except Exception as bug:
        if ":" not in kind:
            raise
        raise BadInputError(
            f"the study '{kind}' fails to write: {type(bug).__name__}: {bug}; the flights are kept: mend it, and run the campaign again"
        ) from bug
    if not isinstance(made, Written):
        raise BadInputError(f"the study '{kind}' writes {type(made).__name__}, and no testbed.studies.study.Written")
    if wrong := [str(name) for name in made.files if not is_plain(name) or name in (*OURS, MANIFEST)]:
        raise BadInputError(f"the study '{kind}' cannot write files of these names: {', '.join(wrong)}")
    if study.flies and made.page is None:
        raise BadInputError(f"the study '{kind}' flies by itself, and has to write a page of its own")
    return made


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


def _timings(results: Sequence[JobResult]) -> bytes:
    stages = list(dict.fromkeys(stage for result in results for stage in result.timings))
    out = io.StringIO(newline="")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["flight_id", *(f"{stage}_s" for stage in stages)])
    for result in results:
        writer.writerow([result.row["flight_id"], *(f"{result.timings[s]:.6f}" if s in result.timings else "" for s in stages)])
    return out.getvalue().encode()
