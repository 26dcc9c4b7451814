"""Figures as a sentence of ``verdict.csv`` writes them, and the names of what they are of."""

import math
from typing import Final

from testbed.results.statistics import Effect
from testbed.show import words

PLACES: Final = words.DIGITS | {"deg": 2, "ms": 2}
"""Decimals in a sentence, which compares what differs little."""
NONE: Final = "none"

READING: Final = {
    "single_as_printed": "Table 1 as printed",
    "single_106": "azimuth 106 deg",
    "single_106_10": "direction (106.1, 10.4) deg",
    "multi_as_printed": "Table 3 as printed",
    "multi_o2_up": "O_2 climbing at +15.4 deg",
}

METHOD: Final = words.METHODS | {
    "least_deflection": "least deflection",
    "droam_hp_left": "DROAM/HP left",
    "droam_hp_right": "DROAM/HP right",
    "droam_vp_up": "DROAM/VP up",
    "droam_vp_down": "DROAM/VP down",
}
RUNG: Final = {"kinematic": "on rails", "jsbsim": "flown"}


def say(value: float, unit: str = "") -> str:
    """``-3.8 m``; ``none`` for what does not exist. Plain characters, for a CSV."""
    return _plain(words.number(value, PLACES.get(unit, 2), unit)) if math.isfinite(value) else NONE


def percent(value: float) -> str:
    """A share; ``none`` for what does not exist."""
    return words.percent(value) if math.isfinite(value) else NONE


def interval(effect: Effect) -> str:
    """``0.42 deg (0.31 to 0.50, 1000 pairs)``."""
    if effect.n == 0:
        return NONE
    bounds = f"{say(effect.low)} to {say(effect.high)}, " if math.isfinite(effect.low) else ""
    return f"{say(effect.value, effect.unit)} ({bounds}{effect.n} pairs)"


def _plain(text: str) -> str:
    return text.replace(words.MINUS, "-")


def reading(encounter: str) -> str:
    """An encounter in words."""
    return READING.get(encounter, encounter)
