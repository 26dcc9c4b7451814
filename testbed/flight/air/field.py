"""The air of one flight: what is the same everywhere, what the planner may know, what there is."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from testbed.campaign.words.air import DrydenTurbulence, JsbsimTurbulence, NoGust
from testbed.campaign.words.settings import FlightPlan
from testbed.core.frames import Vec3
from testbed.core.kept import Kept
from testbed.core.seeds import stream
from testbed.flight.air.dryden import SERIES_HZ, W20_MPS, Dryden, dryden, dryden_series
from testbed.flight.air.gusts import Frame, make_gust
from testbed.flight.air.rotary import rotary_series
from testbed.flight.air.wind import STILL, Wind, make_wind, steady_wind

Array = np.ndarray
Turning = Callable[[float], Wind]  # span of a wing (m) -> angular velocity of the air about it
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
    ``rotation``: of the frozen turbulence, for a wing of a span (m): its angular velocity, ENU rad/s; None where there is none.
    """

    steady: Vec3 | None
    uniform: Vec3 | None
    mean: Wind
    at: Wind
    built_in: BuiltIn | None = None
    rotation: Turning | None = None


CALM = AirModel(STILL, STILL, lambda _t_s, _pos_enu_m: STILL, lambda _t_s, _pos_enu_m: STILL)


def make_air(plan: FlightPlan, route: Frame, begin_s_m: float, longest_s: float) -> AirModel:
    """The air of a plan. ``route``: point and unit tangent by arc length; ``longest_s``: how long the flight may take."""
    mean, uniform = make_wind(plan.air, plan.terrain_z_m), steady_wind(plan.air)
    parts: list[Wind] = []
    rotation = None
    if not isinstance(plan.air.gust, NoGust):
        parts.append(make_gust(plan.air.gust, route, begin_s_m, plan.speed_mps))
    turbulence = plan.air.turbulence
    if isinstance(turbulence, DrydenTurbulence) and math.isfinite(longest_s):
        gusts, rotation, _ = _frozen(plan, turbulence, route(0.0), longest_s)
        parts.append(gusts)
    built_in = None
    if isinstance(turbulence, JsbsimTurbulence):
        seed = int(stream(plan.seed, plan.replicate, "turbulence").integers(LEAST_SEED, 2**31 - 1))
        built_in = BuiltIn(W20_MPS[turbulence.severity], turbulence.severity, seed)
    if not parts:
        return AirModel(uniform if built_in is None else None, uniform, mean, mean, built_in)
    return AirModel(None, uniform, mean, _sum([mean, *parts]), built_in, rotation)


def _sum(parts: list[Wind]) -> Wind:
    def total(t_s: float, pos_enu_m: Vec3) -> Vec3:
        x = y = z = 0.0
        for part in parts:
            dx, dy, dz = part(t_s, pos_enu_m)
            x, y, z = x + dx, y + dy, z + dz
        return x, y, z

    return total


class _Frozen(NamedTuple):
    """A series as functions of time: velocity, and angular velocity for a span."""

    velocity: Wind
    rotation: Turning
    samples: int


_frozen_air: Kept[_Frozen] = Kept(4e5, lambda frozen: frozen.samples)  # some 0.2 kB each


def _frozen(plan: FlightPlan, turbulence: DrydenTurbulence, start: tuple[Vec3, Vec3], longest_s: float) -> _Frozen:
    """The Dryden series of a seed, as functions of time: every flight of the seed meets the same gust at the same time.

    Height above the ground and direction are those of the route's start (not of where the flight begins on it, which may differ between
    aircraft), the airspeed is the set speed. The components along, across (left) and up are laid along the horizontal direction of the
    route there, and stay so: the air does not turn with the aircraft.
    """
    (_, _, z), (tx, ty, _) = start
    model = dryden(turbulence.severity, turbulence.height_m if turbulence.height_m is not None else z - plan.terrain_z_m)
    count = math.ceil((longest_s + MARGIN_S) * SERIES_HZ) + 2
    key = (model, plan.speed_mps, count, plan.seed, plan.replicate, repr((tx, ty)))  # repr tells 0 from -0
    return _frozen_air.get(key, lambda: _drawn(*key[:5], tx, ty))


def _drawn(model: Dryden, speed_mps: float, count: int, seed: int, replicate: int, tx: float, ty: float) -> _Frozen:
    series = dryden_series(model, speed_mps, count, stream(seed, replicate, "turbulence"))
    rotations: Kept[Wind] = Kept(3)

    def rotation(span_m: float) -> Wind:
        def make() -> Wind:
            noise = stream(seed, replicate, "turbulence_roll").normal(size=count)  # its own: the velocities do not know of it
            return _laid(rotary_series(series, noise, model, speed_mps, span_m), tx, ty)

        return rotations.get(span_m, make)

    return _Frozen(_laid(series, tx, ty), rotation, count)


def _laid(series: Array, tx: float, ty: float) -> Wind:
    """A series (n,3) along, left and up as a function of time in ENU: linear between its samples, along towards (tx, ty)."""
    flat = math.hypot(tx, ty)
    cos, sin = (tx / flat, ty / flat) if flat > 0.0 else (1.0, 0.0)
    along, left, up = series.T
    # three lists of floats and no list of tuples: ten thousands of tuples at once make Python look for garbage, which takes 60 ms
    east, north, above = ((cos * along - sin * left).tolist(), (sin * along + cos * left).tolist(), up.tolist())
    last = float(len(above) - 2)

    def frozen(t_s: float, _pos_enu_m: Vec3) -> Vec3:
        at = min(t_s * SERIES_HZ, last)
        k = int(at)
        share = at - k
        ax, ay, az = east[k], north[k], above[k]
        k += 1
        bx, by, bz = east[k], north[k], above[k]
        return ax + share * (bx - ax), ay + share * (by - ay), az + share * (bz - az)

    return frozen
