"""The names of methods, readings and rungs for a reader who knows the paper, and numbers with their units."""

import math
import re
from collections.abc import Mapping

from testbed.results.statistics import Effect, Spread
from testbed.show import words
from testbed.show.words import DASH, amount, counted, interval, percent, sentence
from testbed.studies.scoam.claim import FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN, HOLDS, HOLDS_ONLY_IF, NOT_DETERMINED, TOO_FEW
from testbed.studies.scoam.labels import Axis, Design, Encounter, Method, Part, Rung

METHOD_NAMES: Mapping[str, str] = words.METHOD_NAMES | {
    Method.DROAM_HP_LEFT: "DROAM/HP, left",
    Method.DROAM_HP_RIGHT: "DROAM/HP, right",
    Method.DROAM_VP_UP: "DROAM/VP, up",
    Method.DROAM_VP_DOWN: "DROAM/VP, down",
    Method.SCOAM_NEARER: "SCOAM, nearer root",
    Method.SCOAM_CORRECTED: "SCOAM, corrected cap",
    Method.SCOAM_BEHIND: "SCOAM, behind the obstacle",
    Method.SCOAM_FORWARD: "SCOAM, meeting ahead",
    Method.SCOAM_FLYABLE: "SCOAM, flyable path",
}
READING_NAMES: Mapping[str, str] = {
    Encounter.SINGLE_AS_PRINTED: "Table 1 as printed",
    Encounter.SINGLE_106: "Table 1, azimuth 106\N{DEGREE SIGN}",
    Encounter.SINGLE_106_10: "Table 1, direction (106.1\N{DEGREE SIGN}, 10.4\N{DEGREE SIGN})",
    Encounter.MULTI_AS_PRINTED: "Table 3 as printed",
    Encounter.MULTI_O2_UP: "Table 3, second obstacle climbing (+15.4\N{DEGREE SIGN})",
    Encounter.GENTLE: "gentle, 6 s ahead with 8 m of margin",
    Encounter.GENTLE_NO_MARGIN: "gentle, 6 s ahead",
    Encounter.IMPOSSIBLE: "impossible, 0.3 s ahead",
    Encounter.OVERTAKEN: "overtaken from straight behind",
}
RUNG_NAMES: Mapping[str, str] = {
    Rung.VO_INSTANT: "velocity turned at once",
    Rung.KINEMATIC: "kinematic",
    Rung.POINT_IDEAL: "point mass, no limits",
    Rung.POINT_ROLL: "point mass, roll only",
    Rung.POINT_LOAD: "point mass, load factor only",
    Rung.POINT_SPEED: "point mass, speed only",
    Rung.POINT_NO_ROLL: "point mass without roll limit",
    Rung.POINT_NO_LOAD: "point mass without load factor limit",
    Rung.POINT_NO_SPEED: "point mass without speed limit",
    Rung.POINT_MASS: "point mass",
    Rung.JSBSIM: "flown, calm",
    Rung.DIRECT: "flown, no insertion point",
    Part.WIND: "flown, steady wind",
    Part.TURBULENCE: "flown, turbulence",
}
STEP_NAMES: Mapping[str, str] = {
    Rung.VO_INSTANT: "velocity turned at once",
    Rung.KINEMATIC: "+ insertion point (kinematic)",
    Rung.POINT_IDEAL: "+ guidance",
    Rung.POINT_LOAD: "+ load factor limit",
    Rung.POINT_NO_ROLL: "+ speed loss",
    Rung.POINT_MASS: "+ roll limit (point mass)",
    Rung.JSBSIM: "+ six degrees of freedom",
    Part.WIND: "in steady wind (median)",
    Part.TURBULENCE: "in turbulence (median)",
}
"""What each step of a waterfall adds."""
RUNG_NAMES_IN_AIR: Mapping[str, str] = {Rung.KINEMATIC: "kinematic", Rung.JSBSIM: "flown", Rung.DIRECT: "flown, no insertion point"}
AIRCRAFT_NAMES: Mapping[str, str] = {"gtm_t2": "GTM-T2", "c172p": "Cessna 172P", "t37": "T-37"}
PART_NAMES: Mapping[str, str] = {
    Part.CALM: "calm air",
    Part.WIND: "steady wind",
    Part.TURBULENCE: "turbulence",
    Part.POPULATION: "population",
    Part.ROBUSTNESS_SINGLE: "draws, section 5.1",
    Part.ROBUSTNESS_MULTI: "draws, section 5.2",
    Part.CONTROLS: "controls",
    Part.REMEDY: "remedy",
    Part.READINGS: "readings, calm air",
    Part.READINGS_WIND: "readings, steady wind",
    Part.READINGS_POPULATION: "readings, population",
}
LABEL_NAMES: Mapping[str, Mapping[str, str]] = {
    Axis.PART: PART_NAMES,
    Axis.ENCOUNTER: {**READING_NAMES, Encounter.CLASS: "drawn of the paper's class"},
    Axis.RUNG: {**RUNG_NAMES, Rung.JSBSIM: "flown"},
    Axis.DESIGN: {Design.ANCHORED: "encounter kept in the wind", Design.GROUND_FIXED: "obstacle as printed"},
}
"""Names for the ordinary parts of the page."""
SHORT_CLAIMS: Mapping[str, str] = {
    "words.single.safe": "safe",
    "words.single.flyable": "flyable",
    "words.multi.safe": "several threats avoided",
    "words.deflection_least": "least deflection",
    "words.path_shortest": "shortest path",
    "words.time_least": "least time",
    "words.online": "re-planned online",
    "words.superior": "superior to DROAM",
    "words.overload": "overload easily met",
}
LIMIT_NAMES = {"roll": "roll", "load_factor": "load factor", "load": "load factor", "speed": "speed"}
WORD_CLASS = {
    HOLDS: "holds",
    HOLDS_ONLY_IF: "only-if",
    FAILS_KINEMATICALLY: "fails-kinematically",
    FAILS_WHEN_FLOWN: "fails-flown",
    NOT_DETERMINED: "not-determined",
    TOO_FEW: "too-few",
}
ENCOUNTER, METHOD = Encounter.SINGLE_106, Method.SCOAM
"""Section 5.1 in the reading that makes its obstacle a threat: what the pictures show."""
HYPHEN_AS_MINUS = re.compile(r"(?<![\w.)])-(?=[\d.])")  # of a number, not a hyphen


def typeset(text: str) -> str:
    """A sentence of the verdict as the page writes it: the names of aircraft, minus signs, one full stop."""
    for key, name in AIRCRAFT_NAMES.items():
        text = re.sub(rf"\b{key}\b", name, text)
    return sentence(HYPHEN_AS_MINUS.sub("\N{MINUS SIGN}", text))


def decimals(printed: str) -> int:
    """Decimals of a number as the paper prints it; 0 for words."""
    return len(printed.partition(".")[2]) if math.isfinite(number_of(printed)) else 0


def number_of(printed: str) -> float:
    """The number that the paper prints; NaN for words."""
    return float(printed) if printed.replace(".", "", 1).lstrip("-").isdigit() else math.nan


def spread(told: Spread, unit: str, digits: int | None = None) -> str:
    """5th to 95th percentile."""
    return interval(told.p05, told.p95, unit, digits) if told.n else DASH


def signed(metres: float) -> str:
    """A change in metres, always with its sign."""
    text = amount(metres, "m")
    return f"+{text}" if math.isfinite(metres) and not text.startswith("\N{MINUS SIGN}") else text


def effect(told: Effect) -> str:
    """``clearance: -3.8 m (95 % interval -4.4 to -3.1 m, n = 48)``; empty where there is none."""
    if not math.isfinite(told.value):
        return ""
    known = []
    if math.isfinite(told.low) and math.isfinite(told.high):  # of a single figure it is the range that the rounding leaves
        known = [f"{'95 % interval ' if told.n > 1 else ''}{interval(told.low, told.high, told.unit)}"]
    return f"{told.what}: {amount(told.value, told.unit)} ({', '.join([*known, f'n = {told.n}'])})"


def p_value(p: float) -> str:
    """``p = 0.03``, ``p < 0.001``."""
    return DASH if not math.isfinite(p) else "p < 0.001" if p < 0.001 else f"p = {p:.2g}"


def robustness(share: float, n: int) -> str:
    """Share of the draws that give the same word."""
    return f"{percent(share)} of {counted(n, 'draw')}" if n and math.isfinite(share) else DASH
