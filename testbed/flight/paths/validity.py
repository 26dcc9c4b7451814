"""Is a path flown at the present speed clear of moving spheres, and within the aircraft's limits?

The speed is held, through the air or over the ground, so that a place on the path has its time: t = s/V in calm air, and the integral
of ds over the speed over the ground in a known wind. A sphere goes straight on. Between samples aircraft and sphere move straight.
Lift carries V^2 kappa and the weight, in a coordinated turn, with the speed over the ground for V.
"""

import math
from typing import NamedTuple

import numpy as np

from testbed.core.frames import Vec3
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.plants.aircraft import Limits
from vosc.ph_flyable import lift
from vosc.vec import FloatArray

FORBIDS = ("the radius that is kept", "load factor", "bank", "climb angle", "roll rate")
"""What each column of an excess is of."""
LEAST_SHARE_OF_SPEED = 0.05  # against a wind as fast as the aircraft the path is not flown in a finite time
SLACK = 1e-9


class Ability(NamedTuple):
    """What a path may ask for: load factors, bank and climb angle rad, roll rate rad/s."""

    load_max: float
    load_min: float
    bank: float
    climb: float
    roll_rate: float

    @classmethod
    def of(cls, limits: Limits, share: float, climb_deg: float) -> "Ability":
        """A share of the aircraft's turn and of its roll rate; of the load factor, of what is beside the weight."""
        beside = (1.0 + share * (limits.load_factor_max - 1.0), 1.0 - share * (1.0 - limits.load_factor_min))
        return cls(*beside, share * limits.bank_deg * DEG, climb_deg * DEG, share * limits.roll_rate_dps * DEG)

    def granting(self, asked: "Asked") -> "Ability":
        """The same, but for what the start asks for already, which no path can do without."""
        load_max, load_min = max(self.load_max, float(asked.load.max())), min(self.load_min, float(asked.load.min()))
        bank, climb = max(self.bank, float(np.abs(asked.bank).max())), max(self.climb, float(np.abs(asked.climb).max()))
        return Ability(load_max, load_min, bank, climb, self.roll_rate)


class Pace(NamedTuple):
    """The speed that is held, and the wind that it is held in: none where it is the speed over the ground."""

    speed_mps: float
    wind: Vec3

    def over_ground(self, tangents: FloatArray) -> FloatArray:
        """Speeds over the ground (...,) along directions (...,3)."""
        wind = np.array(self.wind)
        along = tangents @ wind
        left = np.maximum(self.speed_mps**2 - (wind @ wind - along**2), 0.0)
        return np.asarray(np.maximum(along + np.sqrt(left), LEAST_SHARE_OF_SPEED * self.speed_mps))


class Spheres(NamedTuple):
    """Obstacles at the time of the decision: centres (k,3), velocities (k,3), distances to the centre that are kept (k,)."""

    centres: FloatArray
    velocities: FloatArray
    kept: FloatArray


class Sampled(NamedTuple):
    """Places of n paths: arc lengths (n,m) m, points, unit tangents and curvature vectors (n,m,3)."""

    s: FloatArray
    points: FloatArray
    tangents: FloatArray
    bends: FloatArray


class Asked(NamedTuple):
    """What paths ask of the aircraft at their samples (n,m): load factor, bank and climb angle rad."""

    load: FloatArray
    bank: FloatArray
    climb: FloatArray


def asked(tangents: FloatArray, bends: FloatArray, speeds: FloatArray) -> Asked:
    """Load factor, bank and climb at samples (n,m)."""
    right, up = lift(tangents, bends, speeds)
    return Asked(np.hypot(right, up) / G0_MPS2, np.arctan2(right, up), np.arcsin(np.clip(tangents[..., 2], -1.0, 1.0)))


def times(sampled: Sampled, pace: Pace, begins_s: FloatArray) -> FloatArray:
    """When the samples are reached (n,m), s; the first of each path at ``begins_s`` (n,)."""
    slow = 1.0 / pace.over_ground(sampled.tangents)
    steps = 0.5 * (slow[:, 1:] + slow[:, :-1]) * np.diff(sampled.s, axis=1)
    return np.asarray(begins_s[:, None] + np.concatenate([np.zeros((len(steps), 1)), np.cumsum(steps, axis=1)], axis=1))


def clearances(points: FloatArray, when_s: FloatArray, spheres: Spheres) -> FloatArray:
    """Least distance (n,k) to each centre less what is kept, over what is kept: below 0 is too near."""
    out = np.empty((len(points), len(spheres.kept)))
    for k, (centre, velocity, kept) in enumerate(zip(*spheres, strict=True)):
        relative = points - centre - when_s[..., None] * velocity
        first, step = relative[:, :-1], np.diff(relative, axis=1)
        square = (step * step).sum(axis=-1)
        share = np.clip(-(first * step).sum(axis=-1) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
        out[:, k] = np.linalg.norm(first + share[..., None] * step, axis=-1).min(axis=1) / kept - 1.0
    return out


def excesses(sampled: Sampled, when_s: FloatArray, pace: Pace, spheres: Spheres, ability: Ability) -> FloatArray:
    """How far paths are beyond each limit (n,5), as shares of it (climb: in radians); up to 0 is within. Lost paths: infinite."""
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        load, bank, climb = asked(sampled.tangents, sampled.bends, pace.over_ground(sampled.tangents))
        rate = np.abs(np.diff(np.unwrap(bank, axis=1), axis=1)) / np.maximum(np.diff(when_s, axis=1), 1e-9)
        near = -clearances(sampled.points, when_s, spheres)
        out = np.stack(
            [
                near.max(axis=1, initial=-math.inf),
                np.maximum(load.max(axis=1) / ability.load_max - 1.0, ability.load_min - load.min(axis=1)),
                np.abs(bank).max(axis=1) / ability.bank - 1.0,
                np.abs(climb).max(axis=1) - ability.climb,
                rate.max(axis=1) / ability.roll_rate - 1.0,
            ],
            axis=1,
        )
    return np.where(np.isnan(out), math.inf, out)
