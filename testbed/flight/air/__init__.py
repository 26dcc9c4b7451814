"""The one source of air for every plant, method and aircraft: mean wind, a discrete gust, a frozen turbulence.

Everything in it depends on the plan alone, never on what is flown in it: two methods, plants or aircraft of the same seed and the
same set speed meet the same air, and how much a wing feels of its rotation depends on the span alone. (JSBSim's own turbulence is the
exception, and the reason why it is an option only.)
"""

from testbed.flight.air.field import CALM, AirModel, BuiltIn, make_air
from testbed.flight.air.wind import Wind, ground_speed_along, make_wind

__all__ = ["CALM", "AirModel", "BuiltIn", "Wind", "ground_speed_along", "make_air", "make_wind"]
