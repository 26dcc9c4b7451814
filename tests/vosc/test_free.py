"""The exact search itself: curves and roots against independent evaluations, small gaps, dense scenes."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from vosc import free
from vosc.cone import Cone, cone_of, is_free, loop_point, loops_of, outside, peaks, zero
from vosc.crowd import exact_cones
from vosc.vec import norm


def test_loops_lie_on_the_sphere_and_on_the_cone(scenes):
    rng = np.random.default_rng(11)
    kinds = set()
    for _ in range(200):
        own, (obstacle,) = scenes.encounter(rng, 1)
        cone = cone_of(own, obstacle)
        for loop in loops_of(cone, 50.0):
            kinds.add((loop.e > 0, loop.half > 0, loop.sign))
            for theta in rng.uniform(0, 2 * np.pi, 8):
                v = np.array(loop_point(loop, theta))
                assert np.linalg.norm(v) == pytest.approx(50.0, rel=1e-10)
                w = v - np.array(obstacle.vel_mps)
                if np.linalg.norm(w) > 1e-3:
                    p = np.subtract(obstacle.pos_m, own.pos_m)
                    cosine = w @ p / np.linalg.norm(w) / np.linalg.norm(p)
                    assert cosine == pytest.approx(math.sqrt(1 - (obstacle.radius_m / np.linalg.norm(p)) ** 2), abs=1e-9)
    assert kinds == {(True, False, 1.0), (False, False, 1.0), (False, False, -1.0), (False, True, 0.0)}


def test_vectorised_samples_equal_the_scalar_ones(scenes):
    rng = np.random.default_rng(12)
    for _ in range(100):
        own, obstacles = scenes.encounter(rng, 3)
        loops = [loop for o in obstacles for loop in loops_of(cone_of(own, o), 50.0)]
        if loops:
            grid = 2 * np.pi * np.arange(free.GRID) / free.GRID
            expected = [[loop_point(loop, float(t)) for t in grid] for loop in loops]
            np.testing.assert_allclose(free._sample(loops), expected, atol=1e-5)


def test_peaks_are_the_best_points_of_the_loop(scenes):
    rng = np.random.default_rng(13)
    for _ in range(80):
        own, (obstacle,) = scenes.encounter(rng, 1)
        towards = scenes.sized(rng, 1.0)
        for loop in loops_of(cone_of(own, obstacle), 50.0):
            found = max(np.dot(v, towards) for v in peaks(loop, tuple(towards)))
            grid = np.linspace(0, 2 * np.pi, 361)
            value = [np.dot(loop_point(loop, t), towards) for t in grid.tolist()]
            t = grid[int(np.argmax(value))]
            bounds = (t - 0.02, t + 0.02)
            refined = minimize_scalar(lambda x, c=loop, d=towards: -np.dot(loop_point(c, x), d), bounds=bounds, method="bounded")
            assert found >= max(*value, -refined.fun) - 1e-6


def test_zero_of_functions_with_a_known_one():
    assert zero(lambda x: x**3 - 2.0, 0.0, 3.0, -2.0, 25.0) == pytest.approx(2 ** (1 / 3), abs=1e-11)
    assert zero(lambda x: math.atan(50 * (x - 0.3)), 0.0, 1.0, math.atan(-15), math.atan(35)) == pytest.approx(0.3, abs=1e-11)
    assert free.zeros(lambda x: (x - 0.4) ** 2 - 1e-6, 0.0, 1.0) == pytest.approx([0.399, 0.401], abs=1e-9)
    assert free.zeros(lambda x: (x - 0.4) ** 2 + 1e-6, 0.0, 1.0) == []
    assert free.zeros(lambda x: 1.0 + x, 0.0, 1.0) == []


def slit(gap_rad):
    """Two half-spheres with a slit of ``gap_rad`` between them straight on, and a small circle on it."""
    tilt = 0.5 * math.pi + 0.5 * gap_rad
    halves = [Cone((0.0, 0.0, 0.0), (math.cos(tilt), s * math.sin(tilt), 0.0), 0.0, 1.0) for s in (-1, 1)]
    return [*halves, Cone((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), math.cos(0.2), math.sin(0.2))]


@pytest.mark.parametrize("gap_rad", [1e-2, 1e-4, 1e-6])
def test_a_narrow_slit_is_found(gap_rad):
    """The slit is free above and below the small circle, 0.2 rad away; without it the nearest free direction is straight up."""
    found = free.nearest_free(slit(gap_rad), 50.0, (1.0, 0.0, 0.003))
    assert math.acos(found[0] / 50) == pytest.approx(0.2, abs=1e-9)
    assert abs(found[1]) <= 50 * gap_rad
    assert found[2] > 0
    closed = free.nearest_free(slit(-1e-2), 50.0, (1.0, 0.0, 0.003))
    assert math.acos(closed[0] / 50) > 1.5


def test_dense_scenes_agree_with_a_finer_sampling(scenes, monkeypatch):
    rng = np.random.default_rng(14)
    drawn = [scenes.encounter(rng, 30) for _ in range(6)]
    coarse = [free.nearest_free(exact_cones(*s), 50.0, s[0].vel_mps) for s in drawn]
    monkeypatch.setattr(free, "GRID", 384)
    monkeypatch.setattr(free, "_THETA", 2 * np.pi * np.arange(384) / 384)
    monkeypatch.setattr(free, "_STEP", 2 * math.pi / 384)
    monkeypatch.setattr(free, "_AFTER", np.arange(1, 385) % 384)
    monkeypatch.setattr(free, "_BEFORE", np.arange(-1, 383) % 384)
    for (own, obstacles), found in zip(drawn, coarse, strict=True):
        fine = free.nearest_free(exact_cones(own, obstacles), 50.0, own.vel_mps)
        assert (fine is None) == (found is None)
        if fine is not None:
            np.testing.assert_allclose(found, fine, atol=1e-7)
            assert is_free(exact_cones(own, obstacles), found)


def test_blocks_do_not_change_the_answer(scenes, monkeypatch):
    own, obstacles = scenes.encounter(np.random.default_rng(15), 40)
    whole = free.nearest_free(exact_cones(own, obstacles), 50.0, own.vel_mps)
    monkeypatch.setattr(free, "BLOCK", 1000)
    assert free.nearest_free(exact_cones(own, obstacles), 50.0, own.vel_mps) == whole


def test_the_sieve_of_crowded_scenes_does_not_change_the_answer(scenes, monkeypatch):
    rng = np.random.default_rng(18)
    drawn = [scenes.encounter(rng, 80) for _ in range(4)]
    sieved = [free.nearest_free(exact_cones(*s), 50.0, s[0].vel_mps) for s in drawn]
    monkeypatch.setattr(free, "CROWD", 10**9)
    monkeypatch.setattr(free, "BLOCK", 10**8)
    assert [free.nearest_free(exact_cones(*s), 50.0, s[0].vel_mps) for s in drawn] == sieved
    assert any(v is not None for v in sieved)


def test_outside_is_the_sine_of_the_margin(scenes):
    rng = np.random.default_rng(16)
    for _ in range(50):
        own, (obstacle,) = scenes.encounter(rng, 1)
        v, p = scenes.sized(rng, 50.0), np.subtract(obstacle.pos_m, own.pos_m)
        w = v - np.array(obstacle.vel_mps)
        alpha = math.acos(np.clip(w @ p / np.linalg.norm(w) / np.linalg.norm(p), -1, 1))
        expected = math.sin(alpha - math.asin(obstacle.radius_m / np.linalg.norm(p)))
        assert outside(cone_of(own, obstacle), tuple(v)) == pytest.approx(expected, abs=1e-7)
    cone = cone_of(own, obstacle)
    assert outside(cone, cone.apex) == 1.0


def test_reach_is_the_distance_to_the_cone(scenes):
    rng = np.random.default_rng(17)
    for _ in range(20):
        own, (obstacle,) = scenes.encounter(rng, 1)
        cone = cone_of(own, obstacle)
        v = scenes.sized(rng, 60.0)
        reach = free._reach(cone, tuple(v))
        tried = v + rng.normal(size=(4000, 3)) * 60
        w = tried - np.array(cone.apex)
        inside = w @ np.array(cone.axis) > cone.cos * np.linalg.norm(w, axis=1)
        if inside.any():
            assert np.linalg.norm(tried[inside] - v, axis=1).min() >= reach - 1e-9
        if outside(cone, tuple(v)) > 0:
            assert reach > 0.0
        else:
            assert reach == 0.0
    assert norm((3.0, 4.0, 0.0)) == 5.0
