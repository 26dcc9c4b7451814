"""A planner with memory: when something comes near, it goes aside for a while, and then for the goal.

plugins: [./holder.py]
planner: {kind: "holder:Planner", options: {aside_deg: 45.0, hold_s: 3.0}}
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from testbed.flight.planning import Context
from testbed.flight.plants.base import State
from testbed.flight.sensing import Seen


class Memory(NamedTuple):
    """What the planner was told, and until when it looks at nothing else."""

    context: Context
    busy_until_s: float = 0.0


class Planner:
    """One planner a flight."""

    def __init__(self, aside_deg: float = 45.0, hold_s: float = 3.0, near_m: float = 150.0) -> None:
        self.aside, self.hold_s, self.near_m = math.radians(aside_deg), hold_s, near_m

    def start(self, context: Context) -> Memory:
        return Memory(context)

    def step(self, memory: Memory, time_s: float, state: State, seen: Sequence[Seen]) -> tuple[Memory, np.ndarray | None]:
        """A new path is PH curves (vosc.ph) joined end to end, or points (n,3) to fly through; None: stay on the path."""
        if time_s < memory.busy_until_s:
            return memory, None
        pos = np.array(state[:3])
        near = [one for one in seen if math.dist(one.at(time_s), pos) - one.radius_m < self.near_m]
        if not near:
            return memory, None
        heading = math.atan2(state.vy, state.vx) + self.aside
        away = memory.context.speed_mps * self.hold_s * np.array([math.cos(heading), math.sin(heading), 0.0])
        return memory._replace(busy_until_s=time_s + 2.0 * self.hold_s), np.array([pos, pos + away, memory.context.goal])
