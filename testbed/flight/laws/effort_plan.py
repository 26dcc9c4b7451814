"""The plan of least effort: a point whose acceleration acts across a direction, and conditions on where it is at given times.

x'' = a, a across the velocity through the air of now, since the airspeed is held. Each condition asks for a place along a unit vector n_i
at a time t_i, and its zero-effort miss z_i is what it is short of without acceleration. The least integral of a^2 is

    a(tau) = sum_i lambda_i P n_i max(t_i - tau, 0)        sum_j G_ij lambda_j = z_i
    G_ij = n_i'P n_j t_i^2 (3 t_j - t_i) / 6,  t_i <= t_j

P leaves out what is along it. With one condition, across it: a = 3 z / t^2 now, less and less until none at its time.
"""

from typing import NamedTuple

import numpy as np

from testbed.core.frames import Vec3, vec3
from vosc.vec import along, dot

SOONEST_S = 0.25  # a condition that is due sooner acts as one that is due then: what is short there is rounding, or too late
SAME = 1e-9  # conditions of which one says nothing new to this share are met between them


class Condition(NamedTuple):
    """At ``due_s`` from now the place must be ``short_m`` farther along the unit vector ``way`` than it would be by itself."""

    due_s: float
    way: Vec3
    short_m: float


class Plan:
    """From a place and a velocity, the least effort across the unit vector ``ahead`` that meets the conditions; those that contradict
    each other are met between them.
    """

    def __init__(self, pos: Vec3, vel: Vec3, ahead: Vec3, conditions: tuple[Condition, ...] = ()) -> None:
        self.pos, self.vel, self.ahead, self.conditions = pos, vel, ahead, conditions
        times = [max(one.due_s, SOONEST_S) for one in conditions]
        pulls = [along(one.way, -dot(one.way, ahead), ahead) for one in conditions]
        each = list(zip(times, pulls, strict=True))
        self._gram = np.array([[dot(p, q) * overlap(t, u) for u, q in each] for t, p in each])
        self._times, across = np.array(times), np.array(pulls).reshape(-1, 3)
        size = self._times**1.5  # so that the matrix does not grow with the times
        short = np.array([one.short_m for one in conditions])
        solved = np.linalg.lstsq(self._gram / (size[:, None] * size), short / size, rcond=SAME)[0] if conditions else short
        self._multipliers = solved / size
        self._pulls = self._multipliers[:, None] * across

    def acceleration(self) -> Vec3:
        """Now, m/s^2."""
        return vec3(self._times @ self._pulls)

    def effort(self) -> float:
        """The integral of a^2, m^2/s^3."""
        return float(self._multipliers @ self._gram @ self._multipliers)

    def points(self, time_s: np.ndarray) -> np.ndarray:
        """Places (n,3) at times (n,)."""
        early, late = np.minimum(time_s[:, None], self._times), np.maximum(time_s[:, None], self._times)
        weights = early**2 * (3.0 * late - early) / 6.0
        return np.asarray(np.array(self.pos) + time_s[:, None] * np.array(self.vel) + weights @ self._pulls)


def overlap(one_s: float, other_s: float) -> float:
    """The integral of max(t_i - tau, 0) max(t_j - tau, 0), s^3."""
    early, late = (one_s, other_s) if one_s <= other_s else (other_s, one_s)
    return early * early * (3.0 * late - early) / 6.0
