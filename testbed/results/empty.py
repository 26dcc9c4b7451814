"""Which numbers of a row may be missing, and when: what is missing without one of these reasons is a fault of the program.

A number is missing (NaN, an empty field in files) where the quantity does not exist, never because a computation failed.
"""

import math
from collections.abc import Callable
from typing import Final, NamedTuple

from testbed.results.columns import METRICS, Kind
from testbed.results.flight_row import Row, value

NUMBERS: Final = frozenset(column.name for column in METRICS if column.kind is Kind.NUMBER)


class Reason(NamedTuple):
    """Why numbers are missing, when that holds of a row, and which."""

    words: str
    holds: Callable[[Row], bool]
    columns: frozenset[str]


def _named(names: str) -> frozenset[str]:
    return frozenset(names.split())


OF_AN_AVOIDANCE: Final = _named(
    "deflection_deg deflection_ground_deg flown_deflection_deg flown_deflection_air_deg peak_deflection_deg peak_deflection_air_deg "
    "avoidance_time_s insertion_miss_m clear_time_s rejoin_time_s rejoin_length_m"
)
OF_AN_OBSTACLE: Final = _named(
    "least_clearance_m time_at_least_clearance_s planned_clearance_m schedule_part_m cross_track_part_m encounter_radius_m "
    "encounter_speed_mps encounter_closing_mps encounter_miss_m encounter_crossing_deg"
)
REASONS: Final = (
    Reason("nothing was flown", lambda row: math.isnan(value(row, "flight_time_s")), NUMBERS),
    Reason("a state was not finite", lambda row: row["outcome"] == "diverged", NUMBERS),
    Reason("there was no obstacle", lambda row: math.isnan(value(row, "least_clearance_m")), OF_AN_OBSTACLE),
    Reason("nothing was decided", lambda row: not row.get("events"), _named("trigger_time_s route_miss_m")),
    Reason("nothing was avoided", lambda row: not row["replans"], OF_AN_AVOIDANCE),
    Reason(
        "the answer has no insertion point, or the flight was not clear, or not back, before it ended",
        lambda row: bool(row["replans"]),
        _named(
            "flown_deflection_deg flown_deflection_air_deg avoidance_time_s insertion_miss_m clear_time_s rejoin_time_s rejoin_length_m"
        ),
    ),
    Reason(
        "a law, or a planner of somebody's own, commands no velocity; or the flight ended with the decision",
        lambda row: bool(row["replans"]),
        OF_AN_AVOIDANCE,
    ),
    Reason("a point has no wing", lambda row: row["plant"] != "jsbsim", _named("max_alpha_deg")),
    Reason(
        "the flight lasted a tick or two", lambda row: value(row, "flight_time_s") < 0.05, _named("max_roll_rate_dps wind_along_std_mps")
    ),
    Reason("the planned path is straight", lambda _: True, _named("planned_min_radius_m")),
    Reason(
        "an obstacle that stands still has no course, and one at the same place no bearing",
        lambda _: True,
        _named("encounter_crossing_deg encounter_closing_mps"),
    ),
    Reason(
        "the point that keeps to its plan was at its goal before the obstacle came",
        lambda _: True,
        _named("planned_clearance_m schedule_part_m cross_track_part_m"),
    ),
)


def undeclared(row: Row) -> list[str]:
    """Numbers of a flown row that are missing without a reason, or infinite, in the order of the columns."""
    if row["outcome"] == "crashed":
        return []
    excused = frozenset().union(*(reason.columns for reason in REASONS if reason.holds(row)))
    found = [(column.name, value(row, column.name)) for column in METRICS if column.kind is Kind.NUMBER]
    return [name for name, number in found if math.isinf(number) or (math.isnan(number) and name not in excused)]
