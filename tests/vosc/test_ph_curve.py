import dataclasses
import math
import pickle

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

from tests.vosc.draws import percent
from vosc import ph

CHORD = math.dist((0, 0, 0), (500, 200, 100))


def polar(size, azimuth_deg, elevation_deg):
    a, e = math.radians(azimuth_deg), math.radians(elevation_deg)
    return np.array([size * math.cos(e) * math.cos(a), size * math.cos(e) * math.sin(a), size * math.sin(e)])


def original_path():
    return ph.hermite((0, 0, 0), polar(CHORD, 40.87, 26.13), (500, 200, 100), polar(CHORD, 10.0, 2.84))


component = st.floats(-1.0, 1.0)
vector = st.tuples(component, component, component).filter(lambda v: math.hypot(*v) > 0.05).map(np.array)
data = st.tuples(vector, vector, vector, st.floats(0.3, 2.0), st.floats(0.3, 2.0))


def unit(v):
    return v / np.linalg.norm(v)


def curve_of(drawn, away_from_reversal=True):
    t0, chord, t1, lam0, lam1 = drawn
    if away_from_reversal:
        assume(unit(t0) @ unit(t1) > -0.95)
    size = np.linalg.norm(chord)
    p0 = np.array([1.0, -2.0, 3.0])
    d0, p1, d1 = lam0 * size * unit(t0), p0 + chord, lam1 * size * unit(t1)
    return ph.hermite(p0, d0, p1, d1), p0, d0, p1, d1


def bernstein(curve):
    """r(t) written out afresh from the preimage: quaternion products, independent of the curve's own polynomials."""

    def times(p, q):
        (a, b, c, d), (e, f, g, h) = p, q
        real, i = a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g
        return np.array([real, i, a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e])

    axis, b = np.array([0.0, *curve.e]), np.array(curve.a)

    def velocity(t):
        """Of one parameter (3,), of many (3,n)."""
        t = np.asarray(t)
        pure = np.multiply.outer(b[0], (1 - t) ** 2) + np.multiply.outer(b[1], 2 * t * (1 - t)) + np.multiply.outer(b[2], t * t)
        zero = np.zeros_like(pure[:1])
        return times(times(np.concatenate([zero, pure]), axis), np.concatenate([zero, -pure]))[1:]

    return velocity


def way(velocity, t):
    """Integral of the speed from 0 to t; the speed is a polynomial of degree 4, so 12 Gauss points are exact."""
    x, weights = np.polynomial.legendre.leggauss(12)
    return 0.5 * t * weights @ np.linalg.norm(velocity(0.5 * t * (x + 1)), axis=0)


def test_original_path_of_the_design():
    curve = original_path()
    assert curve.length_m == pytest.approx(557.9, abs=0.05)
    np.testing.assert_allclose(curve.point(202.5), (162, 101, 64.3), atol=0.06)
    tangent = curve.tangent(202.5)
    assert math.degrees(math.atan2(tangent[1], tangent[0])) == pytest.approx(24.7, abs=0.05)
    assert math.degrees(math.asin(tangent[2])) == pytest.approx(12.0, abs=0.05)
    assert curve.min_radius_m == pytest.approx(457, abs=1)
    assert np.degrees(curve.climb_range_rad()) == pytest.approx([2.82, 26.13], abs=0.01)


@given(data)
@percent(20)
def test_ends_are_met(drawn):
    curve, p0, d0, p1, d1 = curve_of(drawn)
    size = np.linalg.norm(p1 - p0)
    np.testing.assert_allclose(curve.point(0.0), p0, atol=1e-12)
    np.testing.assert_allclose(curve.point(curve.length_m), p1, atol=3e-13 * (1 + size + curve.length_m))
    np.testing.assert_allclose(curve.tangent(0.0), unit(d0), atol=1e-12)
    np.testing.assert_allclose(curve.tangent(curve.length_m), unit(d1), atol=1e-12)
    velocity = bernstein(curve)
    np.testing.assert_allclose(velocity(0.0), d0, atol=1e-12)
    np.testing.assert_allclose(velocity(1.0), d1, atol=1e-12)


@given(data)
@percent(20)
def test_length_is_the_integral_of_the_speed(drawn):
    curve, *_ = curve_of(drawn)
    velocity = bernstein(curve)
    assert curve.length_m == pytest.approx(way(velocity, 1.0), rel=1e-12)


def test_length_and_point_to_thirty_digits():
    curve = original_path()
    with mpmath.workdps(30):
        e = [mpmath.mpf(x) for x in curve.e]
        rows = [[mpmath.mpf(x) for x in a] for a in curve.a]

        def velocity(t):
            a = [rows[0][k] * (1 - t) ** 2 + 2 * rows[1][k] * t * (1 - t) + rows[2][k] * t * t for k in range(3)]
            w, s = sum(x * y for x, y in zip(a, e, strict=True)), sum(x * x for x in a)
            return [2 * w * a[k] - s * e[k] for k in range(3)]

        length = mpmath.quad(lambda t: mpmath.sqrt(sum(v * v for v in velocity(t))), [0, 0.5, 1])
        end = [mpmath.quad(lambda t, k=k: velocity(t)[k], [0, 1]) for k in range(3)]
    assert curve.length_m == pytest.approx(float(length), rel=1e-14)
    np.testing.assert_allclose(curve.point(curve.length_m), [float(x) for x in end], rtol=1e-13)


@given(data, st.floats(0.02, 0.98))
@percent(20)
def test_parameter_of_arc_length_and_back(drawn, share):
    curve, *_ = curve_of(drawn)
    velocity = bernstein(curve)
    t = curve.parameter(share * curve.length_m)
    assert way(velocity, t) == pytest.approx(share * curve.length_m, abs=1e-9 * curve.length_m)


@given(data, st.floats(0.02, 0.98))
@percent(20)
def test_tangent_and_curvature_are_the_derivatives_of_the_point(drawn, share):
    curve, *_ = curve_of(drawn)
    assume(curve.min_speed > 0.05)
    s, h = share * curve.length_m, 1e-3 * curve.length_m
    stencil = np.array([-2, -1, 0, 1, 2]) * h * 0.25
    near = np.array([curve.frame(s + x)[0] for x in stencil])
    first = (near[0] - 8 * near[1] + 8 * near[3] - near[4]) / (12 * 0.25 * h)
    second = (-near[0] + 16 * near[1] - 30 * near[2] + 16 * near[3] - near[4]) / (12 * (0.25 * h) ** 2)
    _, tangent, bend = curve.frame(s)
    scale = curve.max_curvature()
    np.testing.assert_allclose(tangent, first, atol=1e-6 * max(1.0, (scale * curve.length_m) ** 4))
    tolerance = 2e-5 * max(1.0, (scale * curve.length_m) ** 5)
    np.testing.assert_allclose(np.array(bend) * curve.length_m, second * curve.length_m, atol=tolerance)
    assert math.hypot(*tangent) == pytest.approx(1.0, abs=1e-12)
    assert np.dot(tangent, bend) == pytest.approx(0.0, abs=1e-9 * max(1.0, scale))
    assert curve.curvature(s) == pytest.approx(math.hypot(*bend))


@given(data)
@percent(20)
def test_sampled_equals_scalar(drawn):
    curve, *_ = curve_of(drawn)
    assume(curve.min_speed > 0.01)
    s = np.linspace(-0.1, 1.1, 40) * curve.length_m
    points, tangents, bends = curve.sample(s)
    frames = [curve.frame(x) for x in s]
    np.testing.assert_allclose(points, [f[0] for f in frames], atol=1e-11)
    np.testing.assert_array_equal(points, curve.points(s))
    np.testing.assert_allclose(tangents, [f[1] for f in frames], atol=1e-8)
    np.testing.assert_allclose(bends, [f[2] for f in frames], atol=1e-7 * max(1.0, curve.max_curvature()) ** 2)


@given(data)
@percent(20)
def test_extremes_bound_the_samples_and_are_reached(drawn):
    curve, *_ = curve_of(drawn)
    assume(curve.min_speed > 0.02)
    s = np.linspace(0.0, curve.length_m, 3000)
    _, tangents, bends = curve.sample(s)
    curvature, climb = np.linalg.norm(bends, axis=1), np.arcsin(np.clip(tangents[:, 2], -1, 1))
    top = curve.max_curvature()
    assert curvature.max() <= top * (1 + 1e-9) + 1e-12
    assert curvature.max() >= top * 0.98 - 1e-9
    low, high = curve.climb_range_rad()
    assert low - 1e-7 <= climb.min() <= low + 5e-3 + 2e-3 * top * curve.length_m / 6
    assert high + 1e-7 >= climb.max() >= high - 5e-3 - 2e-3 * top * curve.length_m / 6
    assert curve.min_radius_m == pytest.approx(1 / top) if top > 0 else math.isinf(curve.min_radius_m)


def rotation(q):
    a, b, c, d = unit(np.array(q))
    return np.array([[a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
                     [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
                     [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d]])  # fmt: skip


quaternion = st.tuples(component, component, component, component).filter(lambda q: math.hypot(*q) > 0.1)


def determined(p0, d0, p1, d1):
    """A tangent against the chord, all on one line, leaves the plane of the turn open: either side is as good, and one is chosen."""
    chord, t0, t1 = unit(p1 - p0), unit(d0), unit(d1)
    across = max(np.linalg.norm(np.cross(chord, t)) for t in (t0, t1))
    return across > 1e-6 or min(chord @ t0, chord @ t1) > 0.0


@given(data, quaternion, st.sampled_from([1.0, -1.0]), st.floats(0.01, 100.0))
@percent(20)
def test_turns_mirrors_and_scales_with_the_data(drawn, q, handed, unit_of_length):
    curve, p0, d0, p1, d1 = curve_of(drawn)
    assume(curve.min_speed > 0.01 and determined(p0, d0, p1, d1))
    m = unit_of_length * rotation(q) @ np.diag([1.0, 1.0, handed])
    turned = ph.hermite(m @ p0, m @ d0, m @ p1, m @ d1)
    share = np.linspace(0, 1, 9)
    assert turned.length_m == pytest.approx(unit_of_length * curve.length_m, rel=1e-9)
    expected = curve.sample(share * curve.length_m)[0] @ m.T
    np.testing.assert_allclose(turned.sample(share * turned.length_m)[0], expected, atol=1e-7 * unit_of_length * (10 + curve.length_m))


@given(data)
@percent(20)
def test_reverses_with_the_data(drawn):
    curve, p0, d0, p1, d1 = curve_of(drawn)
    assume(curve.min_speed > 0.01 and determined(p0, d0, p1, d1))
    back = ph.hermite(p1, -d1, p0, -d0)
    share = np.linspace(0, 1, 9)
    expected = curve.sample((1 - share) * curve.length_m)[0]
    np.testing.assert_allclose(back.sample(share * back.length_m)[0], expected, atol=1e-7 * (10 + curve.length_m))


@given(data)
@percent(20)
def test_planar_data_stay_planar(drawn):
    t0, chord, t1, lam0, lam1 = drawn
    t0, chord, t1 = (np.array([v[0], v[1], 0.0]) for v in (t0, chord, t1))
    assume(min(np.linalg.norm(v) for v in (t0, chord, t1)) > 0.05)
    curve, *_ = curve_of((t0, chord, t1, lam0, lam1))
    np.testing.assert_allclose(curve.sample(np.linspace(0, curve.length_m, 20))[0][:, 2], 3.0, atol=1e-10)


@pytest.mark.parametrize(("lam0", "lam1"), [(1.0, 1.0), (0.7, 1.4), (2.0, 0.5)])
def test_collinear_data_give_the_straight_line(lam0, lam1):
    direction = unit(np.array([3.0, -1.0, 0.7]))
    curve = ph.hermite((5, 6, 7), lam0 * 80 * direction, np.array([5, 6, 7]) + 80 * direction, lam1 * 80 * direction)
    assert curve.length_m == pytest.approx(80.0, rel=1e-14)
    assert curve.max_curvature() < 1e-15
    points, tangents, _ = curve.sample(np.linspace(0, 80, 11))
    np.testing.assert_allclose(points, np.array([5, 6, 7]) + np.linspace(0, 80, 11)[:, None] * direction, atol=1e-12)
    np.testing.assert_allclose(tangents, np.broadcast_to(direction, (11, 3)), atol=1e-15)
    assert np.ptp(curve.climb_range_rad()) < 1e-14


def test_order_of_convergence_is_four():
    def helix(u):
        return np.array([math.cos(u), math.sin(1.3 * u) + 0.2 * u * u, 0.4 * u + 0.1 * u**3])

    def rate(u):
        return np.array([-math.sin(u), 1.3 * math.cos(1.3 * u) + 0.4 * u, 0.4 + 0.3 * u * u])

    steps, errors = np.array([0.4, 0.2, 0.1, 0.05]), []
    for h in steps:
        curve = ph.hermite(helix(0.3), h * rate(0.3), helix(0.3 + h), h * rate(0.3 + h))
        sampled = np.array([helix(0.3 + h * x) for x in np.linspace(0.1, 0.9, 15)])
        errors.append(curve.nearest(sampled)[1].max())
    slope = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert slope == pytest.approx(4.0, abs=0.15)


@given(data, st.lists(vector, min_size=1, max_size=3))
@percent(20)
def test_nearest_is_the_nearest_of_many(drawn, offsets):
    curve, p0, *_ = curve_of(drawn)
    assume(curve.min_speed > 0.02)
    points = p0 + 2.0 * np.array(offsets)
    s, distance = curve.nearest(points)
    dense = curve.sample(np.linspace(0, curve.length_m, 1500))[0]
    brute = np.linalg.norm(dense[None] - points[:, None], axis=2)
    step = curve.length_m / 1499
    assert (distance <= brute.min(axis=1) + 1e-12).all()
    assert (distance >= brute.min(axis=1) - step).all()
    at = np.array([curve.frame(x)[0] for x in s])
    np.testing.assert_allclose(np.linalg.norm(at - points, axis=1), distance, atol=1e-9)
    for point, place, found in zip(points, brute.argmin(axis=1), distance, strict=True):
        bounds = ((place - 1) * step, (place + 1) * step)
        options = {"xatol": 1e-12}
        refined = minimize_scalar(lambda x, p=point: math.dist(curve.frame(x)[0], p), bounds=bounds, method="bounded", options=options)
        assert found <= refined.fun + 1e-9


def test_nearest_clamps_at_the_ends_and_is_exact_on_the_curve():
    curve = original_path()
    s, distance = curve.nearest(np.array([[-30.0, -40.0, 0.0], [600.0, 220.0, 105.0]]))
    assert s.tolist() == [0.0, curve.length_m]
    assert distance[0] == 50.0
    wanted = np.linspace(0, curve.length_m, 1001)
    s, distance = curve.nearest(curve.sample(wanted)[0])
    np.testing.assert_allclose(s, wanted, atol=1e-8)
    assert distance.max() < 1e-10


def test_beyond_the_ends_it_stays_at_the_end():
    curve = original_path()
    assert curve.frame(-5.0) == curve.frame(0.0)
    assert curve.frame(curve.length_m + 5.0) == curve.frame(curve.length_m)
    assert math.isfinite(curve.frame(math.nan)[0][0])


@pytest.mark.parametrize(("lam", "cusp", "loops"), [(4.9, False, False), (5.0, True, False), (6.5, False, True)])
def test_too_long_derivatives_are_reported(lam, cusp, loops):
    curve = ph.hermite((0, 0, 0), (100 * lam, 0, 0), (100, 0, 0), (100 * lam, 0, 0))
    assert (curve.min_speed < 1e-6) is cusp
    assert math.isinf(curve.max_curvature()) is cusp
    assert (curve.length_m > 110) is loops
    points, tangents, bends = curve.sample(np.linspace(0, curve.length_m, 50))
    assert np.isfinite(points).all()
    assert np.isfinite(tangents).all()
    assert np.isfinite(bends).all()


def test_u_turn_goes_to_the_side_of_its_end():
    for side in (1.0, -1.0):
        curve = ph.hermite((0, 0, 0), (100, 0, 0), (0, side * 60, 0), (-100, 0, 0))
        points = curve.sample(np.linspace(0, curve.length_m, 40))[0]
        assert (side * points[:, 1] > -1e-9).all()
        assert points[:, 0].max() > 10
        assert curve.min_speed > 0.1


@given(st.sampled_from([(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.6, 0, -0.8)]), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
@percent(20)
def test_reversed_data_behave(direction, ahead, beside):
    assume(abs(ahead) + abs(beside) > 0.01)
    x = np.array(direction, float)
    y = np.cross(x, (0.3, 0.4, 0.5))
    for d1 in (x, -x):
        curve = ph.hermite((0, 0, 0), x, ahead * x + beside * y, d1)
        points, tangents, bends = curve.sample(np.linspace(0, curve.length_m, 30))
        assert np.isfinite(points).all()
        assert np.isfinite(tangents).all()
        assert np.isfinite(bends).all()
        assert not math.isnan(curve.max_curvature())
        # beside a reversal the bisector of nearly opposite vectors keeps half of the digits
        np.testing.assert_allclose(points[-1], ahead * x + beside * y, atol=1e-7)


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_very_short_and_very_long(size):
    curve = ph.hermite((0, 0, 0), (size, 0, 0), (size, 0.3 * size, 0.1 * size), (size, 0, 0.1 * size))
    one = ph.hermite((0, 0, 0), (1, 0, 0), (1, 0.3, 0.1), (1, 0, 0.1))
    assert curve.length_m / size == pytest.approx(one.length_m, rel=1e-12)
    assert curve.max_curvature() * size == pytest.approx(one.max_curvature(), rel=1e-9)
    np.testing.assert_allclose(curve.point(0.4 * curve.length_m) / size, one.point(0.4 * one.length_m), atol=1e-11)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"d0_m": (0, 0, 0)}, "d0_m: give a non-zero end derivative"),
        ({"d1_m": (0, 0, 0)}, "d1_m: give a non-zero end derivative"),
        ({"d1_m": (math.nan, 0, 0)}, "d1_m: all three numbers must be finite"),
        ({"p1_m": (0, 0, 0)}, "p1_m: give an end point that differs"),
        ({"p0_m": (0, 0)}, "p0_m: give three numbers"),
    ],
)
def test_bad_data_say_what_to_do(changed, message):
    good = {"p0_m": (0, 0, 0), "d0_m": (1, 0, 0), "p1_m": (1, 1, 0), "d1_m": (1, 0, 0)}
    with pytest.raises(ValueError, match=message):
        ph.hermite(**(good | changed))


@pytest.mark.parametrize("points", [np.zeros(3), np.zeros((4, 2)), np.full((1, 3), np.nan)])
def test_nearest_refuses_what_is_not_points(points):
    with pytest.raises(ValueError, match=r"points: give an array of shape \(m, 3\)"):
        original_path().nearest(points)


def test_pickles_alike_cold_and_warm_and_is_frozen():
    cold, warm = original_path(), original_path()
    warm.sample(np.linspace(0, 500, 50))
    warm.max_curvature()
    assert pickle.dumps(cold) == pickle.dumps(warm)
    again = pickle.loads(pickle.dumps(warm))
    assert again == cold
    assert hash(again) == hash(cold)
    assert again.frame(123.4) == cold.frame(123.4)
    with pytest.raises(dataclasses.FrozenInstanceError):
        cold.e = (1.0, 0.0, 0.0)


def test_a_direction_that_is_off_by_next_to_nothing_overflows_nowhere():
    """A leading coefficient of some 1e-300: found by hypothesis as a flight to (0, 101, 0)."""
    end = math.radians(7.453075167976526e-159)
    curve = ph.hermite((0, 0, 0), (101, 0, 0), (0, 101, 0), (101 * math.cos(end), 0, 101 * math.sin(end)))
    level = ph.hermite((0, 0, 0), (101, 0, 0), (0, 101, 0), (101, 0, 0))
    assert curve.max_curvature() == pytest.approx(level.max_curvature(), rel=1e-12)
