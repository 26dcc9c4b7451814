"""The lead-time study as the testbed sees it: each flight a search, and a page of its own."""

import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any, ClassVar

from testbed.campaign.words.settings import FlightPlan
from testbed.studies.lead_time.options import LeadTime
from testbed.studies.study import Run, Study, Written


class LeadTimeStudy(Study):
    """How early must a threat be answered? ``docs/lead_time.md``."""

    Options = LeadTime
    flies: ClassVar[bool] = True
    formerly: ClassVar[Mapping[str, str]] = {
        "lead_time": "study: {kind: lead_time, options: {leads_s: [...], ...}}, and study.options.<name> in parts and sweeps"
    }

    def __init__(self, **options: Any):
        self._options = LeadTime.model_validate(options)

    def unfit(self, settings: Mapping[str, Any]) -> str | None:
        return self._options.unfit(settings)

    def fly(self, plan: FlightPlan) -> tuple[str, dict[str, Any]]:
        from testbed.studies.lead_time import search

        found = search.search(plan)
        return "found" if math.isfinite(found.lead_s) else "not_found", asdict(found)

    def write(self, run: Run) -> Written:
        from testbed.studies.lead_time.answer import answer
        from testbed.studies.lead_time.line import Searches, csv_text, line_of
        from testbed.studies.lead_time.page import page_text

        lines = tuple(line_of(plan, row) for plan, row in zip(run.plans, run.rows, strict=True) if "found" in row)
        study = Searches(run.campaign.question, run.campaign.seed, lines, dict(run.provenance))
        return Written({"lead_time.csv": csv_text(lines).encode()}, page=page_text(study), answer=answer(lines))
