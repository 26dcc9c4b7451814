"""The arena as the testbed sees it: flights of any methods, judged together. No method, rung or population is known here by name."""

from collections.abc import Iterator, Mapping
from typing import ClassVar, Final

from testbed.campaign.words.study import Axes, LabelKind, Labels
from testbed.studies.study import Run, Study, Written

METHOD, RUNG, FLOWN_BY, LEAD_S = "method", "rung", "flown_by", "lead_s"
AXES: Final[Axes] = {METHOD: LabelKind.ANY, RUNG: LabelKind.ANY, FLOWN_BY: LabelKind.AIRCRAFT, LEAD_S: LabelKind.NUMBER}


class EveryPart(Mapping[str, Axes]):
    """The same axes for a part of whatever name: each part is a population of encounters, and so is a campaign without parts."""

    def __getitem__(self, part: str) -> Axes:
        return AXES

    def __iter__(self) -> Iterator[str]:
        return iter(())

    def __len__(self) -> int:
        return 0


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
