"""The mean wind: steady, or sheared with the height above the ground. A wind is a function of time and place."""

import math
from collections.abc import Callable

from testbed.campaign.words.air import Air, Calm, LogarithmicWind, PowerLawWind, SteadyWind
from testbed.core.frames import Vec3, ground_speed_along, wind_enu_from_compass

__all__ = ["STILL", "Wind", "ground_speed_along", "logarithmic", "make_wind", "power_law", "steady_wind"]

Wind = Callable[[float, Vec3], Vec3]  # (t_s, pos_enu_m) -> velocity of the air over the ground, ENU m/s

STILL: Vec3 = (0.0, 0.0, 0.0)


def steady_wind(air: Air) -> Vec3 | None:
    """The mean wind that is the same everywhere; None if it changes with height."""
    if isinstance(air.wind, Calm):
        return STILL
    return wind_enu_from_compass(air.wind.speed_mps, air.wind.from_deg) if isinstance(air.wind, SteadyWind) else None


def make_wind(air: Air, terrain_z_m: float = 0.0) -> Wind:
    """The mean wind of a plan over flat ground at ``terrain_z_m``."""
    if (fixed := steady_wind(air)) is not None:
        return lambda _t_s, _pos_enu_m: fixed
    assert isinstance(air.wind, PowerLawWind | LogarithmicWind)
    share = power_law(air.wind) if isinstance(air.wind, PowerLawWind) else logarithmic(air.wind)
    x, y, _ = wind_enu_from_compass(air.wind.speed_mps, air.wind.from_deg)

    def sheared(_t_s: float, pos_enu_m: Vec3) -> Vec3:
        factor = share(pos_enu_m[2] - terrain_z_m)
        return factor * x, factor * y, 0.0

    return sheared


def power_law(wind: PowerLawWind) -> Callable[[float], float]:
    """Height above the ground (m) to the wind's share of its reference speed: (h / h_ref)^exponent."""
    reference, exponent = wind.reference_height_m, wind.exponent
    return lambda height_m: (height_m / reference) ** exponent if height_m > 0.0 else 0.0


def logarithmic(wind: LogarithmicWind) -> Callable[[float], float]:
    """Height above the ground (m) to the wind's share of its reference speed: ln(h / z_0) / ln(h_ref / z_0) (MIL-F-8785C 3.7.3.2)."""
    roughness = wind.roughness_m
    scale = 1.0 / math.log(wind.reference_height_m / roughness)
    return lambda height_m: scale * math.log(height_m / roughness) if height_m > roughness else 0.0
