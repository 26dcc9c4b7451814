"""Discrete gusts: full strength at once, or a (1 - cos)/2 rise, at a time or at a plane across the route."""

import math
from collections.abc import Callable

from testbed.campaign.words.air import OneMinusCosineGust, StepGust
from testbed.core.frames import Vec3, unit_from_direction
from testbed.core.units import DEG
from testbed.flight.air.wind import Wind

Frame = Callable[[float], tuple[Vec3, Vec3]]  # arc length of the route -> point, unit tangent


def shape(gust: StepGust | OneMinusCosineGust) -> Callable[[float], float]:
    """Share of the gust's strength after a length (m) into it, 0 before it."""
    if isinstance(gust, StepGust):
        return lambda into_m: 1.0 if into_m >= 0.0 else 0.0
    rise, hold = gust.rise_m, math.inf if gust.hold_m is None else gust.hold_m

    def share(into_m: float) -> float:
        if into_m > rise:
            into_m = max(rise, into_m - hold)  # what is left of it falls as it rose
        return 0.5 * (1.0 - math.cos(math.pi * into_m / rise)) if 0.0 < into_m < 2.0 * rise else 0.0

    return share


def make_gust(gust: StepGust | OneMinusCosineGust, route: Frame, begin_s_m: float, speed_mps: float) -> Wind:
    """The gust alone (ENU, m/s). In time it passes at the set speed; in place it stands over the ground, across the route there."""
    place, along = route(begin_s_m if gust.at_route_s_m is None else gust.at_route_s_m)
    azimuth, elevation = gust.direction_deg
    if gust.frame == "track":
        azimuth += math.atan2(along[1], along[0]) / DEG
    ux, uy, uz = (gust.amplitude_mps * u for u in unit_from_direction(azimuth, elevation))
    share = shape(gust)

    if gust.at_time_s is not None:
        from_s = gust.at_time_s

        def in_time(t_s: float, _pos_enu_m: Vec3) -> Vec3:
            k = share(speed_mps * (t_s - from_s))
            return k * ux, k * uy, k * uz

        return in_time

    (px, py, pz), (tx, ty, tz) = place, along

    def in_place(_t_s: float, pos_enu_m: Vec3) -> Vec3:
        x, y, z = pos_enu_m
        k = share((x - px) * tx + (y - py) * ty + (z - pz) * tz)
        return k * ux, k * uy, k * uz

    return in_place
