"""Path following: a second-order law on the error from the path, fed forward with the curvature ahead.

    a = -w^2 e - 2 z w de/dt - integral + v^2 kappa(s + v T)

e is the 3-D offset from the nearest point of the path and v the ground velocity, so wind becomes crab without any estimate of
it. All of it is taken along the left and up normals of the ground velocity, where lift can act. The look-ahead T makes up for
the lag from command to bank (sideways) and to load factor (up). Memory goes in and comes out; the telemetry row is returned with
the command.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from testbed.core.units import DEG, G0_MPS2
from testbed.flight.aircraft import Aircraft, Limits
from testbed.flight.path import ActivePath
from testbed.flight.plants.base import Command, State, make

LEAST_LIFT_MPS2 = 2.0  # below this the bank command would be singular (push-over through zero g)
UNLOAD = 8.0  # load factor given up per share of speed lost near the least speed
INTEGRAL_LIMIT_MPS2 = 3.0
CATCH_UP_1PS = 0.5  # airspeed added per metre behind the schedule ...
CATCH_UP_SHARE = 0.06  # ... up to this share of the set speed
STEEPEST_RETURN = 0.5  # sine of the angle at which a far-off path is approached: beyond it the error no longer adds to the demand


BANK_LIMITED, LIFT_LIMITED = 1.0, 2.0


class Memory(NamedTuple):
    """Arc length of the last projection, where the schedule has the aircraft, and the integral of the error, left and up (m/s^2)."""

    s_m: float
    scheduled_s_m: float
    left: float = 0.0
    up: float = 0.0


class Telemetry(NamedTuple):
    """One row of the guidance log."""

    s_m: float
    bank_cmd: float
    load_factor_cmd: float
    limited: float  # which limits of the aircraft cut the command: BANK_LIMITED + LIFT_LIMITED, 0 for none


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
        self._per_slowest = UNLOAD / limits.speed_min_mps

    def solve(self, left: float, soon: float, up: float, bank_now: float, airspeed: float) -> tuple[float, float, float]:
        """Bank (rad), load factor, and which limits cut them; demands in m/s^2, gravity made up for in ``up``.

        ``left`` is what the bank will have to serve when it answers; ``soon``, to the left too, what the load factor will.
        """
        most = self._bank
        raw_bank = math.atan2(-left, up if up > LEAST_LIFT_MPS2 else LEAST_LIFT_MPS2)
        bank = -most if raw_bank < -most else most if raw_bank > most else raw_bank
        # the lift that serves the demand at the bank the aircraft has, not at the one it was told
        raw_n = (up * math.cos(bank_now) - soon * math.sin(bank_now)) / G0_MPS2
        n_max = self.most_load_factor(airspeed)
        load_factor = self._n_min if raw_n < self._n_min else n_max if raw_n > n_max else raw_n
        return bank, load_factor, (BANK_LIMITED if bank != raw_bank else 0.0) + (LIFT_LIMITED if load_factor != raw_n else 0.0)

    def most_load_factor(self, airspeed: float) -> float:
        """What may be asked for at an airspeed (m/s): the structural limit, or less where there is less lift."""
        available = self._n_per_speed2 * airspeed * airspeed
        n_max = available if available < self._n_max else self._n_max
        # speed before height: what flies as slowly as it may does not climb, and slower than that it unloads
        unloaded = 1.0 - UNLOAD + self._per_slowest * airspeed
        return unloaded if unloaded < n_max else n_max


@dataclass(frozen=True, slots=True)
class SpeedHold:
    """Which speed is held, and whether time lost along the path is made up for."""

    speed_mps: float
    airspeed: bool  # true: the airspeed is held; false: the speed over the ground
    keep_schedule: bool

    def solve(self, airspeed_now: float, ground_speed: float, behind_m: float) -> tuple[float, float]:
        """The airspeed to fly, and the speed along the path that the schedule moves on with, m/s.

        In wind the schedule of an airspeed hold moves with the ground speed that the set airspeed would give just now.
        """
        drift = ground_speed - airspeed_now
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
        x, y, z, vx, vy, vz, bank_now, _, _, _, airspeed_now = state[:11]
        s, scheduled_s, i_left, i_up = memory
        flat2 = vx * vx + vy * vy
        speed2 = flat2 + vz * vz
        flat, speed = math.sqrt(flat2), math.sqrt(speed2)

        # nearest point: from the last one, one step along the velocity, then one correction
        d, (px, py, pz, tx, ty, tz, kx, ky, kz) = path.look_up(s)
        h = 0.5 * d
        ex, ey, ez = x - px - (tx + kx * h) * d, y - py - (ty + ky * h) * d, z - pz - (tz + kz * h) * d
        tx, ty, tz = tx + kx * d, ty + ky * d, tz + kz * d
        s += ex * tx + ey * ty + ez * tz
        v_along = vx * tx + vy * ty + vz * tz
        v_on = v_along if v_along > 0.0 else 0.0
        ahead, lift_ahead, power_ahead = path.rows_at(s + v_on * self._bank_lead, s + v_on * self._lift_lead, s + v_on * self._power_lead)

        # components along the left (lx, ly, 0) and up (ux, uy, uz) normals of the ground velocity, which has none itself
        lx, ly = -vy / flat, vx / flat
        sin_climb, uz = vz / speed, flat / speed
        ux, uy = -sin_climb * ly, sin_climb * lx
        e_left, e_up = ex * lx + ey * ly, ex * ux + ey * uy + ez * uz
        c, k = self._damping, self._stiffness
        far2, most = e_left * e_left + e_up * e_up, c * STEEPEST_RETURN * speed
        if k * k * far2 > most * most:
            k = most / math.sqrt(far2)
        damp, v2 = c * v_along, v_along * v_along
        left = damp * (tx * lx + ty * ly) - k * e_left - i_left
        soon = left + v2 * (lift_ahead[6] * lx + lift_ahead[7] * ly)
        left += v2 * (ahead[6] * lx + ahead[7] * ly)
        up = damp * (tx * ux + ty * uy + tz * uz) - k * e_up - i_up + G0_MPS2 * uz
        up += v2 * (lift_ahead[6] * ux + lift_ahead[7] * uy + lift_ahead[8] * uz)
        bank, load_factor, limited = self._turn.solve(left, soon, up, bank_now, airspeed_now)

        if not limited:
            gain, bound = self._integral * self._dt, INTEGRAL_LIMIT_MPS2
            i_left, i_up = i_left + gain * e_left, i_up + gain * e_up
            i_left = -bound if i_left < -bound else bound if i_left > bound else i_left
            i_up = -bound if i_up < -bound else bound if i_up > bound else i_up
        airspeed, scheduled = self._hold.solve(airspeed_now, speed, scheduled_s - s)
        memory = make(Memory, (s + v_along * self._dt, scheduled_s + scheduled * self._dt, i_left, i_up))
        command = make(Command, (bank, load_factor, airspeed, power_ahead[5]))
        return command, memory, make(Telemetry, (s, bank, load_factor, limited))
