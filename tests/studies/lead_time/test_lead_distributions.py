"""Intervals against tables and other libraries."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import binomtest

from testbed.results.statistics import share_at_least
from testbed.studies.lead_time.lead_distributions import bootstrap, cost, logistic, quantile, shown_from


def test_the_median_of_twenty_lies_between_the_sixth_and_the_fifteenth() -> None:
    """The textbook's 95 % interval of order statistics; its coverage is that of the binomial distribution."""
    found = quantile(list(np.random.default_rng(1).permutation(np.arange(1.0, 21.0))), 0.5)
    assert found == (10.0, 6.0, 15.0)
    rng = np.random.default_rng(2)
    covered = np.mean([low <= 0.5 <= high for _, low, high in (quantile(list(rng.random(20)), 0.5) for _ in range(2000))])
    assert covered == pytest.approx(0.9586, abs=0.02)


def test_what_the_sample_cannot_bound_is_infinite() -> None:
    values = [float(k) for k in range(1, 41)]
    assert quantile(values, 0.95)[0] == 38.0
    assert math.isinf(quantile(values, 0.95).high)
    assert quantile([1.0, 2.0, math.inf], 0.5).value == 2.0
    assert math.isinf(quantile([1.0, math.inf, math.inf], 0.5).value)
    assert math.isnan(quantile([], 0.5).value)


def test_ninety_nine_per_cent_takes_299_flights_without_a_failure() -> None:
    assert share_at_least(299, 299) >= 0.99 > share_at_least(298, 298)
    assert share_at_least(299, 300) < 0.99
    for kept, of in ((290, 300), (1, 40), (20, 40), (40, 40)):
        truth = binomtest(kept, of, alternative="greater").proportion_ci(0.95, "exact").low
        assert share_at_least(kept, of) == pytest.approx(truth, abs=1e-9)
    assert share_at_least(0, 40) == 0.0


def test_shown_means_at_that_lead_and_every_longer_one() -> None:
    leads = (1.0, 2.0, 3.0)
    all_kept = np.ones((300, 3))
    assert shown_from(leads, all_kept) == 1.0
    all_kept[:5, 1] = 0.0
    assert shown_from(leads, all_kept) == 3.0
    all_kept[:5, 2] = 0.0
    assert math.isinf(shown_from(leads, all_kept))


def test_the_logistic_curve_is_the_one_of_greatest_likelihood() -> None:
    rng = np.random.default_rng(3)
    lead = np.tile([0.5, 1.0, 1.5, 2.0, 3.0], 80)
    kept = (rng.random(400) < 1.0 / (1.0 + np.exp(3.0 - 2.0 * lead))).astype(float)

    def cost_of(at: np.ndarray) -> float:
        slope = at[0] + at[1] * lead
        return float(np.sum(np.logaddexp(0.0, slope) - kept * slope))

    truth = minimize(cost_of, np.zeros(2), tol=1e-12).x
    found = logistic(lead, kept)
    assert found == pytest.approx(truth, abs=1e-4)
    assert found.at(np.array(found.lead_s(0.95))) == pytest.approx(0.95)


@pytest.mark.parametrize("kept", [[0.0, 0.0, 0.0, 0.0], [1.0, 1.0, 1.0, 1.0], [0.0, 0.0, 1.0, 1.0]])
def test_where_there_is_no_maximum_there_is_no_curve(kept: list[float]) -> None:
    assert all(math.isnan(part) for part in logistic(np.array([1.0, 2.0, 3.0, 4.0]), np.array(kept)))


def test_the_bootstrap_covers_a_mean_like_its_standard_error() -> None:
    table = np.random.default_rng(4).normal(5.0, 2.0, (400, 1))
    value, low, high = bootstrap(table, 7, lambda rows: float(rows.mean()))
    assert value == pytest.approx(float(table.mean()))
    assert (high - low) == pytest.approx(2 * 1.96 * 2.0 / 20.0, rel=0.15)
    assert bootstrap(table, 7, lambda rows: float(rows.mean())) == (value, low, high)


def test_a_cost_is_paired_and_counts_who_never_makes_it() -> None:
    found = cost([2.0, 3.0, math.inf, 1.0, math.inf], [1.0, 1.0, 1.0, math.inf, math.inf])
    assert (found.pairs, found.lost, found.gained) == (2, 1, 1)
    assert found.difference_s.value == 1.0  # of -inf, 1, 2, inf the second: nobody can say what inf - inf is
