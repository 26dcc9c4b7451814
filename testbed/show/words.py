"""How numbers, shares, lists and names are worded for people: page, recording, command line and studies all ask here.

A study has the names of its own labels beside it; what every campaign has, plants, outcomes, methods, common axes, is named in this file.
"""

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any, Final

from testbed.core.units import DEG
from testbed.flight.record import Outcome, inside
from testbed.results.columns import read_aloud

DASH: Final = "\N{EN DASH}"
MINUS: Final = "\N{MINUS SIGN}"
UNIT_DIGITS: Final = {"m": 1, "deg": 1, "s": 2, "deg/s": 0, "%": 0, "ms": 1, "g": 1}
"""Decimals of a quantity by its unit; 2 of any other."""

SHOWN_UNITS: Final = {"times the limit": "\N{MULTIPLICATION SIGN} limit"}
"""Units that are written otherwise beside a number."""

OUTCOME_NAMES: Final = {
    Outcome.REACHED: ("reached the goal", ""),
    Outcome.COLLIDED: ("collided", "came closer than the obstacle's radius"),
    Outcome.TIMED_OUT: ("timed out", ""),
    Outcome.NO_PATH: ("found no path", ""),
    Outcome.HIT_GROUND: ("hit the ground", ""),
    Outcome.DIVERGED: ("diverged", "left the envelope of the model"),
    Outcome.TRIM_FAILED: ("could not be trimmed", ""),
    Outcome.STOPPED: ("was stopped before the goal", ""),
    Outcome.CRASHED: ("failed to run", ""),
}
"""What a flight did, in the order of telling, and what that means where it is not plain."""

BAD_OUTCOMES: Final = (Outcome.COLLIDED, Outcome.HIT_GROUND, Outcome.DIVERGED, Outcome.CRASHED)

METHOD_NAMES: Final = {
    "none": "no avoidance",
    "scoam": "SCOAM",
    "droam_hp": "DROAM/HP",
    "droam_vp": "DROAM/VP",
    "orca": "ORCA",
}
FLYER_NAMES: Final = {"kinematic": "kinematic point", "point_mass": "{} as a point mass", "jsbsim": "{} flown in JSBSim"}
RUNG_NAMES: Final = {"kinematic": "point on rails", "point_mass": "point mass", "jsbsim": "flown"}
"""Physics by the step from the paper to an aircraft that it is, the least of them first."""
WITHOUT_LIMIT: Final = {"roll": "roll", "load_factor": "lift", "speed": "speed", "gust": "gusts"}
AXIS_NAMES: Final = {
    "flown_by": "flown by {}",
    "wind_mps": "wind {} m/s",
    "wind_from": "wind from {}",
    "severity": "{} turbulence",
    "speed_mps": "{} m/s",
    "replan.k": "k {}",
    "replan.swell_m": "margin {} m",
    "air.wind.speed_mps": "wind {} m/s",
    "air.wind.from_deg": "wind from {} deg",
    "air.turbulence.severity": "{} turbulence",
    "sensor.range_m": "seen from {} m on",
    "sensor.kind": "{} sensor",
    "tracker.kind": "tracker {}",
    "replan.policy": "policy {}",
    "lead_s": "lead {} s",
    "swell_m": "margin {} m",
}
AXIS_HEADINGS: Final = {
    "flown_by": "aircraft",
    "wind_mps": "wind, m/s",
    "wind_from": "wind from",
    "severity": "turbulence",
    "lead_s": "lead, s",
    "swell_m": "margin, m",
    "speed_mps": "speed, m/s",
    "replan.k": "k (replan)",
    "replan.swell_m": "margin, m",
    "air.wind.speed_mps": "wind, m/s",
    "air.wind.from_deg": "wind from, deg",
    "air.turbulence.severity": "turbulence",
    "sensor.range_m": "seen from, m",
    "sensor.kind": "sensor",
    "tracker.kind": "tracker",
    "replan.policy": "policy",
}
UNITS: Final = {"mps": "m/s", "mps2": "m/s\N{SUPERSCRIPT TWO}", "deg": "deg", "dps": "deg/s", "m": "m", "s": "s", "hz": "Hz", "kg": "kg"}
"""Ends of the names of settings, and the units that they stand for."""
_BARE = re.compile(r"[+-]?[\d.]+([eE][+-]?\d+)?|[+-]?inf|true|false|null|\[.*")  # says nothing without its axis


def number(value: float, digits: int = 1, unit: str = "") -> str:
    """A number: a dash for what does not exist, no minus sign on zero."""
    if not math.isfinite(value):
        return DASH
    text = f"{value:.{digits}f}"
    text = text.removeprefix("-") if float(text) == 0.0 else text.replace("-", MINUS)
    return f"{text} {unit}".rstrip()


def percent(share: float) -> str:
    """A share: ``92 %``, with a decimal (cut off) below 1 and above 99, so that 0 and 100 are said of none and of all alone."""
    if not math.isfinite(share):
        return DASH
    whole = 100.0 * share
    if 0.0 < whole < 0.1:
        return "below 0.1 %"
    if 0.0 < whole < 1.0 or 99.0 < whole < 100.0:
        return f"{min(math.floor(10.0 * whole + 1e-9) / 10.0, 99.9):.1f} %"
    return f"{whole:.0f} %"


def amount(value: float, unit: str, digits: int | None = None) -> str:
    """A quantity with the decimals of its unit; a ``share`` as per cent."""
    if unit == "share":
        return percent(value)
    return number(value, UNIT_DIGITS.get(unit, 2) if digits is None else digits, SHOWN_UNITS.get(unit, unit))


def interval(low: float, high: float, unit: str, digits: int | None = None) -> str:
    """``2.1 to 3.4 m``, ``21 to 29 %``; one of them where both read the same."""
    if not (math.isfinite(low) and math.isfinite(high)):
        return DASH
    shown = "%" if unit == "share" else SHOWN_UNITS.get(unit, unit)
    first, last = amount(low, unit, digits), amount(high, unit, digits)
    return f"{first.removesuffix(shown).rstrip()} to {last}"


def span(low: float, high: float, unit: str, digits: int) -> str:
    """The range of what was seen: an interval, or one value where both ends read the same."""
    first, last = number(low, digits, unit), number(high, digits, unit)
    return last if first == last else interval(low, high, unit, digits)


def listed(names: Sequence[str]) -> str:
    """``a``, ``a and b``, ``a, b and c``."""
    return " and ".join([", ".join(names[:-1]), names[-1]]) if len(names) > 1 else "".join(names)


def counted(number_of: int, noun: str) -> str:
    """``1 flight``, ``2 flights``."""
    return f"{number_of} {noun}" + ("" if number_of == 1 else "s")


def size(number_of_bytes: float) -> str:
    """Bytes, with two digits that count: ``830 B``, ``2.1 kB``, ``15 MB``."""
    value, unit = number_of_bytes, "B"
    for larger in ("kB", "MB", "GB", "TB"):
        if float(f"{value:.1e}") < 1000.0:
            break
        value, unit = value / 1000.0, larger
    value = float(f"{value:.1e}")
    return f"{value:.1f} {unit}" if value < 10.0 and unit != "B" else f"{value:.0f} {unit}"


def duration(seconds: float) -> str:
    """A time to wait, with two digits that count: ``8 s``, ``25 min``, ``3.5 h``."""
    for per, unit, up_to in ((1.0, "s", 100.0), (60.0, "min", 100.0), (3600.0, "h", 100.0), (86400.0, "days", math.inf)):
        value = float(f"{seconds / per:.1e}")
        if value < up_to:
            return f"{value:.1f} {unit}" if value < 10.0 and per > 1.0 else f"{value:.0f} {unit}"
    raise ValueError(f"{seconds} s is no time to wait")


def sentence(text: str) -> str:
    """With a full stop, and only one."""
    return text if not text or text.endswith((".", "?", "!")) else f"{text}."


def capital(text: str) -> str:
    """With a capital at its beginning."""
    return text[:1].upper() + text[1:]


def named(names: Mapping[str, str], key: str) -> str:
    """The reader's name of something; one that is not known is read aloud."""
    return names.get(key, read_aloud(key))


def method(name: str) -> str:
    """An avoidance method."""
    return named(METHOD_NAMES, name)


def flyer(plant: str, aircraft: str) -> str:
    """Who flew: the point, or the aircraft and the physics it flew in."""
    return FLYER_NAMES.get(plant, f"{{}} ({plant})").format(aircraft)


def circumstance(axis: str, label: str) -> str:
    """A label of a flight; one that says something by itself needs no axis."""
    if axis in AXIS_NAMES:
        return AXIS_NAMES[axis].format(label)
    if axis in ("method", "method.kind"):
        return method(label)
    if not _BARE.fullmatch(label):
        return label
    name, unit = setting(axis)
    if unit == "m/s":
        name = name.removesuffix(" speed")  # its unit says so
    return f"{name} {label} {unit}".rstrip()


def setting(path: str) -> tuple[str, str]:
    """A dotted path as a name, and its unit, empty if it has none: ``obstacles.O.radius_m`` is ``obstacle O radius``, in ``m``."""
    stem, _, end = path.rpartition("_")
    unit = UNITS.get(end, "") if stem else ""
    name = (stem if unit else path).replace(".options.", ".").replace(".", " ")
    return read_aloud(re.sub(r"^obstacles ", "obstacle ", name)), unit


OF_THE_METHOD: Final = "method.options."
"""What the axes begin with whose labels are part of the method's name."""


def method_with(name: str, labels: Mapping[str, str]) -> str:
    """An avoidance method with those of its options that a campaign sweeps: ``tangent:avoid, side = left``."""
    swept = [f"{axis.removeprefix(OF_THE_METHOD)} = {label}" for axis, label in labels.items() if axis.startswith(OF_THE_METHOD)]
    return ", ".join([method(name), *swept])


def axis_heading(axis: str) -> str:
    """An axis as the heading of a column: of a dotted path its last word, and in brackets what it belongs to, ``side (method)``."""
    if axis in AXIS_HEADINGS:
        return AXIS_HEADINGS[axis]
    section, _, name = axis.rpartition(".")
    section = section.removesuffix(".options").replace(".", " ")
    return section if section and name == "kind" else f"{name} ({section})" if section else name


def outcome(name: str) -> str:
    """What a flight did, briefly."""
    return OUTCOME_NAMES[Outcome(name)][0] if name in OUTCOME_NAMES else read_aloud(name)


def outcome_told(name: str) -> str:
    """What a flight did, and what that means."""
    return ": ".join(filter(None, OUTCOME_NAMES[Outcome(name)]))


def in_order(count: Mapping[str, int]) -> list[str]:
    """Outcomes in the order of telling; those that are a study's own come last."""
    known = [one.value for one in OUTCOME_NAMES if one in count]
    return [*known, *sorted(set(count) - set(known))]


def outcomes(count: Mapping[str, int]) -> str:
    """``7 reached the goal, 5 collided``."""
    return ", ".join(f"{count[name]} {outcome(name)}" for name in in_order(count))


def tone(name: str) -> str:
    """How an outcome is coloured: ``good``, ``bad`` or ``warn``."""
    return "good" if name == Outcome.REACHED else "bad" if name in BAD_OUTCOMES else "warn"


def clearance(value_m: float, of: str = "") -> str:
    """How far from a sphere's surface: ``12.4 m clear of O``, ``3.1 m inside O``."""
    if not math.isfinite(value_m):
        return DASH
    where = "inside" if inside(value_m) else "clear of" if of else "clear"
    return f"{number(abs(value_m), 1)} m {where} {of}".rstrip()


def bank(value_rad: float) -> str:
    """``bank 63 deg left``; wings level within half a degree."""
    degrees = value_rad / DEG
    if abs(degrees) < 0.5:
        return "wings level"
    return f"bank {number(abs(degrees), 0)} deg {'right' if degrees > 0.0 else 'left'}"


def wind(velocity_enu_mps: Sequence[float]) -> str:
    """A wind by where it comes from, as pilots say it: ``wind 10 m/s from 270 deg``, and what of it goes up or down."""
    east, north, up = velocity_enu_mps
    speed = math.hypot(east, north)
    told = (
        "wind calm" if speed < 0.05 else f"wind {number(speed, 1)} m/s from {round(math.degrees(math.atan2(-east, -north))) % 360:03d} deg"
    )
    return told if abs(up) < 0.05 else f"{told}, {number(abs(up), 1)} m/s {'up' if up > 0.0 else 'down'}"


def turn(azimuth_deg: float, elevation_deg: float) -> str:
    """A change of direction: ``left 12 deg, up 1 deg``."""
    parts = [
        f"{way} {number(abs(angle), 0)} deg"
        for angle, way in (
            (azimuth_deg, "left" if azimuth_deg > 0.0 else "right"),
            (elevation_deg, "up" if elevation_deg > 0.0 else "down"),
        )
        if abs(angle) >= 0.5
    ]
    return ", ".join(parts) or "straight on"


def clock(bearing_rad: float) -> str:
    """Where something is as seen from the cockpit, clockwise from straight ahead: ``2 o'clock``."""
    return f"{round(math.degrees(bearing_rad) / 30.0) % 12 or 12} o'clock"


def rung(plant: str, ideal: Sequence[str], answer: str) -> str:
    """How much of flight there is in a flight: ``point mass without limits of roll and lift``, ``flown, direct``."""
    name = named(RUNG_NAMES, plant)
    if ideal:
        name = f"{name} without limits of {listed([named(WITHOUT_LIMIT, limit) for limit in ideal])}"
    return f"{name}, the direction at once" if answer == "direct" else name


def air(wind: str, wind_mps: float, from_deg: float, gust: str, turbulence: str, severity: str) -> str:
    """The air of a flight by its settings: ``in calm air``, ``in wind 10 m/s from 270 deg and severe turbulence``."""
    parts = [] if wind == "calm" or wind_mps == 0.0 else [f"wind {wind_mps:g} m/s from {from_deg:g} deg"]
    parts += [] if gust == "none" else ["a gust"]
    parts += [] if turbulence == "none" else [f"{severity} turbulence"]
    return f"in {listed(parts)}" if parts else "in calm air"


def air_of(settings: Mapping[str, Any]) -> str:
    """The same from the section ``air`` of a flight's plan."""
    wind, turbulence = settings["wind"], settings["turbulence"]
    speed_mps, from_deg = wind.get("speed_mps", 0.0), wind.get("from_deg", 0.0)
    return air(wind["kind"], speed_mps, from_deg, settings["gust"]["kind"], turbulence["kind"], turbulence.get("severity", ""))
