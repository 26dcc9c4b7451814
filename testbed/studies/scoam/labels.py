"""The labels that the study selects flights by: the only place where they are spelt. What each stands for is said in ``docs/verdict.md``.

``LABELS`` is what a campaign is checked against when it is loaded; whatever judges or pictures takes its labels from here.
"""

from collections.abc import Mapping
from enum import StrEnum
from typing import Final

from testbed.campaign.words.grid import PART
from testbed.campaign.words.study import Axes, LabelKind, Labels


class Axis(StrEnum):
    """What flights differ by."""

    PART = PART
    ENCOUNTER = "encounter"
    METHOD = "method"
    FLOWN_BY = "flown_by"
    RUNG = "rung"
    DESIGN = "design"
    WIND_MPS = "wind_mps"
    WIND_FROM = "wind_from"
    SEVERITY = "severity"
    LEAD_S = "lead_s"
    SWELL_M = "swell_m"


class Part(StrEnum):
    """Parts of the campaign."""

    CALM = "calm"
    WIND = "wind"
    TURBULENCE = "turbulence"
    POPULATION = "population"
    ROBUSTNESS_SINGLE = "robustness_single"
    ROBUSTNESS_MULTI = "robustness_multi"
    CONTROLS = "controls"
    REMEDY = "remedy"
    READINGS = "readings"
    READINGS_WIND = "readings_wind"
    READINGS_POPULATION = "readings_population"


class Encounter(StrEnum):
    """Readings of sections 5.1 and 5.2, the class that the population is drawn from, the controls, and where roots differ."""

    SINGLE_AS_PRINTED = "single_as_printed"
    SINGLE_106 = "single_106"
    SINGLE_106_10 = "single_106_10"
    MULTI_AS_PRINTED = "multi_as_printed"
    MULTI_O2_UP = "multi_o2_up"
    CLASS = "class"
    GENTLE = "gentle"
    GENTLE_NO_MARGIN = "gentle_no_margin"
    IMPOSSIBLE = "impossible"
    OVERTAKEN = "overtaken"


class Method(StrEnum):
    """Who answers; DROAM by its plane, and in calm air by the side it takes too; SCOAM by what the paper may be read as, one at a time."""

    NONE = "none"
    SCOAM = "scoam"
    DROAM_HP = "droam_hp"
    DROAM_VP = "droam_vp"
    DROAM_HP_LEFT = "droam_hp_left"
    DROAM_HP_RIGHT = "droam_hp_right"
    DROAM_VP_UP = "droam_vp_up"
    DROAM_VP_DOWN = "droam_vp_down"
    LEAST_DEFLECTION = "least_deflection"
    SCOAM_NEARER = "scoam_nearer"
    SCOAM_CORRECTED = "scoam_corrected"
    SCOAM_BEHIND = "scoam_behind"
    SCOAM_FORWARD = "scoam_forward"
    SCOAM_FLYABLE = "scoam_flyable"


class Rung(StrEnum):
    """How much of flight there is."""

    VO_INSTANT = "vo_instant"
    KINEMATIC = "kinematic"
    POINT_IDEAL = "point_ideal"
    POINT_ROLL = "point_roll"
    POINT_LOAD = "point_load"
    POINT_SPEED = "point_speed"
    POINT_NO_ROLL = "point_no_roll"
    POINT_NO_LOAD = "point_no_load"
    POINT_NO_SPEED = "point_no_speed"
    POINT_MASS = "point_mass"
    JSBSIM = "jsbsim"
    DIRECT = "direct"


class Design(StrEnum):
    """How an obstacle takes part in the wind."""

    ANCHORED = "anchored"
    GROUND_FIXED = "ground_fixed"


class Compass(StrEnum):
    """Where the wind comes from."""

    N = "N"
    NE = "NE"
    E = "E"
    SE = "SE"
    S = "S"
    SW = "SW"
    W = "W"
    NW = "NW"


class Severity(StrEnum):
    """Of turbulence, weakest first."""

    LIGHT = "light"
    MODERATE = "moderate"
    SEVERE = "severe"


MAIN: Final = "gtm_t2"  # flies the geometry that the paper prints
ROBUSTNESS: Final = "robustness"  # what the draws of several encounters, parts of their own, are together
SINGLE: Final = (Encounter.SINGLE_106, Encounter.SINGLE_106_10)  # readings of section 5.1 in which its obstacle is a threat
MULTI: Final = (Encounter.MULTI_AS_PRINTED, Encounter.MULTI_O2_UP)
DRAWN: Final = (Encounter.SINGLE_106, Encounter.MULTI_O2_UP)  # encounters of the robustness parts
DROAM: Final = (Method.DROAM_HP, Method.DROAM_VP)
SIDES: Final[Mapping[str, tuple[Method, Method]]] = {
    Method.DROAM_HP: (Method.DROAM_HP_LEFT, Method.DROAM_HP_RIGHT),
    Method.DROAM_VP: (Method.DROAM_VP_UP, Method.DROAM_VP_DOWN),
}
READINGS: Final = (
    *(Method.SCOAM, Method.SCOAM_NEARER, Method.SCOAM_CORRECTED, Method.SCOAM_BEHIND, Method.SCOAM_FORWARD),
    Method.SCOAM_FLYABLE,
)
READING_PARTS: Final = (Part.READINGS, Part.READINGS_WIND, Part.READINGS_POPULATION)

_PRINTED: Final = (Encounter.SINGLE_AS_PRINTED, *SINGLE, *MULTI)
_METHODS: Final = (Method.NONE, Method.SCOAM, *DROAM, Method.LEAST_DEFLECTION)
_SIDES: Final = tuple(side for plane in DROAM for side in SIDES[plane])
_FLOWN: Final[Axes] = {Axis.METHOD: _METHODS, Axis.FLOWN_BY: LabelKind.AIRCRAFT, Axis.RUNG: tuple(Rung)}
_READ: Final[Axes] = {**_FLOWN, Axis.METHOD: (Method.NONE, *READINGS)}
_WIND: Final[Axes] = {Axis.DESIGN: tuple(Design), Axis.WIND_MPS: LabelKind.NUMBER, Axis.WIND_FROM: tuple(Compass)}
_TURBULENCE: Final[Axes] = {Axis.SEVERITY: tuple(Severity)}

LABELS: Final[Labels] = {
    Part.CALM: {Axis.ENCOUNTER: _PRINTED, **_FLOWN, Axis.METHOD: (*_METHODS, *_SIDES)},
    Part.WIND: {Axis.ENCOUNTER: _PRINTED, **_FLOWN, **_WIND},
    Part.TURBULENCE: {Axis.ENCOUNTER: _PRINTED, **_FLOWN, **_TURBULENCE},
    Part.POPULATION: {Axis.ENCOUNTER: (Encounter.CLASS,), **_FLOWN},
    Part.ROBUSTNESS_SINGLE: {Axis.ENCOUNTER: DRAWN[:1], **_FLOWN},
    Part.ROBUSTNESS_MULTI: {Axis.ENCOUNTER: DRAWN[1:], **_FLOWN},
    Part.CONTROLS: {Axis.ENCOUNTER: (Encounter.GENTLE, Encounter.GENTLE_NO_MARGIN, Encounter.IMPOSSIBLE), **_FLOWN},
    Part.REMEDY: {**_FLOWN, Axis.LEAD_S: LabelKind.NUMBER, Axis.SWELL_M: LabelKind.NUMBER},
    Part.READINGS: {Axis.ENCOUNTER: (*DRAWN, Encounter.OVERTAKEN), **_READ},
    Part.READINGS_WIND: {Axis.ENCOUNTER: DRAWN, **_READ, **_WIND},
    Part.READINGS_POPULATION: {Axis.ENCOUNTER: (Encounter.CLASS,), **_READ},
}
"""Part to its axes and their labels."""

AIR: Final = tuple(Axis(name) for name in (*_WIND, *_TURBULENCE))
"""The axes that say in which air a flight is: with all of them, and its encounter, aircraft and rung, a place is one place."""
