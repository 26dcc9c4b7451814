"""What a case must come to: an answer that can be read, or a row whose numbers are there or known to be missing."""

import json
import math
from collections.abc import Callable, Mapping
from typing import Any

from testbed.results.columns import METRICS, Kind
from testbed.run import journal
from testbed.run.job import JobResult

Row = Mapping[str, Any]
MOST_CHARACTERS = 30_000
"""A list of problems that is longer is read by nobody."""


def text_faults(text: str) -> list[str]:
    """What keeps a message from being read: nothing in it, a control character, half a character, no end."""
    found = []
    if not text.strip():
        found.append("an empty message")
    if len(text) > MOST_CHARACTERS:
        found.append(f"a message of {len(text):,} characters")
    if odd := next((c for c in text if not c.isprintable() and c not in "\n\t"), None):
        found.append(f"a message with the character U+{ord(odd):04X}")
    if "Traceback (most recent" in text:
        found.append("a traceback in a message")
    return found


def _not_flown(row: Row) -> bool:
    """Not a single tick: no trim, no route, the start in the ground. The row says why, and has no number of a flight."""
    flown = (row["flight_time_s"], row["path_length_m"], row["max_airspeed_mps"], row["max_load_factor"])
    return all(map(math.isnan, flown)) and row["outcome"] not in ("reached", "collided", "timed_out") and row["message"] != ""


def _no_obstacle(row: Row) -> bool:
    return row["nearest_obstacle"] == ""


def _no_decision(row: Row) -> bool:
    return not row["events"]


def _path_kept(row: Row) -> bool:
    return row["replans"] == 0


def _may(_row: Row) -> bool:
    return True


EMPTY: dict[str, tuple[Callable[[Row], bool], str]] = {
    **dict.fromkeys(
        (
            "least_clearance_m time_at_least_clearance_s schedule_error_s planned_clearance_m schedule_part_m cross_track_part_m "
            "encounter_radius_m encounter_speed_mps encounter_miss_m"
        ).split(),
        (_no_obstacle, "there is no obstacle to be clear of"),
    ),
    **dict.fromkeys(
        ("encounter_closing_mps", "encounter_crossing_deg"), (_may, "a direction that does not exist: nothing moves, or in the centre")
    ),
    **dict.fromkeys(("trigger_time_s", "route_miss_m"), (_no_decision, "the planner decided nothing")),
    "deflection_deg": (_path_kept, "the path was never changed"),
    **dict.fromkeys(
        (
            "deflection_ground_deg flown_deflection_deg flown_deflection_air_deg peak_deflection_deg peak_deflection_air_deg "
            "avoidance_time_s insertion_miss_m clear_time_s rejoin_time_s rejoin_length_m"
        ).split(),
        (_may, "what ends an avoidance may not come: no insertion point, never clear, never back, or the flight ends at the trigger"),
    ),
    "max_roll_rate_dps": (
        lambda row: row["flight_time_s"] < 0.04,
        "a point that is at its goal after a tick or two has no rate of anything",
    ),
    "planned_min_radius_m": (_may, "a straight path has no bend"),
    "max_alpha_deg": (lambda row: row["plant"] != "jsbsim", "a point has no angle of attack"),
}
"""Numbers that may be missing, by the definitions of their columns: when, and why. All are where nothing was flown. None is infinite."""


def row_faults(result: JobResult) -> list[str]:
    """Of a flight's row: a failure of the program, a number that is missing without a reason or infinite, a row that cannot be kept."""
    row = result.row
    if row["outcome"] == "crashed":
        return [f"crashed: {row['message'][:200]} {_where(row['traceback'])}"]
    found = []
    for column in METRICS:
        value = row[column.name]
        if column.kind is not Kind.NUMBER:
            continue
        if math.isinf(value):
            found.append(f"{column.name} is {value}")
        elif math.isnan(value) and not _not_flown(row):
            may = EMPTY.get(column.name)
            if may is None or not may[0](row):
                found.append(f"{column.name} is missing ({row['outcome']})")
    again = journal.decode(journal.encode(result))
    if json.dumps(again.row["message"]) != json.dumps(row["message"]):
        found.append("a message that the journal does not keep")
    return found


def _where(traceback: str) -> str:
    """The last place in a traceback that is the project's own."""
    lines = [line.strip() for line in traceback.splitlines() if line.strip().startswith("File ")]
    own = [line for line in lines if "/testbed/" in line or "/vosc/" in line]
    named = (own or lines or [""])[-1]
    return named.rpartition("/")[2].replace('", line ', ":") if named else ""
