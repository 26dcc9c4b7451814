"""The air round an aircraft, made visible: streaks that move with it. Geometry only."""

import numpy as np

Array = np.ndarray
CALM_MPS = 0.01  # air that is never faster is calm
STREAK_S = 0.35  # a streak is as long as the air moves in this time
COUNT = 36
_STEPS = np.array([0.8191725133961645, 0.6710436067037893, 0.5497004779019703])  # powers of the plastic number: even in a box, not random


def is_calm(wind: Array) -> bool:
    """Whether the air (n, 3) is at rest throughout."""
    return bool(np.nanmax(np.linalg.norm(wind, axis=1), initial=0.0) < CALM_MPS)


def drift(time_s: Array, wind: Array) -> Array:
    """How far the air has moved (n, 3) since the first row."""
    steps = 0.5 * (wind[1:] + wind[:-1]) * np.diff(time_s)[:, None]
    return np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])


def streaks(time_s: Array, own: Array, wind: Array, half_m: float) -> Array:
    """Line segments (n, COUNT, 2, 3) in a box round the aircraft: each ends in a particle of air, and begins where that came from.

    The air at the aircraft is taken to be the air of the whole box. A particle that leaves the box comes in again on its other side.
    """
    wind = np.nan_to_num(wind)
    seeds = (np.arange(1, COUNT + 1)[:, None] * _STEPS % 1.0) * 2.0 * half_m
    moved = drift(time_s, wind) - (own - own[0])
    place = np.mod(seeds[None] + moved[:, None], 2.0 * half_m) - half_m + own[:, None]
    return np.stack([place - STREAK_S * wind[:, None], place], axis=2)
