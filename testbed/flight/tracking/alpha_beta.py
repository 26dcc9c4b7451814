"""The alpha-beta filter: a measurement corrects the predicted place by a share, and the velocity by another."""

import math
from typing import Annotated

import numpy as np
from pydantic import Field

from testbed.flight.tracking.base import Filtered, Looks, Measurement, Seconds
from testbed.flight.traffic.track import Array


class AlphaBeta(Filtered):
    """``alpha``: share of the place's error that is corrected. ``beta``: of the velocity's, times the interval; left out, the one that
    is best for that alpha when accelerations are white noise (Kalata): 2 (2 - alpha) - 4 sqrt(1 - alpha).

    Measured velocities are used for a track's begin and then left out. It says nothing of its own error.
    """

    def __init__(
        self,
        alpha: Annotated[float, Field(gt=0, le=1)] = 0.5,
        beta: Annotated[float, Field(gt=0, le=2)] | None = None,
        confirm_looks: Looks = 3,
        coast_s: Seconds = 1.0,
    ) -> None:
        super().__init__(confirm_looks, coast_s)
        self._alpha = alpha
        self._beta = 2.0 * (2.0 - alpha) - 4.0 * math.sqrt(1.0 - alpha) if beta is None else beta

    def begin(self, measured: Measurement) -> tuple[Array, bool]:
        """Place and velocity, and whether the velocity is more than a guess."""
        values = measured.values
        return (values, True) if len(values) == 6 else (np.concatenate([values, np.zeros(3)]), False)

    def measured(self, estimate: tuple[Array, bool], elapsed_s: float, measured: Measurement) -> tuple[Array, bool]:
        values, moves = estimate
        place = measured.values[:3]
        if not moves:
            return np.concatenate([place, (place - values[:3]) / elapsed_s]), True
        ahead = values[:3] + elapsed_s * values[3:]
        error = place - ahead
        return np.concatenate([ahead + self._alpha * error, values[3:] + (self._beta / elapsed_s) * error]), True

    def predicted(self, estimate: tuple[Array, bool], elapsed_s: float) -> tuple[Array, None]:
        values, _ = estimate
        return np.concatenate([values[:3] + elapsed_s * values[3:], values[3:]]), None
