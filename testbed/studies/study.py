"""What a study is: the question behind a campaign, and all that is peculiar to it.

    from testbed.studies.study import Run, Study, Written

    class Tally(Study):
        labels = {"": {"method": ("none", "scoam")}}
        def __init__(self, least_m: float = 0.0): ...
        def write(self, run: Run) -> Written: ...

A study is a class; what its ``__init__`` takes (or its model ``Options``) are the options that a campaign may give it. Whatever it does
not say is as it is without a study. ``testbed.run`` flies, stores and writes for all of them alike.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from testbed.campaign.words.settings import Campaign, FlightPlan
    from testbed.campaign.words.study import Labels
    from testbed.show.answer import Answer
    from testbed.show.assets import PageHead

Row = dict[str, Any]


@dataclass(frozen=True)
class Run:
    """The flights that have a row, in plan order: plan, row as in ``rows.jsonl``, and wall-clock seconds of each, side by side.

    All three are read from the run's files flight by flight as they are asked for, each time anew, since there may be more of them than
    memory holds: go through them once, and keep what you need.
    """

    campaign: "Campaign"
    plans: "Sequence[FlightPlan]"
    rows: Sequence[Row]
    timings: Sequence[Mapping[str, float]]
    series: Mapping[str, dict[str, Any]]
    """Flight to the curves of it that were stored."""
    provenance: Mapping[str, Any]
    """What the page is told of the run's origin."""


@dataclass(frozen=True)
class Written:
    """What a study makes of a run: the same bytes for the same rows."""

    files: Mapping[str, bytes] = field(default_factory=dict)
    """Name in the run directory to content."""
    head: "PageHead | None" = None
    """What stands on top of the ordinary page, which is folded up below it."""
    page: str | None = None
    """A page of its own instead."""
    answer: "Answer | None" = None
    """What it found, in three lines; by default what became of the clearance."""


class Study:
    """No question but the campaign's own: the ordinary page. Others derive from it."""

    labels: "ClassVar[Labels | None]" = None
    """The labels that it selects flights by, against which a campaign is checked when it is loaded. None: it needs none."""
    flies: ClassVar[bool] = False
    """Whether its unit is not one flight: ``fly`` then takes the place of it, and ``write`` has to give a page. Its options are part of
    what a flight is. Otherwise they are not: the same flights can be judged anew."""
    formerly: ClassVar[Mapping[str, str]] = {}
    """Keys that a campaign once had for it, to what is written instead."""

    def unfit(self, settings: Mapping[str, Any]) -> str | None:  # noqa: ARG002 (for those that derive from it)
        """Why flights with these settings are nothing for it, as a sentence that begins with its verb; None if they are.

        Settings that are faulty themselves are absent.
        """
        return None

    def pictures(self, plan: "FlightPlan") -> bool:  # noqa: ARG002
        """Whether the flight is in its pictures: such flights have their curves stored first, and `recordings: selected` means them."""
        return False

    def fly(self, plan: "FlightPlan") -> tuple[str, dict[str, Any]]:
        """(outcome, what was found: numbers and lists of them) in the place of a flight's metrics. Of a study that ``flies``."""
        raise NotImplementedError(f"{type(self).__name__} flies, and does not say how")

    def write(self, run: Run) -> Written:  # noqa: ARG002
        """What becomes of the rows."""
        return Written()
