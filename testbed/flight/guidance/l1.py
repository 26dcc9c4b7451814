"""The L1 law, for comparison: Park, Deyst and How, "A New Nonlinear Guidance Logic for Trajectory Tracking", AIAA 2004-4900.

    a = 2 V^2 / L1 sin(eta), towards a reference point on the path at the distance L1 ahead

written as a vector, a = 2 V^2 / L1^2 (d - (d.v) v) with d the vector to the reference point and v the unit ground velocity: the
law in the plane of both, which in level flight is the published one. Near a straight path it is a second-order system of
frequency sqrt(2) V / L1 and damping 0.71, so L1 follows from the aircraft's own guidance bandwidth. It anticipates a curve by
aiming ahead, and knows neither the curvature nor the lag of the aircraft.
"""

import math

from testbed.core.units import G0_MPS2
from testbed.flight.guidance.bank_to_turn import BankToTurn
from testbed.flight.guidance.law import STANDSTILL_MPS, VERTICAL, GuidanceSetting, Memory, SpeedHold, Telemetry
from testbed.flight.plants.aircraft import Aircraft
from testbed.flight.plants.base import Command, State
from testbed.flight.route.path import Path


class L1Law:
    """The law above, with one aircraft's bandwidth and limits."""

    def __init__(self, aircraft: Aircraft, hold: SpeedHold, dt_s: float) -> None:
        self._seconds = math.sqrt(2.0) / aircraft.guidance.bandwidth_rad_s  # L1 / V
        self._power_ahead_s = aircraft.autopilot.throttle_lag_s
        self._turn = BankToTurn(aircraft.limits)
        self._hold, self._dt = hold, dt_s

    def start(self, s_m: float) -> Memory:
        return Memory(s_m, s_m)

    def step(self, memory: Memory, state: State, path: Path) -> tuple[Command, Memory, Telemetry]:
        x, y, z, vx, vy, vz = state[:6]
        flat = math.hypot(vx, vy)
        speed = math.hypot(flat, vz) or STANDSTILL_MPS
        s, off = _nearest(memory.s_m, state, path)
        length = speed * self._seconds
        # the reference point is where the sphere of radius L1 meets the path: ahead of the nearest point by Pythagoras
        ahead = math.sqrt(max(length * length - off * off, 0.04 * length * length))
        d, (px, py, pz, tx, ty, tz, _, _, _) = path.look_up(s + ahead)
        dx, dy, dz = px + tx * d - x, py + ty * d - y, pz + tz * d - z
        along = (dx * vx + dy * vy + dz * vz) / speed
        gain = 2.0 * speed * speed / max(dx * dx + dy * dy + dz * dz, STANDSTILL_MPS**2)
        ax, ay, az = (gain * (c - along * v / speed) for c, v in ((dx, vx), (dy, vy), (dz, vz)))
        hx, hy = (vx / flat, vy / flat) if flat > VERTICAL * speed else (1.0, 0.0)  # straight up, every heading is as good
        left = ay * hx - ax * hy
        up = (az * flat - vz * (ax * hx + ay * hy)) / speed + G0_MPS2 * flat / speed
        bank, load_factor, limited = self._turn.solve(left, left, up, state.bank, state.airspeed)
        _, power_ahead = path.look_up(s + speed * self._power_ahead_s)
        airspeed, scheduled = self._hold.solve(state.airspeed, speed, memory.scheduled_s_m - s)
        command = Command(bank, load_factor, airspeed, power_ahead[5])
        memory = Memory(s + speed * self._dt, memory.scheduled_s_m + scheduled * self._dt)
        return command, memory, Telemetry(s, bank, load_factor, limited)


def make_law(setting: GuidanceSetting) -> L1Law:
    """The law for one flight."""
    return L1Law(setting.aircraft, setting.hold, setting.dt_s)


def _nearest(s_m: float, state: State, path: Path) -> tuple[float, float]:
    """Arc length of the nearest point, from a guess beside it, and the distance."""
    d, (px, py, pz, tx, ty, tz, _, _, _) = path.look_up(s_m)
    ex, ey, ez = state.x - px - tx * d, state.y - py - ty * d, state.z - pz - tz * d
    along = ex * tx + ey * ty + ez * tz
    return s_m + along, math.hypot(ex - along * tx, ey - along * ty, ez - along * tz)
