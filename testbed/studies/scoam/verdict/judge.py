"""From rows to the verdict. Pure: the rows go in (the aircraft's limits come from the catalogue), a frozen value comes out."""

from collections.abc import Iterable

from testbed.studies.scoam.verdict.ablation import waterfalls
from testbed.studies.scoam.verdict.comparisons import comparisons
from testbed.studies.scoam.verdict.controls import controls
from testbed.studies.scoam.verdict.flights import Flights, Row
from testbed.studies.scoam.verdict.judged import Verdict
from testbed.studies.scoam.verdict.numbers import numbers
from testbed.studies.scoam.verdict.online import online
from testbed.studies.scoam.verdict.promises import promises
from testbed.studies.scoam.verdict.ranking import ranks
from testbed.studies.scoam.verdict.reach import Reach
from testbed.studies.scoam.verdict.readings import reading_cells, readings
from testbed.studies.scoam.verdict.superior import superior
from testbed.studies.scoam.verdict.tables import air_cells, cases, counted


def judge(rows: Iterable[Row], reach: Reach | None = None) -> Verdict:
    """The verdict on the paper's claims. A part that is missing leaves NaN and ``not determined``.

    ``reach``: a bound on the pose of the insertion point, from a re-plan and an aircraft's limits; without one the pose is not tested.
    """
    flights = Flights(rows)
    safe, flyable, several, overload = promises(flights, reach)
    words = (safe, flyable, several, *comparisons(flights), online(flights, safe), superior(flights), overload)
    return Verdict(
        (*words, *numbers(flights)),
        waterfalls(flights),
        controls(flights),
        ranks(flights),
        cases(flights),
        air_cells(flights),
        counted(flights),
        readings(flights),
        reading_cells(flights),
    )
