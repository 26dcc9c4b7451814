"""Figures and lists as a sentence writes them."""

import math
from collections.abc import Mapping, Sequence
from typing import Final

from testbed.studies.scoam.claim import Effect
from testbed.studies.scoam.labels import Encounter, Method, Rung

PLACES: Final = {"m": 1, "deg": 2, "s": 2, "g": 1, "": 2, "deg/s": 0, "ms": 2, "times the limit": 2}

READING: Final[Mapping[str, str]] = {
    Encounter.SINGLE_AS_PRINTED: "Table 1 as printed",
    Encounter.SINGLE_106: "azimuth 106 deg",
    Encounter.SINGLE_106_10: "direction (106.1, 10.4) deg",
    Encounter.MULTI_AS_PRINTED: "Table 3 as printed",
    Encounter.MULTI_O2_UP: "O_2 climbing at +15.4 deg",
}

METHOD: Final[Mapping[str, str]] = {
    Method.SCOAM: "SCOAM",
    Method.DROAM_HP: "DROAM/HP",
    Method.DROAM_VP: "DROAM/VP",
    Method.LEAST_DEFLECTION: "least deflection",
    Method.DROAM_HP_LEFT: "DROAM/HP left",
    Method.DROAM_HP_RIGHT: "DROAM/HP right",
    Method.DROAM_VP_UP: "DROAM/VP up",
    Method.DROAM_VP_DOWN: "DROAM/VP down",
}
RUNG: Final[Mapping[str, str]] = {Rung.KINEMATIC: "on rails", Rung.JSBSIM: "flown"}


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
