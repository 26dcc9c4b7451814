"""The study of the paper's method as the testbed sees it: what becomes of the paper's claims leads the page."""

import math
import statistics
from collections.abc import Mapping, Sequence
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
        from testbed.studies.scoam.page import render
        from testbed.studies.scoam.pose import event_reach
        from testbed.studies.scoam.verdict import csv_bytes, judge

        found = judge(run.rows, event_reach, answer_ms(run.timings))
        return Written({"verdict.csv": csv_bytes(found)}, head=render(found, run.rows, run.series))


def answer_ms(timings: Sequence[Mapping[str, float]]) -> float:
    """What an answer of the planner typically costs: the median over flights, rounded up to a power of ten, at least 10 ms.

    A time of the computer would make every page another one; its order of magnitude does not. NaN without answers.
    """
    costs = [seconds for stages in timings if (seconds := stages.get("fly.answer", 0.0)) > 0.0]
    return 10.0 ** max(1, math.ceil(math.log10(1e3 * statistics.median(costs)))) if costs else math.nan
