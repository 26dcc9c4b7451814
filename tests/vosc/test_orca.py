"""The half-spaces and the linear programme against definitions written out separately; RVO2-3D itself where it is installed."""

import importlib.util
import math

import numpy as np
import pytest
from scipy.optimize import minimize

from vosc import Obstacle, Own
from vosc.methods import avoid
from vosc.methods.orca import half_space, least_violating, nearest_in_ball


def nearest_on_the_cone(own, obstacle, horizon_s, n=400):
    """The point of the truncated cone's surface nearest to the relative velocity: brute force over cone and cap, then refined."""
    p, w = np.subtract(obstacle.pos_m, own.pos_m), np.subtract(own.vel_mps, obstacle.vel_mps)
    d, r = np.linalg.norm(p), obstacle.radius_m
    a = p / d
    b = np.cross(a, np.eye(3)[np.argmin(np.abs(a))])
    b /= np.linalg.norm(b)
    c = np.cross(a, b)
    alpha0 = math.asin(r / d)
    tangent = math.sqrt(d * d - r * r) / horizon_s

    def surface(along, round_):
        q = math.cos(alpha0) * a + math.sin(alpha0) * (math.cos(round_) * b + math.sin(round_) * c)
        if along >= 0:
            return (tangent + along) * q
        lean = (0.5 * math.pi - alpha0) * min(1.0, -along / 50.0)  # over the cap, from the tangent circle to its nearest point
        side = math.cos(round_) * b + math.sin(round_) * c
        beam = 0.5 * math.pi - alpha0 - lean
        return p / horizon_s + r / horizon_s * (math.sin(beam) * side - math.cos(beam) * a)

    def cost(x):
        return float(np.linalg.norm(surface(*x) - w))

    starts = [(s, t) for s in np.linspace(-50, 150, 21) for t in np.linspace(0, 2 * np.pi, 13)]
    starts = sorted(starts, key=cost)[:4]
    options = {"xatol": 1e-9, "fatol": 1e-12, "maxiter": 4000}
    best = min((minimize(cost, s, method="Nelder-Mead", options=options) for s in starts), key=lambda m: m.fun)
    return surface(*best.x), w


def test_half_space_is_the_nearest_way_out(scenes):
    rng = np.random.default_rng(21)
    for k in range(6):
        own, (obstacle,) = scenes.encounter(rng, 1)
        horizon_s = (4.0, 1e6)[k % 2]
        near, w = nearest_on_the_cone(own, obstacle, horizon_s)
        space = half_space(own, obstacle, 1.0, horizon_s)
        u = near - w
        edge = np.array(own.vel_mps) + u
        assert np.dot(space.normal, edge) == pytest.approx(space.offset, abs=2e-3)
        assert abs(np.dot(space.normal, u)) == pytest.approx(np.linalg.norm(u), abs=2e-3)
        half = half_space(own, obstacle, 0.5, horizon_s)
        assert np.dot(half.normal, np.array(own.vel_mps) + 0.5 * u) == pytest.approx(half.offset, abs=2e-3)


def test_full_responsibility_is_safe_and_half_is_not(scenes):
    rng = np.random.default_rng(22)
    seen = []
    for _ in range(60):
        own, obstacles = scenes.encounter(rng, 1)
        full, half = avoid("orca", own, obstacles), avoid("orca", own, obstacles, responsibility=0.5)
        if full.status == "avoided":
            seen.append(half.status)
            assert half.deflection_rad < full.deflection_rad
    assert len(seen) > 15
    assert set(seen) == {"unsafe"}


def test_a_horizon_lets_far_obstacles_pass():
    own, far = Own((0, 0, 0), (50, 0, 0)), Obstacle((1000, 1, 0), (0, 0, 0), 25)
    assert avoid("orca", own, [far]).deflection_rad > 0.02
    assert avoid("orca", own, [far], horizon_s=5.0).deflection_rad == pytest.approx(0.0, abs=1e-12)
    assert avoid("orca", own, [far], horizon_s=5.0).status == "unsafe"  # inside the untruncated cone all the same


def test_programme_against_a_general_optimiser():
    rng = np.random.default_rng(23)
    solved = 0
    for _ in range(25):
        normals = rng.normal(size=(6, 3))
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        offsets = rng.uniform(-1.5, 0.3, 6)
        wanted = rng.normal(size=3)
        spaces = [type("H", (), {"normal": tuple(n), "offset": float(o)})() for n, o in zip(normals, offsets, strict=True)]
        mine = nearest_in_ball(spaces, tuple(wanted), 1.0)
        bounds = {
            "type": "ineq",
            "fun": lambda v, n=normals, o=offsets: np.append(n @ v - o, 1.0 - v @ v),
            "jac": lambda v, n=normals: np.vstack([n, -2.0 * v]),
        }
        theirs = minimize(
            lambda v, g=wanted: (v - g) @ (v - g),
            np.zeros(3),
            jac=lambda v, g=wanted: 2.0 * (v - g),
            constraints=bounds,
            method="SLSQP",
            options={"ftol": 1e-14},
        )
        if theirs.success:
            solved += 1
            assert mine is not None
            np.testing.assert_allclose(mine, theirs.x, atol=1e-5)
    assert solved > 15
    opposite = [type("H", (), {"normal": (s, 0.0, 0.0), "offset": 0.1})() for s in (1.0, -1.0)]
    assert nearest_in_ball(opposite, (0.0, 0.0, 0.0), 1.0) is None


def test_slower_speeds_are_allowed_without_keep_speed(table_1):
    own, obstacle = table_1("azimuth_106")
    free = avoid("orca", own, [obstacle], keep_speed=False)
    kept = avoid("orca", own, [obstacle])
    assert free.status == kept.status == "avoided"
    assert np.linalg.norm(free.velocity_mps) <= 50.0 + 1e-9
    change = [np.linalg.norm(a.velocity_mps - np.array(own.vel_mps)) for a in (free, kept)]
    assert change[0] <= change[1] + 1e-9


def squeezed(rng, count):
    """Spheres that close in from all sides, so that the half-spaces seldom have a common point."""
    out = rng.normal(size=(count, 3))
    out *= (rng.uniform(40, 120, count) / np.linalg.norm(out, axis=1))[:, None]
    return [Obstacle(tuple(p), tuple(-p * rng.uniform(0.2, 0.6) + 8 * rng.normal(size=3)), 30.0) for p in out]


def violation(spaces, v):
    return max(h.offset - np.dot(h.normal, v) for h in spaces)


def test_where_there_is_no_common_point_the_worst_is_violated_least(brute):
    """Of all speeds against a minimax of scipy; at one speed against a dense sampling of the sphere."""
    rng, tried = np.random.default_rng(11), 0
    own = Own((0, 0, 0), (50, 0, 0))
    turns, bearings = (a.ravel() for a in np.meshgrid(np.linspace(0, np.pi, 181), np.linspace(0, 2 * np.pi, 360)))
    sphere = brute.around(own)(turns, bearings)
    while tried < 12:
        obstacles = squeezed(rng, int(rng.integers(5, 10)))
        spaces = [half_space(own, o, 1.0, math.inf) for o in obstacles]
        if nearest_in_ball(spaces, own.vel_mps, 50.0) is not None:
            continue
        tried += 1
        within = minimize(
            lambda x: x[3],
            np.array([0.0, 0.0, 0.0, 100.0]),
            constraints=[{"type": "ineq", "fun": lambda x, h=h: np.dot(h.normal, x[:3]) + x[3] - h.offset} for h in spaces]
            + [{"type": "ineq", "fun": lambda x: 2500.0 - x[:3] @ x[:3]}],
            method="SLSQP",
        )
        assert within.success
        assert violation(spaces, least_violating(spaces, own.vel_mps, keep_speed=False)) == pytest.approx(within.x[3], abs=2e-3)
        found = least_violating(spaces, own.vel_mps, keep_speed=True)
        assert np.linalg.norm(found) == pytest.approx(50.0)
        sampled = np.max([h.offset - sphere @ np.array(h.normal) for h in spaces], axis=0).min()
        assert violation(spaces, found) <= sampled + 1e-3
        np.testing.assert_array_equal(avoid("orca", own, obstacles).velocity_mps, found)


def test_pinched_from_both_sides_it_climbs():
    """Two spheres meet the aircraft at one place from left and right, on exact collision courses."""
    own = Own((500, 0, 0), (50, 0, 0))
    pair = [Obstacle((700, s * 200.0, 0), (0, -s * 50.0, 0), 33) for s in (-1, 1)]
    answer = avoid("orca", own, pair)
    assert answer.status == "avoided"
    assert answer.velocity_mps[2] > 5.0


@pytest.mark.skipif(importlib.util.find_spec("rvo23d") is None, reason="the optional package jt-pyrvo23d is not installed")
def test_against_rvo2_3d(scenes):
    import rvo23d

    rng = np.random.default_rng(24)
    for k in range(60):
        own, obstacles = scenes.encounter(rng, int(rng.integers(1, 5))) if k < 40 else (Own((0, 0, 0), (50, 0, 0)), squeezed(rng, 8))
        sim = rvo23d.PyRVOSimulator(1 / 60, 1e4, 50, 4.0, 0.0, 50.0)
        me = sim.addAgent(tuple(own.pos_m), 1e4, 50, 4.0, 0.0, 50.0, tuple(own.vel_mps))
        for o in obstacles:
            sim.addAgent(tuple(o.pos_m), 1e4, 50, 4.0, o.radius_m, 200.0, tuple(o.vel_mps))
        sim.setAgentPrefVelocity(me, tuple(own.vel_mps))
        sim.doStep()
        spaces = [half_space(own, o, 0.5, 4.0) for o in obstacles]
        mine = nearest_in_ball(spaces, own.vel_mps, 50.0)
        theirs = sim.getAgentVelocity(me)
        if mine is not None:
            np.testing.assert_allclose(theirs, mine, atol=2e-2)
        else:
            assert violation(spaces, least_violating(spaces, own.vel_mps, keep_speed=False)) <= violation(spaces, theirs) + 1e-3
