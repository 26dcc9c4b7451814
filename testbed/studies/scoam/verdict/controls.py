"""Controls: flights of which it is known beforehand what they must show."""

from collections.abc import Callable, Iterable
from typing import Final

import numpy as np

from testbed.studies.scoam.claim import Control
from testbed.studies.scoam.verdict.saying import say
from testbed.studies.scoam.verdict.select import MULTI, SINGLE, Flights, Row, clearance, keeps, label, number

SAME_MISS_M: Final = 1.0
"""Anchored wind: an aircraft without planner has its calm clearance within this; on rails it is the same to rounding."""
EXACT_M: Final = 0.01
RESIDUAL_M: Final = 0.5
"""Clearance = planned + schedule part + cross-track part, within this."""
SHOWN: Final = 3  # exceptions that are named


def controls(flights: Flights) -> tuple[Control, ...]:
    """All of them; one without flights has n = 0."""
    calm = _rows(flights, "calm")
    told = _rows(flights, "controls")
    idle = [row for row in calm if label(row, "method") == "none" and label(row, "encounter") in (*SINGLE, *MULTI)]
    harmless = [row for row in calm if label(row, "encounter") == "single_as_printed"]
    active = [row for row in told if label(row, "method") != "none"]
    gentle = [row for row in active if label(row, "encounter") == "gentle"]
    bare = [row for row in active if label(row, "encounter") == "gentle_no_margin"]
    at_once = [row for row in bare if label(row, "rung") == "vo_instant"]
    through = [row for row in bare if label(row, "rung") == "kinematic"]
    impossible = [row for row in active if label(row, "encounter") == "impossible"]
    anchored = [row for row in _rows(flights, "wind") if label(row, "design") == "anchored" and label(row, "method") == "none"]
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
            [row for row in same_miss if label(row, "rung") == "kinematic"],
            lambda row: abs(_calm_miss(flights, row)) <= EXACT_M,
        ),
        _control(
            "anchored wind, flown",
            f"the aircraft without planner has its calm clearance within {SAME_MISS_M:g} m",
            [row for row in same_miss if label(row, "rung") == "jsbsim"],
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
    return [row for row in flights.all if label(row, "part") == part and id(row) not in silent]


def _acts(row: Row) -> bool:
    return number(row, "replans") > 0


def _calm_miss(flights: Flights, row: Row) -> float:
    where = {"encounter": label(row, "encounter"), "flown_by": label(row, "flown_by")}
    rung = label(row, "rung")
    return clearance(row) - clearance(flights.one("calm", "none", rung, **where))


def _residual(row: Row) -> float:
    return clearance(row) - number(row, "planned_clearance_m") - number(row, "schedule_part_m") - number(row, "cross_track_part_m")


def _control(name: str, expected: str, rows: Iterable[Row], met: Callable[[Row], bool]) -> Control:
    every = list(rows)
    wrong = [row for row in every if not met(row)]
    named = [f"{row.get('cell')} ({say(clearance(row), 'm')})" for row in wrong[:SHOWN]]
    more = [f"and {len(wrong) - SHOWN} more"] if len(wrong) > SHOWN else []
    return Control(name, expected, len(every) - len(wrong), len(every), "; ".join([*named, *more]))
