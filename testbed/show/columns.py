"""The columns of the page's tables: heading, unit, decimals and definition, said once for table and glossary."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from testbed.flight.record import inside
from testbed.show.story import number


@dataclass(frozen=True)
class Column:
    """A metric as the page shows it. ``worse`` is the end of its range that a reader looks for: ``low``, ``high`` or neither."""

    key: str
    heading: str
    unit: str
    digits: int
    worse: str
    definition: str

    def text(self, row: Mapping[str, Any]) -> str:
        return number(value(row, self.key), self.digits)


def value(row: Mapping[str, Any], key: str) -> float:
    """A number of a row; NaN if it is missing, whichever way that is written."""
    found = row.get(key)
    return math.nan if found is None else float(found)


def collided(row: Mapping[str, Any]) -> bool:
    """Did the flight of a row come inside of an obstacle?"""
    return bool(inside(value(row, "least_clearance_m")))


METRICS = (
    Column("least_clearance_m", "least clearance", "m", 2, "low", "Least distance to an obstacle's surface; negative: a collision."),
    Column("time_at_least_clearance_s", "at", "s", 2, "", "Flight time of the least clearance."),
    Column("deflection_deg", "deflection", "deg", 1, "", "Space angle from the velocity to the command of the first re-plan."),
    Column("path_length_m", "length", "m", 1, "", "Length of the path flown over the ground."),
    Column("flight_time_s", "time", "s", 2, "", "Duration of the flight."),
    Column("cross_track_rms_m", "cross-track rms", "m", 2, "high", "Root mean square of the distance to the path active at each instant."),
    Column("cross_track_max_m", "cross-track max", "m", 2, "high", "Largest distance to the path that was active at that instant."),
    Column("schedule_error_s", "schedule error", "s", 2, "", "How late (positive) or early it was along its path at the closest approach."),
    Column("max_bank_deg", "bank", "deg", 1, "high", "Largest bank angle, either side; of the point: what its path would need."),
    Column("max_load_factor", "load factor", "", 2, "high", "Largest normal load factor (1 in level flight), a crash included."),
    Column("max_roll_rate_dps", "roll rate", "deg/s", 0, "high", "Largest roll rate, either side."),
    Column("min_airspeed_mps", "least airspeed", "m/s", 1, "low", "Least airspeed."),
    Column("max_alpha_deg", "alpha", "deg", 1, "high", "Largest angle of attack."),
    Column("saturated_share", "saturated", "", 2, "high", "Share of the flight in which guidance asked for more than the limits allow."),
    Column("airspeed_rms_error_mps", "airspeed error", "m/s", 2, "high", "Root mean square difference of the airspeed from the set speed."),
    Column("wind_along_std_mps", "gusts along", "m/s", 2, "", "Standard deviation of the air's velocity along the flight."),
    Column("clear_time_s", "clear after", "s", 2, "", "From the re-plan until obstacles open and every radius is kept to the end."),
    Column("rejoin_time_s", "rejoined after", "s", 1, "", "From the re-plan until back within 5 m of the route for good."),
    Column("rejoin_length_m", "length to rejoin", "m", 0, "", "Path flown over the ground until then."),
    Column("replans", "re-plans", "", 0, "", "Number of times the path was changed."),
)  # fmt: skip

SUMMARISED = ("least_clearance_m", "cross_track_rms_m", "cross_track_max_m", "max_bank_deg", "max_load_factor", "min_airspeed_mps")
"""What the table of cells shows as median and worst."""

BY_KEY = {column.key: column for column in METRICS}

DECISION_TERMS = (
    (
        "alpha, alpha_0",
        "deg",
        "Angle of the relative velocity from the line of sight, and half-angle of the collision cone: a threat when alpha is smaller.",
    ),
    ("miss", "m", "Least distance to the obstacle's centre if both flew straight on from there."),
    (
        "cap",
        "deg",
        "Spherical cap of forbidden directions on the velocity sphere: azimuth and elevation of its centre, and its half-angle.",
    ),
    ("command", "deg", "Azimuth and elevation of the avoidance velocity (counter-clockwise from east, upwards)."),
    ("insertion point", "m", "Where the new path takes up the commanded direction (east, north, up)."),
    ("least radius", "m", "Radius of the tightest bend of the new path up to the insertion point."),
    ("bank and load factor it needs", "deg, -", "Those of a steady level turn of that radius at the speed of the decision."),
)
