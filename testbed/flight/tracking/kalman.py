"""The Kalman filter of an obstacle that flies straight on but for accelerations of random size and direction.

An acceleration is constant between two measurements and has a standard deviation; so in a time t a track's covariance grows by

    [ t^4/4  t^3/2 ]
    [ t^3/2  t^2   ]   times the acceleration's variance, for each of the three axes.
"""

from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from testbed.flight.tracking.base import Filtered, Looks, Measurement, Seconds, Sigma
from testbed.flight.traffic.track import Array

Acceleration = Annotated[float, Field(ge=0, le=1000)]
EYE6 = np.eye(6)
PLACES, MIXED, SPEEDS = (np.kron(np.array(block), np.eye(3)) for block in ([[1, 0], [0, 0]], [[0, 1], [1, 0]], [[0, 0], [0, 1]]))


class Estimate(NamedTuple):
    """Place and velocity (6,), and their covariance (6,6)."""

    values: Array
    covariance: Array


class Corrected(NamedTuple):
    """An estimate with a measurement, the measurement's error as it was foretold, and that error's covariance."""

    estimate: Estimate
    error: Array
    spread: Array


def ahead(estimate: Estimate, elapsed_s: float, acceleration_mps2: float) -> Estimate:
    """A time later, nothing measured."""
    t, values, before = elapsed_s, estimate.values.copy(), estimate.covariance
    values[:3] += t * values[3:]
    after, moves, both = before.copy(), t * before[3:, 3:], t * before[:3, 3:]
    after[:3, :3] += both + both.T + t * moves
    after[:3, 3:] += moves
    after[3:, :3] += moves
    return Estimate(values, after + (acceleration_mps2 * t) ** 2 * (0.25 * t * t * PLACES + 0.5 * t * MIXED + SPEEDS))


def corrected(estimate: Estimate, measured: Measurement) -> Corrected:
    """With a measurement of this instant, by Joseph's form, which keeps a covariance symmetrical and positive."""
    values, covariance = estimate
    n = len(measured.values)
    error, spread = measured.values - values[:n], covariance[:n, :n] + measured.covariance
    gain = np.linalg.solve(spread, covariance[:n]).T
    rest = EYE6.copy()
    rest[:, :n] -= gain
    new = Estimate(values + gain @ error, rest @ covariance @ rest.T + gain @ measured.covariance @ gain.T)
    return Corrected(new, error, spread)


def first(measured: Measurement, speed_mps: float) -> Estimate:
    """Of one measurement. A velocity that was not measured is none, give or take ``speed_mps``."""
    n = len(measured.values)
    values, covariance = np.zeros(6), speed_mps**2 * np.eye(6)
    values[:n], covariance[:n, :n] = measured.values, measured.covariance
    return Estimate(values, covariance)


class Kalman(Filtered):
    """``acceleration_mps2``: standard deviation of what an obstacle accelerates by. ``first_speed_mps``: of its speed along an axis, where
    no velocity is measured.
    """

    def __init__(
        self,
        acceleration_mps2: Acceleration = 2.0,
        first_speed_mps: Sigma = 60.0,
        confirm_looks: Looks = 3,
        coast_s: Seconds = 1.0,
        position_noise_m: Sigma = 3.0,
        velocity_noise_mps: Sigma = 1.0,
    ) -> None:
        super().__init__(confirm_looks, coast_s, position_noise_m, velocity_noise_mps)
        self._acceleration_mps2, self._first_speed_mps = acceleration_mps2, first_speed_mps

    def begin(self, measured: Measurement) -> Estimate:
        return first(measured, self._first_speed_mps)

    def measured(self, estimate: Estimate, elapsed_s: float, measured: Measurement) -> Estimate:
        return corrected(ahead(estimate, elapsed_s, self._acceleration_mps2), measured).estimate

    def predicted(self, estimate: Estimate, elapsed_s: float) -> tuple[Array, Array]:
        if elapsed_s <= 0.0:
            return estimate
        return ahead(estimate, elapsed_s, self._acceleration_mps2)
