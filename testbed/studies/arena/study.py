"""The arena as the testbed sees it: flights of any methods, judged together. No method, rung or population is known here by name."""

from typing import ClassVar

from testbed.campaign.words.study import Labels
from testbed.studies.arena.labels import EveryPart
from testbed.studies.study import Run, Study, Written


class Arena(Study):
    """Which method keeps every radius, where, and what does it cost? ``docs/arena.md``."""

    labels: ClassVar[Labels | None] = EveryPart()

    def write(self, run: Run) -> Written:
        from testbed.studies.arena.answer import answer
        from testbed.studies.arena.csv_file import csv_text
        from testbed.studies.arena.flights import read
        from testbed.studies.arena.page import page_text
        from testbed.studies.arena.ranks import judge
        from testbed.studies.arena.timings import timings_text

        flights = read(run)
        judged = judge(flights)
        files = {"arena.csv": csv_text(judged).encode(), "arena_timings.csv": timings_text(flights).encode()}
        return Written(files, page=page_text(run.campaign, flights, judged, run.provenance), answer=answer(judged))
