"""The one source of wind, for every plant. A wind is a function of time and place."""

from collections.abc import Callable

from testbed.frames import Vec3, wind_enu_from_compass
from testbed.spec.model import Air, SteadyWind

Wind = Callable[[float, Vec3], Vec3]  # (t_s, pos_enu_m) -> velocity of the air over the ground, ENU m/s


def make_wind(air: Air) -> Wind:
    """The wind of a plan."""
    fixed = wind_enu_from_compass(air.wind.speed_mps, air.wind.from_deg) if isinstance(air.wind, SteadyWind) else (0.0, 0.0, 0.0)
    return lambda _t_s, _pos_enu_m: fixed


def ground_speed_along(tangent: Vec3, airspeed_mps: float, wind: Vec3) -> float:
    """Speed over the ground along a unit tangent at a given true airspeed: |v_g T - W| = TAS, the forward root; 0 if there is none."""
    along = sum(t * w for t, w in zip(tangent, wind, strict=True))
    square = along * along - (sum(w * w for w in wind) - airspeed_mps * airspeed_mps)
    return max(0.0, along + square**0.5) if square > 0.0 else 0.0
