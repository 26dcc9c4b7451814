"""The columns that a campaign with a section ``daa`` has beside the others: declared as those are, in the order of the files.

``DaaMetrics`` has what does not depend on a volume; each volume, of a standard or of one's own, has the three of ``volume_columns``.
Obstacles count together: the nearest, the deepest, any.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Final

from testbed.campaign.words.daa import Daa, Volume
from testbed.core.units import FT
from testbed.results.columns import NOT_MEASURED, Column, Kind, columns_of, declared, read_aloud

if TYPE_CHECKING:
    from testbed.flight.record import FlightRecord


@dataclass(frozen=True)
class DaaMetrics:
    """Metrics of detect and avoid that no volume has a part in."""

    slant_miss_m: float = declared(
        "Least distance between the own centre of gravity and an obstacle's centre, between ticks too.",
        lambda m: m.miss.slant_m, "m", "slant miss", 1, "low",
    )  # fmt: skip
    horizontal_miss_m: float = declared("Its horizontal part.", lambda m: m.miss.horizontal_m, "m", "horizontal miss", 1, "low")
    vertical_miss_m: float = declared("Its vertical part, without a sign.", lambda m: m.miss.vertical_m, "m", "vertical miss", 1, "low")
    miss_time_s: float = declared("Flight time of the slant miss.", lambda m: m.miss.time_s, "s", "nearest at")
    least_tau_mod_s: float = declared(
        "Least modified tau at the ticks: (DMOD^2 - r^2) / (r dr/dt) of the horizontal range r where that shrinks, 0 within DMOD. Empty "
        "where the range never shrinks.",
        lambda m: m.least_tau_mod_s, "s", "least modified tau", 1, "low",
    )  # fmt: skip
    alert_lead_s: float = declared(
        "From the first alert, the planner's first decision whatever it was (trigger_time_s), to the slant miss.",
        lambda m: m.alert_lead_s, "s", "alert before", 2, "low",
    )  # fmt: skip
    manoeuvre_time_s: float = declared(
        "Flight time of the first decision by which the path was left.", lambda m: m.manoeuvre_time_s, "s", "manoeuvre at"
    )
    manoeuvre_lead_s: float = declared("From then to the slant miss.", lambda m: m.manoeuvre_lead_s, "s", "manoeuvre before", 2, "low")
    manoeuvre_needed: bool | None = declared(
        "Whether the route, flown as planned and never left, would have led into what the campaign's needed_by names.",
        lambda m: m.needed,
        heading="manoeuvre needed",
    )
    false_manoeuvre: bool | None = declared(
        "Whether the path was left although that was not needed.", lambda m: m.false_manoeuvre, "", "false manoeuvre", 0, "high"
    )
    missed_manoeuvre: bool | None = declared(
        "Whether the path was never left although that was needed.", lambda m: m.missed_manoeuvre, "", "missed manoeuvre", 0, "high"
    )
    reversals: int = declared(
        "How often a command turns to the other side of the present velocity than the last one that turned by 1 deg or more: left "
        "instead of right, up instead of down.",
        lambda m: m.reversals, "", "reversals", 0, "high",
    )  # fmt: skip
    height_change_m: float = declared(
        "Height over the nearest place of the route from the first manoeuvre on, every 0.1 s: the one farthest from 0.",
        lambda m: m.height_change_m, "m", "height change", 1,
    )  # fmt: skip
    energy_change_m: float = declared(
        "The same of that height plus (airspeed^2 - set speed^2) / 2g: energy over that of the route at the set speed.",
        lambda m: m.energy_change_m, "m", "energy change", 1,
    )  # fmt: skip
    extra_length_m: float = declared(
        "Path flown to the goal's plane, less the length of the route. Empty where the goal was not reached.",
        lambda m: m.extra_length_m, "m", "extra length", 1, "high",
    )  # fmt: skip
    extra_time_s: float = declared(
        "The same of the time, less that of the route by its plan in the mean wind.", lambda m: m.extra_time_s, "s", "extra time", 2, "high"
    )


DAA_METRICS: Final = columns_of(DaaMetrics)

TITLES: Final = {
    "nmac": "NMAC",
    "do365_phase_1": "well clear, DO-365 phase I",
    "do365_non_cooperative": "well clear, DO-365 non-cooperative",
    "do365_terminal": "well clear, DO-365 terminal area",
    "astm_f3442": "well clear, ASTM F3442",
    "sphere": "the obstacle's sphere",
}
"""What people call the volumes of the standards."""


def title(name: str) -> str:
    """Of a volume."""
    return TITLES.get(name) or read_aloud(name)


def limits_text(volume: Volume) -> str:
    """The limits of a volume, as they are set: ``1219.2 m (4000 ft)``."""
    less = "<" if volume.edge == "out" else "<="
    said = f"{'range' if volume.shape == 'sphere' else 'horizontal'} {less} {_length(volume.radius_m)}"
    if volume.half_height_m is not None:
        said += f", vertical {less} {_length(volume.half_height_m)}"
    return said + (f", modified tau {less} {volume.tau_s:g} s" if volume.tau_s else "")


def _length(metres: float) -> str:
    feet = metres / FT
    whole = abs(feet - round(feet)) < 1e-9
    return f"{metres:.10g} m ({round(feet)} ft)" if whole else f"{metres:.10g} m"


def volume_columns(name: str, limits: str) -> tuple[Column, ...]:
    """The three of a volume; ``limits`` in words."""
    what = f"{title(name)} ({limits})" if limits else title(name)
    return (
        Column(
            entered(name), Kind.FLAG, "", f"in: {title(name)}", 0, "high",
            f"Whether the aircraft came into the volume: {what}. Between ticks too. Empty where nothing was met.",
            lambda m: m.volume(name).entered,
        ),
        Column(
            f"time_in_{name}_s", Kind.NUMBER, "s", f"time in: {title(name)}", 2, "high",
            "Time in it, added up over the obstacles.", lambda m: m.volume(name).time_s,
        ),
        Column(
            f"severity_{name}", Kind.NUMBER, "", f"severity: {title(name)}", 2, "high",
            "Largest severity of that by DO-365: 1 less the Fernandez-Guasti norm of range, horizontal miss and height over their limits; "
            "0 outside. Of a sphere the depth over its radius.",
            lambda m: m.volume(name).severity,
        ),
    )  # fmt: skip


def entered(name: str) -> str:
    """The column that says whether a flight came into a volume; of the obstacle's own sphere it is kept_clear, the other way round."""
    return f"entered_{name}"


@lru_cache
def _columns(said: str) -> tuple[Column, ...]:
    daa = Daa.model_validate_json(said)
    of_volumes = (column for name, volume in daa.all_volumes.items() for column in volume_columns(name, limits_text(volume)))
    return (*DAA_METRICS, *of_volumes)


def daa_columns(daa: Daa | None) -> tuple[Column, ...]:
    """Those of a campaign; none without the section."""
    return () if daa is None else _columns(daa.model_dump_json())


def measure_daa(record: "FlightRecord", daa: Daa) -> dict[str, Any]:
    """Their values of one flight."""
    from testbed.results.daa.measured import DaaMeasured  # a driver that only reads rows does without the physics

    of = DaaMeasured(record, daa)
    return {column.name: column.function(of) for column in daa_columns(daa) if column.function is not None}


def no_daa(daa: Daa | None) -> dict[str, Any]:
    """Those of a flight that the program failed to fly."""
    return {column.name: NOT_MEASURED[column.kind] for column in daa_columns(daa)}


_TYPES: Final = {Kind.FLAG: (bool,), Kind.WHOLE: (int,), Kind.NUMBER: (float, int), Kind.TEXT: (str,)}


def checked(row: dict[str, Any], columns: tuple[Column, ...]) -> dict[str, Any]:
    """The row with all of these columns. A journal may have been written by anybody: what is missing or of another type is unmeasured."""
    if not columns:
        return row
    return row | {column.name: _of_kind(row.get(column.name), column.kind) for column in columns}


def _of_kind(value: Any, kind: Kind) -> Any:
    if type(value) not in _TYPES[kind]:
        return NOT_MEASURED[kind]
    return float(value) if kind is Kind.NUMBER else value


def as_number(value: Any) -> float:
    """A number, or a flag as 0 and 1; NaN for none."""
    return math.nan if value is None else float(value)
