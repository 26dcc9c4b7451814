"""The columns of ``results.csv``: the one place that says what each is called, its unit, what it means and how it is computed.

CSV, Parquet (units and definitions in its fields' metadata), the journal, the page's tables with their glossary, and
``docs/results.md`` follow from ``COLUMNS``. A new metric is one field of ``FlightMetrics`` here; a function reads what
``testbed.results.measured`` computes once a flight. What only campaigns with a section ``daa`` have is declared in the same way in
``testbed.results.daa.columns``.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from enum import StrEnum
from typing import Any, Final

AXIS: Final = "label."
"""What the name of an axis of the sweep begins with."""


class Kind(StrEnum):
    """What a column holds."""

    TEXT = "text"
    WHOLE = "whole number"
    NUMBER = "number"  # NaN, an empty field in files, where the quantity does not exist
    FLAG = "true or false"  # None, an empty field in files, where there is no answer


_KINDS: Final[dict[Any, Kind]] = {str: Kind.TEXT, int: Kind.WHOLE, float: Kind.NUMBER, bool | None: Kind.FLAG}
NOT_MEASURED: Final[dict[Kind, Any]] = {Kind.TEXT: "", Kind.WHOLE: 0, Kind.NUMBER: math.nan, Kind.FLAG: None}
"""What stands in a column where nothing was measured."""


@dataclass(frozen=True)
class Column:
    """A column. ``worse`` is the end of its range that a reader looks for: ``low``, ``high`` or neither."""

    name: str
    kind: Kind
    unit: str  # empty for text, counts, shares and other pure numbers
    heading: str  # over a table for people, which shows ``digits`` decimals
    digits: int
    worse: str
    definition: str
    function: "Callable[[Any], Any] | None" = None  # None: known before the flight


def declared(definition: str, function: "Callable[[Any], Any]", unit: str = "", heading: str = "", digits: int = 2, worse: str = "") -> Any:
    """A metric: a field whose column says the rest. Without a heading its name does, read aloud."""
    told = {"unit": unit, "heading": heading, "digits": digits, "worse": worse, "definition": definition, "function": function}
    return field(metadata=told)


@dataclass(frozen=True)
class FlightMetrics:
    """One row of results.csv, apart from who the flight is, in the order of its columns. NaN where a quantity does not exist."""

    outcome: str = declared(
        "How the flight ended; of several the first in the order crashed, diverged, hit_ground, collided, trim_failed, no_path, "
        "timed_out, reached. It does not say whether a radius was kept: kept_clear does.",
        lambda m: m.record.outcome.value,
    )
    least_clearance_m: float = declared(
        "Least distance to an obstacle's surface; negative: a collision.",
        lambda m: m.approach.clearance_m,
        "m",
        "least clearance",
        2,
        "low",
    )
    time_at_least_clearance_s: float = declared("Flight time of the least clearance.", lambda m: m.approach.time_s, "s", "at")
    replans: int = declared("Number of times the path was changed.", lambda m: m.replans, "", "re-plans", 0)
    deflection_deg: float = declared(
        "Space angle from the velocity to the command of the first re-plan.", lambda m: m.deflection_deg, "deg", "deflection", 1
    )
    path_length_m: float = declared("Length of the path flown over the ground.", lambda m: m.length_m, "m", "length", 1)
    flight_time_s: float = declared("Duration of the flight.", lambda m: m.time_s, "s", "time")
    cross_track_rms_m: float = declared(
        "Root mean square of the distance to the path active at each instant.",
        lambda m: m.rms("path.cross_track_m"), "m", "cross-track rms", 2, "high",
    )  # fmt: skip
    cross_track_max_m: float = declared(
        "Largest distance to the path that was active at that instant.",
        lambda m: m.most("path.cross_track_m"), "m", "cross-track max", 2, "high",
    )  # fmt: skip
    schedule_error_s: float = declared(
        "How late (positive) or early it was along its path at the closest approach.", lambda m: m.schedule_error_s, "s", "schedule error"
    )
    max_bank_deg: float = declared(
        "Largest bank angle, either side; of the point: what its path would need.", lambda m: m.bank_deg, "deg", "bank", 1, "high"
    )
    max_load_factor: float = declared(
        "Largest normal load factor (1 in level flight), a crash included.",
        lambda m: m.most("own.load_factor"),
        "",
        "load factor",
        2,
        "high",
    )
    max_roll_rate_dps: float = declared("Largest roll rate, either side.", lambda m: m.roll_rate_dps, "deg/s", "roll rate", 0, "high")
    min_airspeed_mps: float = declared("Least airspeed.", lambda m: m.least("own.airspeed_mps"), "m/s", "least airspeed", 1, "low")
    max_airspeed_mps: float = declared("Largest airspeed.", lambda m: m.most("own.airspeed_mps"), "m/s", "largest airspeed", 1)
    nearest_obstacle: str = declared("Name of the obstacle of the least clearance.", lambda m: m.approach.obstacle)
    trigger_time_s: float = declared("Flight time of the planner's first decision.", lambda m: m.trigger_s, "s", "trigger")
    min_load_factor: float = declared("Least normal load factor.", lambda m: m.least("own.load_factor"), "", "least load factor", 2, "low")
    max_alpha_deg: float = declared("Largest angle of attack.", lambda m: m.alpha_deg, "deg", "alpha", 1, "high")
    planned_length_m: float = declared("Length of the path that was planned last.", lambda m: m.planned_length_m, "m", "planned length", 1)
    planned_min_radius_m: float = declared(
        "Radius of its tightest bend.", lambda m: m.planned_radius_m, "m", "planned least radius", 0, "low"
    )
    planned_clearance_m: float = declared(
        "Least clearance of a point that keeps to the planned paths and their schedule.",
        lambda m: m.planned_clearance_m, "m", "planned clearance", 2, "low",
    )  # fmt: skip
    schedule_part_m: float = declared(
        "What being early or late on the path added to planned_clearance_m; with cross_track_part_m the sum is least_clearance_m.",
        lambda m: m.followed_clearance_m - m.planned_clearance_m, "m", "by schedule",
    )  # fmt: skip
    cross_track_part_m: float = declared(
        "What being off the path added.", lambda m: m.approach.clearance_m - m.followed_clearance_m, "m", "by cross-track"
    )
    saturated_share: float = declared(
        "Share of the flight in which guidance asked for more than the limits allow.",
        lambda m: m.saturated_share,
        "",
        "saturated",
        2,
        "high",
    )
    limits_hit: str = declared("Limits that were reached, of bank, load_factor, roll_rate, surface and thrust.", lambda m: m.limits_hit)
    airspeed_rms_error_mps: float = declared(
        "Root mean square difference of the airspeed from the set speed.",
        lambda m: m.airspeed_error_mps,
        "m/s",
        "airspeed error",
        2,
        "high",
    )
    wind_along_std_mps: float = declared(
        "Standard deviation of the air's velocity along the flight.", lambda m: m.wind_along_std_mps, "m/s", "gusts along"
    )
    begin_s_m: float = declared("Arc length of the route at which the flight began.", lambda m: m.begin_s_m, "m", "begins at", 1)
    route_miss_m: float = declared(
        "Least distance to the threat's centre along the path flown at the first decision.", lambda m: m.route_miss_m, "m", "route miss"
    )
    deflection_ground_deg: float = declared(
        "Commanded deflection over the ground; deflection_deg is the planner's, through the air that it knows.",
        lambda m: m.avoidance.deflection_ground_deg, "deg", "deflection over the ground", 1,
    )  # fmt: skip
    flown_deflection_deg: float = declared(
        "Deflection of the velocity over the ground at the closest passage of the insertion point.",
        lambda m: m.avoidance.flown_deflection_deg, "deg", "flown deflection", 1,
    )  # fmt: skip
    flown_deflection_air_deg: float = declared(
        "The same, of the velocity through the air.", lambda m: m.avoidance.flown_deflection_air_deg, "deg", "flown, in the air", 1
    )
    peak_deflection_deg: float = declared(
        "Largest deflection before the flight is clear, over the ground.",
        lambda m: m.avoidance.peak_deflection_deg, "deg", "largest deflection", 1,
    )  # fmt: skip
    peak_deflection_air_deg: float = declared(
        "The same, of the velocity through the air.", lambda m: m.avoidance.peak_deflection_air_deg, "deg", "largest, in the air", 1
    )
    avoidance_time_s: float = declared(
        "From the re-plan to the closest passage of the insertion point.", lambda m: m.avoidance.avoidance_time_s, "s", "avoids for"
    )
    insertion_miss_m: float = declared(
        "Distance from the insertion point there.", lambda m: m.avoidance.insertion_miss_m, "m", "insertion miss"
    )
    clear_time_s: float = declared(
        "From the re-plan until obstacles open and every radius is kept to the end.", lambda m: m.avoidance.clear_time_s, "s", "clear after"
    )
    rejoin_time_s: float = declared(
        "From the re-plan until back within 5 m of the route for good.", lambda m: m.avoidance.rejoin_time_s, "s", "rejoined after", 1
    )
    rejoin_length_m: float = declared(
        "Path flown over the ground until then.", lambda m: m.avoidance.rejoin_length_m, "m", "length to rejoin", 0
    )
    kept_clear: bool | None = declared(
        "Whether every radius was kept, however the flight ended: least_clearance_m is not below 0 by more than 1e-6 m. Empty where "
        "nothing was flown or there was no obstacle.",
        lambda m: m.kept_clear,
    )
    encounter_radius_m: float = declared(
        "Radius of the obstacle of the encounter: that of the planner's first decision, at that instant; where nothing was decided, the "
        "nearest one, at the start of the flight. The true one, without the planner's margin.",
        lambda m: m.encounter.radius_m, "m", "obstacle radius", 1,
    )  # fmt: skip
    encounter_speed_mps: float = declared(
        "Speed of that obstacle over the ground then.", lambda m: m.encounter.speed_mps, "m/s", "obstacle speed", 1
    )
    encounter_closing_mps: float = declared(
        "Rate at which the distance to its centre shrinks then; negative: it grows.", lambda m: m.encounter.closing_mps, "m/s", "closing", 1
    )
    encounter_miss_m: float = declared(
        "Least distance to its centre if both flew straight on from there, also where that has passed.",
        lambda m: m.encounter.miss_m, "m", "straight-line miss", 1,
    )  # fmt: skip
    encounter_crossing_deg: float = declared(
        "Angle between the two velocities over the ground then: 0 overtaking, 180 head on.",
        lambda m: m.encounter.crossing_deg, "deg", "crossing angle", 0,
    )  # fmt: skip


def _known(name: str, kind: Kind, definition: str) -> Column:
    return Column(name, kind, "", read_aloud(name), 0, "", definition)


def read_aloud(name: str) -> str:
    """A name without its underscores."""
    return name.replace("_", " ")


IDENTITY_COLUMNS: Final = (
    _known("flight_id", Kind.TEXT, "12 hexadecimal digits that stand for everything the flight depends on."),
    _known("cell", Kind.TEXT, "The labels of the flight's axes, joined by '/'."),
    _known("replicate", Kind.WHOLE, "Number of the flight in its cell, from 0."),
    _known("seed", Kind.WHOLE, "Seed of the campaign."),
    _known("plant", Kind.TEXT, "Physics that flew it: kinematic, point_mass or jsbsim."),
    _known("aircraft", Kind.TEXT, "The aircraft whose numbers, or model, flew it."),
    _known("method", Kind.TEXT, "The avoidance method."),
)
"""Who the flight is."""


WEIGHT: Final = _known("weight", Kind.NUMBER, "What the flight's encounter counts: how likely it is over how often it is drawn.")
"""A column of campaigns some of whose encounters are drawn more often than they occur; of the others every flight counts 1."""


def _column(name: str, kind: Kind, told: dict[str, Any]) -> Column:
    return Column(name, kind, **told | {"heading": told["heading"] or read_aloud(name)})


def columns_of(metrics: type) -> tuple[Column, ...]:
    """Those that the fields of a dataclass declare."""
    return tuple(_column(one.name, _KINDS[one.type], dict(one.metadata)) for one in fields(metrics))


METRICS: Final = columns_of(FlightMetrics)
"""What was measured."""

COLUMNS: Final = (*IDENTITY_COLUMNS, *METRICS)
BY_NAME: Final = {column.name: column for column in COLUMNS}


def axis_column(axis: str, kind: Kind) -> Column:
    """The column of an axis of the sweep; it comes after all others."""
    return Column(f"{AXIS}{axis}", kind, "", axis, 0, "", f"Label of the flight on the axis {axis} of the sweep.")


def nothing_measured() -> dict[str, Any]:
    """The metrics of a flight that the program failed to fly, its outcome apart."""
    return {column.name: NOT_MEASURED[column.kind] for column in METRICS}
