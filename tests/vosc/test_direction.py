"""Several obstacles: S and S', any K by an objective, the union of three, the paper's caps against the exact boundary."""

import math

import numpy as np
import pytest

from vosc import Obstacle, Own, cap
from vosc.direction import boundary_curves, cap_gap, choose, corner_points, point_on_cap, points_with_component
from vosc.methods import avoid


def polar(size, azimuth_deg, elevation_deg):
    a, e = math.radians(azimuth_deg), math.radians(elevation_deg)
    return np.array([size * math.cos(e) * math.cos(a), size * math.cos(e) * math.sin(a), size * math.sin(e)])


@pytest.fixture(scope="module")
def two_threats():
    """Table 3 with the elevation of O_2 positive: the reading in which both are threats."""
    own = Own((162, 101, 64.3), polar(50, 24.7, 12.0))
    return own, [Obstacle((254, 63.8, 59.8), polar(35, 106, 11.4), 25), Obstacle((208, 186, 42.5), polar(32, -50.3, 15.4), 30)]


def sphere_grid(own, n=40_000):
    k = np.arange(n) + 0.5
    z, turn = 1 - 2 * k / n, np.pi * (1 + math.sqrt(5)) * k
    r = np.sqrt(1 - z * z)
    return np.linalg.norm(own.vel_mps) * np.stack([r * np.cos(turn), r * np.sin(turn), z], axis=1)


def angles(a, b):
    a, b = np.atleast_2d(a), np.asarray(b)
    return np.arccos(np.clip(a @ b / np.linalg.norm(a, axis=1) / np.linalg.norm(b), -1, 1))


def inside_caps(own, obstacles, velocities):
    """The paper's circles, tested with the printed parameters only."""
    out = np.zeros(len(velocities), bool)
    for o in obstacles:
        g = cap(own, o)
        out |= angles(velocities, polar(1.0, math.degrees(g.azimuth_rad), math.degrees(g.elevation_rad))) < g.half_angle_rad
    return out


def test_s_and_s_prime_satisfy_eq_29_to_31(two_threats):
    own, obstacles = two_threats
    caps = [cap(own, o) for o in obstacles]
    points = corner_points(*caps, 50.0)
    assert len(points) == 2
    for s in points:
        assert np.linalg.norm(s) == pytest.approx(50.0, rel=1e-12)
        for g in caps:
            centre = polar(g.radius_mps, math.degrees(g.azimuth_rad), math.degrees(g.elevation_rad))
            assert centre @ (s - centre) == pytest.approx(0.0, abs=1e-9)
    assert np.linalg.norm(points[0] - points[1]) > 1.0


def test_circles_that_do_not_meet_have_no_corner():
    own = Own((0, 0, 0), (50, 0, 0))
    one, other = (cap(own, Obstacle(p, (0, 0, 0), 10)) for p in ((100, 0, 0), (0, 100, 0)))
    assert corner_points(one, other, 50.0) == []
    assert corner_points(one, one, 50.0) == []


def test_any_k_of_eq_32_33(two_threats):
    own, obstacles = two_threats
    g = cap(own, obstacles[1])
    np.testing.assert_allclose(point_on_cap(g, 0.0), g.nearest_mps, atol=1e-9)
    np.testing.assert_allclose(point_on_cap(g, math.pi), g.farthest_mps, atol=1e-9)
    centre = 0.5 * (g.nearest_mps + g.farthest_mps)
    for axis in range(3):
        value = point_on_cap(g, 1.0)[axis]
        found = points_with_component(g, axis, value)
        assert min(np.linalg.norm(k - point_on_cap(g, 1.0)) for k in found) < 1e-9
        for k in found:
            assert k[axis] == pytest.approx(value)
            assert np.linalg.norm(k) == pytest.approx(50.0)
            assert centre @ (k - centre) == pytest.approx(0.0, abs=1e-8)
    assert points_with_component(g, 0, 60.0) == []


def test_the_paper_s_circle_runs_inside_the_exact_cone(two_threats):
    own, obstacles = two_threats
    for o in obstacles:
        gap = cap_gap(own, o)
        assert gap[[0, 180]] == pytest.approx([0.0, 0.0], abs=1e-9)
        assert math.radians(-6.0) < gap.min() < math.radians(-0.2)
        still = Obstacle(o.pos_m, (0, 0, 0), o.radius_m)
        assert np.abs(cap_gap(own, still)).max() < 1e-9  # a standing obstacle: the circle is exact
    assert cap_gap(own, Obstacle(own.pos_m, (0, 0, 0), 5)) is None


@pytest.mark.parametrize("boundary", ["exact", "paper"])
def test_boundary_curves_lie_on_the_sphere_and_on_the_edge(two_threats, boundary, brute):
    own, obstacles = two_threats
    for o in obstacles:
        (curve,) = boundary_curves(own, o, boundary, n=60)
        np.testing.assert_allclose(np.linalg.norm(curve, axis=1), 50.0, rtol=1e-12)
        centre = curve.mean(axis=0)
        out, into = curve + 1e-3 * (curve - centre), curve - 1e-3 * (curve - centre)
        out, into = (50 * v / np.linalg.norm(v, axis=1)[:, None] for v in (out, into))
        test = brute.forbidden if boundary == "exact" else inside_caps
        assert not test(own, [o], out).any()
        assert test(own, [o], into).all()


def test_a_fast_obstacle_has_two_loops_one_or_none():
    own = Own((0, 0, 0), (20, 0, 0))
    assert len(boundary_curves(own, Obstacle((0, 200, 0), (0, -80, 0), 10))) == 2
    assert len(boundary_curves(own, Obstacle((0, 200, 0), (15, -80, 0), 40))) == 1
    assert boundary_curves(own, Obstacle((0, 200, 0), (0, 80, 0), 10)) == []
    assert boundary_curves(own, Obstacle((0, 5, 0), (0, 80, 0), 10)) == []


def climb(v):
    return np.arcsin(np.clip(v[..., 2] / np.linalg.norm(v, axis=-1), -1, 1))


@pytest.mark.parametrize("boundary", ["exact", "paper"])
@pytest.mark.parametrize("objective", ["least_deflection", "least_climb_change", "right_of_way", "goal"])
def test_no_sampled_direction_beats_the_objective(scenes, brute, objective, boundary):
    rng = np.random.default_rng(9)
    tried = 0
    for _ in range(12):
        own, obstacles = scenes.encounter(rng, int(rng.integers(2, 5)))
        obstacles = [o for o in obstacles if np.linalg.norm(o.vel_mps) < 45]
        goal = rng.normal(size=3) if objective == "goal" else None
        found = choose(own, obstacles, objective, boundary, goal)
        grid = sphere_grid(own)
        bad = brute.forbidden(own, obstacles, grid) if boundary == "exact" else inside_caps(own, obstacles, grid)
        v = np.array(own.vel_mps)
        left = np.array([-v[1], v[0], 0.0])
        if objective == "right_of_way":
            bad |= grid @ left > 0
        if bad.all():
            continue
        free = grid[~bad]
        tried += 1
        assert np.linalg.norm(found) == pytest.approx(50.0, rel=1e-9)
        spacing = 0.02  # rad between neighbours of the grid
        if objective == "least_climb_change":
            assert abs(climb(found) - climb(v)) <= np.abs(climb(free) - climb(v)).min() + 1e-6
        else:
            centre = goal if goal is not None else v
            assert angles(free, centre).min() + 1e-6 >= angles(found, centre)[0] >= angles(free, centre).min() - 2 * spacing
        near = found + 1e-3 * rng.normal(size=(400, 3))  # the answer is at the edge of what is free, not inside the forbidden
        near *= 50 / np.linalg.norm(near, axis=1)[:, None]
        bad_near = brute.forbidden(own, obstacles, near) if boundary == "exact" else inside_caps(own, obstacles, near)
        assert not bad_near.all()
        if objective == "right_of_way":
            assert found @ left <= 1e-6
    assert tried >= 8


def test_least_climb_change_leaves_the_level_only_when_it_must():
    own = Own((0, 0, 0), (50, 0, 0))
    wall = [Obstacle((100 * math.cos(a), 100 * math.sin(a), 10.0), (0, 0, 0), 40) for a in np.linspace(0, 2 * np.pi, 12, endpoint=False)]
    found = choose(own, wall, "least_climb_change")
    assert climb(found) < -0.2  # the ring stands a little high: under it is closer than over it
    level = choose(own, wall[:3], "least_climb_change")
    assert climb(level) == pytest.approx(0.0, abs=1e-9)


def test_goal_is_taken_where_it_is_free(two_threats):
    own, obstacles = two_threats
    np.testing.assert_allclose(choose(own, obstacles, "goal", goal=(0, 0, -2)), (0, 0, -50), atol=1e-9)


def test_scoam_takes_a_point_of_the_union_of_caps(two_threats):
    own, obstacles = two_threats
    answer = avoid("scoam", own, obstacles)
    np.testing.assert_allclose(answer.velocity_mps, choose(own, obstacles, "least_deflection", "paper"), atol=1e-9)
    corners = corner_points(*(cap(own, o) for o in obstacles), 50.0)
    corner = avoid("scoam", own, obstacles, corners_only=True)
    assert min(np.linalg.norm(corner.velocity_mps - s) for s in corners) < 1e-9
    assert corner.deflection_rad >= answer.deflection_rad - 1e-9
    exact = avoid("scoam", own, obstacles, boundary="exact")
    assert exact.status == "avoided"
    assert exact.deflection_rad == pytest.approx(avoid("least_deflection", own, obstacles).deflection_rad, abs=1e-9)


def test_third_cap_disqualifies_a_corner(two_threats):
    own, obstacles = two_threats
    first = avoid("scoam", own, obstacles, corners_only=True).velocity_mps
    third = Obstacle(np.array(own.pos_m) + 2.0 * first, (0, 0, 0), 30)
    answer = avoid("scoam", own, [*obstacles, third], corners_only=True, consider="all")
    assert np.linalg.norm(answer.velocity_mps - first) > 1.0


def test_scoam_looks_at_all_obstacles_when_asked(table_1):
    own, obstacle = table_1("azimuth_106")
    single = avoid("scoam", own, [obstacle])
    blocker = Obstacle(np.array(own.pos_m) + 2.0 * single.velocity_mps, (0, 0, 0), 12)
    assert avoid("scoam", own, [obstacle, blocker]).status == "unsafe"
    both = avoid("scoam", own, [obstacle, blocker], consider="all", boundary="exact")
    assert both.status == "avoided"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"objective": "fun"}, "objective: one of"),
        ({"objective": "goal"}, "goal: give"),
        ({"goal": (1, 0, 0)}, "goal: give"),
        ({"boundary": "x"}, "boundary"),
    ],
)
def test_bad_options_say_what_to_do(two_threats, options, message):
    with pytest.raises(ValueError, match=message):
        choose(*two_threats, **options)
