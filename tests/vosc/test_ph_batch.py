"""Many curves at once, and the search for a flyable one."""

import math

import numpy as np
import pytest

from vosc import ph


@pytest.fixture(scope="module")
def rows():
    rng = np.random.default_rng(31)
    return rng.normal(size=(4, 60, 3)) * np.array([1, 1, 3, 1])[:, None, None]


def test_rows_are_the_single_curves(rows):
    p0, d0, p1, d1 = rows
    curves = ph.hermite_many(p0, d0, p1, d1)
    assert len(curves) == 60
    t = np.linspace(0, 1, 7)
    sigma, tangent, bend = curves.evaluate(t)
    for i in range(60):
        one = ph.hermite(p0[i], d0[i], p1[i], d1[i])
        np.testing.assert_allclose(curves.curve(i).a, one.a, atol=1e-11)
        assert curves.length_m()[i] == pytest.approx(one.length_m, rel=1e-12)
        inner = slice(1, -1) if one.min_speed < 0.01 else slice(None)
        s = [np.polynomial.Polynomial(one._arc)(x) for x in t[inner]]
        _, tangents, bends = one.sample(np.array(s))
        np.testing.assert_allclose(tangent[i, inner], tangents, atol=1e-6)
        np.testing.assert_allclose(bend[i, inner], bends, atol=1e-5 * max(1.0, np.abs(bends).max()) ** 2)
        assert sigma[i, 0] == pytest.approx(np.linalg.norm(d0[i]))


def test_one_row_is_broadcast():
    ends = np.array([[100, 10, 0], [100, 20, 5.0]])
    curves = ph.hermite_many(np.zeros(3), np.array([100, 0, 0.0]), ends, np.array([100, 0, 0.0]))
    assert curves.length_m()[1] == pytest.approx(ph.hermite((0, 0, 0), (100, 0, 0), ends[1], (100, 0, 0)).length_m)


def test_blocks_do_not_show():
    rng = np.random.default_rng(32)
    p0, d0, p1, d1 = rng.normal(size=(4, 5000, 3))
    whole = ph.hermite_many(p0, d0, p1, d1).length_m()
    parts = [ph.hermite_many(p0[k : k + 700], d0[k : k + 700], p1[k : k + 700], d1[k : k + 700]).length_m() for k in range(0, 5000, 700)]
    np.testing.assert_allclose(whole, np.concatenate(parts), rtol=1e-13)


def test_hopeless_rows_are_nan_and_the_others_are_not():
    d0 = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 0], [1, 0, 0.0]])
    p1 = np.array([[1, 0, 0], [0, 0, 0], [1, 0, 0], [0, 1, 0.0]])
    d1 = np.array([[1, 0, 0], [1, 0, 0], [1, 0, 0], [-1, 0, 0.0]])
    length = ph.hermite_many(np.zeros(3), d0, p1, d1).length_m()
    assert np.isnan(length).tolist() == [True, True, False, False]
    assert length[3] == pytest.approx(ph.hermite((0, 0, 0), (1, 0, 0), (0, 1, 0), (-1, 0, 0)).length_m)


def test_septic_has_the_wanted_curvature_and_ends(rows):
    p0, d0, p1, d1 = rows
    wanted = np.random.default_rng(33).normal(size=p0.shape)
    curves = ph.hermite_many(p0, d0, p1, d1, wanted)
    tangents = d0 / np.linalg.norm(d0, axis=1)[:, None]
    across = wanted - (wanted * tangents).sum(axis=1)[:, None] * tangents
    for i in range(60):
        one = curves.curve(i)
        np.testing.assert_allclose(one.frame(0.0)[2], across[i], atol=1e-9)
        np.testing.assert_allclose(one.tangent(0.0), tangents[i], atol=1e-12)
        np.testing.assert_allclose(one.point(one.length_m), p1[i], atol=1e-11 * (1 + one.length_m))
        np.testing.assert_allclose(one.tangent(one.length_m), d1[i] / np.linalg.norm(d1[i]), atol=1e-11)
        assert one.length_m == pytest.approx(curves.length_m()[i], rel=1e-11)


def test_septic_of_a_quintic_s_own_curvature_is_the_quintic(rows):
    p0, d0, p1, d1 = rows
    quintic = ph.hermite_many(p0, d0, p1, d1)
    septic = ph.hermite_many(p0, d0, p1, d1, quintic.evaluate(np.zeros(1))[2][:, 0])
    np.testing.assert_allclose(septic.length_m(), quintic.length_m(), rtol=1e-10)


def test_septic_arc_length_and_frames_agree_with_each_other():
    ends = np.zeros(3), np.array([100, 0, 0.0]), np.array([[120, 30, 10.0]]), np.array([90, 30, 0.0])
    one = ph.hermite_many(*ends, np.array([0, 0.004, 0.001])).curve(0)
    s = np.linspace(0, one.length_m, 4001)
    points, tangents, bends = one.sample(s)
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    assert chords == pytest.approx(one.length_m, rel=1e-6)
    step = s[1]
    np.testing.assert_allclose((points[2:] - points[:-2]) / (2 * step), tangents[1:-1], atol=1e-6)
    np.testing.assert_allclose((tangents[2:] - tangents[:-2]) / (2 * step), bends[1:-1], atol=1e-6)
    assert np.linalg.norm(bends, axis=1).max() == pytest.approx(one.max_curvature(), rel=1e-5)
    for x in (0.0, 30.0, 77.7):
        np.testing.assert_allclose(one.frame(x), np.array(one.sample(np.array([x])))[:, 0], atol=1e-12)
    found, distance = one.nearest(points[::100])
    np.testing.assert_allclose(found, s[::100], atol=1e-7)
    assert distance.max() < 1e-9


GENTLE = ph.Limits(speed_mps=50.0, max_curvature_per_m=1 / 150, min_climb_rad=-0.3, max_climb_rad=0.3, max_bank_rate_radps=1.2)


def bank_rate(curve, speed, g=9.80665):
    """Bank of a coordinated turn from finite differences of the tangent, written out on its own."""
    s = np.linspace(0, curve.length_m, 3001)
    tangents = np.array([curve.tangent(x) for x in s])
    push = speed**2 * np.gradient(tangents, s, axis=0) + np.array([0, 0, g])
    right = np.cross(tangents, [0, 0, 1.0])
    right /= np.linalg.norm(right, axis=1)[:, None]
    up = np.cross(right, tangents)
    bank = np.arctan2((push * right).sum(axis=1), (push * up).sum(axis=1))
    return np.abs(np.gradient(np.unwrap(bank), s))[5:-5].max() * speed


@pytest.mark.parametrize("bend", [None, (0.0, 0.0, 0.0), (0.0, 1 / 400, 0.0003)])
def test_flyable_keeps_what_it_promises(bend):
    found = ph.flyable((0, 0, 0), (1, 0, 0), (400, 100, 20), (1, 0.3, 0), GENTLE, bend)
    assert found.ok
    assert found.missed == ()
    curve = found.curve
    np.testing.assert_allclose(curve.point(0), (0, 0, 0), atol=1e-9)
    np.testing.assert_allclose(curve.point(curve.length_m), (400, 100, 20), atol=1e-8)
    np.testing.assert_allclose(curve.tangent(curve.length_m), np.array([1, 0.3, 0]) / math.hypot(1, 0.3), atol=1e-9)
    assert curve.max_curvature() <= 1 / 150 * (1 + 1e-9)
    low, high = curve.climb_range_rad()
    assert -0.3 <= low <= high <= 0.3
    assert bank_rate(curve, 50.0) <= 1.2 * 1.02
    assert found.max_bank_rate_radps == pytest.approx(bank_rate(curve, 50.0), rel=0.05)
    assert found.max_curvature_per_m == curve.max_curvature()
    if bend is not None:
        np.testing.assert_allclose(curve.frame(0.0)[2], bend, atol=1e-9)


@pytest.mark.parametrize(
    ("limits", "missed"),
    [
        (ph.Limits(50.0, max_curvature_per_m=1 / 2000), ("curvature",)),
        (ph.Limits(50.0, max_climb_rad=0.01), ("climb_up",)),
        (ph.Limits(50.0, max_bank_rate_radps=0.01), ("bank_rate",)),
        (ph.Limits(50.0, max_curvature_per_m=1 / 2000, max_climb_rad=0.01), ("curvature", "climb_up")),
    ],
)
def test_the_limit_that_cannot_be_met_is_named(limits, missed):
    found = ph.flyable((0, 0, 0), (1, 0, 0), (400, 100, 20), (1, 0.3, 0), limits)
    assert not found.ok
    assert found.missed == missed
    assert not found.together
    assert all(name in found.message for name in missed)
    assert found.curve is not None


@pytest.mark.slow
def test_limits_that_exclude_each_other_are_said_to():
    """A climbing turn: the least climb wants short end derivatives, the least curvature longer ones."""

    def search(curvature=math.inf, climb=1.5):
        limits = ph.Limits(50.0, max_curvature_per_m=curvature, max_climb_rad=climb)
        return ph.flyable((0, 0, 0), (1, 0, 0), (250, 150, 60), (0.5, 1, 0), limits)

    def least(make, low, high):
        for _ in range(12):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if make(middle).ok else (middle, high)
        return high

    curvature, climb = least(lambda k: search(curvature=k), 1e-3, 0.05), least(lambda c: search(climb=c), 0.05, 1.0)
    both = search(1.002 * curvature, 1.002 * climb)
    assert not both.ok
    assert both.together
    assert both.missed
    assert "not together" in both.message


def test_the_paper_s_insertion_pose_cannot_be_reached_above_103_m_radius(table_1):
    own, obstacle = table_1("azimuth_106")
    from vosc import insertion_point
    from vosc.methods import avoid

    target, heading = insertion_point(own, obstacle).point_m, avoid("scoam", own, [obstacle]).velocity_mps
    found = ph.flyable(own.pos_m, own.vel_mps, target, heading, ph.Limits(50.0, max_curvature_per_m=1 / 103.0))
    assert not found.ok
    assert found.missed == ("curvature",)
    assert 80 < found.curve.min_radius_m < 103


def test_offered_ends_are_searched():
    points = [(400, 300, 0), (400, 40, 0), (400, -350, 0)]
    found = ph.flyable((0, 0, 0), (1, 0, 0), points, [(0, 1, 0), (1, 0, 0)], ph.Limits(50.0, max_curvature_per_m=1 / 150))
    assert found.ok
    assert (found.point, found.direction) == (1, 1)
    np.testing.assert_allclose(found.curve.point(found.curve.length_m), points[1], atol=1e-8)


@pytest.mark.slow
def test_no_random_candidate_within_the_limits_is_shorter():
    found = ph.flyable((0, 0, 0), (1, 0, 0), (400, 100, 20), (1, 0.3, 0), GENTLE)
    rng = np.random.default_rng(34)
    chord, end = math.dist((0, 0, 0), (400, 100, 20)), np.array([1, 0.3, 0]) / math.hypot(1, 0.3)
    for _ in range(150):
        a, b = rng.uniform(0.4, 3.0, 2)
        curve = ph.hermite((0, 0, 0), (a * chord, 0, 0), (400, 100, 20), b * chord * end)
        low, high = curve.climb_range_rad()
        if curve.max_curvature() <= 1 / 150 and -0.3 <= low <= high <= 0.3 and bank_rate(curve, 50.0) <= 1.15:
            assert curve.length_m >= found.curve.length_m * (1 - 1e-3)


def test_straight_reversed_very_short_and_very_long():
    straight = ph.flyable((0, 0, 0), (1, 0, 0), (300, 0, 0), (1, 0, 0), GENTLE, (0, 0, 0))
    assert straight.ok
    assert straight.curve.length_m == pytest.approx(300)
    back = ph.flyable((0, 0, 0), (1, 0, 0), (0, 400, 0), (-1, 0, 0), GENTLE)
    assert back.ok
    assert back.curve.min_radius_m >= 150
    behind = ph.flyable((0, 0, 0), (1, 0, 0), (-300, 0, 0), (1, 0, 0), GENTLE)
    assert not behind.ok
    short = ph.flyable((0, 0, 0), (1, 0, 0), (1e-3, 2e-4, 0), (1, 0, 0), GENTLE)
    assert "curvature" in short.missed
    long = ph.flyable((0, 0, 0), (1, 0, 0), (1e6, 2e5, 0), (1, 0, 0), GENTLE)
    assert long.ok


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ph.Limits(0.0), "Limits.speed_mps"),
        (lambda: ph.Limits(50.0, max_curvature_per_m=0.0), "curvature and a bank rate above 0"),
        (lambda: ph.Limits(50.0, min_climb_rad=0.2, max_climb_rad=0.1), "climb range"),
        (lambda: ph.flyable((0, 0, 0), (0, 0, 0), (1, 0, 0), (1, 0, 0), GENTLE), "non-zero directions"),
        (lambda: ph.flyable((0, 0, 0), (1, 0, 0), (0, 0, 0), (1, 0, 0), GENTLE), "p1_m: give end points that differ"),
        (lambda: ph.flyable((0, 0, 0), (1, 0, 0), (1, 0, 0), (1, 0, 0), GENTLE, magnitudes=(1.0, 5.0)), "magnitudes"),
        (lambda: ph.flyable((0, 0, math.nan), (1, 0, 0), (1, 0, 0), (1, 0, 0), GENTLE), "p0_m: all three"),
    ],
)
def test_bad_input_says_what_to_do(make, message):
    with pytest.raises(ValueError, match=message):
        make()
