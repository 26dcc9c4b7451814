"""The 95 % interval of a ratio of risks in pairs, and how many pairs an interval of some width takes.

Encounters are resampled as pairs, 2,000 times, and the interval is bias-corrected and accelerated (BCa: Efron, JASA 82, 1987). Pairs of
the same weight and the same two events are alike, so that a resample is one draw from a multinomial distribution of the kinds of
pairs: without weights there are four of them, however many encounters. docs/daa.md has the coverage as measured.

Where the resamples all give the same ratio they say nothing about its spread. Without an event with avoidance the upper end is then the
exact one of a share of none (Clopper and Pearson) over the share without; with the same encounters as without, the interval is that of
the logarithm of the ratio by the delta method with half an encounter added to each count.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy import special

Array = np.ndarray
NAN = math.nan
RESAMPLES = 2000
TAIL = 0.025
Z95 = float(special.ndtri(1.0 - TAIL))
AT_ONCE = 4_000_000  # numbers drawn at once: of very many weights a few resamples at a time


class Interval(NamedTuple):
    """A ratio with its interval; NaN where nobody had an event without avoidance."""

    value: float = NAN
    low: float = NAN
    high: float = NAN


def ratio_interval(weights: Array, without: Array, with_: Array, rng: np.random.Generator) -> Interval:
    """Of pairs (n,): their weights, and whether there was the event without and with avoidance."""
    n = len(weights)
    below, above = float(weights @ without), float(weights @ with_)
    if n == 0 or below <= 0.0:
        return Interval()
    known_weights, which = np.unique(weights, return_inverse=True)
    kinds, counts = np.unique(4 * which + 2 * (without > 0.0) + (with_ > 0.0), return_counts=True)
    w, e0, e1 = known_weights[kinds // 4], (kinds // 2 % 2).astype(float), (kinds % 2).astype(float)
    value = above / below
    resampled = _resampled(w * e0, w * e1, counts, n, rng)
    if np.ptp(resampled) <= 1e-12 * max(value, 1.0):
        return Interval(value, *_without_spread(weights, without, with_))
    left0, left1 = below - w * e0, above - w * e1
    known = left0 > 0.0
    jack = np.divide(left1, left0, out=np.full(len(w), value), where=known)
    mean = float(counts[known] @ jack[known]) / max(1, int(counts[known].sum()))
    skew, spread = (float(counts[known] @ (mean - jack[known]) ** power) for power in (3, 2))
    acceleration = skew / (6.0 * spread**1.5) if spread > 0.0 else 0.0
    lower = float(np.mean(resampled < value) + 0.5 * np.mean(resampled == value))
    bias = float(special.ndtri(min(max(lower, 1.0 / RESAMPLES), 1.0 - 1.0 / RESAMPLES)))
    levels = [float(special.ndtr(bias + (bias + z) / (1.0 - acceleration * (bias + z)))) for z in (-Z95, Z95)]
    low, high = np.quantile(resampled, levels).tolist()
    return Interval(value, low, high)


def _resampled(below: Array, above: Array, counts: Array, n: int, rng: np.random.Generator) -> Array:
    """Ratios (m,) of resamples, those without an event below left out."""
    shares = counts / n
    at_once = max(1, AT_ONCE // len(counts))
    found: list[Array] = []
    for first in range(0, RESAMPLES, at_once):
        drawn = rng.multinomial(n, shares, size=min(at_once, RESAMPLES - first))
        bottom = drawn @ below
        found.append((drawn @ above)[bottom > 0.0] / bottom[bottom > 0.0])
    every = np.concatenate(found)
    return every if len(every) else np.zeros(1)


def _without_spread(weights: Array, without: Array, with_: Array) -> tuple[float, float]:
    """Of encounters of different weights by as many of equal ones as say as much (Kish)."""
    scale = float(weights.sum() / (weights @ weights))
    n, below, above = (scale * float(weights @ event) for event in (np.ones(len(weights)), without, with_))
    if above == 0.0:
        return 0.0, (1.0 - TAIL ** (1.0 / n)) * n / below
    differ = scale * float(weights @ (without != with_))
    spread = math.sqrt((differ + 0.5) / ((below + 0.5) * (above + 0.5)))
    middle = math.log((above + 0.5) / (below + 0.5))
    return math.exp(middle - Z95 * spread), math.exp(middle + Z95 * spread)


def pairs_for_width(width: float, ratio: float, share: float, induced: float = 0.0) -> int:
    """Encounters after which the interval of a ratio is about so wide, by the delta method for its logarithm.

    ``share``: of encounters with the event without avoidance; ``induced``: the part of the ratio that is of the others.
    """
    with_alone, without_alone = share * induced, share * (1.0 - ratio + induced)
    spread = math.asinh(width / (2.0 * ratio)) / Z95  # half the width of the logarithm's interval over 1.96
    return math.ceil((with_alone + without_alone) / (share**2 * ratio * spread**2))
