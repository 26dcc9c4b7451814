"""Paths to prove an aircraft on, of the shapes that campaigns fly, scaled to what the aircraft can turn and climb."""

import math

import numpy as np

from testbed.campaign.words.route import Random, Swerve
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.route.courses import Ends, bends, course
from testbed.flight.route.path import ActivePath
from vosc import ph


def turn_radius(speed_mps: float, bank_rad: float) -> float:
    """Radius (m) of a level coordinated turn."""
    return speed_mps * speed_mps / (G0_MPS2 * math.tan(bank_rad))


def turn_radius_at(speed_mps: float, load_factor: float) -> float:
    """Radius (m) of a level coordinated turn at a load factor above 1, V^2 / (g sqrt(n^2 - 1)); inf at 1 g and below."""
    return speed_mps * speed_mps / (G0_MPS2 * math.sqrt(load_factor * load_factor - 1.0)) if load_factor > 1.0 else math.inf


def swerve(swings: int, heading_deg: float = 15.0, swing_m: float = 150.0) -> ActivePath:
    """A level S-swerve: from ``heading_deg`` on one side to as much on the other in ``swing_m``; no curvature at either end."""
    return _path(course(Swerve(kind="swerve", heading_deg=heading_deg, swing_m=swing_m, swings=swings), np.random.default_rng(0)))


def random_path(rng: np.random.Generator, least_radius_m: float, climb_limit_rad: float) -> ActivePath:
    """A random path of that least radius, no steeper than the limit."""
    shape = Random(kind="random", least_radius_m=(least_radius_m, least_radius_m), climb_at_most_deg=climb_limit_rad / DEG)
    return _path(course(shape, rng))


def random_bends(rng: np.random.Generator, least_radius_m: float, climb_limit_rad: float) -> ActivePath:
    """A random path of smooth bends."""
    return _path(bends(rng, least_radius_m, climb_limit_rad))


def _path(pieces: list[Ends]) -> ActivePath:
    return ActivePath([ph.hermite(*piece) for piece in pieces])
