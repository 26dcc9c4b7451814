"""Inner loops: bank, load factor and speed commands to surfaces and throttle. Memory goes in and comes out.

Surface signs are JSBSim's: elevator + nose down, aileron + rolls right, rudder + nose left.
"""

import math
from dataclasses import make_dataclass
from typing import NamedTuple

from testbed.core.units import DEG, G0_MPS2
from testbed.flight.plants.aircraft import Aircraft, AutopilotGains
from testbed.flight.plants.base import Command, State, make


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
    load_factor: float | None = None  # the command, as late as the aircraft answers it


_Gains = make_dataclass("_Gains", AutopilotGains.model_fields, slots=True)  # the same names in slots: quicker to look up


class Autopilot:
    """Settings of one aircraft's loops; ``step`` is pure."""

    def __init__(self, aircraft: Aircraft, trim_throttle: float, dt_s: float) -> None:
        self._gains = _Gains(**aircraft.autopilot.model_dump())
        self._roll_limit = aircraft.limits.roll_rate_dps * DEG
        self._trim_throttle = trim_throttle
        self._dt = dt_s
        lag = aircraft.autopilot.load_factor_lag_s
        self._load_share = 1.0 - math.exp(-dt_s / lag) if lag > 0.0 else 1.0

    def step(self, memory: Memory, state: State, command: Command) -> tuple[Surfaces, Memory]:
        g = self._gains
        bank_cmd, load_factor_cmd, speed_cmd, sin_climb = command
        elevator_memory, throttle_memory, rudder_memory, late = memory
        bank, pitch, _, load_factor, airspeed, alpha, beta, p, q, r = state[6:16]

        speed_error = speed_cmd - airspeed
        throttle, throttle_memory = self._throttle(throttle_memory, speed_error, sin_climb)
        airspeed = airspeed if airspeed > 1.0 else 1.0
        ratio = g.reference_mps / airspeed
        scale = ratio * ratio

        most = self._roll_limit
        roll_cmd = g.bank_1ps * (bank_cmd - bank)
        roll_cmd = -most if roll_cmd < -most else most if roll_cmd > most else roll_cmd
        aileron = scale * g.aileron_per_roll_rate_s * (roll_cmd - p) + ratio * g.aileron_feed_forward_s * roll_cmd
        aileron_out = -1.0 if aileron < -1.0 else 1.0 if aileron > 1.0 else aileron

        cos_pitch = math.cos(pitch)
        late = load_factor if late is None else late
        late += self._load_share * (load_factor_cmd - late)
        turn = G0_MPS2 / airspeed
        pitch_rate_cmd = turn * (load_factor_cmd - math.cos(bank) * cos_pitch)
        elevator = -scale * (
            g.elevator_per_load_factor * (load_factor_cmd - 1.0)
            + g.elevator_p * (load_factor_cmd - load_factor)
            + elevator_memory
            + g.elevator_per_pitch_rate_s * (pitch_rate_cmd - q)
        )
        elevator_out = -1.0 if elevator < -1.0 else 1.0 if elevator > 1.0 else elevator

        # what keeps the nose in the wind: the turn of the velocity, and rolling about it rather than about the body's axis
        turn_rate = turn * math.sin(bank) * cos_pitch
        slip = g.rudder_per_yaw_rate_s * (r - turn_rate - alpha * p) - g.rudder_p * beta - rudder_memory
        rudder = (
            scale * slip
            + ratio * (g.rudder_per_turn_rate_s * turn_rate + g.rudder_per_roll_rate_s * p)
            + g.rudder_per_aileron * aileron_out
        )
        rudder_out = -1.0 if rudder < -1.0 else 1.0 if rudder > 1.0 else rudder

        free = elevator_out == elevator  # no wind-up against a stop; nor in a rise, whose lag is no error
        if free:
            elevator_memory += g.elevator_i_1ps * (late - load_factor) * self._dt
        if rudder_out == rudder:
            rudder_memory += g.rudder_i_1ps * beta * self._dt
        stopped = not (free and aileron_out == aileron and rudder_out == rudder)
        surfaces = make(Surfaces, (elevator_out, aileron_out, rudder_out, throttle, stopped))
        return surfaces, make(Memory, (elevator_memory, throttle_memory, rudder_memory, late))

    def _throttle(self, memory: float, error: float, sin_climb: float) -> tuple[float, float]:
        """Feed-forward of the climb, plus PI on the error of the airspeed (m/s); and the integral."""
        g = self._gains
        raw = self._trim_throttle + g.throttle_per_accel_g * sin_climb + g.throttle_per_mps * error + memory
        out = 0.0 if raw < 0.0 else 1.0 if raw > 1.0 else raw
        return out, memory + (g.throttle_integral_1ps * error * self._dt if out == raw else 0.0)
