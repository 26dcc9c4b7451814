"""Distributions of leads, some of which are infinite: quantiles with exact intervals, shares, a logistic curve."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import expit

from testbed.core.seeds import stream
from testbed.results.statistics import share_at_least

Array = np.ndarray
CONFIDENCE = 0.95
RESAMPLES = 400
NEWTON_STEPS = 60
SHARE_SHOWN = 0.99  # a share is shown to be this large when its one-sided lower bound is


class Estimate(NamedTuple):
    """A number and the ends of its 95 % interval; an end that the sample cannot give is infinite."""

    value: float
    low: float
    high: float


def quantile(values: Sequence[float], share: float) -> Estimate:
    """The least value that at least a share of the sample does not exceed, with the distribution-free interval of order statistics.

    Infinite values count as larger than all others; NaN must not be there. NaN for an empty sample.
    """
    ordered = sorted(values)
    n = len(ordered)
    if not n:
        return Estimate(math.nan, math.nan, math.nan)
    from scipy.stats import binom  # here, because it takes over a second to import

    tail = 0.5 * (1.0 - CONFIDENCE)
    below, above = int(binom.ppf(tail, n, share)), int(binom.ppf(1.0 - tail, n, share)) + 1
    low = ordered[below - 1] if below >= 1 else -math.inf
    high = ordered[above - 1] if above <= n else math.inf
    return Estimate(ordered[max(0, math.ceil(share * n - 1e-9) - 1)], low, high)


def shown_from(leads_s: Sequence[float], kept: Array) -> float:
    """The least lead of the grid at which, and at every longer one, 99 % is shown; infinite for none. ``kept`` (n, leads), 0 or 1."""
    bounds = [share_at_least(int(column.sum()), len(column)) >= SHARE_SHOWN for column in kept.T]
    return next((lead for k, lead in enumerate(leads_s) if all(bounds[k:])), math.inf)


class Logistic(NamedTuple):
    """P(keeps R) = 1 / (1 + exp(-(a + b lead)))."""

    a: float
    b: float

    def at(self, lead_s: Array) -> Array:
        return np.asarray(expit(self.a + self.b * lead_s))

    def lead_s(self, share: float) -> float:
        """Where the curve reaches a share; NaN where it does not rise."""
        return (math.log(share / (1.0 - share)) - self.a) / self.b if self.b > 0.0 else math.nan


def logistic(lead_s: Array, kept: Array) -> Logistic:
    """Maximum likelihood by Newton's method; NaN where there is no maximum (all kept, none kept, or a clean cut)."""
    lead_s, kept = np.asarray(lead_s, dtype=float).ravel(), np.asarray(kept, dtype=float).ravel()
    design = np.column_stack([np.ones_like(lead_s), lead_s])
    at = np.zeros(2)
    nowhere = Logistic(math.nan, math.nan)
    if not 0.0 < kept.mean() < 1.0:
        return nowhere
    for _ in range(NEWTON_STEPS):
        share = expit(design @ at)
        curvature = design.T @ (design * (share * (1.0 - share))[:, None])
        if np.linalg.cond(curvature) > 1e12:
            return nowhere
        step = np.linalg.solve(curvature, design.T @ (kept - share))
        at = at + step
        if np.max(np.abs(step)) < 1e-10:
            return Logistic(float(at[0]), float(at[1])) if np.max(np.abs(at)) < 1e3 else nowhere
    return nowhere


def bootstrap(kept: Array, seed: int, of: Callable[[Array], float]) -> Estimate:
    """A number of a table (n encounters, leads) with the 95 % interval of resampled encounters; NaN resamples are left out."""
    rng = stream(seed, 0, "lead_time_bootstrap")
    n = len(kept)
    drawn = [of(kept[rng.integers(0, n, n)]) for _ in range(RESAMPLES)]
    known = [value for value in drawn if not math.isnan(value)]
    if not known:
        return Estimate(of(kept), math.nan, math.nan)
    low, high = np.quantile(known, [0.5 * (1.0 - CONFIDENCE), 0.5 * (1.0 + CONFIDENCE)])
    return Estimate(of(kept), float(low), float(high))


class Cost(NamedTuple):
    """What one thing costs in lead time, by encounter: the median of (with - without), and who can do without it only, or with it only."""

    difference_s: Estimate
    pairs: int  # in which both suffice somewhere
    lost: int  # suffices without it, never with it
    gained: int


def cost(with_it: Sequence[float], without: Sequence[float]) -> Cost:
    """Paired leads, by encounter. An encounter that is lost counts as an infinite cost, one gained as minus infinite."""
    pairs = list(zip(with_it, without, strict=True))
    differences = [a - b for a, b in pairs if math.isfinite(a) or math.isfinite(b)]
    return Cost(
        quantile(differences, 0.5),
        sum(math.isfinite(a) and math.isfinite(b) for a, b in pairs),
        sum(math.isinf(a) and math.isfinite(b) for a, b in pairs),
        sum(math.isfinite(a) and math.isinf(b) for a, b in pairs),
    )
