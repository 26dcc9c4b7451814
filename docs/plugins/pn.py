"""A law over time: proportional navigation turned round, which accelerates away from the miss that is to be expected.

    plugins: [./pn.py]
    method: {kind: "pn:Law", options: {gain: 3.0, spare_m: 10.0}}

Of the obstacle that is met first, with p from the aircraft to it, w the relative velocity and t = p.w / w^2 until the closest approach:
d = w t - p is the miss to be expected, R the radius, and the acceleration asked for is gain (R + spare - |d|) / t^2 along d.
"""

import math
from collections.abc import Sequence

from testbed.flight.planning import Context, Steer
from testbed.flight.plants.base import State
from testbed.flight.sensing import Seen

Vec = tuple[float, float, float]


class Law:
    """Its memory is the direction of the last miss: an obstacle straight ahead has none, and is passed on the same side as before."""

    def __init__(self, gain: float = 3.0, spare_m: float = 10.0, most_mps2: float = 30.0) -> None:
        if gain <= 0.0:
            raise ValueError(f"gain: give a number above 0, got {gain}")
        self.gain, self.spare_m, self.most_mps2 = gain, spare_m, most_mps2

    def start(self, context: Context) -> Vec:  # noqa: ARG002
        """``context`` has the route, the goal, the aircraft's limits and the wind that a planner may know; this law needs none of it."""
        return (0.0, 0.0, 1.0)

    def steer(self, memory: Vec, time_s: float, own: State, seen: Sequence[Seen]) -> tuple[Vec, Steer]:
        """At the guidance rate, from the first threat until every obstacle opens and the way back keeps its radius."""
        pull: Vec = (0.0, 0.0, 0.0)
        soonest = math.inf
        for one in seen:
            p = [c - x for c, x in zip(one.at(time_s), own[:3], strict=True)]
            w = [v - u for v, u in zip(own[3:6], one.vel, strict=True)]
            speed2 = sum(c * c for c in w)
            left_s = sum(a * b for a, b in zip(p, w, strict=True)) / speed2 if speed2 > 0.0 else -1.0
            if not 0.0 < left_s < soonest:
                continue
            miss = [b * left_s - a for a, b in zip(p, w, strict=True)]
            size = math.hypot(*miss)
            short = one.radius_m + self.spare_m - size
            if short <= 0.0:
                continue
            soonest = left_s
            if size > 0.1:
                memory = (miss[0] / size, miss[1] / size, miss[2] / size)
            amount = min(self.most_mps2, self.gain * short / left_s**2)
            pull = (amount * memory[0], amount * memory[1], amount * memory[2])
        return memory, Steer(acceleration_enu_mps2=pull)
