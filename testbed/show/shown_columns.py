"""Which declared columns the page shows, and the terms of its table of decisions."""

from collections.abc import Mapping
from typing import Any

from testbed.results.columns import BY_NAME, Column
from testbed.results.flight_row import value
from testbed.show.words import number

SHOWN_COLUMNS = tuple(
    BY_NAME[name]
    for name in (
        "least_clearance_m time_at_least_clearance_s deflection_deg path_length_m flight_time_s cross_track_rms_m cross_track_max_m "
        "schedule_error_s max_bank_deg max_load_factor max_roll_rate_dps min_airspeed_mps max_alpha_deg saturated_share "
        "airspeed_rms_error_mps wind_along_std_mps clear_time_s rejoin_time_s rejoin_length_m replans"
    ).split()
)
"""The table of flights."""

SUMMARISED = tuple(
    BY_NAME[name] for name in "least_clearance_m cross_track_rms_m cross_track_max_m max_bank_deg max_load_factor min_airspeed_mps".split()
)
"""What the table of cells shows as median and worst."""

PAIRED = tuple(
    BY_NAME[name]
    for name in (
        "cross_track_rms_m cross_track_max_m schedule_error_s max_bank_deg max_load_factor max_roll_rate_dps min_airspeed_mps"
    ).split()
)
"""What the table of pairs says of the aircraft."""


def text(column: Column, row: Mapping[str, Any]) -> str:
    """A number of a row with the decimals of its column."""
    return number(value(row, column.name), column.digits)


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
