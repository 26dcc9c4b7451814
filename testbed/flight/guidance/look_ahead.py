"""Path following: a second-order law on the error from the path, fed forward with the curvature ahead.

    a = -w^2 e - 2 z w de/dt - integral + v^2 kappa(s + v T)

e is the 3-D offset from the nearest point of the path and v the ground velocity, so wind becomes crab without any estimate of
it. All of it is taken along the left and up normals of the ground velocity, where lift can act. The look-ahead T makes up for
the lag from command to bank (sideways) and to load factor (up). Memory goes in and comes out; the telemetry row is returned with
the command.
"""

import math

from testbed.core.units import G0_MPS2
from testbed.flight.guidance.bank_to_turn import BankToTurn
from testbed.flight.guidance.law import STANDSTILL_MPS, VERTICAL, GuidanceSetting, Memory, SpeedHold, Telemetry
from testbed.flight.plants.aircraft import Aircraft
from testbed.flight.plants.base import Command, State, make
from testbed.flight.route.path import Path

INTEGRAL_LIMIT_MPS2 = 3.0
STEEPEST_RETURN = 0.5  # sine of the angle at which a far-off path is approached: beyond it the error no longer adds to the demand


class LookAheadLaw:
    """The law above, with one aircraft's gains and limits."""

    def __init__(self, aircraft: Aircraft, hold: SpeedHold, dt_s: float) -> None:
        gains = aircraft.guidance
        self._stiffness = gains.bandwidth_rad_s**2
        self._damping = 2.0 * gains.damping * gains.bandwidth_rad_s
        self._integral = gains.integral_1ps * self._stiffness
        self._bank_ahead_s, self._lift_ahead_s = gains.bank_lead_s, gains.load_factor_lead_s
        self._power_ahead_s = aircraft.autopilot.throttle_lag_s
        self._turn = BankToTurn(aircraft.limits)
        self._hold, self._dt = hold, dt_s

    def start(self, s_m: float) -> Memory:
        return Memory(s_m, s_m)

    def step(self, memory: Memory, state: State, path: Path) -> tuple[Command, Memory, Telemetry]:
        x, y, z, vx, vy, vz, bank_now, _, _, _, airspeed_now = state[:11]
        s, scheduled_s, i_left, i_up = memory
        flat2 = vx * vx + vy * vy
        speed2 = flat2 + vz * vz
        flat, speed = math.sqrt(flat2), math.sqrt(speed2) or STANDSTILL_MPS

        # nearest point: from the last one, one step along the velocity, then one correction
        d, (px, py, pz, tx, ty, tz, kx, ky, kz) = path.look_up(s)
        h = 0.5 * d
        ex, ey, ez = x - px - (tx + kx * h) * d, y - py - (ty + ky * h) * d, z - pz - (tz + kz * h) * d
        tx, ty, tz = tx + kx * d, ty + ky * d, tz + kz * d
        s += ex * tx + ey * ty + ez * tz
        v_along = vx * tx + vy * ty + vz * tz
        v_on = v_along if v_along > 0.0 else 0.0
        ahead, lift_ahead, power_ahead = path.rows_at(
            s + v_on * self._bank_ahead_s, s + v_on * self._lift_ahead_s, s + v_on * self._power_ahead_s
        )

        # components along the left (lx, ly, 0) and up (ux, uy, uz) normals of the ground velocity, which has none itself
        lx, ly = (-vy / flat, vx / flat) if flat > VERTICAL * speed else (0.0, 1.0)  # straight up, every side is as good
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


def make_law(setting: GuidanceSetting) -> LookAheadLaw:
    """The law for one flight."""
    return LookAheadLaw(setting.aircraft, setting.hold, setting.dt_s)
