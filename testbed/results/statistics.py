"""Statistics of flights, all exact and without random numbers, so that anybody gets the same figures.

Shares: Clopper and Pearson (Biometrika 26, 1934). Medians of paired differences: order statistics, that is the sign test turned
round (Conover, Practical Nonparametric Statistics). Shares in pairs: McNemar's test, exact (Psychometrika 12, 1947); the interval of
their difference is made of those of its two halves, each at half the risk (Bonferroni), so that it holds for any number of pairs.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy import special  # not scipy.stats: that takes over a second to import, in every process that writes a page

LEVEL: Final = 0.95
LEAST_PAIRS: Final = 6  # fewer have no interval of 95 % for their median
NAN: Final = math.nan


@dataclass(frozen=True)
class Spread:
    """A quantity over flights: 5th percentile, median, 95th percentile, and how many flights. NaN and 0 where there is none."""

    p05: float
    median: float
    p95: float
    n: int


@dataclass(frozen=True)
class Effect:
    """Size of an effect with its 95 % interval; ``n`` flights or pairs; what it is and its unit."""

    what: str
    unit: str
    value: float
    low: float
    high: float
    n: int


NO_SPREAD: Final = Spread(NAN, NAN, NAN, 0)
NO_EFFECT: Final = Effect("", "", NAN, NAN, NAN, 0)


def finite(values: Iterable[float]) -> list[float]:
    """Those that are numbers."""
    return [value for value in values if math.isfinite(value)]


def spread(values: Iterable[float]) -> Spread:
    """5th percentile, median and 95th percentile (linear interpolation) of the finite values."""
    found = finite(values)
    if not found:
        return NO_SPREAD
    low, middle, high = (float(value) for value in np.percentile(found, (5.0, 50.0, 95.0)))
    return Spread(low, middle, high, len(found))


def share_interval(count: float, n: int) -> tuple[float, float]:
    """Two-sided 95 % interval of a share, Clopper-Pearson; NaN for no flights. A count need not be whole: of a mean of n shares, which
    spread less than n yes and no with the same mean, it is an interval that is rather too wide.
    """
    if n == 0:
        return NAN, NAN
    return _share_above(count, n, 0.5 * (1.0 - LEVEL)), 1.0 - _share_above(n - count, n, 0.5 * (1.0 - LEVEL))


def share_at_least(count: int, n: int) -> float:
    """One-sided 95 % lower bound of a share, Clopper-Pearson. 0.99 is reached by 299 of 299, and not by 298 of 298."""
    if n == 0:
        return NAN
    return _share_above(count, n, 1.0 - LEVEL)


def _share_above(count: float, n: int, tail: float) -> float:
    """The share with which ``count`` or more of ``n`` come out with probability ``tail``."""
    return float(special.betaincinv(count, n - count + 1, tail)) if count else 0.0


def share(what: str, count: int, n: int) -> Effect:
    """A share with its two-sided interval."""
    return Effect(what, "", count / n if n else NAN, *share_interval(count, n), n)


def median(what: str, unit: str, differences: Iterable[float]) -> Effect:
    """Median of paired differences with its distribution-free 95 % interval; NaN bounds below six pairs."""
    found = sorted(finite(differences))
    n = len(found)
    if n == 0:
        return Effect(what, unit, NAN, NAN, NAN, 0)
    middle = float(np.median(found))
    if n < LEAST_PAIRS:
        return Effect(what, unit, middle, NAN, NAN, n)
    tails = special.bdtr(np.arange(n + 1), n, 0.5)
    rank = int(np.searchsorted(tails, 0.5 * (1.0 - LEVEL)))  # from 1: the rank-th from below and from above
    return Effect(what, unit, middle, found[rank - 1], found[n - rank], n)


def share_difference(what: str, only_first: int, only_second: int, n: int) -> Effect:
    """Share of the second less that of the first over ``n`` pairs, of which so many have just one of the two. At least 95 %, exact."""
    if n == 0:
        return Effect(what, "", NAN, NAN, NAN, 0)
    tail = 0.25 * (1.0 - LEVEL)
    (low_1, high_1), (low_2, high_2) = (
        (_share_above(count, n, tail), 1.0 - _share_above(n - count, n, tail)) for count in (only_first, only_second)
    )
    return Effect(what, "", (only_second - only_first) / n, low_2 - high_1, high_2 - low_1, n)


def mcnemar(only_first: int, only_second: int) -> float:
    """Exact two-sided p that pairs in which just one of two holds fall either way alike; 1 without such pairs."""
    n = only_first + only_second
    return min(1.0, 2.0 * float(special.bdtr(min(only_first, only_second), n, 0.5)))
