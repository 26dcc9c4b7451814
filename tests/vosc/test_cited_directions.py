"""The directions of methods that the paper cites, each against its own condition written out."""

import math

import numpy as np
import pytest

from vosc import Obstacle, Own
from vosc.methods import avoid
from vosc.methods.interfered_fluid import gamma, stream
from vosc.methods.tangent_lyapunov import wanted

V = 50.0


@pytest.fixture(scope="module")
def encounters(scenes):
    """Single threats with a slower obstacle."""
    rng, out = np.random.default_rng(8), []
    while len(out) < 40:
        own, (obstacle,) = scenes.encounter(rng, 1)
        threatened = avoid("none", own, [obstacle]).status not in ("clear", "inside")
        if threatened and np.linalg.norm(obstacle.vel_mps) < 0.95 * np.linalg.norm(own.vel_mps):
            out.append((own, obstacle))
    return out


def relative(own, obstacle, velocity):
    return np.asarray(velocity) - np.array(obstacle.vel_mps), np.subtract(obstacle.pos_m, own.pos_m)


def test_in_the_plane_of_the_encounter_one_plane_turns_no_more_than_scoam(encounters):
    equal = 0
    for own, obstacle in encounters:
        ours, paper = avoid("one_plane", own, [obstacle]), avoid("scoam", own, [obstacle])
        assert ours.status == "avoided"
        assert ours.margin_rad == pytest.approx(0.0, abs=1e-8)
        w, p = relative(own, obstacle, own.vel_mps)
        normal = np.cross(p, w) / np.linalg.norm(np.cross(p, w))
        assert ours.velocity_mps @ normal == pytest.approx(np.array(own.vel_mps) @ normal, abs=1e-6)  # what is across the plane stays
        assert ours.deflection_rad <= paper.deflection_rad + 1e-9
        equal += np.allclose(ours.velocity_mps, paper.velocity_mps, atol=1e-6)
    assert equal > 30


@pytest.mark.parametrize(("plane", "kept"), [("horizontal", "climb"), ("vertical", "azimuth")])
def test_one_plane_turns_in_the_plane_that_was_chosen(encounters, plane, kept):
    for own, obstacle in encounters:
        answer = avoid("one_plane", own, [obstacle], plane=plane)
        if answer.status == "avoided":
            u, v = np.array(own.vel_mps), answer.velocity_mps
            if kept == "climb":
                assert v[2] == pytest.approx(u[2], abs=1e-9)
            else:
                assert v[0] * u[1] == pytest.approx(v[1] * u[0], abs=1e-6)


def test_the_search_is_too_far_by_less_than_a_step(encounters):
    for own, obstacle in encounters[:15]:
        least = avoid("least_deflection", own, [obstacle]).deflection_rad
        found = avoid("outward_search", own, [obstacle], step_deg=0.5, bearings=180)
        assert found.status == "avoided"
        assert -1e-9 <= found.deflection_rad - least < math.radians(1.0)
        assert math.degrees(found.deflection_rad) % 0.5 == pytest.approx(0.0, abs=1e-6) or math.degrees(
            found.deflection_rad
        ) % 0.5 == pytest.approx(0.5, abs=1e-6)


def test_outside_the_circle_the_relative_velocity_touches_it(encounters):
    for own, obstacle in encounters:
        answer = avoid("tangent_lyapunov", own, [obstacle], standoff=1.01)
        if np.linalg.norm(np.subtract(obstacle.pos_m, own.pos_m)) < 1.01 * obstacle.radius_m or answer.status == "undefined":
            continue
        w, p = relative(own, obstacle, answer.velocity_mps)
        assert np.linalg.norm(np.cross(p, w)) / np.linalg.norm(w) == pytest.approx(1.01 * obstacle.radius_m, rel=1e-9)
        same = avoid("tangent_lyapunov", own, [obstacle], standoff=1.0)
        np.testing.assert_allclose(same.velocity_mps, avoid("scoam", own, [obstacle]).velocity_mps, atol=1e-6)


def test_inside_the_circle_it_is_the_field_of_the_paper_that_is_cited():
    """The field f written out in the plane: x towards the aircraft, y against the side on which it passes."""
    own, obstacle, circle = Own((0, 0, 0), (V, 0, 0)), Obstacle((30, 4, 0), (-10, 0, 0), 25), 45.0
    place = np.subtract(own.pos_m, obstacle.pos_m)[:2]
    r = np.linalg.norm(place)
    x_axis = place / r
    w = np.array([60.0, 0.0])
    across = w - (w @ x_axis) * x_axis
    y_axis = across / np.linalg.norm(across)
    x, y = r, 0.0
    fx = -(x * (r**2 - circle**2) + 2 * y * r * circle)
    fy = -(y * (r**2 - circle**2) - 2 * x * r * circle)
    field = fx * x_axis + fy * y_axis
    np.testing.assert_allclose(wanted(own, obstacle, circle)[:2], field / np.linalg.norm(field), atol=1e-12)
    on_it = wanted(own, obstacle, r)  # on the circle the field runs along it
    assert np.dot(on_it[:2], x_axis) == pytest.approx(0.0, abs=1e-9)
    assert avoid("tangent_lyapunov", own, [obstacle], standoff=1.8).status == "avoided"


def test_nothing_flows_into_a_sphere(encounters):
    for own, obstacle in encounters:
        w, p = relative(own, obstacle, own.vel_mps)
        n = -p / np.linalg.norm(p)
        touching = Obstacle(obstacle.pos_m, obstacle.vel_mps, float(np.linalg.norm(p)) * (1 - 1e-9))
        assert np.dot(stream(own, touching, 1.0, 1.0), n) == pytest.approx(0.0, abs=1e-6 * np.linalg.norm(w))
        # elsewhere it is the matrix M, written out
        level = gamma(own, obstacle)
        t = w - (w @ n) * n
        t /= np.linalg.norm(t)
        rho, sigma = 2.0, 0.7
        matrix = np.eye(3) - np.outer(n, n) / level ** (1 / rho) + math.copysign(1.0, w @ n) * np.outer(t, n) / level ** (1 / sigma)
        np.testing.assert_allclose(stream(own, obstacle, rho, sigma), matrix @ w, atol=1e-9)


@pytest.mark.parametrize(
    ("method", "options"),
    [
        ("one_plane", {"plane": "slanted"}),
        ("outward_search", {"step_deg": 0.0}),
        ("outward_search", {"bearings": 2}),
        ("tangent_lyapunov", {"standoff": 0.9}),
        ("interfered_fluid", {"rho": math.nan}),
    ],
)
def test_options_that_mean_nothing_are_refused(method, options, encounters):
    own, obstacle = encounters[0]
    with pytest.raises(ValueError, match=next(iter(options))):
        avoid(method, own, [obstacle], **options)
