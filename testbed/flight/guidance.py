"""Path following: a second-order law on the error from the path, fed forward with the curvature ahead.

    a = -w^2 e - 2 z w de/dt - integral + v^2 kappa(s + v T)

e is the 3-D offset from the nearest point of the path and v the ground velocity, so wind becomes crab without any estimate of
it. The look-ahead T makes up for the lag from command to bank (sideways) and to load factor (up). The acceleration is turned
into bank and load factor in the left and up normals of the ground velocity. Memory goes in and comes out; the telemetry row
is returned with the command.
"""

import math
from typing import NamedTuple, Protocol

from testbed.flight.aircraft import Aircraft
from testbed.flight.path import ActivePath
from testbed.flight.plants.base import Command, State
from testbed.units import DEG, G0_MPS2

LEAST_LIFT_MPS2 = 2.0  # below this the bank command would be singular (push-over through zero g)
INTEGRAL_LIMIT_MPS2 = 3.0
STEEPEST_RETURN = 0.5  # sine of the angle at which a far-off path is approached: beyond it the error no longer adds to the demand


class Memory(NamedTuple):
    """Arc length of the last projection, and the integral of the error (ENU, m/s^2)."""

    s_m: float = 0.0
    ix: float = 0.0
    iy: float = 0.0
    iz: float = 0.0


class Telemetry(NamedTuple):
    """One row of the guidance log."""

    s_m: float
    bank_cmd: float
    load_factor_cmd: float
    saturated: float  # 1 when a limit of the aircraft cut the command


class Law(Protocol):
    """A guidance law."""

    def start(self, s_m: float) -> Memory:
        """Fresh memory for a path on which the aircraft stands at ``s_m``."""

    def step(self, memory: Memory, state: State, path: ActivePath) -> tuple[Command, Memory, Telemetry]: ...


class LookAheadLaw:
    """The law above, with one aircraft's gains and limits."""

    def __init__(self, aircraft: Aircraft, speed_mps: float, hold_airspeed: bool, dt_s: float) -> None:
        gains, limits = aircraft.guidance, aircraft.limits
        self._stiffness = gains.bandwidth_rad_s**2
        self._damping = 2.0 * gains.damping * gains.bandwidth_rad_s
        self._integral = gains.integral_1ps * self._stiffness
        self._bank_lead, self._lift_lead = gains.bank_lead_s, gains.load_factor_lead_s
        self._power_lead = aircraft.autopilot.throttle_lag_s
        self._bank_limit = limits.bank_deg * DEG
        self._n_min, self._n_max = limits.load_factor_min, limits.load_factor_max
        self._n_per_speed2 = 1.0 / limits.alpha_max_1g_mps**2
        self._speed, self._hold_airspeed, self._dt = speed_mps, hold_airspeed, dt_s

    def start(self, s_m: float) -> Memory:
        return Memory(s_m)

    def step(self, memory: Memory, state: State, path: ActivePath) -> tuple[Command, Memory, Telemetry]:
        x, y, z, vx, vy, vz = state[:6]
        flat2 = vx * vx + vy * vy
        speed2 = flat2 + vz * vz
        flat, speed = math.sqrt(flat2), math.sqrt(speed2)

        # nearest point: from the last one, one step along the velocity, then one correction
        s = memory.s_m
        d, (px, py, pz, tx, ty, tz, kx, ky, kz) = path.look_up(s)
        h = 0.5 * d
        ex, ey, ez = x - px - (tx + kx * h) * d, y - py - (ty + ky * h) * d, z - pz - (tz + kz * h) * d
        tx, ty, tz = tx + kx * d, ty + ky * d, tz + kz * d
        along = ex * tx + ey * ty + ez * tz
        s += along
        ex, ey, ez = ex - along * tx, ey - along * ty, ez - along * tz
        v_along = vx * tx + vy * ty + vz * tz
        rx, ry, rz = vx - v_along * tx, vy - v_along * ty, vz - v_along * tz

        _, ahead = path.look_up(s + v_along * self._bank_lead)
        _, lift_ahead = path.look_up(s + v_along * self._lift_lead)
        _, power_ahead = path.look_up(s + v_along * self._power_lead)
        v2 = v_along * v_along
        c = self._damping
        k = self._stiffness
        if (far := k * math.sqrt(ex * ex + ey * ey + ez * ez)) > (most := c * STEEPEST_RETURN * speed):
            k *= most / far
        bx = -k * ex - c * rx - memory.ix
        by = -k * ey - c * ry - memory.iy
        bz = -k * ez - c * rz - memory.iz

        # left and up normals of the ground velocity
        left = ((bx + v2 * ahead[6]) * -vy + (by + v2 * ahead[7]) * vx) / flat
        ax, ay, az = bx + v2 * lift_ahead[6], by + v2 * lift_ahead[7], bz + v2 * lift_ahead[8]
        up = (az * flat - vz * (ax * vx + ay * vy) / flat) / speed + G0_MPS2 * flat / speed
        raw_bank = math.atan2(-left, up if up > LEAST_LIFT_MPS2 else LEAST_LIFT_MPS2)
        bank = max(-self._bank_limit, min(self._bank_limit, raw_bank))
        # the lift that serves the demand at the bank the aircraft has, not at the one it was told
        raw_n = (up * math.cos(state.bank) - left * math.sin(state.bank)) / G0_MPS2
        n_max = min(self._n_max, self._n_per_speed2 * state.airspeed * state.airspeed)
        load_factor = max(self._n_min, min(n_max, raw_n))
        limited = bank != raw_bank or load_factor != raw_n

        gain = 0.0 if limited else self._integral * self._dt
        bound = INTEGRAL_LIMIT_MPS2
        memory = Memory(
            s + v_along * self._dt,
            max(-bound, min(bound, memory.ix + gain * ex)),
            max(-bound, min(bound, memory.iy + gain * ey)),
            max(-bound, min(bound, memory.iz + gain * ez)),
        )
        airspeed_cmd = self._speed if self._hold_airspeed else self._speed + state.airspeed - speed
        command = Command(bank, load_factor, airspeed_cmd, power_ahead[5], 0.0)
        return command, memory, Telemetry(s, bank, load_factor, 1.0 if limited else 0.0)
