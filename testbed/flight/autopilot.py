"""Inner loops: bank, load factor and speed commands to surfaces and throttle. Memory goes in and comes out.

Surface signs are JSBSim's: elevator + nose down, aileron + rolls right, rudder + nose left.
"""

import math
from typing import NamedTuple

from testbed.flight.aircraft import Aircraft
from testbed.flight.plants.base import Command, State
from testbed.units import DEG, G0_MPS2


class Surfaces(NamedTuple):
    """Commands beside the pitch trim: elevator, aileron and rudder -1..1, throttle 0..1; and whether a surface is at its stop."""

    elevator: float
    aileron: float
    rudder: float
    throttle: float
    saturated: bool


class Memory(NamedTuple):
    """Integrators."""

    elevator: float = 0.0
    throttle: float = 0.0


class Autopilot:
    """Settings of one aircraft's loops; ``step`` is pure."""

    def __init__(self, aircraft: Aircraft, trim_throttle: float, dt_s: float) -> None:
        self._gains = aircraft.autopilot
        self._limits = aircraft.limits
        self._roll_limit = aircraft.limits.roll_rate_dps * DEG
        self._trim_throttle = trim_throttle
        self._dt = dt_s

    def step(self, memory: Memory, state: State, command: Command) -> tuple[Surfaces, Memory]:
        g = self._gains
        ratio = g.reference_mps / max(state.airspeed, 1.0)
        scale = ratio * ratio

        roll_cmd = g.bank_1ps * (command.bank - state.bank)
        roll_cmd = max(-self._roll_limit, min(self._roll_limit, roll_cmd))
        aileron = scale * g.aileron_per_roll_rate_s * (roll_cmd - state.p) + ratio * g.aileron_feed_forward_s * roll_cmd
        aileron_out = max(-1.0, min(1.0, aileron))

        cos_bank, cos_pitch = math.cos(state.bank), math.cos(state.pitch)
        error = command.load_factor - state.load_factor
        turn = G0_MPS2 / max(state.airspeed, 1.0)
        pitch_rate_cmd = turn * (command.load_factor - cos_bank * cos_pitch)
        elevator = -scale * (
            g.elevator_per_load_factor * (command.load_factor - 1.0)
            + g.elevator_p * error
            + memory.elevator
            + g.elevator_per_pitch_rate_s * (pitch_rate_cmd - state.q)
        )
        elevator_out = max(-1.0, min(1.0, elevator))

        yaw_rate_cmd = turn * math.sin(state.bank) * cos_pitch
        rudder = scale * (g.rudder_per_beta * state.beta + g.rudder_per_yaw_rate_s * (state.r - yaw_rate_cmd))
        rudder_out = max(-1.0, min(1.0, rudder))

        throttle, throttle_memory = self._throttle(memory, state, command)
        still = aileron_out == aileron and elevator_out == elevator and rudder_out == rudder
        grow = elevator_out == elevator  # no wind-up against a stop
        integral = memory.elevator + (g.elevator_i_1ps * error * self._dt if grow else 0.0)
        surfaces = Surfaces(elevator_out, aileron_out, rudder_out, throttle, not still)
        return surfaces, Memory(integral, throttle_memory)

    def _throttle(self, memory: Memory, state: State, command: Command) -> tuple[float, float]:
        """Feed-forward of climb and acceleration, plus PI on airspeed."""
        g = self._gains
        error = command.speed - state.airspeed
        demand = command.sin_climb + command.accel / G0_MPS2
        raw = self._trim_throttle + g.throttle_per_accel_g * demand + g.throttle_per_mps * error + memory.throttle
        out = max(0.0, min(1.0, raw))
        integral = memory.throttle + (g.throttle_integral_1ps * error * self._dt if out == raw else 0.0)
        return out, integral
