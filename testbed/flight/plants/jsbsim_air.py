"""How the air gets into JSBSim, in its feet: the mean wind of the start stays JSBSim's wind, and what differs from it is its gust.

Frozen turbulence turns the air too. JSBSim's own turbulence is told apart from it by who takes it off the aircraft's rates, and by a
sign: its pitch is +dw/dx, w down (FGWinds.cpp, eq. 34 of its source), where air that turns rigidly has -dw/dx, as ours has.
"""

import math
from collections.abc import Callable
from typing import Any

from testbed.core.frames import Vec3
from testbed.core.units import FT
from testbed.flight.air import AirModel, BuiltIn, Wind
from testbed.flight.plants.jsbsim_model import AERO_RATES, IN_ROTATING_AIR, ROTARY_GUST

WIND = tuple(f"atmosphere/total-wind-{axis}-fps" for axis in ("east", "north", "down"))
"""The air that the aircraft felt in the last step, as JSBSim has it."""
MILSPEC = 3  # JSBSim's turbulence after MIL-F-8785C; 4 (Tustin) can turn to NaN
SEVERITY = {"light": 3, "moderate": 4, "severe": 6}  # rows of figure 7 of MIL-F-8785C: exceeded with a probability of 1e-2, 1e-3, 1e-5
Lookup = Callable[[str], Any]  # name -> node; refuses a name that is missing


def rates_in_air(air: AirModel) -> tuple[str, ...]:
    """The properties with the rates that the aerodynamics use; none where the air does not turn."""
    if air.rotation is not None:
        return IN_ROTATING_AIR
    return AERO_RATES if air.built_in is not None else ()


class GustFeed:
    """Writes the air of a time and place into JSBSim, less the wind of the start, which JSBSim has already."""

    def __init__(self, lookup: Lookup, air: AirModel, base: Vec3) -> None:
        self._at, self._base = air.at, base
        self._east, self._north, self._down = (lookup(f"atmosphere/gust-{axis}-fps").set_double_value for axis in ("east", "north", "down"))
        self._turn: Callable[[float, Vec3], None] | None = None
        if air.rotation is not None:
            self._turn = rotary_feed(lookup, air.rotation(FT * lookup("metrics/bw-ft").get_double_value()))

    def write(self, time_s: float, place: Vec3) -> None:
        x, y, z = self._at(time_s, place)
        bx, by, bz = self._base
        self._east((x - bx) / FT)
        self._north((y - by) / FT)
        self._down((bz - z) / FT)
        if self._turn is not None:
            self._turn(time_s, place)


def rotary_feed(lookup: Lookup, rotation: Wind) -> Callable[[float, Vec3], None]:
    """Writes the angular velocity of the air (ENU, rad/s) into JSBSim in body axes.

    The attitude is what JSBSim has at that moment: of one step ago, as the place is; at the start of the last probe of the start.
    """
    bank, pitch, heading = (lookup(f"attitude/{angle}-rad").get_double_value for angle in ("phi", "theta", "psi"))
    set_p, set_q, set_r = (lookup(name).set_double_value for name in ROTARY_GUST)

    def write(time_s: float, place: Vec3) -> None:
        x, y, z = rotation(time_s, place)
        roll, nose, track = bank(), pitch(), heading()
        sin, cos = math.sin(track), math.cos(track)
        ahead, right = sin * x + cos * y, cos * x - sin * y  # level, along and across the heading
        sin, cos = math.sin(nose), math.cos(nose)
        below = sin * ahead - cos * z  # of the aircraft with its wings level
        set_p(cos * ahead + sin * z)
        sin, cos = math.sin(roll), math.cos(roll)
        set_q(cos * right + sin * below)
        set_r(cos * below - sin * right)

    return write


def switch_on(lookup: Lookup, turbulence: BuiltIn) -> None:
    """JSBSim's own turbulence. Below 1000 ft the wind at 20 ft sets its strength, above 2000 ft the severity does; without either, none."""
    lookup("atmosphere/randomseed").set_double_value(turbulence.seed)
    lookup("atmosphere/turbulence/milspec/windspeed_at_20ft_AGL-fps").set_double_value(turbulence.w20_mps / FT)
    lookup("atmosphere/turbulence/milspec/severity").set_double_value(SEVERITY[turbulence.severity])
    lookup("atmosphere/turb-type").set_double_value(MILSPEC)
