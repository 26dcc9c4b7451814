"""The names of methods, readings and rungs for a reader who knows the paper, and numbers with their units."""

import math
import re

from testbed.results.statistics import Effect, Spread
from testbed.show import words
from testbed.show.words import DASH, amount, interval, percent, sentence
from testbed.studies.scoam.claim import FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN, HOLDS, HOLDS_ONLY_IF, NOT_DETERMINED

METHODS = words.METHODS | {
    "droam_hp_left": "DROAM/HP, left",
    "droam_hp_right": "DROAM/HP, right",
    "droam_vp_up": "DROAM/VP, up",
    "droam_vp_down": "DROAM/VP, down",
}
READINGS = {
    "single_as_printed": "Table 1 as printed",
    "single_106": "Table 1, azimuth 106\N{DEGREE SIGN}",
    "single_106_10": "Table 1, direction (106.1\N{DEGREE SIGN}, 10.4\N{DEGREE SIGN})",
    "multi_as_printed": "Table 3 as printed",
    "multi_o2_up": "Table 3, second obstacle climbing (+15.4\N{DEGREE SIGN})",
    "gentle": "gentle, 6 s ahead with 8 m of margin",
    "gentle_no_margin": "gentle, 6 s ahead",
    "impossible": "impossible, 0.3 s ahead",
}
RUNGS = {
    "vo_instant": "velocity turned at once",
    "kinematic": "kinematic",
    "point_ideal": "point mass, no limits",
    "point_roll": "point mass, roll only",
    "point_load": "point mass, load factor only",
    "point_speed": "point mass, speed only",
    "point_no_roll": "point mass without roll limit",
    "point_no_load": "point mass without load factor limit",
    "point_no_speed": "point mass without speed limit",
    "point_mass": "point mass",
    "jsbsim": "flown, calm",
    "direct": "flown, no insertion point",
    "wind": "flown, steady wind",
    "turbulence": "flown, turbulence",
}
STEPS = {
    "vo_instant": "velocity turned at once",
    "kinematic": "+ insertion point (kinematic)",
    "point_ideal": "+ guidance",
    "point_load": "+ load factor limit",
    "point_no_roll": "+ speed loss",
    "point_mass": "+ roll limit (point mass)",
    "jsbsim": "+ six degrees of freedom",
    "wind": "in steady wind (median)",
    "turbulence": "in turbulence (median)",
}
"""What each step of a waterfall adds."""
IN_AIR = {"kinematic": "kinematic", "jsbsim": "flown", "direct": "flown, no insertion point"}
AIRCRAFT = {"gtm_t2": "GTM-T2", "c172p": "Cessna 172P", "t37": "T-37"}
LIMITS = {"roll": "roll", "load_factor": "load factor", "load": "load factor", "speed": "speed"}
WORD_CLASS = {
    HOLDS: "holds",
    HOLDS_ONLY_IF: "only-if",
    FAILS_KINEMATICALLY: "fails-kinematically",
    FAILS_WHEN_FLOWN: "fails-flown",
    NOT_DETERMINED: "not-determined",
}
ENCOUNTER, METHOD = "single_106", "scoam"
"""Section 5.1 in the reading that makes its obstacle a threat: what the pictures show."""
MINUS = re.compile(r"(?<![\w.)])-(?=[\d.])")  # of a number, not a hyphen


def typeset(text: str) -> str:
    """A sentence of the verdict as the page writes it: the names of aircraft, minus signs, one full stop."""
    for key, name in AIRCRAFT.items():
        text = re.sub(rf"\b{key}\b", name, text)
    return sentence(MINUS.sub("\N{MINUS SIGN}", text))


def decimals(printed: str) -> int:
    """Decimals of a number as the paper prints it; 0 for words."""
    return len(printed.partition(".")[2]) if printed.replace(".", "", 1).lstrip("-").isdigit() else 0


def spread(told: Spread, unit: str, digits: int | None = None) -> str:
    """5th to 95th percentile."""
    return interval(told.p05, told.p95, unit, digits) if told.n else DASH


def effect(told: Effect) -> str:
    """``clearance: -3.8 m (95 % interval -4.4 to -3.1 m, n = 48)``; empty where there is none."""
    if not math.isfinite(told.value):
        return ""
    known = []
    if math.isfinite(told.low) and math.isfinite(told.high):  # of a single figure it is the range that the rounding leaves
        known = [f"{'95 % interval ' if told.n > 1 else ''}{interval(told.low, told.high, told.unit)}"]
    return f"{told.what}: {amount(told.value, told.unit)} ({', '.join([*known, f'n = {told.n}'])})"


def robustness(share: float, n: int) -> str:
    """Share of the draws that give the same word."""
    return f"{percent(share)} of {n}" if n and math.isfinite(share) else DASH
