"""Closed inner loops on the linear model: the autopilot's laws written as state feedback, their step responses and margins.

Between a command and its surface stand up to three first-order lags: the hold of the sampled command, the plant's command filter
and the servo. Gains are those at the reference airspeed. What is judged:

- the integral of the squared error of a step (s): how late the loop is, overshoot included;
- the greatest sensitivity |1 / (1 + L)| with the loop broken at the surface: 1.5 means that the gain may grow at least
  threefold, that 39 deg of phase may be lost, and that no other error of the loop transfer below 2/3 upsets it.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from testbed.airframe.linearise import LinearModel, respond
from testbed.core.units import G0_MPS2
from testbed.flight.plants.aircraft import AutopilotGains

Array = np.ndarray
FREQUENCIES_RAD_S = np.geomspace(0.2, 120.0, 90)


@dataclass(frozen=True)
class ClosedLoop:
    """dx/dt = a x + b r for a reference r, output c x; and the loop transfer at each surface with the others closed."""

    a: Array
    b: Array
    c: Array
    disturbance: Array  # input matrix (m,) of a unit disturbance
    broken: tuple[tuple[Array, Array, Array], ...]  # for every surface: a with that loop open, its input, its feedback row

    @cached_property
    def stable(self) -> bool:
        """Every root decays."""
        return bool(np.linalg.eigvals(self.a).real.max() < 0.0)

    def step(self, seconds: float, dt_s: float, disturbed: bool = False) -> Array:
        """Output (n,) after a unit step of the reference, or of the disturbance."""
        time_s = dt_s * np.arange(round(seconds / dt_s) + 1)
        return respond(self.a, self.disturbance if disturbed else self.b, np.zeros(len(self.a)), time_s) @ self.c

    def sensitivity(self) -> float:
        """The greatest of |1 / (1 + L)| over frequency, at the worst of the surfaces."""
        return max(float(np.max(1.0 / np.abs(1.0 + self.transfer(k)))) for k in range(len(self.broken)))

    def transfer(self, surface: int) -> Array:
        """L(j w) at ``FREQUENCIES_RAD_S``, positive for negative feedback."""
        a, b, k = self.broken[surface]
        jw = 1j * FREQUENCIES_RAD_S[:, None, None] * np.eye(len(a))
        return np.asarray(-(k @ np.linalg.solve(jw - a, b[:, None])[..., 0].T))

    def margins(self, surface: int) -> tuple[float, float]:
        """Phase margin (rad) at the highest crossover, and gain margin (factor); inf where there is none."""
        loop = self.transfer(surface)
        size, phase = np.abs(loop), np.unwrap(np.angle(loop))
        phase -= 2.0 * math.pi * round(phase[0] / (2.0 * math.pi))
        down = np.flatnonzero((size[:-1] >= 1.0) & (size[1:] < 1.0))
        phase_margin = math.inf
        if len(down):
            k = down[-1]
            share = math.log(size[k]) / math.log(size[k] / size[k + 1])
            phase_margin = math.pi - abs((phase[k] + share * (phase[k + 1] - phase[k]) + math.pi) % (2 * math.pi) - math.pi)
        through = np.flatnonzero((phase[:-1] > -math.pi) & (phase[1:] <= -math.pi))
        if not len(through):
            return phase_margin, math.inf
        k = through[0]
        share = (phase[k] + math.pi) / (phase[k] - phase[k + 1])
        return phase_margin, float(size[k] ** (share - 1.0) / size[k + 1] ** share)


def _with_lags(a: Array, b: Array, lags_s: tuple[float, ...]) -> tuple[Array, Array]:
    """Append to every input of (a, b) the chain of first-order lags from command to surface; returns the grown matrices."""
    chain = [lag for lag in lags_s if lag > 0.0]
    for lag in chain:  # the first of the loop stands next to the surface
        n, m = b.shape
        grown = np.zeros((n + m, n + m))
        grown[:n, :n], grown[:n, n:] = a, b
        grown[n:, n:] = -np.eye(m) / lag
        a, b = grown, np.vstack([np.zeros((n, m)), np.eye(m) / lag])
    return a, b


def lateral(model: LinearModel, gains: AutopilotGains, lags_s: tuple[float, ...], output: str = "bank") -> ClosedLoop:
    """Bank command to bank, sideslip (rad) or rudder command: roll rate inside bank, and the rudder with its integral of sideslip.

    The disturbance is a rudder out of trim by what holds one radian of sideslip.
    """
    a, b = _with_lags(model.a_lat, model.b_lat, lags_s)
    size = len(a) + 1  # the integral of sideslip comes last
    a, b = np.pad(a, (0, 1)), np.pad(b, ((0, 1), (0, 0)))
    a[-1, 0] = 1.0 / model.speed_mps
    turn = G0_MPS2 / model.speed_mps * math.cos(model.pitch_rad)  # yaw rate of a turn per bank
    feedback = np.zeros((2, size))
    feedback[0, 1] = -gains.aileron_per_roll_rate_s
    feedback[0, 3] = per_bank = -gains.bank_1ps * (gains.aileron_per_roll_rate_s + gains.aileron_feed_forward_s)
    feedback[1, 0] = -gains.rudder_p / model.speed_mps
    feedback[1, 1] = gains.rudder_per_roll_rate_s - gains.rudder_per_yaw_rate_s * model.pitch_rad
    feedback[1, 2] = gains.rudder_per_yaw_rate_s
    feedback[1, 3] = (gains.rudder_per_turn_rate_s - gains.rudder_per_yaw_rate_s) * turn
    feedback[1, -1] = -gains.rudder_i_1ps
    feedback[1] += gains.rudder_per_aileron * feedback[0]
    outputs = {"bank": np.eye(size)[3], "sideslip": np.eye(size)[0] / model.speed_mps, "rudder": feedback[1]}
    upset = np.zeros(size)
    upset[:4] = model.b_lat[:, 1] / slip_per_rudder(model)
    broken = tuple((a + np.outer(b[:, 1 - k], feedback[1 - k]), b[:, k], feedback[k]) for k in (0, 1))
    reference = -(b[:, 0] + gains.rudder_per_aileron * b[:, 1]) * per_bank
    return ClosedLoop(a + b @ feedback, reference, outputs[output], upset, broken)


def slip_per_rudder(model: LinearModel) -> float:
    """Sideslip (rad) that a unit of rudder holds against the weathercock stability of the aircraft."""
    return float(abs(model.b_lat[2, 1] / (model.a_lat[2, 0] * model.speed_mps)))


def pitch(model: LinearModel, gains: AutopilotGains, lags_s: tuple[float, ...]) -> ClosedLoop:
    """Load-factor command to load factor, airspeed held (short period only). The disturbance is an elevator that makes 1 g."""
    c, d = model.c_load_factor[1:3], float(model.d_load_factor[0])
    turn = G0_MPS2 / model.speed_mps
    lagged_a, lagged_b = _with_lags(model.a_long[1:3, 1:3], model.b_long[1:3, :1], lags_s)
    size = len(lagged_a)  # then the integral, then the late command that it compares with
    measured = np.zeros(size + 2)
    measured[:2] = c
    if size > 2:
        measured[2] = d  # the surface itself
    a = np.zeros((size + 2, size + 2))
    a[:size, :size] = lagged_a
    a[size] = -measured
    a[size, size + 1] = 1.0
    a[size + 1, size + 1] = -1.0 / max(gains.load_factor_lag_s, 1e-3)
    b = np.append(lagged_b[:, 0], [0.0, 0.0])
    feedback = gains.elevator_p * measured
    feedback[1] += gains.elevator_per_pitch_rate_s
    feedback[size] = -gains.elevator_i_1ps
    reference = -(gains.elevator_per_load_factor + gains.elevator_p + gains.elevator_per_pitch_rate_s * turn) * b
    reference[size + 1] = -a[size + 1, size + 1]
    upset = np.zeros(size + 2)
    upset[:2] = model.b_long[1:3, 0] * elevator_per_load_factor(model)
    return ClosedLoop(a + np.outer(b, feedback), reference, measured, upset, ((a, b, feedback),))


def elevator_per_load_factor(model: LinearModel) -> float:
    """Elevator (command) for 1 g more in a steady pull at constant airspeed; negative, since + is nose down."""
    a, b = model.a_long[1:3, 1:3], model.b_long[1:3, 0]
    steady = -np.linalg.solve(a, b)
    return float(1.0 / (model.c_load_factor[1:3] @ steady + model.d_load_factor[0]))
