"""How a check campaign is judged: what was flown against a truth that does not come from the flight.

Where a flight is flown, ``evidence`` takes from its record the few numbers that its check needs; they stay in the row. ``judge``
holds the rows of a campaign against the truth, so a run can be judged again, or to another tolerance, without flying. A line says of a
quantity what is true, what was measured, and whether that is near enough.
"""

from collections.abc import Sequence

from testbed.campaign.words.check import Check
from testbed.flight.record import FlightRecord, Outcome
from testbed.results.checks import air, modes, numerics, power, steady, turbulence
from testbed.results.checks.verdict import CheckResult, Evidence, Flown, Judge, csv_bytes, nothing

__all__ = ["CHECKS", "CheckResult", "Evidence", "Flown", "Judge", "csv_bytes", "evidence", "judge"]

CHECKS = {
    "wind_triangle": Judge(air.triangle_flown, air.wind_triangle),
    "gust_response": Judge(air.load_factor_flown, air.gust_response),
    "invariance": Judge(nothing, air.invariance),
    "turbulence": Judge(turbulence.gusts_met, turbulence.turbulence),
    "steady_turn": Judge(steady.turn_flown, steady.steady_turn),
    "trims": Judge(steady.trim_flown, steady.trims),
    "excess_power": Judge(power.climb_flown, power.excess_power),
    "energy": Judge(power.energy_flown, power.energy),
    "modes": Judge(modes.modes_flown, modes.modes),
    "convergence": Judge(numerics.places_flown, numerics.convergence),
    "clearance": Judge(nothing, numerics.clearance),
}

JUDGED = {Outcome.REACHED, Outcome.COLLIDED, Outcome.NO_PATH}
"""Flights that came to their end; of the others there is no evidence."""


def evidence(check: Check, record: FlightRecord) -> Evidence | None:
    """What the check needs of a record; None when the flight did not come to its end."""
    flown = record.outcome in JUDGED and len(record.columns["time_s"]) > 1
    return CHECKS[check.kind].gather(check, record) if flown else None


def judge(check: Check, flights: Sequence[Flown], planned: int) -> tuple[CheckResult, ...]:
    """The lines of a check, in a fixed order. The first counts the flights: one that is missing or failed is a miss."""
    good = [flight for flight in flights if flight.row.get("evidence") is not None]
    lines = list(CHECKS[check.kind].judge(check, good)) if good else []
    counted = CheckResult("flights that can be judged", "", float(planned), float(len(good)), 0.0)
    compared = [] if lines else [CheckResult("something to compare", "", 1.0, 0.0, 0.0)]
    return (counted, *compared, *lines)
