"""Figures as a sentence of ``verdict.csv`` writes them, and the names of what they are of."""

import math
from collections.abc import Mapping
from typing import Final

from testbed.results.statistics import Effect
from testbed.show import words
from testbed.studies.scoam.labels import Encounter, Method, Rung

DECIMALS: Final = words.UNIT_DIGITS | {"deg": 2, "ms": 2}
"""Decimals in a sentence, which compares what differs little."""
NO_FIGURE: Final = "none"

READING_WORDS: Final[Mapping[str, str]] = {
    Encounter.SINGLE_AS_PRINTED: "Table 1 as printed",
    Encounter.SINGLE_106: "azimuth 106 deg",
    Encounter.SINGLE_106_10: "direction (106.1, 10.4) deg",
    Encounter.MULTI_AS_PRINTED: "Table 3 as printed",
    Encounter.MULTI_O2_UP: "O_2 climbing at +15.4 deg",
    Encounter.OVERTAKEN: "overtaken from straight behind",
}

METHOD_WORDS: Final[Mapping[str, str]] = words.METHOD_NAMES | {
    Method.LEAST_DEFLECTION: "least deflection",
    Method.DROAM_HP_LEFT: "DROAM/HP left",
    Method.DROAM_HP_RIGHT: "DROAM/HP right",
    Method.DROAM_VP_UP: "DROAM/VP up",
    Method.DROAM_VP_DOWN: "DROAM/VP down",
    Method.SCOAM_NEARER: "SCOAM, nearer root",
    Method.SCOAM_CORRECTED: "SCOAM, corrected cap",
    Method.SCOAM_BEHIND: "SCOAM, behind the obstacle",
    Method.SCOAM_FORWARD: "SCOAM, meeting ahead",
    Method.SCOAM_FLYABLE: "SCOAM, flyable path",
}
RUNG_WORDS: Final[Mapping[str, str]] = {Rung.KINEMATIC: "on rails", Rung.JSBSIM: "flown"}


def say(value: float, unit: str = "") -> str:
    """``-3.8 m``; ``none`` for what does not exist. Plain characters, for a CSV."""
    return _plain(words.number(value, DECIMALS.get(unit, 2), unit)) if math.isfinite(value) else NO_FIGURE


def percent(value: float) -> str:
    """A share; ``none`` for what does not exist."""
    return words.percent(value) if math.isfinite(value) else NO_FIGURE


def interval(effect: Effect) -> str:
    """``0.42 deg (0.31 to 0.50, 1000 pairs)``."""
    if effect.n == 0:
        return NO_FIGURE
    bounds = f"{say(effect.low)} to {say(effect.high)}, " if math.isfinite(effect.low) else ""
    return f"{say(effect.value, effect.unit)} ({bounds}{effect.n} pairs)"


def _plain(text: str) -> str:
    return text.replace(words.MINUS, "-")


def reading(encounter: str) -> str:
    """An encounter in words."""
    return READING_WORDS.get(encounter, encounter)
