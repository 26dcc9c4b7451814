"""Meshes and line sets."""

import math

import numpy as np
import pytest

from testbed.show import shapes


def test_turning_keeps_lengths_and_takes_x_to_the_axis() -> None:
    axes = np.array([[1.0, 0, 0], [0, 2.0, 0], [0, 0, -3.0], [-1.0, 0, 0], [-1.0, 1e-9, 0], [0.3, -0.5, 0.8]])
    points = np.broadcast_to([[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]], (len(axes), 3, 3))
    turned = shapes.turned_from_x_axis(points, axes)
    for axis, (x, y, z) in zip(axes, turned, strict=True):
        assert x == pytest.approx(axis / np.linalg.norm(axis), abs=1e-8)
        assert np.cross(x, y) == pytest.approx(z, abs=1e-8)
        assert np.linalg.norm(y) == pytest.approx(1.0)


def test_caps_and_circles_lie_on_the_unit_sphere_within_their_angle() -> None:
    angles = np.array([0.1, 0.9])
    caps, rims = shapes.caps(angles), shapes.circles(angles)
    assert np.linalg.norm(caps, axis=2) == pytest.approx(np.ones(caps.shape[:2]))
    assert np.arccos(caps[:, :, 0]).max(axis=1) == pytest.approx(angles)
    assert np.arccos(rims[:, :, 0]) == pytest.approx(np.repeat(angles[:, None], rims.shape[1], axis=1))
    assert shapes.cap_triangles().max() == caps.shape[1] - 1
    assert shapes.cone_triangles().max() == rims.shape[1] - 1


def test_aeroplane_is_as_long_as_asked_symmetric_and_points_forward() -> None:
    mesh = shapes.aeroplane(10.0)
    assert np.ptp(mesh.points[:, 0]) == pytest.approx(10.0)
    assert mesh.points[:, 1].max() == pytest.approx(-mesh.points[:, 1].min())
    assert mesh.points[:, 2].min() < -1.0  # the fin points up: z is down
    assert mesh.triangles.max() < len(mesh.points)
    assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(np.ones(len(mesh.points)))


def test_graticule_is_on_the_unit_sphere() -> None:
    for line in shapes.graticule():
        assert np.linalg.norm(line, axis=1) == pytest.approx(np.ones(len(line)))
        assert math.isfinite(line.sum())
