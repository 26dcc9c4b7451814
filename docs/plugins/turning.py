"""A track: the obstacle turns level at a constant rate, and may leave.

plugins: [./turning.py]
obstacles:
  - name: O
    kind: "turning:Turning"
    options: {rate_dps: -12.0}
    radius_m: 25
    position_enu_m: [300, 60, 0]
    speed_mps: 30
    direction_deg: [180, 0]
"""

import math

from testbed.flight.traffic import Sampled, TrackSetting

Vec = tuple[float, float, float]


class Turning(Sampled):
    """``Sampled`` makes the columns of the log out of ``at``."""

    def __init__(self, setting: TrackSetting, rate_dps: float = 6.0, leaves_s: float | None = None) -> None:
        if rate_dps == 0.0:
            raise ValueError("rate_dps: give a rate other than 0 deg/s; a straight track needs no plug-in")
        self.name, self.radius_m = setting.name, setting.radius_m
        self.setting, self.rate, self.leaves_s = setting, math.radians(rate_dps), leaves_s

    def at(self, time_s: float) -> tuple[Vec, Vec] | None:
        """Centre and velocity; None once it has left."""
        if self.leaves_s is not None and time_s > self.leaves_s:
            return None
        elapsed = time_s - self.setting.time_s
        (x, y, z), (vx, vy, vz) = self.setting.pos, self.setting.vel
        cos, sin = math.cos(self.rate * elapsed), math.sin(self.rate * elapsed)
        ux, uy = cos * vx - sin * vy, sin * vx + cos * vy
        return (x + (uy - vy) / self.rate, y - (ux - vx) / self.rate, z + vz * elapsed), (ux, uy, vz)
