"""A guidance law: pure pursuit of a point some seconds ahead on the path.

plugins: [./pure_pursuit.py]
guidance: {kind: "pure_pursuit:Pursuit", options: {ahead_s: 1.2}}
"""

import math

from testbed.core.units import G0_MPS2
from testbed.flight.guidance.bank_to_turn import BankToTurn
from testbed.flight.guidance.law import GuidanceSetting, Memory, Telemetry
from testbed.flight.plants.base import Command, State
from testbed.flight.route.path import Path


class Pursuit:
    """The acceleration 2 V^2 / d^2 (across part of d), with d to the point that is pursued."""

    def __init__(self, setting: GuidanceSetting, ahead_s: float = 1.2) -> None:
        if not 0.2 <= ahead_s <= 10.0:
            raise ValueError(f"ahead_s: give a time from 0.2 to 10 s, got {ahead_s}")
        self.ahead_s, self.hold, self.dt_s = ahead_s, setting.hold, setting.dt_s
        self.turn = BankToTurn(setting.aircraft.limits)

    def start(self, s_m: float) -> Memory:
        return Memory(s_m, s_m)

    def step(self, memory: Memory, state: State, path: Path) -> tuple[Command, Memory, Telemetry]:
        pos, velocity = state[:3], state[3:6]
        flat, speed = math.hypot(*velocity[:2]), math.hypot(*velocity)
        point, tangent, _ = path.frame(memory.s_m)
        s_m = memory.s_m + sum((x - p) * t for x, p, t in zip(pos, point, tangent, strict=True))
        target, along, _ = path.frame(s_m + self.ahead_s * speed)
        d = [p - x for p, x in zip(target, pos, strict=True)]
        on = sum(a * v for a, v in zip(d, velocity, strict=True)) / speed**2
        ax, ay, az = (2.0 * speed**2 / sum(c * c for c in d) * (a - on * v) for a, v in zip(d, velocity, strict=True))
        vx, vy, vz = velocity
        left = (ay * vx - ax * vy) / flat
        up = (az * flat - vz * (ax * vx + ay * vy) / flat) / speed + G0_MPS2 * flat / speed
        bank, load_factor, limited = self.turn.solve(left, left, up, state.bank, state.airspeed)
        airspeed, scheduled = self.hold.solve(state.airspeed, speed, memory.scheduled_s_m - s_m)
        memory = Memory(s_m + speed * self.dt_s, memory.scheduled_s_m + scheduled * self.dt_s)
        return Command(bank, load_factor, airspeed, along[2]), memory, Telemetry(s_m, bank, load_factor, limited)
