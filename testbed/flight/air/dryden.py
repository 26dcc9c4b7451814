"""Frozen Dryden turbulence after MIL-F-8785C: strength and scale from height and severity, a series from a seed.

The specification (3.7.1.2) gives one-sided spectra over the spatial frequency W; with t = L/V they are the spectra in time of

    longitudinal       R(s) = sigma^2 exp(-s/t)                   H(p) ~ 1 / (1 + t p)
    lateral, vertical  R(s) = sigma^2 exp(-s/t) (1 - s / 2t)      H(p) ~ (1 + sqrt(3) t p) / (1 + t p)^2

The forming filters are solved exactly over a step, noise included (not by Euler or Tustin), and start in their stationary state, so
the series has these autocorrelations at its samples whatever the step, from the first sample on.

A series is sampled at ``SERIES_HZ`` whatever the rate of the plant, which interpolates: refining a plant's step does not change its
air. Half-way between samples that costs 0.75 V/(L SERIES_HZ) of the variance: 0.2 % at 50 m/s, 200 m above the ground.

What turns the air about a wing follows from these series, see ``rotary.py``.
"""

import math
from typing import NamedTuple

import numpy as np

from testbed.core.units import FT, KNOT

Array = np.ndarray
SERIES_HZ = 120
ROOT3 = math.sqrt(3.0)

W20_MPS = {"light": 15 * KNOT, "moderate": 30 * KNOT, "severe": 45 * KNOT}
"""Wind at 20 ft that sets the strength near the ground (MIL-F-8785C figure 9)."""

LOWEST_M, LOW_M, HIGH_M = 10 * FT, 1000 * FT, 2000 * FT  # 3.7.3 holds up to 1000 ft, 3.7.2 from 2000 ft on; linear between
HIGH_SCALE_M = 1750 * FT  # 3.7.2.1

ALTITUDE_M = np.array([500.0, 1750, 3750, 7500, 15e3, 25e3, 35e3, 45e3, 55e3, 65e3, 75e3, 80e3]) * FT
SIGMA_ALOFT_MPS = {  # figure 7, root mean square that is exceeded with a probability of 1e-2, 1e-3, 1e-5
    "light": np.array([6.6, 6.9, 7.4, 6.7, 4.6, 2.7, 0.4, 0, 0, 0, 0, 0]) * FT,
    "moderate": np.array([8.6, 9.6, 10.6, 10.1, 8.0, 6.6, 5.0, 4.2, 2.7, 0, 0, 0]) * FT,
    "severe": np.array([15.6, 17.6, 23.0, 23.6, 22.1, 20.0, 16.0, 15.1, 12.1, 7.9, 6.2, 5.1]) * FT,
}


class Dryden(NamedTuple):
    """Standard deviations (m/s) and scales (m) along, across and up."""

    sigma_u: float
    sigma_v: float
    sigma_w: float
    scale_u: float
    scale_v: float
    scale_w: float


def dryden(severity: str, height_m: float) -> Dryden:
    """Strength and scale at a height above the ground (aloft, the height stands for the altitude).

    Up to 1000 ft (3.7.3.4, figures 10 and 11): sigma_w = 0.1 W20, L_w = h, sigma_u = sigma_v = sigma_w / (0.177 + 0.000823 h)^0.4,
    L_u = L_v = h / (0.177 + 0.000823 h)^1.2, h in ft, at least 10 ft. From 2000 ft on: figure 7 and 1750 ft for all three.
    """
    if height_m >= HIGH_M:
        sigma = float(np.interp(height_m, ALTITUDE_M, SIGMA_ALOFT_MPS[severity]))
        return Dryden(sigma, sigma, sigma, HIGH_SCALE_M, HIGH_SCALE_M, HIGH_SCALE_M)
    if height_m > LOW_M:
        share = (height_m - LOW_M) / (HIGH_M - LOW_M)
        return Dryden(*(a + share * (b - a) for a, b in zip(dryden(severity, LOW_M), dryden(severity, HIGH_M), strict=True)))
    height_m = max(LOWEST_M, height_m)
    base = 0.177 + 0.000823 * height_m / FT
    sigma_w = 0.1 * W20_MPS[severity]
    sigma, scale = sigma_w / base**0.4, height_m / base**1.2
    return Dryden(sigma, sigma, sigma_w, scale, scale, height_m)


def transition(step: float) -> tuple[Array, Array]:
    """One step of the two-stage filter of unit noise, ``step`` = dt/t: the transition (2,2), and a root (2,2) of the noise's covariance.

    The stages are x' = (noise - x)/t and y' = (x - y)/t; sqrt(3) x + (1 - sqrt(3)) y has unit variance and the autocorrelation above.
    """
    from scipy.special import gammainc

    # integrals over the step of x^n exp(-2x), n = 0, 1, 2: incomplete gamma functions, which lose no digits for a small step
    i0, i1, i2 = (math.gamma(n + 1) * float(gammainc(n + 1, 2.0 * step)) / 2.0 ** (n + 1) for n in range(3))
    decay = math.exp(-step)
    first = math.sqrt(i0)
    cross = i1 / first
    return decay * np.array([[1.0, 0.0], [step, 1.0]]), np.array([[first, 0.0], [cross, math.sqrt(max(0.0, i2 - cross * cross))]])


START_ROOT = np.array([[math.sqrt(0.5), 0.0], [math.sqrt(0.125), math.sqrt(0.125)]])
"""Root (2,2) of the stationary covariance [[1/2, 1/4], [1/4, 1/4]] of the two stages."""


def dryden_series(model: Dryden, speed_mps: float, count: int, rng: np.random.Generator) -> Array:
    """``count`` samples (count, 3) of along, across and up at ``SERIES_HZ``, m/s. A longer series begins with the shorter one."""
    from scipy.signal import lfilter

    noise = rng.normal(size=(count, 5))  # row by row: what comes first does not depend on the length
    out = np.empty((count, 3))
    step = speed_mps / (model.scale_u * SERIES_HZ)
    decay = math.exp(-step)
    drive = noise[:, 0] * math.sqrt(-math.expm1(-2.0 * step))
    drive[:1] = noise[:1, 0]
    out[:, 0] = model.sigma_u * lfilter([1.0], [1.0, -decay], drive)
    for column, sigma, scale in ((1, model.sigma_v, model.scale_v), (2, model.sigma_w, model.scale_w)):
        own = noise[:, 2 * column - 1 : 2 * column + 1]
        step_matrix, root = transition(speed_mps / (scale * SERIES_HZ))
        drives = own @ root.T
        drives[:1] = own[:1] @ START_ROOT.T
        x = lfilter([1.0], [1.0, -step_matrix[0, 0]], drives[:, 0])
        drives[1:, 1] += step_matrix[1, 0] * x[:-1]
        y = lfilter([1.0], [1.0, -step_matrix[1, 1]], drives[:, 1])
        out[:, column] = sigma * (ROOT3 * x + (1.0 - ROOT3) * y)
    return out


def autocorrelation(lag_s: Array, tau_s: float, two_stage: bool) -> Array:
    """Of a component of unit variance with time scale ``tau_s`` = L/V; ``two_stage``: lateral and vertical."""
    r = np.abs(lag_s) / tau_s
    return np.exp(-r) * (1.0 - 0.5 * r) if two_stage else np.exp(-r)


def spectrum(frequency_hz: Array, tau_s: float, two_stage: bool) -> Array:
    """One-sided power per Hz of a component of unit variance (3.7.1.2, with W = 2 pi f / V)."""
    square = (2.0 * math.pi * tau_s * np.asarray(frequency_hz)) ** 2
    return 2.0 * tau_s * (1.0 + 3.0 * square) / (1.0 + square) ** 2 if two_stage else 4.0 * tau_s / (1.0 + square)
