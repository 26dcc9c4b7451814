"""Interacting multiple models: two Kalman filters, one of quiet flight and one of manoeuvres, weighed by how well they foretell.

At each measurement the two exchange what they have (an obstacle may have begun or ended a manoeuvre), each foretells and corrects, and
each one's probability follows from how likely the measurement was to it (Blom and Bar-Shalom). What is told is their mixture.
"""

import math
from typing import NamedTuple

import numpy as np

from testbed.flight.tracking.base import Filtered, Looks, Measurement, Seconds, Sigma
from testbed.flight.tracking.kalman import Acceleration, Corrected, Estimate, ahead, corrected, first
from testbed.flight.traffic.track import Array

UNLIKELY = 1e-300  # the least likelihood: both models may be surprised


class Models(NamedTuple):
    """An estimate of each model, and how probable each is (2,)."""

    estimates: tuple[Estimate, ...]
    shares: Array


class InteractingModels(Filtered):
    """``quiet_mps2``, ``manoeuvre_mps2``: standard deviation of the acceleration in quiet flight and in a manoeuvre. ``lasts_s``: how
    long either goes on, in the mean. ``first_speed_mps`` as of ``kalman``.
    """

    def __init__(
        self,
        quiet_mps2: Acceleration = 0.5,
        manoeuvre_mps2: Acceleration = 10.0,
        lasts_s: Sigma = 5.0,
        first_speed_mps: Sigma = 60.0,
        confirm_looks: Looks = 3,
        coast_s: Seconds = 1.0,
        position_noise_m: Sigma = 3.0,
        velocity_noise_mps: Sigma = 1.0,
    ) -> None:
        if quiet_mps2 >= manoeuvre_mps2:
            raise ValueError(f"quiet_mps2: must be less than manoeuvre_mps2, which is {manoeuvre_mps2:g}")
        super().__init__(confirm_looks, coast_s, position_noise_m, velocity_noise_mps)
        self._accelerations, self._lasts_s, self._first_speed_mps = (quiet_mps2, manoeuvre_mps2), lasts_s, first_speed_mps

    def begin(self, measured: Measurement) -> Models:
        estimate = first(measured, self._first_speed_mps)
        return Models((estimate, estimate), np.array([0.5, 0.5]))

    def measured(self, estimate: Models, elapsed_s: float, measured: Measurement) -> Models:
        mixed, before = self._mixed(estimate, elapsed_s)
        found = [corrected(one, measured) for one in self._ahead(mixed, elapsed_s)]
        likely = np.array([log_likelihood(one) for one in found])
        shares = np.maximum(before * np.exp(likely - likely.max()), UNLIKELY)
        return Models(tuple(one.estimate for one in found), shares / shares.sum())

    def predicted(self, estimate: Models, elapsed_s: float) -> tuple[Array, Array]:
        if elapsed_s <= 0.0:
            return together(estimate.estimates, estimate.shares)
        mixed, before = self._mixed(estimate, elapsed_s)
        return together(self._ahead(mixed, elapsed_s), before)

    def _ahead(self, estimates: tuple[Estimate, ...], elapsed_s: float) -> tuple[Estimate, ...]:
        return tuple(ahead(one, elapsed_s, size) for one, size in zip(estimates, self._accelerations, strict=True))

    def _mixed(self, models: Models, elapsed_s: float) -> tuple[tuple[Estimate, ...], Array]:
        """What each model starts from after a time in which the obstacle may have changed over, and how probable each then is (2,)."""
        stays = 0.5 * (1.0 + math.exp(-2.0 * elapsed_s / self._lasts_s))
        turns = np.array([[stays, 1.0 - stays], [1.0 - stays, stays]])  # from a model (row) to a model (column)
        came = models.shares[:, None] * turns
        before = came.sum(axis=0)
        return tuple(together(models.estimates, came[:, k] / before[k]) for k in range(2)), before


def together(estimates: tuple[Estimate, ...], shares: Array) -> Estimate:
    """Mean and covariance of a mixture."""
    values = sum(share * one.values for share, one in zip(shares, estimates, strict=True))
    parts = (share * (one.covariance + np.outer(off := one.values - values, off)) for share, one in zip(shares, estimates, strict=True))
    return Estimate(np.asarray(values), np.asarray(sum(parts)))


def log_likelihood(one: Corrected) -> float:
    """Of a measurement with that error, up to what all models share."""
    _, size = np.linalg.slogdet(one.spread)
    return -0.5 * float(size + one.error @ np.linalg.solve(one.spread, one.error))
