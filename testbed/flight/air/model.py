"""The air of one flight: what is the same everywhere, what the planner may know, what there is."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from testbed.flight.air.dryden import SERIES_HZ, W20_MPS, dryden, dryden_series
from testbed.flight.air.gusts import Frame, make_gust
from testbed.flight.air.wind import STILL, Wind, make_wind, steady_wind
from testbed.frames import Vec3
from testbed.seeds import stream
from testbed.spec.air import DrydenTurbulence, JsbsimTurbulence, NoGust
from testbed.spec.model import FlightPlan

MARGIN_S = 2.0  # the series is that much longer than the flight may take
LEAST_SEED = 2**20  # JSBSim takes small seeds for no seed


class BuiltIn(NamedTuple):
    """JSBSim's own turbulence: the strength near the ground, the severity that sets it aloft, the seed of its noise."""

    w20_mps: float
    severity: str
    seed: int


@dataclass(frozen=True)
class AirModel:
    """Velocity of the air over the ground, ENU m/s, as functions of time (s) and place (ENU, m).

    ``steady``: the one velocity that the air has everywhere and always, gusts included; None where it varies.
    ``mean``: the mean wind, which a start is trimmed for, which traffic may drift with and which a planner may know;
    ``uniform``: the mean wind that is the same everywhere, None where it is sheared.
    ``at``: the air itself, gust and turbulence included. ``built_in``: turbulence that only the plant knows, on top of ``at``.
    """

    steady: Vec3 | None
    uniform: Vec3 | None
    mean: Wind
    at: Wind
    built_in: BuiltIn | None = None


CALM = AirModel(STILL, STILL, lambda _t_s, _pos_enu_m: STILL, lambda _t_s, _pos_enu_m: STILL)


def make_air(plan: FlightPlan, route: Frame, begin_s_m: float, longest_s: float) -> AirModel:
    """The air of a plan. ``route``: point and unit tangent by arc length; ``longest_s``: how long the flight may take."""
    mean, uniform = make_wind(plan.air, plan.terrain_z_m), steady_wind(plan.air)
    parts: list[Wind] = []
    if not isinstance(plan.air.gust, NoGust):
        parts.append(make_gust(plan.air.gust, route, begin_s_m, plan.speed_mps))
    turbulence = plan.air.turbulence
    if isinstance(turbulence, DrydenTurbulence) and math.isfinite(longest_s):
        parts.append(_frozen(plan, turbulence, route(0.0), longest_s))
    built_in = None
    if isinstance(turbulence, JsbsimTurbulence):
        seed = int(stream(plan.seed, plan.replicate, "turbulence").integers(LEAST_SEED, 2**31 - 1))
        built_in = BuiltIn(W20_MPS[turbulence.severity], turbulence.severity, seed)
    if not parts:
        return AirModel(uniform if built_in is None else None, uniform, mean, mean, built_in)
    return AirModel(None, uniform, mean, _sum([mean, *parts]), built_in)


def _sum(parts: list[Wind]) -> Wind:
    def total(t_s: float, pos_enu_m: Vec3) -> Vec3:
        x = y = z = 0.0
        for part in parts:
            dx, dy, dz = part(t_s, pos_enu_m)
            x, y, z = x + dx, y + dy, z + dz
        return x, y, z

    return total


def _frozen(plan: FlightPlan, turbulence: DrydenTurbulence, start: tuple[Vec3, Vec3], longest_s: float) -> Wind:
    """The Dryden series of a seed, as a function of time: every flight of the seed meets the same gust at the same time.

    Height above the ground and direction are those of the route's start (not of where the flight begins on it, which may differ
    between aircraft), the airspeed is the set speed. The components along, across (left) and up are laid along the horizontal
    direction of the route there, and stay so: the air does not turn with the aircraft.
    """
    (_, _, z), (tx, ty, _) = start
    height = turbulence.height_m if turbulence.height_m is not None else z - plan.terrain_z_m
    series = dryden_series(
        dryden(turbulence.severity, height),
        plan.speed_mps,
        math.ceil((longest_s + MARGIN_S) * SERIES_HZ) + 2,
        stream(plan.seed, plan.replicate, "turbulence"),
    )
    flat = math.hypot(tx, ty)
    cos, sin = (tx / flat, ty / flat) if flat > 0.0 else (1.0, 0.0)
    along, left, up = series.T
    rows: list[Vec3] = [tuple(row) for row in np.column_stack([cos * along - sin * left, sin * along + cos * left, up]).tolist()]
    last = float(len(rows) - 2)

    def frozen(t_s: float, _pos_enu_m: Vec3) -> Vec3:
        at = min(t_s * SERIES_HZ, last)
        k = int(at)
        share = at - k
        (ax, ay, az), (bx, by, bz) = rows[k], rows[k + 1]
        return ax + share * (bx - ax), ay + share * (by - ay), az + share * (bz - az)

    return frozen
