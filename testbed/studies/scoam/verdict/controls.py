"""Controls: flights of which it is known beforehand what they must show."""

from collections.abc import Callable, Iterable
from typing import Final

import numpy as np

from testbed.studies.scoam.claim import Control
from testbed.studies.scoam.labels import MULTI, SINGLE, Axis, Design, Encounter, Method, Part, Rung
from testbed.studies.scoam.verdict.csv_words import say
from testbed.studies.scoam.verdict.flights import Flights, Row, clearance, keeps, label, number

SAME_MISS_M: Final = 1.0
"""Anchored wind: an aircraft without planner has its calm clearance within this; on rails it is the same to rounding."""
EXACT_M: Final = 0.01
RESIDUAL_M: Final = 0.5
"""Clearance = planned + schedule part + cross-track part, within this."""
MOST_EXCEPTIONS_NAMED: Final = 3


def controls(flights: Flights) -> tuple[Control, ...]:
    """All of them; one without flights has n = 0."""
    calm = _rows(flights, Part.CALM)
    told = _rows(flights, Part.CONTROLS)
    idle = [row for row in calm if label(row, Axis.METHOD) == Method.NONE and label(row, Axis.ENCOUNTER) in (*SINGLE, *MULTI)]
    harmless = [row for row in calm if label(row, Axis.ENCOUNTER) == Encounter.SINGLE_AS_PRINTED]
    active = [row for row in told if label(row, Axis.METHOD) != Method.NONE]
    gentle = [row for row in active if label(row, Axis.ENCOUNTER) == Encounter.GENTLE]
    bare = [row for row in active if label(row, Axis.ENCOUNTER) == Encounter.GENTLE_NO_MARGIN]
    at_once = [row for row in bare if label(row, Axis.RUNG) == Rung.VO_INSTANT]
    through = [row for row in bare if label(row, Axis.RUNG) == Rung.KINEMATIC]
    impossible = [row for row in active if label(row, Axis.ENCOUNTER) == Encounter.IMPOSSIBLE]
    windy = [row for row in _rows(flights, Part.WIND) if label(row, Axis.DESIGN) == Design.ANCHORED]
    anchored = [row for row in windy if label(row, Axis.METHOD) == Method.NONE]
    same_miss = [row for row in anchored if np.isfinite(_calm_miss(flights, row))]
    split = [row for row in calm if np.isfinite(_residual(row))]
    kept = f" (through the insertion point {sum(map(keeps, through))} of {len(through)} on rails do)" if through else ""
    return (
        _control("no planner", "every flight at a threat in calm air comes inside a radius", idle, lambda row: not keeps(row)),
        _control(
            "no threat", "Table 1 as printed: no re-plan, and the radius is kept", harmless, lambda row: keeps(row) and not _acts(row)
        ),
        _control("gentle", "6 s ahead with 8 m of margin every method keeps the radius on every rung", gentle, keeps),
        _control("gentle without margin", f"6 s ahead the direction flown at once keeps the radius{kept}", at_once, keeps),
        _control("impossible", "0.3 s ahead no method keeps the radius on any rung", impossible, lambda row: not keeps(row)),
        _control(
            "anchored wind, on rails",
            f"the point without planner has its calm clearance within {EXACT_M:g} m",
            [row for row in same_miss if label(row, Axis.RUNG) == Rung.KINEMATIC],
            lambda row: abs(_calm_miss(flights, row)) <= EXACT_M,
        ),
        _control(
            "anchored wind, flown",
            f"the aircraft without planner has its calm clearance within {SAME_MISS_M:g} m",
            [row for row in same_miss if label(row, Axis.RUNG) == Rung.JSBSIM],
            lambda row: abs(_calm_miss(flights, row)) <= SAME_MISS_M,
        ),
        _control(
            "clearance adds up",
            f"planned, schedule and cross-track parts make up the clearance within {RESIDUAL_M:g} m",
            split,
            lambda row: abs(_residual(row)) <= RESIDUAL_M,
        ),
    )


def _rows(flights: Flights, part: str) -> list[Row]:
    silent = {id(row) for row in flights.silent}
    return [row for row in flights.all if label(row, Axis.PART) == part and id(row) not in silent]


def _acts(row: Row) -> bool:
    return number(row, "replans") > 0


def _calm_miss(flights: Flights, row: Row) -> float:
    where = {Axis.ENCOUNTER: label(row, Axis.ENCOUNTER), Axis.FLOWN_BY: label(row, Axis.FLOWN_BY)}
    rung = label(row, Axis.RUNG)
    return clearance(row) - clearance(flights.one(Part.CALM, Method.NONE, rung, **where))


def _residual(row: Row) -> float:
    return clearance(row) - number(row, "planned_clearance_m") - number(row, "schedule_part_m") - number(row, "cross_track_part_m")


def _control(name: str, expected: str, rows: Iterable[Row], met: Callable[[Row], bool]) -> Control:
    every = list(rows)
    wrong = [row for row in every if not met(row)]
    named = [f"{row.get('cell')} ({say(clearance(row), 'm')})" for row in wrong[:MOST_EXCEPTIONS_NAMED]]
    more = [f"and {len(wrong) - MOST_EXCEPTIONS_NAMED} more"] if len(wrong) > MOST_EXCEPTIONS_NAMED else []
    return Control(name, expected, len(every) - len(wrong), len(every), "; ".join([*named, *more]))
