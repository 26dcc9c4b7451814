"""The path that guidance follows: PH pieces joined end to end, with a table that makes a look-up cost half a microsecond.

The table is a second-order Taylor expansion about samples every ``STEP_M``; between them the point is off by at most
|dkappa/ds| STEP_M^3 / 48, some 1e-5 m on the paths flown here. What is exact (the kinematic point, the metrics) asks the
curves themselves. Before its start and past its end the path is straight.
"""

from collections.abc import Sequence

import numpy as np

from testbed.core.chain import Chain
from vosc import ph

STEP_M = 1.0
RUN_OUT_M = 400.0  # straight piece after the goal, for look-ahead and for flights that pass it
Row = tuple[float, float, float, float, float, float, float, float, float]


class ActivePath(Chain):
    """A chain with the table that guidance looks up."""

    def __init__(self, curves: Sequence[ph.Curve]) -> None:
        super().__init__(curves)
        rows = np.hstack(self.sample(np.arange(0.0, self.length_m + RUN_OUT_M, STEP_M)))
        self._table: list[Row] = [(x, y, z, tx, ty, tz, kx, ky, kz) for x, y, z, tx, ty, tz, kx, ky, kz in rows.tolist()]
        self._last = len(self._table) - 1
        self._before = (*self._table[0][:6], 0.0, 0.0, 0.0)  # straight before the start, as the chain is

    def rows_at(self, s1_m: float, s2_m: float, s3_m: float) -> tuple[Row, Row, Row]:
        """The nearest samples of three arc lengths (one call instead of three: guidance asks 60 times a second)."""
        table = self._table
        i, j, k = int(s1_m / STEP_M + 0.5), int(s2_m / STEP_M + 0.5), int(s3_m / STEP_M + 0.5)
        if i < 0 or j < 0 or k < 0:  # a negative index would be one from the end
            first, second, third = (self._before if n < 0 else table[min(n, self._last)] for n in (i, j, k))
            return first, second, third
        try:
            return table[i], table[j], table[k]
        except IndexError:
            last = self._last
            return table[min(i, last)], table[min(j, last)], table[min(k, last)]

    def look_up(self, s_m: float) -> tuple[float, Row]:
        """Offset from the nearest sample, and that sample: point, tangent, curvature vector."""
        index = int(s_m / STEP_M + 0.5)
        if index < 0:
            return s_m, self._before
        index = index if index < self._last else self._last
        return s_m - index * STEP_M, self._table[index]
