"""How the air gets into JSBSim, in its feet: the mean wind of the start stays JSBSim's wind, and what differs from it is its gust."""

from collections.abc import Callable
from typing import Any

from testbed.flight.air import AirModel, BuiltIn
from testbed.frames import Vec3
from testbed.units import FT

WIND = tuple(f"atmosphere/total-wind-{axis}-fps" for axis in ("east", "north", "down"))
"""The air that the aircraft felt in the last step, as JSBSim has it."""
MILSPEC = 3  # JSBSim's turbulence after MIL-F-8785C; 4 (Tustin) can turn to NaN
SEVERITY = {"light": 3, "moderate": 4, "severe": 6}  # rows of figure 7 of MIL-F-8785C: exceeded with a probability of 1e-2, 1e-3, 1e-5
Lookup = Callable[[str], Any]  # name -> node; refuses a name that is missing


class GustFeed:
    """Writes the air of a time and place into JSBSim, less the wind of the start, which JSBSim has already."""

    def __init__(self, lookup: Lookup, air: AirModel, base: Vec3) -> None:
        self._at, self._base = air.at, base
        self._east, self._north, self._down = (lookup(f"atmosphere/gust-{axis}-fps").set_double_value for axis in ("east", "north", "down"))

    def write(self, time_s: float, place: Vec3) -> None:
        x, y, z = self._at(time_s, place)
        bx, by, bz = self._base
        self._east((x - bx) / FT)
        self._north((y - by) / FT)
        self._down((bz - z) / FT)


def switch_on(lookup: Lookup, turbulence: BuiltIn) -> None:
    """JSBSim's own turbulence. Below 1000 ft the wind at 20 ft sets its strength, above 2000 ft the severity does; without either, none."""
    lookup("atmosphere/randomseed").set_double_value(turbulence.seed)
    lookup("atmosphere/turbulence/milspec/windspeed_at_20ft_AGL-fps").set_double_value(turbulence.w20_mps / FT)
    lookup("atmosphere/turbulence/milspec/severity").set_double_value(SEVERITY[turbulence.severity])
    lookup("atmosphere/turb-type").set_double_value(MILSPEC)
