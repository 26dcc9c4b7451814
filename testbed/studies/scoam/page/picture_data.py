"""Which flights the verdict pictures, and the data behind its curves. The drawing itself is templates/verdict.js."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from testbed.results.flight_row import collided, value
from testbed.show import palette
from testbed.show.gathered import Row
from testbed.show.player import limits_of
from testbed.show.words import named, number
from testbed.studies.scoam.labels import Axis, Compass, Design, Part, Rung, Severity
from testbed.studies.scoam.page.paper_names import AIRCRAFT_NAMES, ENCOUNTER, METHOD

PICTURED_CURVES = ("time_s", "x", "y", "z", "clearance_m", "bank_deg", "load_factor", "roll_rate_dps", "paths", "obstacles", "decisions")


@dataclass(frozen=True)
class Pictured:
    """A flight of the pictures: the labels that single it out, its name there, its colours by day and by night, its dash."""

    key: str
    name: str
    labels: Mapping[str, str]
    light: str
    dark: str
    dash: str


def _calm(key: str, name: str, light: str, dark: str, dash: str) -> Pictured:
    return Pictured(key, name, {Axis.PART: Part.CALM, Axis.RUNG: key}, light, dark, dash)


def _wind(where: str, words: str, light: str, dark: str, dash: str) -> Pictured:
    air: dict[str, str] = {Axis.DESIGN: Design.ANCHORED, Axis.WIND_MPS: "10", Axis.WIND_FROM: where}
    labels: dict[str, str] = {Axis.PART: Part.WIND, Axis.RUNG: Rung.JSBSIM, **air}
    return Pictured(f"wind_{where}", f"flown, wind 10 m/s from {words}", labels, light, dark, dash)


PICTURED = (
    _calm(Rung.VO_INSTANT, "velocity turned at once", palette.GREY, palette.GREY, "dot"),
    _calm(Rung.KINEMATIC, "kinematic", "ink", "ink", "solid"),
    _calm(Rung.POINT_MASS, "point mass", palette.PURPLE, palette.PURPLE, "dash"),
    _calm(Rung.JSBSIM, "flown, calm", palette.BLUE, palette.SKY, "solid"),
    _calm(Rung.DIRECT, "flown at once, no insertion point", "#A67C00", palette.YELLOW, "dashdot"),
    _wind(Compass.NE, "the north-east", palette.GREEN, "#2CC79E", "dash"),  # the route leads east-north-east: against the flight
    _wind(Compass.NW, "the north-west", palette.GREEN, "#2CC79E", "dot"),  # and across it
    Pictured(
        Part.TURBULENCE,
        "flown, severe turbulence",
        {Axis.PART: Part.TURBULENCE, Axis.RUNG: Rung.JSBSIM, Axis.SEVERITY: Severity.SEVERE},
        palette.VERMILLION,
        palette.ORANGE,
        "longdash",
    ),
)
IN_SPACE = (Rung.KINEMATIC, Rung.JSBSIM, "wind_NE", "wind_NW", Part.TURBULENCE)
PICTURED_RUNGS = (Rung.VO_INSTANT, Rung.KINEMATIC, Rung.POINT_MASS, Rung.JSBSIM, Rung.DIRECT)
DEMAND = (Rung.KINEMATIC, Rung.JSBSIM)


def picture_of(labels: Mapping[str, str], replicate: int) -> Pictured | None:
    """How the pictures show the flight of these labels; nothing if they do not. A campaign keeps the curves of these flights first."""
    if replicate or labels.get(Axis.ENCOUNTER) != ENCOUNTER or labels.get(Axis.METHOD) != METHOD:
        return None
    return next((one for one in PICTURED if all(labels.get(axis) == label for axis, label in one.labels.items())), None)


def picture_data(rows: Sequence[Row], series: Mapping[str, dict[str, Any] | None]) -> dict[str, Any]:
    """By aircraft its limits and its flights; which flights each picture takes; names and colours. Only what has curves."""
    aircraft: dict[str, dict[str, Any]] = {}
    for row in rows:
        one, curves = picture_of(row["labels"], row["replicate"]), series.get(row["flight_id"])
        if one is None or not curves or not curves["time_s"]:
            continue
        name = str(row["aircraft"])
        panel = aircraft.setdefault(name, {"name": named(AIRCRAFT_NAMES, name), "limits": limits_of(name), "flights": {}})
        panel["flights"][one.key] = {
            "collided": collided(row),
            **{curve: curves[curve] for curve in PICTURED_CURVES if curve in curves},
        }
    styles = {one.key: {"name": one.name, "light": one.light, "dark": one.dark, "dash": one.dash} for one in PICTURED}
    return {
        "aircraft": aircraft,
        "styles": styles,
        "order": [one.key for one in PICTURED],
        "in_space": IN_SPACE,
        "rungs": PICTURED_RUNGS,
        "demand": DEMAND,
    }


def flight_list(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """The flights of the pictures: clearance, recording, and the id to fly one again. Also those without curves."""
    found = [(one, row) for row in rows if (one := picture_of(row["labels"], row["replicate"])) is not None]
    return [
        {
            "aircraft": named(AIRCRAFT_NAMES, str(row["aircraft"])),
            "name": one.name,
            "clearance": number(value(row, "least_clearance_m"), 1),
            "bad": collided(row),
            "needs": [
                number(value(row, key), digits) for key, digits in (("max_bank_deg", 0), ("max_load_factor", 1), ("max_roll_rate_dps", 0))
            ],
            "recording": row["recording"],
            "id": row["flight_id"],
        }
        for one, row in sorted(
            found,
            key=lambda pair: (
                list(AIRCRAFT_NAMES).index(pair[1]["aircraft"]) if pair[1]["aircraft"] in AIRCRAFT_NAMES else 9,
                PICTURED.index(pair[0]),
            ),
        )
    ]
