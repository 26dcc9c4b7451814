"""Path following: a second-order law on the error from the path, fed forward with the curvature ahead.

    a = -w^2 e - 2 z w de/dt - integral + v^2 kappa(s + v T)

e is the 3-D offset from the nearest point of the path and v the ground velocity, so wind becomes crab without any estimate of
it. The look-ahead T makes up for the lag from command to bank (sideways) and to load factor (up). The acceleration is turned
into bank and load factor in the left and up normals of the ground velocity. Memory goes in and comes out; the telemetry row
is returned with the command.
"""

import math
from typing import NamedTuple, Protocol

from testbed.flight.aircraft import Aircraft, Limits
from testbed.flight.path import ActivePath
from testbed.flight.plants.base import Command, State, make
from testbed.units import DEG, G0_MPS2

LEAST_LIFT_MPS2 = 2.0  # below this the bank command would be singular (push-over through zero g)
INTEGRAL_LIMIT_MPS2 = 3.0
CATCH_UP_1PS = 0.5  # airspeed added per metre behind the schedule ...
CATCH_UP_SHARE = 0.06  # ... up to this share of the set speed
STEEPEST_RETURN = 0.5  # sine of the angle at which a far-off path is approached: beyond it the error no longer adds to the demand


class Memory(NamedTuple):
    """Arc length of the last projection, where the schedule has the aircraft, and the integral of the error (ENU, m/s^2)."""

    s_m: float
    scheduled_s_m: float
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


class BankToTurn:
    """From a lift demand to bank and load factor, within an aircraft's limits."""

    def __init__(self, limits: Limits) -> None:
        self._bank = limits.bank_deg * DEG
        self._n_min, self._n_max = limits.load_factor_min, limits.load_factor_max
        self._n_per_speed2 = 1.0 / limits.alpha_max_1g_mps**2

    def solve(self, left: float, up: float, state: State) -> tuple[float, float, bool]:
        """Bank (rad), load factor, and whether a limit cut them; ``left`` and ``up`` in m/s^2, gravity made up for in ``up``."""
        most = self._bank
        raw_bank = math.atan2(-left, up if up > LEAST_LIFT_MPS2 else LEAST_LIFT_MPS2)
        bank = -most if raw_bank < -most else most if raw_bank > most else raw_bank
        # the lift that serves the demand at the bank the aircraft has, not at the one it was told
        raw_n = (up * math.cos(state.bank) - left * math.sin(state.bank)) / G0_MPS2
        available = self._n_per_speed2 * state.airspeed * state.airspeed
        n_max = available if available < self._n_max else self._n_max
        load_factor = self._n_min if raw_n < self._n_min else n_max if raw_n > n_max else raw_n
        return bank, load_factor, bank != raw_bank or load_factor != raw_n


class SpeedHold(NamedTuple):
    """Which speed is held, and whether time lost along the path is made up for."""

    speed_mps: float
    airspeed: bool  # true: the airspeed is held; false: the speed over the ground
    keep_schedule: bool

    def solve(self, state: State, ground_speed: float, behind_m: float) -> tuple[float, float]:
        """The airspeed to fly, and the speed along the path that the schedule moves on with, m/s.

        In wind the schedule of an airspeed hold moves with the ground speed that the set airspeed would give just now.
        """
        drift = ground_speed - state.airspeed
        airspeed, scheduled = (self.speed_mps, self.speed_mps + drift) if self.airspeed else (self.speed_mps - drift, self.speed_mps)
        if self.keep_schedule:
            most = CATCH_UP_SHARE * self.speed_mps
            airspeed += max(-most, min(most, CATCH_UP_1PS * behind_m))
        return airspeed, scheduled


class LookAheadLaw:
    """The law above, with one aircraft's gains and limits."""

    def __init__(self, aircraft: Aircraft, hold: SpeedHold, dt_s: float) -> None:
        gains = aircraft.guidance
        self._stiffness = gains.bandwidth_rad_s**2
        self._damping = 2.0 * gains.damping * gains.bandwidth_rad_s
        self._integral = gains.integral_1ps * self._stiffness
        self._bank_lead, self._lift_lead = gains.bank_lead_s, gains.load_factor_lead_s
        self._power_lead = aircraft.autopilot.throttle_lag_s
        self._turn = BankToTurn(aircraft.limits)
        self._hold, self._dt = hold, dt_s

    def start(self, s_m: float) -> Memory:
        return Memory(s_m, s_m)

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

        v_on = v_along if v_along > 0.0 else 0.0
        ahead, lift_ahead, power_ahead = path.rows_at(s + v_on * self._bank_lead, s + v_on * self._lift_lead, s + v_on * self._power_lead)
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
        bank, load_factor, limited = self._turn.solve(left, up, state)

        gain = 0.0 if limited else self._integral * self._dt
        bound = INTEGRAL_LIMIT_MPS2
        airspeed, scheduled = self._hold.solve(state, speed, memory.scheduled_s_m - s)
        ix, iy, iz = memory.ix + gain * ex, memory.iy + gain * ey, memory.iz + gain * ez
        ix = -bound if ix < -bound else bound if ix > bound else ix
        iy = -bound if iy < -bound else bound if iy > bound else iy
        iz = -bound if iz < -bound else bound if iz > bound else iz
        memory = make(Memory, (s + v_along * self._dt, memory.scheduled_s_m + scheduled * self._dt, ix, iy, iz))
        command = make(Command, (bank, load_factor, airspeed, power_ahead[5], 0.0))
        return command, memory, make(Telemetry, (s, bank, load_factor, 1.0 if limited else 0.0))
