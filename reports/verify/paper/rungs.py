"""A figure of one flight on every rung and in moving air."""

import math

import numpy as np

from .flights import Figure, Flights


def on_rungs(flights: Flights, figure: Figure, **where: str) -> dict[str, float]:
    """A figure on the rungs in calm air, and its spread in anchored wind and turbulence."""
    calm = {
        column: next(map(figure, flights.pick(part="calm", rung=rung, **where)), math.nan)
        for column, rung in (("kinematic", "kinematic"), ("point_mass", "point_mass"), ("flown_calm", "jsbsim"))
    }
    return calm | in_air(flights, figure, **where)


def in_air(flights: Flights, figure: Figure, **where: str) -> dict[str, float]:
    """The spread of a figure in anchored wind and turbulence, and of how many flights."""
    air = [*flights.pick(part="wind", design="anchored", rung="jsbsim", **where), *flights.pick(part="turbulence", rung="jsbsim", **where)]
    found = [value for value in map(figure, air) if not math.isnan(value)]
    low, middle, high = np.percentile(found, (5.0, 50.0, 95.0)) if found else (math.nan, math.nan, math.nan)
    return {"flown_air_p05": float(low), "flown_air_median": float(middle), "flown_air_p95": float(high), "flown_air_n": len(found)}
