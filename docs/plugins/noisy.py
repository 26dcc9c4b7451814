"""A sensor with errors: it is late, and its positions and velocities are off.

plugins: [./noisy.py]
sensor: {kind: "noisy:Noisy", range_m: 120, options: {position_m: 3.0, velocity_mps: 1.0, late_s: 0.1}}
"""

import math

import numpy as np

from testbed.flight.plants.base import State
from testbed.flight.sensing import Seen, SensorContext
from testbed.flight.traffic import Traffic


class Noisy:
    """Its memory is the context: the range, and the stream that its errors come from."""

    def __init__(self, position_m: float = 3.0, velocity_mps: float = 1.0, late_s: float = 0.0) -> None:
        if late_s < 0.0:
            raise ValueError(f"late_s: give a time of at least 0 s, got {late_s}")
        self.sizes, self.late_s = np.repeat([position_m, velocity_mps], 3), late_s

    def start(self, context: SensorContext) -> SensorContext:
        return context

    def sense(self, memory: SensorContext, time_s: float, own: State, traffic: Traffic) -> tuple[SensorContext, tuple[Seen, ...]]:
        """As many numbers are drawn whatever is in sight: at the same look every method meets the same errors."""
        errors = {track.name: self.sizes * memory.random.normal(size=6) for track in traffic.tracks}
        seen = []
        for body in traffic.at(time_s - self.late_s):
            if math.dist(body.pos, own[:3]) <= memory.range_m:
                x, y, z, vx, vy, vz = (*body.pos, *body.vel) + errors[body.name]
                seen.append(Seen(body.name, body.radius_m, (x, y, z), (vx, vy, vz), body.time_s))
        return memory, tuple(seen)
