"""Figures and lists as a sentence writes them."""

import math
from collections.abc import Sequence
from typing import Final

from testbed.studies.scoam.claim import Effect

PLACES: Final = {"m": 1, "deg": 2, "s": 2, "g": 1, "": 2, "deg/s": 0, "ms": 2, "times the limit": 2}

READING: Final = {
    "single_as_printed": "Table 1 as printed",
    "single_106": "azimuth 106 deg",
    "single_106_10": "direction (106.1, 10.4) deg",
    "multi_as_printed": "Table 3 as printed",
    "multi_o2_up": "O_2 climbing at +15.4 deg",
}

METHOD: Final = {
    "scoam": "SCOAM",
    "droam_hp": "DROAM/HP",
    "droam_vp": "DROAM/VP",
    "least_deflection": "least deflection",
    "droam_hp_left": "DROAM/HP left",
    "droam_hp_right": "DROAM/HP right",
    "droam_vp_up": "DROAM/VP up",
    "droam_vp_down": "DROAM/VP down",
}
RUNG: Final = {"kinematic": "on rails", "jsbsim": "flown"}


def say(value: float, unit: str = "") -> str:
    """``-3.8 m``; ``none`` for what does not exist. No negative zero."""
    if not math.isfinite(value):
        return "none"
    text = f"{round(value, PLACES.get(unit, 2)) + 0.0:.{PLACES.get(unit, 2)}f}"
    return f"{text} {unit}".rstrip()


def percent(value: float) -> str:
    """A share: ``92 %``; one decimal between 99 and 100 and between 0 and 1, where it matters."""
    if not math.isfinite(value):
        return "none"
    whole = 100.0 * value
    near = 99.0 < whole < 100.0 or 0.0 < whole < 1.0
    return f"{math.floor(10.0 * whole + 1e-9) / 10.0:.1f} %" if near else f"{whole:.0f} %"


def interval(effect: Effect) -> str:
    """``0.42 deg (0.31 to 0.50, 1000 pairs)``."""
    if effect.n == 0:
        return "none"
    bounds = f"{say(effect.low)} to {say(effect.high)}, " if math.isfinite(effect.low) else ""
    return f"{say(effect.value, effect.unit)} ({bounds}{effect.n} pairs)"


def listed(names: Sequence[str]) -> str:
    """``a``, ``a and b``, ``a, b and c``."""
    return " and ".join([", ".join(names[:-1]), names[-1]]) if len(names) > 1 else "".join(names)


def reading(encounter: str) -> str:
    """An encounter in words."""
    return READING.get(encounter, encounter)
