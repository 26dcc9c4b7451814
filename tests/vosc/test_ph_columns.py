"""Columns of frames are the frames, bit by bit."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vosc import ph
from vosc.ph_columns import Pieces, frames, parameters, tangent
from vosc.ph_curve import Curve

numbers = st.floats(-500.0, 500.0, allow_subnormal=False)
vectors = st.tuples(numbers, numbers, numbers)


def places(curve: Curve) -> np.ndarray:
    inside = np.random.default_rng(4).uniform(0.0, curve.length_m, 40)
    return np.concatenate([[-1.0, 0.0, curve.length_m, 1.1 * curve.length_m], inside])


def same_as_one_by_one(curve: Curve) -> None:
    s = places(curve)
    each = [curve.frame(float(x)) for x in s]
    for part, columns in enumerate(frames(curve, s)):
        assert np.array(columns).T.tobytes() == np.array([frame[part] for frame in each]).tobytes()
    assert parameters(curve, s).tolist() == [curve.parameter(float(x)) for x in s]
    assert [tangent(curve, float(x)) for x in s] == [frame[1] for frame in each]


@settings(max_examples=60, deadline=None)
@given(end=vectors, first=vectors, last=vectors)
def test_of_any_quintic(end: tuple, first: tuple, last: tuple) -> None:
    try:
        curve = ph.hermite((0.0, 0.0, 0.0), first, end, last)
    except ValueError:
        return  # no curve
    if curve.length_m > 1.0 and curve.min_speed > 1e-6:
        same_as_one_by_one(curve)


def test_of_a_septic() -> None:
    limits = ph.Limits(50.0, max_curvature_per_m=1 / 100)
    curve = ph.flyable((0, 0, 0), (1, 0, 0), (400, 100, 20), (1, 0.3, 0), limits, (0.0, 0.001, 0.0)).curve
    assert curve is not None
    assert len(curve.a) == 4
    same_as_one_by_one(curve)


def test_at_a_cusp_the_tangent_is_the_axis_and_the_curvature_zero() -> None:
    low = Curve((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), ((0.0, 0.0, 0.0), (1.0, 1.0, 0.0), (2.0, 2.0, 1.0)))  # stands still at its start
    s = np.array([0.0, 0.5 * low.length_m])
    _, tangents, bends = frames(low, s)
    expected = [low.frame(float(x)) for x in s]
    assert np.array(tangents).T.tolist() == [list(frame[1]) for frame in expected]
    assert np.array(bends).T.tolist() == [list(frame[2]) for frame in expected]


@pytest.mark.parametrize("count", [1, 2, 7])
def test_of_several_curves_at_once(count: int) -> None:
    rng = np.random.default_rng(count)
    curves = [ph.hermite((0, 0, 0), rng.normal(size=3) * 300, rng.normal(size=3) * 400, rng.normal(size=3) * 300) for _ in range(count)]
    which = rng.integers(0, count, 50)
    s = np.array([rng.uniform(-1.0, curves[k].length_m + 1.0) for k in which])
    rows = Pieces(curves).on(which)
    found = rows.frames(s)
    for part in range(3):
        expected = [curves[k].frame(float(x))[part] for k, x in zip(which, s, strict=True)]
        assert np.array(found[part]).T.tolist() == [list(row) for row in expected]
    assert np.array(rows.points(s)).tolist() == np.array(found[0]).tolist()
