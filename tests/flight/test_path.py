"""The arc that a law steers along: a circle, by arc length, straight before its start."""

import math

import numpy as np
import pytest

from testbed.flight.route.path import Arc

RADIUS_M = 200.0
CIRCLE = Arc((10.0, -5.0, 3.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0 / RADIUS_M), 50.0, 600.0)


@pytest.mark.parametrize("s_m", [50.0, 80.0, 50.0 + RADIUS_M * math.pi / 2, 500.0])
def test_an_arc_is_a_circle(s_m: float) -> None:
    angle = (s_m - 50.0) / RADIUS_M
    point, tangent, curvature = CIRCLE.frame(s_m)
    assert point == pytest.approx((10.0 + RADIUS_M * math.sin(angle), -5.0, 3.0 + RADIUS_M * (1.0 - math.cos(angle))))
    assert tangent == pytest.approx((math.cos(angle), 0.0, math.sin(angle)), abs=1e-12)
    assert curvature == pytest.approx((-math.sin(angle) / RADIUS_M, 0.0, math.cos(angle) / RADIUS_M), abs=1e-12)
    assert CIRCLE.look_up(s_m) == (0.0, (*point, *tangent, *curvature))
    assert CIRCLE.rows_at(s_m, 50.0, s_m)[0] == CIRCLE.rows_at(50.0, s_m, s_m)[1]
    assert np.allclose(CIRCLE.points(np.array([s_m])), [point])


def test_before_its_start_and_without_a_bend_it_is_straight() -> None:
    point, tangent, curvature = CIRCLE.frame(40.0)
    assert (point, tangent, curvature) == ((0.0, -5.0, 3.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    line = Arc((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.0), 0.0, 600.0)
    assert line.frame(70.0) == ((0.0, 70.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.0))
    assert (CIRCLE.begin_s_m, CIRCLE.length_m, CIRCLE.lasting) == (50.0, 650.0, False)
