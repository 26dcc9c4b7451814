"""From the rows of a run to its files: tables, checks, answer, page, those of its study. In plan order; same rows, same bytes."""

import csv
import io
import json
from collections import Counter, deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from testbed.campaign.reading.blocks import weighted
from testbed.campaign.words.settings import Campaign, FlightPlan
from testbed.core.utf8 import utf8
from testbed.flight.record import Outcome
from testbed.results.columns import WEIGHT
from testbed.results.daa.columns import checked, daa_columns
from testbed.run import manifest, stopping
from testbed.run.directory import MANIFEST, OURS, BadInputError, RunDirectory
from testbed.run.foreign import is_plain
from testbed.run.job import Row
from testbed.run.journal import Index, decode, id_of, row_of, timings_of
from testbed.run.manifest import Manifest, provenance
from testbed.run.planned import Planned
from testbed.show.answer import Answer, Tally
from testbed.studies.study import Run, Written

if TYPE_CHECKING:
    from testbed.results.checks import CheckResult
    from testbed.results.columns import Kind
    from testbed.results.daa.risk import Risk


ANSWER, RISK = "answer.json", "risk.csv"


@dataclass(frozen=True)
class Results:
    """What was written, in short."""

    checks: "tuple[CheckResult, ...]"
    outcomes: dict[str, int]
    first_crash: str
    """Flight id and message of the first flight, in plan order, that crashed; empty if none did."""
    answer: Answer
    whole: int
    """Flights that the run is whole with."""


def write_results(directory: RunDirectory, about: Manifest, campaign: Campaign, planned: Planned, index: Index) -> Results:
    """Write what follows from the rows there are. They are read as they are needed, and none is held: there may be very many."""
    places = index.places(planned.ids)
    there = np.flatnonzero(places >= 0)
    daa = campaign.daa if not campaign.study.part.flies else None
    more = daa_columns(daa)
    rows = index.lines(places[there], lambda line: checked(row_of(line), more))
    timings = index.lines(places[there], timings_of)
    plans = planned.some(there)
    curved = index.lines(places[there][index.curved[places[there]]], decode)
    series = {result.row["flight_id"]: result.series for result in curved if result.series is not None}
    whole = stopping.flights(campaign, planned, index)
    told = provenance(about, whole, len(rows))
    counted = _Counted(rows)
    with directory.writing("timings.csv") as file:
        _write_timings(file, index, places[there])
    checks: tuple[CheckResult, ...] = ()
    if not campaign.study.part.flies:
        from testbed.results import tables

        axes = _axes(planned, there, rows)
        with directory.writing("results.csv") as table, directory.writing("results.parquet") as columns:
            tables.write(counted, axes, table, columns, [*more, *([WEIGHT] if weighted(campaign) else [])])
        checks = _check(directory, campaign, plans, rows, len(planned))
    else:
        deque(counted, maxlen=0)
    risk = _risk(directory, campaign, rows)
    made = _studied(campaign, Run(campaign, plans, rows, timings, series, told))
    manifest.own(directory, about, list(made.files))
    for name, data in made.files.items():
        directory.put(name, data)
    page = made.page
    if page is None:
        from testbed.show.page import render_page

        beside = ["results.csv", *(["checks.csv"] if checks else []), *([RISK] if risk and risk.ratios else []), *made.files]
        page = render_page(campaign, rows, series, told, checks, made.head, beside, risk)
    directory.put("index.html", utf8(page))
    answer = made.answer or counted.tally.answer(checks)
    directory.put(ANSWER, utf8(_answer_text(campaign, answer, counted.outcomes, whole)))
    return Results(checks, dict(counted.outcomes), counted.first_crash, answer, whole)


def _answer_text(campaign: Campaign, answer: Answer, outcomes: Counter[str], planned: int) -> str:
    """What a list of runs tells of this one, so that it need not look into its tables."""
    told = {"question": campaign.question, "flights_planned": planned, "outcomes": dict(sorted(outcomes.items())), **answer.as_dict()}
    return json.dumps(told, indent=1, allow_nan=False) + "\n"


class _Counted:
    """Rows that are counted as they go by."""

    def __init__(self, rows: Iterable[Row]):
        self._rows = rows
        self.outcomes: Counter[str] = Counter()
        self.tally = Tally()
        self.first_crash = ""

    def __iter__(self) -> Iterator[Row]:
        for row in self._rows:
            self.outcomes[row["outcome"]] += 1
            self.tally.add(row)
            if row["outcome"] == Outcome.CRASHED.value and not self.first_crash:
                self.first_crash = f"{row['flight_id']}: {row['message']}"
            yield row


def _axes(planned: Planned, there: np.ndarray, rows: Sequence[Row]) -> "dict[str, Kind]":
    """What the column of each axis holds. The order of the axes, which a plan file does not keep, is that of the rows: the first row
    of each set of axes tells.
    """
    from testbed.results import tables

    kinds = tables.kinds_of(planned.labels)
    order: dict[str, None] = {}
    seen: set[int] = set()
    for row_number, number in enumerate(there):
        if planned.axes[number] not in seen:
            seen.add(planned.axes[number])
            order |= dict.fromkeys(rows[row_number]["labels"])
    return {axis: kinds[axis] for axis in dict.fromkeys([*order, *kinds]) if axis in kinds}


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
    directory: RunDirectory, campaign: Campaign, plans: Sequence[FlightPlan], rows: Sequence[Row], planned: int
) -> "tuple[CheckResult, ...]":
    """The lines of the campaign's check, also written to ``checks.csv``; none if it has no check."""
    if campaign.check is None:
        return ()
    from testbed.results import checks

    flights = [checks.Flown(plan, row) for plan, row in zip(plans, rows, strict=True)]
    lines = checks.judge(campaign.check, flights, planned)
    directory.put("checks.csv", checks.csv_bytes(campaign.check.kind, lines))
    return lines


def _risk(directory: RunDirectory, campaign: Campaign, rows: Sequence[Row]) -> "Risk | None":
    """Ratios of risk, also written to ``risk.csv``; none of a campaign without a section daa, or without flights without avoidance."""
    if campaign.daa is None or campaign.study.part.flies:
        return None
    from testbed.results.daa.risk import csv_bytes, risk_of

    risk = risk_of(rows, campaign.daa, campaign.seed)
    if risk.ratios:
        directory.put(RISK, csv_bytes(risk, campaign.daa))
    return risk


def _write_timings(file: BinaryIO, rows: Index, places: np.ndarray) -> None:
    stages = list(dict.fromkeys(stage for stages in rows.lines(places, timings_of) for stage in stages))
    text = io.TextIOWrapper(file, encoding="utf-8", newline="", write_through=False)
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["flight_id", *(f"{stage}_s" for stage in stages)])
    for flight_id, seconds in rows.lines(places, lambda line: (id_of(line), timings_of(line))):
        writer.writerow([flight_id, *(f"{seconds[s]:.6f}" if s in seconds else "" for s in stages)])
    text.flush()
    text.detach()
