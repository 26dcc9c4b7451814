"""Intervals of 95 % that assume no distribution."""

import math
from collections.abc import Sequence

import numpy as np
from scipy import special

LEAST_PAIRS = 6


def share_bounds(count: int, n: int) -> tuple[float, float]:
    """Two-sided 95 % interval of a share after Clopper and Pearson, from quantiles of the beta distribution."""
    low = float(special.betaincinv(count, n - count + 1, 0.025)) if count else 0.0
    return low, float(special.betaincinv(count + 1, n - count, 0.975)) if count < n else 1.0


def settled_at(count: int, n: int, least: float) -> bool | None:
    """Is the share so large (True), smaller (False), or is its interval on both sides (None)?"""
    low, high = share_bounds(count, n)
    if low < least <= high:
        return None
    return low >= least


def median_bounds(values: Sequence[float]) -> tuple[float, float, float]:
    """Median, and its distribution-free 95 % interval; NaN below six values."""
    ordered = np.sort(np.array(values, dtype=float))
    n = len(ordered)
    if n < LEAST_PAIRS:
        return float(np.median(ordered)) if n else math.nan, math.nan, math.nan
    r = int(np.argmax(special.bdtr(np.arange(n + 1), n, 0.5) >= 0.025))
    return float(np.median(ordered)), float(ordered[r - 1]), float(ordered[n - r])
