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
    "deflection_ground_deg flown_deflection_deg flown_deflection_air_deg peak_deflection_deg peak_deflection_air_deg "
    "avoidance_time_s insertion_miss_m clear_time_s rejoin_time_s rejoin_length_m"
)
OF_AN_OBSTACLE: Final = _named(
    "least_clearance_m time_at_least_clearance_s schedule_error_s planned_clearance_m schedule_part_m cross_track_part_m "
    "encounter_radius_m encounter_speed_mps encounter_closing_mps encounter_miss_m encounter_crossing_deg"
)
FLOWN: Final = ("flight_time_s", "path_length_m", "max_airspeed_mps", "max_load_factor")


def _nothing_flown(row: Row) -> bool:
    """Not a single tick: no trim, no route, the start in the ground. The row says why, and has no number of a flight."""
    none = all(math.isnan(value(row, name)) for name in FLOWN)
    return none and row["outcome"] not in ("reached", "collided", "timed_out") and bool(row.get("message"))


def _no_velocity(row: Row) -> bool:
    """Of a law, or a planner of somebody's own: it bends the path and names no velocity."""
    return not any(math.isfinite(value(event, "deflection_rad")) for event in row["events"])


def _pieces_like_ticks(row: Row) -> bool:
    """A path of bends that are flown in less than half a second, in whose every few ticks the piece changes."""
    return row["plant"] == "kinematic" and value(row, "planned_min_radius_m") < 0.5 * value(row, "max_airspeed_mps")


REASONS: Final = (
    Reason("nothing was flown", _nothing_flown, NUMBERS),
    Reason("there was no obstacle", lambda row: row["nearest_obstacle"] == "", OF_AN_OBSTACLE),
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
    Reason("nothing was decided", lambda row: not row["events"], _named("trigger_time_s route_miss_m")),
    Reason(
        "the path was never changed, or by what names no velocity",
        lambda row: not row["replans"] or _no_velocity(row),
        _named("deflection_deg"),
    ),
    Reason(
        "no insertion point, never clear, never back, or the flight ends with the decision: what ends an avoidance need not come",
        lambda _: True,
        OF_AN_AVOIDANCE,
    ),
    Reason("a point has no wing", lambda row: row["plant"] != "jsbsim", _named("max_alpha_deg")),
    Reason("after a tick or two nothing has a rate", lambda row: value(row, "flight_time_s") < 0.05, _named("max_roll_rate_dps")),
    Reason(
        "the roll of a point jumps where the piece of its path changes, which may be all the time",
        _pieces_like_ticks,
        _named("max_roll_rate_dps"),
    ),
    Reason("the planned path is straight", lambda _: True, _named("planned_min_radius_m")),
)


def undeclared(row: Row) -> list[str]:
    """Numbers of a flown row that are missing without a reason, or infinite, in the order of the columns."""
    if row["outcome"] == "crashed":
        return []
    excused = frozenset().union(*(reason.columns for reason in REASONS if reason.holds(row)))
    found = [(column.name, value(row, column.name)) for column in METRICS if column.kind is Kind.NUMBER]
    return [name for name, number in found if math.isinf(number) or (math.isnan(number) and name not in excused)]
