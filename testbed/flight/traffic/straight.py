"""The straight line at a constant speed: the obstacle of the paper."""

import math
from typing import NamedTuple

import numpy as np

from testbed.core.frames import Vec3, vec3
from testbed.flight.traffic.bounds import Bounds
from testbed.flight.traffic.track import Shifted, Track, TrackSetting

Array = np.ndarray


class Straight(NamedTuple):
    """A sphere that moves in a straight line. ``pos`` is where its centre is at time 0 (ENU m, m/s)."""

    name: str
    radius_m: float
    pos: Vec3
    vel: Vec3

    def at(self, time_s: float) -> tuple[Vec3, Vec3]:
        """Centre and velocity at a time; it is always there."""
        (x, y, z), (vx, vy, vz) = self.pos, self.vel
        return (x + vx * time_s, y + vy * time_s, z + vz * time_s), self.vel

    def sampled(self, time_s: Array) -> tuple[Array, Array]:
        """The same at times (n,), as arrays (n,3)."""
        return np.asarray(self.pos) + np.outer(time_s, self.vel), np.tile(self.vel, (len(time_s), 1))

    def bounds(self) -> Bounds:
        """See ``Bounds``."""
        return Bounds(math.hypot(*self.vel), -math.inf, math.inf)


def make_track(setting: TrackSetting) -> Straight:
    """The line through the obstacle's place at its instant."""
    return through(setting.name, setting.radius_m, setting.time_s, np.asarray(setting.pos), np.asarray(setting.vel))


def through(name: str, radius_m: float, time_s: float, pos: Array, vel: Array) -> Straight:
    """The line that is at ``pos`` (3,) with the velocity ``vel`` (3,) at a time."""
    return Straight(name, radius_m, vec3(pos - time_s * vel), vec3(vel))


def shifted(track: Track, time_s: float, pos: Array, vel: Array) -> Track:
    """A track moved as a whole so that at ``time_s`` it is at ``pos`` (3,) with the velocity ``vel`` (3,); a line stays a line."""
    if isinstance(track, Straight):
        return through(track.name, track.radius_m, time_s, pos, vel)
    return Shifted(track, time_s, pos, vel)
