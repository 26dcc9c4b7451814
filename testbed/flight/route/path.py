"""The path that guidance follows: PH pieces joined end to end, with a table that makes a look-up cost half a microsecond; or, where a
law steers, an arc that lasts for one step.

The table is a second-order Taylor expansion about samples every ``STEP_M``; between them the point is off by at most
|dkappa/ds| STEP_M^3 / 48, some 1e-5 m on the paths flown here. What is exact (the kinematic point, the metrics) asks the
curves themselves. Before its start and past its end the path is straight.
"""

import math
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from testbed.core.chain import Chain
from testbed.core.frames import Vec3
from vosc import ph
from vosc.vec import along, combine

STEP_M = 1.0
RUN_OUT_M = 400.0  # straight piece after the goal, for look-ahead and for flights that pass it
Row = tuple[float, float, float, float, float, float, float, float, float]


class Path(Protocol):
    """What guidance can follow. The aircraft is at ``begin_s_m`` when it is new; one that does not last is replaced at the next step."""

    begin_s_m: float
    lasting: bool
    length_m: float

    def frame(self, s_m: float) -> tuple[Vec3, Vec3, Vec3]:
        """Point (m), unit tangent and curvature vector (1/m) at an arc length; straight beyond either end."""

    def points(self, s_m: np.ndarray) -> np.ndarray:
        """Points (n,3) at arc lengths (n,)."""

    def rows_at(self, s1_m: float, s2_m: float, s3_m: float) -> tuple[Row, Row, Row]:
        """The samples near three arc lengths: point, tangent, curvature vector."""

    def look_up(self, s_m: float) -> tuple[float, Row]:
        """Offset from the nearest sample, and that sample."""


class ActivePath(Chain):
    """A chain with the table that guidance looks up."""

    lasting = True

    def __init__(self, curves: Sequence[ph.Curve], begin_s_m: float = 0.0) -> None:
        super().__init__(curves)
        self.begin_s_m = begin_s_m
        rows = np.hstack(self.sample(np.arange(0.0, self.length_m + RUN_OUT_M, STEP_M)))
        self._table: list[Row] = [(x, y, z, tx, ty, tz, kx, ky, kz) for x, y, z, tx, ty, tz, kx, ky, kz in rows.tolist()]
        self._last = len(self._table) - 1
        self._before = (*self._table[0][:6], 0.0, 0.0, 0.0)  # straight before the start, as the chain is

    def __reduce__(self) -> tuple[type[Chain], tuple[Any, ...]]:
        return ActivePath, (self.curves, self.begin_s_m)

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


class Arc:
    """A piece of a circle (m, unit tangent, curvature vector dT/ds across it), for one step of the guidance."""

    lasting = False

    def __init__(self, point: Vec3, tangent: Vec3, curvature: Vec3, begin_s_m: float, ahead_m: float) -> None:
        self.begin_s_m, self.length_m = begin_s_m, begin_s_m + ahead_m
        self._point, self._tangent, self._curvature = point, tangent, curvature
        self._bend = math.hypot(*curvature)

    def frame(self, s_m: float) -> tuple[Vec3, Vec3, Vec3]:
        """Point (m), unit tangent and curvature vector (1/m) at an arc length; straight before its start."""
        s, bend = s_m - self.begin_s_m, self._bend
        if s <= 0.0 or bend == 0.0:
            return along(self._point, s, self._tangent), self._tangent, self._curvature if s == 0.0 else (0.0, 0.0, 0.0)
        sin, cos, half = math.sin(bend * s), math.cos(bend * s), math.sin(0.5 * bend * s)
        aside = 2.0 * (half / bend) ** 2
        (x, y, z), (dx, dy, dz) = self._point, combine(sin / bend, self._tangent, aside, self._curvature)
        tangent = combine(cos, self._tangent, sin / bend, self._curvature)
        return (x + dx, y + dy, z + dz), tangent, combine(-bend * sin, self._tangent, cos, self._curvature)

    def points(self, s_m: np.ndarray) -> np.ndarray:
        """Points (n,3) at arc lengths (n,)."""
        return np.array([self.frame(s)[0] for s in s_m]).reshape(-1, 3)

    def rows_at(self, s1_m: float, s2_m: float, s3_m: float) -> tuple[Row, Row, Row]:
        """Point, tangent and curvature vector at three arc lengths."""
        return self._row(s1_m), self._row(s2_m), self._row(s3_m)

    def look_up(self, s_m: float) -> tuple[float, Row]:
        """No offset, and the place itself."""
        return 0.0, self._row(s_m)

    def _row(self, s_m: float) -> Row:
        point, tangent, curvature = self.frame(s_m)
        return (*point, *tangent, *curvature)
