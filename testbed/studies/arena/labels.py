"""The axes that a flight of an arena has: all that the study asks of a campaign."""

from collections.abc import Iterator, Mapping
from typing import Final

from testbed.campaign.words.study import Axes, LabelKind

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
