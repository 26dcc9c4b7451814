"""Methods on the population: one line a rung and method, paired by encounter with SCOAM."""

from typing import Final

from testbed.results.statistics import mcnemar, median, share_interval, spread
from testbed.studies.scoam.claim import Rank
from testbed.studies.scoam.labels import DROAM, Axis, Method, Part, Rung
from testbed.studies.scoam.verdict.flights import Flights, Row, clearance, keeps, label, number

RANKED_METHODS: Final = (Method.SCOAM, *DROAM, Method.LEAST_DEFLECTION)
RANKED_RUNGS: Final = (Rung.KINEMATIC, Rung.JSBSIM, Rung.DIRECT)
RANKED_PART: Final = Part.POPULATION

Pairs = list[tuple[Row, Row]]


def ranks(flights: Flights) -> tuple[Rank, ...]:
    """Of every method and rung that was flown, at threats only."""
    every = [_rank(flights, rung, method) for rung in RANKED_RUNGS for method in RANKED_METHODS]
    return tuple(rank for rank in every if rank.n)


def threats(flights: Flights, method: str, rung: str) -> list[Row]:
    """The population's flights of a method on a rung in which a planner is needed."""
    return [row for row in flights.pick(RANKED_PART, method, rung) if flights.is_threat(row)]


def with_scoam(flights: Flights, method: str, rung: str) -> Pairs:
    """Pairs (SCOAM, method) of the same encounter."""
    other = {_encounter(row): row for row in threats(flights, method, rung)}
    return [(row, other[_encounter(row)]) for row in threats(flights, Method.SCOAM, rung) if _encounter(row) in other]


def safe_pairs(pairs: Pairs) -> tuple[int, int]:
    """Pairs in which only SCOAM keeps the radius, and in which only the other does."""
    return sum(keeps(a) and not keeps(b) for a, b in pairs), sum(keeps(b) and not keeps(a) for a, b in pairs)


def _encounter(row: Row) -> tuple[str, ...]:
    return (label(row, Axis.ENCOUNTER), label(row, Axis.FLOWN_BY), str(row.get("replicate")))


def _rank(flights: Flights, rung: str, method: str) -> Rank:
    rows = threats(flights, method, rung)
    pairs = with_scoam(flights, method, rung)
    safe = sum(keeps(row) for row in rows)
    return Rank(
        rung,
        method,
        len(rows),
        safe,
        *share_interval(safe, len(rows)),
        spread(clearance(row) for row in rows),
        spread(number(row, "deflection_deg") for row in rows),
        spread(extra_length(flights, row) for row in rows),
        spread(number(row, "clear_time_s") for row in rows),
        spread(number(row, "max_load_factor") for row in rows),
        median("median of SCOAM's clearance minus the method's", "m", (clearance(a) - clearance(b) for a, b in pairs)),
        mcnemar(*safe_pairs(pairs)),
    )


def extra_length(flights: Flights, row: Row) -> float:
    """Path length beyond that of the flight without planner in the same encounter, m."""
    return number(row, "path_length_m") - number(flights.idle(row), "path_length_m")
