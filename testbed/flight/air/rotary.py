"""Rotary gusts after MIL-F-8785C: how the frozen turbulence turns about a wing, which feels the less of it the larger it is.

The specification (3.7.1.2) gives one-sided spectra over the spatial frequency W for a wing of span b,

    roll   Phi_p = sigma_w^2/L_w 0.8 (pi L_w / 4b)^(1/3) / (1 + (4bW/pi)^2)
    pitch  Phi_q = W^2 / (1 + (4bW/pi)^2) Phi_w
    yaw    Phi_r = W^2 / (1 + (3bW/pi)^2) Phi_v

Roll has a noise of its own; its first-order filter is solved exactly over a step and starts in its stationary state. Pitch and yaw are
the slopes of the frozen velocities, smoothed by 1/(1 + tau s), tau = 4b/(pi V) and 3b/(pi V): the velocities are linear between their
samples, so a slope is constant over a step, and the filter is solved exactly too. It starts from rest: before the series there is none.

Signs are those of a rigid rotation, velocity = Omega x r, with the air frozen, so that d/dx = (1/V) d/dt. In axes along, left and up
a gust (u, v, w) turns the air by (roll, -dw/dx, dv/dx); in body axes (x forward, y right, z down) that is p = dw/dy, q = -dw/dx,
r = dv/dx with v to the right and w down. What an aircraft feels is its own rates less these.
"""

import math
from typing import NamedTuple

import numpy as np

from testbed.flight.air.dryden import SERIES_HZ, Dryden, spectrum

Array = np.ndarray


class Smoothing(NamedTuple):
    """Time constants (s) of the rotary gusts on a wing: that of roll and pitch, and that of yaw."""

    pitch_s: float
    yaw_s: float


def smoothing(span_m: float, speed_mps: float) -> Smoothing:
    """Of a wing of that span at that airspeed."""
    width_s = span_m / (math.pi * speed_mps)
    return Smoothing(4.0 * width_s, 3.0 * width_s)


def sigma_roll(model: Dryden, span_m: float) -> float:
    """Standard deviation of the roll rate of the air, rad/s: the integral of Phi_p over W."""
    k = math.pi * model.scale_w / (4.0 * span_m)
    return model.sigma_w / model.scale_w * math.sqrt(0.4 * math.pi * k ** (4.0 / 3.0))


def rotary_series(velocities: Array, noise: Array, model: Dryden, speed_mps: float, span_m: float) -> Array:
    """Angular velocity (n,3) of the air about along, left and up, rad/s, of velocities (n,3) in these axes and unit noise (n,)."""
    from scipy.signal import lfilter

    slow = smoothing(span_m, speed_mps)
    step = 1.0 / (SERIES_HZ * slow.pitch_s)
    drive = noise * math.sqrt(-math.expm1(-2.0 * step))
    drive[:1] = noise[:1]
    slope = np.diff(velocities, axis=0, prepend=velocities[:1]) * (SERIES_HZ / speed_mps)

    def smoothed(slope: Array, tau_s: float) -> Array:
        decay = math.exp(-1.0 / (SERIES_HZ * tau_s))
        return np.asarray(lfilter([1.0 - decay], [1.0, -decay], slope))

    roll = sigma_roll(model, span_m) * lfilter([1.0], [1.0, -math.exp(-step)], drive)
    return np.column_stack([roll, -smoothed(slope[:, 2], slow.pitch_s), smoothed(slope[:, 1], slow.yaw_s)])


def rotary_spectra(frequency_hz: Array, model: Dryden, speed_mps: float, span_m: float) -> Array:
    """One-sided power (3,n) per Hz of the roll, pitch and yaw rates of the air, rad^2/s^2/Hz (3.7.1.2, with W = 2 pi f / V)."""
    f = np.asarray(frequency_hz)
    slow = smoothing(span_m, speed_mps)
    square = (2.0 * math.pi * f / speed_mps) ** 2
    pitch, yaw = (1.0 / (1.0 + (2.0 * math.pi * f * tau_s) ** 2) for tau_s in slow)
    w = model.sigma_w**2 * spectrum(f, model.scale_w / speed_mps, True)
    v = model.sigma_v**2 * spectrum(f, model.scale_v / speed_mps, True)
    return np.stack([4.0 * slow.pitch_s * sigma_roll(model, span_m) ** 2 * pitch, square * pitch * w, square * yaw * v])
