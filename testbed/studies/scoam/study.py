"""The study of the paper's method as the testbed sees it: what becomes of the paper's claims leads the page."""

from collections.abc import Mapping
from typing import ClassVar

from testbed.campaign.words.settings import FlightPlan
from testbed.campaign.words.study import Labels
from testbed.studies.scoam.labels import LABELS
from testbed.studies.study import Run, Study, Written


class Scoam(Study):
    """Does the paper's method survive flight dynamics and wind? ``docs/verdict.md``."""

    labels: ClassVar[Labels | None] = LABELS
    formerly: ClassVar[Mapping[str, str]] = {"verdict": "study: {kind: scoam}"}

    def pictures(self, plan: FlightPlan) -> bool:
        from testbed.studies.scoam.page.picture_data import picture_of

        return picture_of(plan.labels, plan.replicate) is not None

    def write(self, run: Run) -> Written:
        from testbed.studies.scoam.answer import answer
        from testbed.studies.scoam.audit.audit import audit
        from testbed.studies.scoam.audit.report import page_text
        from testbed.studies.scoam.page import render
        from testbed.studies.scoam.pose import event_reach
        from testbed.studies.scoam.verdict import csv_bytes, judge, readings_bytes

        found = judge(run.rows, event_reach)
        files = {"verdict.csv": csv_bytes(found), "audit.html": page_text(audit()).encode()}
        if found.reading_cells:
            files["readings.csv"] = readings_bytes(found)
        return Written(files, head=render(found, run.rows, run.series), answer=answer(found))
