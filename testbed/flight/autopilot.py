"""Inner loops: bank, load factor and speed commands to surfaces and throttle. Memory goes in and comes out.

Surface signs are JSBSim's: elevator + nose down, aileron + rolls right, rudder + nose left.
"""

import math
from types import SimpleNamespace
from typing import NamedTuple

from testbed.flight.aircraft import Aircraft
from testbed.flight.plants.base import Command, State, make
from testbed.units import DEG, G0_MPS2


class Surfaces(NamedTuple):
    """Commands beside the pitch trim: elevator, aileron and rudder -1..1, throttle 0..1; and whether a surface is at its stop."""

    elevator: float
    aileron: float
    rudder: float
    throttle: float
    saturated: bool


class Memory(NamedTuple):
    """Integrators, and the reference of the load factor."""

    elevator: float = 0.0
    throttle: float = 0.0
    rudder: float = 0.0
    load_factor: float = math.nan  # the command, as late as the aircraft answers it


class Autopilot:
    """Settings of one aircraft's loops; ``step`` is pure."""

    def __init__(self, aircraft: Aircraft, trim_throttle: float, dt_s: float) -> None:
        self._gains = SimpleNamespace(**aircraft.autopilot.model_dump())  # looked up faster than in the model
        self._roll_limit = aircraft.limits.roll_rate_dps * DEG
        self._trim_throttle = trim_throttle
        self._dt = dt_s
        lag = aircraft.autopilot.load_factor_lag_s
        self._load_share = 1.0 - math.exp(-dt_s / lag) if lag > 0.0 else 1.0

    def step(self, memory: Memory, state: State, command: Command) -> tuple[Surfaces, Memory]:
        g = self._gains
        _, _, _, _, _, _, bank, pitch, _, load_factor, airspeed, alpha, beta, p, q, r, *_ = state
        airspeed = airspeed if airspeed > 1.0 else 1.0
        ratio = g.reference_mps / airspeed
        scale = ratio * ratio

        most = self._roll_limit
        roll_cmd = g.bank_1ps * (command.bank - bank)
        roll_cmd = -most if roll_cmd < -most else most if roll_cmd > most else roll_cmd
        aileron = scale * g.aileron_per_roll_rate_s * (roll_cmd - p) + ratio * g.aileron_feed_forward_s * roll_cmd
        aileron_out = -1.0 if aileron < -1.0 else 1.0 if aileron > 1.0 else aileron

        cos_pitch = math.cos(pitch)
        error = command.load_factor - load_factor
        late = memory.load_factor if memory.load_factor == memory.load_factor else load_factor
        late += self._load_share * (command.load_factor - late)
        turn = G0_MPS2 / airspeed
        pitch_rate_cmd = turn * (command.load_factor - math.cos(bank) * cos_pitch)
        elevator = -scale * (
            g.elevator_per_load_factor * (command.load_factor - 1.0)
            + g.elevator_p * error
            + memory.elevator
            + g.elevator_per_pitch_rate_s * (pitch_rate_cmd - q)
        )
        elevator_out = -1.0 if elevator < -1.0 else 1.0 if elevator > 1.0 else elevator

        # what keeps the nose in the wind: the turn of the velocity, and rolling about it rather than about the body's axis
        turn_rate = turn * math.sin(bank) * cos_pitch
        slip = g.rudder_per_yaw_rate_s * (r - turn_rate - alpha * p) - g.rudder_p * beta - memory.rudder
        rudder = (
            scale * slip
            + ratio * (g.rudder_per_turn_rate_s * turn_rate + g.rudder_per_roll_rate_s * p)
            + g.rudder_per_aileron * aileron_out
        )
        rudder_out = -1.0 if rudder < -1.0 else 1.0 if rudder > 1.0 else rudder

        throttle, throttle_memory = self._throttle(memory, state, command)
        still = aileron_out == aileron and elevator_out == elevator and rudder_out == rudder
        grow = elevator_out == elevator  # no wind-up against a stop; nor in a rise, whose lag is no error
        integral = memory.elevator + (g.elevator_i_1ps * (late - load_factor) * self._dt if grow else 0.0)
        yaw_integral = memory.rudder + (g.rudder_i_1ps * beta * self._dt if rudder_out == rudder else 0.0)
        surfaces = make(Surfaces, (elevator_out, aileron_out, rudder_out, throttle, not still))
        return surfaces, make(Memory, (integral, throttle_memory, yaw_integral, late))

    def _throttle(self, memory: Memory, state: State, command: Command) -> tuple[float, float]:
        """Feed-forward of the climb, plus PI on airspeed."""
        g = self._gains
        error = command.speed - state.airspeed
        raw = self._trim_throttle + g.throttle_per_accel_g * command.sin_climb + g.throttle_per_mps * error + memory.throttle
        out = 0.0 if raw < 0.0 else 1.0 if raw > 1.0 else raw
        integral = memory.throttle + (g.throttle_integral_1ps * error * self._dt if out == raw else 0.0)
        return out, integral
