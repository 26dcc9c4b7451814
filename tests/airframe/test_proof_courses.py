"""The paths on which aircraft are proved."""

import math

import numpy as np
import pytest

from testbed.airframe.proof_courses import random_path, swerve, turn_radius
from testbed.core.units import DEG
from testbed.flight.route.path import ActivePath


def curvature(path: ActivePath) -> np.ndarray:
    return np.vstack([curve.sample(np.linspace(0.0, curve.length_m, 40))[2] for curve in path.curves])


def test_swerve_turns_from_side_to_side() -> None:
    path = swerve(4)
    assert path.length_m == pytest.approx(600.0, abs=0.1)
    for s, heading in ((0.0, -15.0), (150.0, 15.0), (300.0, -15.0), (600.0, -15.0)):
        _, (tx, ty, tz), _ = path.frame(min(s, path.length_m))
        assert math.atan2(ty, tx) / DEG == pytest.approx(heading, abs=0.05)
        assert tz == pytest.approx(0.0, abs=1e-12)
    assert np.linalg.norm(path.frame(0.0)[2]) < 0.02 * 15.0 * DEG * math.pi / 150.0
    assert np.linalg.norm(curvature(path), axis=1).max() == pytest.approx(15.0 * DEG * math.pi / 150.0, rel=0.02)


def test_joints_have_no_step_in_curvature_worth_mention() -> None:
    path = swerve(2)
    ends = [curve.frame(curve.length_m)[2] for curve in path.curves[:-1]]
    starts = [curve.frame(0.0)[2] for curve in path.curves[1:]]
    steps = [math.dist(a, b) for a, b in zip(ends, starts, strict=True)]
    assert max(steps) < 0.01 * np.linalg.norm(curvature(path), axis=1).max()


@pytest.mark.parametrize("seed", range(8))
def test_random_paths_keep_their_radius_and_climb(seed: int) -> None:
    radius, climb = 150.0, 15.0 * DEG
    path = random_path(np.random.default_rng(seed), radius, climb)
    assert 1.0 / np.linalg.norm(curvature(path), axis=1).max() == pytest.approx(radius, rel=0.02)
    tangents = np.vstack([curve.sample(np.linspace(0.0, curve.length_m, 40))[1] for curve in path.curves])
    assert np.abs(np.arcsin(tangents[:, 2])).max() <= climb * 1.01


def test_turn_radius() -> None:
    assert turn_radius(50.0, 45.0 * DEG) == pytest.approx(2500.0 / 9.80665)
