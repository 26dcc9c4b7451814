"""The path that guidance follows: PH pieces joined end to end, with a table that makes a look-up cost half a microsecond.

The table is a second-order Taylor expansion about samples every ``STEP_M``; between them the point is off by at most
|dkappa/ds| STEP_M^3 / 48, some 1e-5 m on the paths flown here. What is exact (the kinematic point, the metrics) asks the
curves themselves. Past its end the path goes on straight.
"""

from collections.abc import Sequence

import numpy as np

from testbed.frames import Vec3
from vosc import ph

STEP_M = 1.0
RUN_OUT_M = 400.0  # straight piece after the goal, for look-ahead and for flights that pass it
Row = tuple[float, float, float, float, float, float, float, float, float]


class ActivePath:
    """PH curves flown one after the other, addressed by one arc length."""

    def __init__(self, curves: Sequence[ph.Curve]) -> None:
        self.curves = tuple(curves)
        ends = np.cumsum([curve.length_m for curve in self.curves])
        self.length_m = float(ends[-1])
        self.starts_m = tuple(float(s) for s in [0.0, *ends[:-1]])
        self._table = _tabulate(self.curves, self.starts_m, self.length_m)
        self._last = len(self._table) - 1

    def leg(self, s_m: float) -> int:
        """Which piece an arc length lies on."""
        index = 0
        for k, start in enumerate(self.starts_m):
            if s_m >= start:
                index = k
        return index

    def frame(self, s_m: float) -> tuple[Vec3, Vec3, Vec3]:
        """Exact point, unit tangent and curvature vector; straight before the start and past the goal."""
        if 0.0 <= s_m <= self.length_m:
            k = self.leg(s_m)
            return self.curves[k].frame(min(s_m - self.starts_m[k], self.curves[k].length_m))
        k, end = (0, 0.0) if s_m < 0.0 else (-1, self.curves[-1].length_m)
        point, tangent, _ = self.curves[k].frame(end)
        beyond = s_m if s_m < 0.0 else s_m - self.length_m
        x, y, z = (p + beyond * t for p, t in zip(point, tangent, strict=True))
        return (x, y, z), tangent, (0.0, 0.0, 0.0)

    def rows_at(self, s1_m: float, s2_m: float, s3_m: float) -> tuple[Row, Row, Row]:
        """The nearest samples of three arc lengths ahead of the start (one call instead of three: guidance asks 60 times a second)."""
        table, last = self._table, self._last
        i, j, k = int(s1_m / STEP_M + 0.5), int(s2_m / STEP_M + 0.5), int(s3_m / STEP_M + 0.5)
        return table[i if i < last else last], table[j if j < last else last], table[k if k < last else last]

    def look_up(self, s_m: float) -> tuple[float, Row]:
        """Offset from the nearest sample, and that sample: point, tangent, curvature vector."""
        index = int(s_m / STEP_M + 0.5)
        if index < 0:
            index = 0
        elif index > self._last:
            index = self._last
        return s_m - index * STEP_M, self._table[index]


def _tabulate(curves: tuple[ph.Curve, ...], starts_m: tuple[float, ...], length_m: float) -> list[Row]:
    """Samples every ``STEP_M`` from the start to ``RUN_OUT_M`` past the goal."""
    s = np.arange(0.0, length_m + RUN_OUT_M, STEP_M)
    rows = np.empty((len(s), 9))
    which = np.searchsorted(starts_m, s, side="right") - 1
    for k, curve in enumerate(curves):
        mine = (which == k) & (s <= length_m)
        local = np.minimum(s[mine] - starts_m[k], curve.length_m)
        rows[mine] = np.hstack(curve.sample(local))
    beyond = s > length_m
    point, tangent, _ = curves[-1].frame(curves[-1].length_m)
    rows[beyond, :3] = np.asarray(point) + np.outer(s[beyond] - length_m, tangent)
    rows[beyond, 3:6] = tangent
    rows[beyond, 6:] = 0.0
    return [(x, y, z, tx, ty, tz, kx, ky, kz) for x, y, z, tx, ty, tz, kx, ky, kz in rows.tolist()]
