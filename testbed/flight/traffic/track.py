"""The obstacles: spheres on straight lines, and how close a flight came to them."""

from typing import NamedTuple

import numpy as np

from testbed.core.frames import Vec3

Array = np.ndarray


class Track(NamedTuple):
    """An obstacle: a sphere that moves in a straight line. ``pos`` is where its centre is at time 0 (ENU m, m/s)."""

    name: str
    radius: float
    pos: Vec3
    vel: Vec3

    def at(self, time_s: float) -> Vec3:
        """Centre at a time."""
        (x, y, z), (vx, vy, vz) = self.pos, self.vel
        return x + vx * time_s, y + vy * time_s, z + vz * time_s


class Approach(NamedTuple):
    """The closest approach of a flight to one obstacle."""

    clearance_m: float
    time_s: float


def least_clearance(time_s: Array, own_pos: Array, obstacle_pos: Array, radius_m: float) -> Approach:
    """Least distance to the surface over a sampled flight, between samples too.

    ``time_s`` (n,), positions (n,3). Both bodies are taken to move straight between samples, which makes the minimum on each
    segment a closed form. NaN for an empty flight; samples that are not finite are passed over.
    """
    relative = own_pos - obstacle_pos
    good = np.isfinite(relative).all(axis=1)
    time_s, relative = time_s[good], relative[good]
    if not len(relative):
        return Approach(np.nan, np.nan)
    step = np.diff(relative, axis=0)
    square = np.einsum("ij,ij->i", step, step)
    share = np.clip(-np.einsum("ij,ij->i", relative[:-1], step) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    points = np.vstack([relative, relative[:-1] + share[:, None] * step])
    times = np.concatenate([time_s, time_s[:-1] + share * np.diff(time_s)])
    distance = np.linalg.norm(points, axis=1)
    k = int(np.argmin(distance))
    return Approach(float(distance[k]) - radius_m, float(times[k]))
