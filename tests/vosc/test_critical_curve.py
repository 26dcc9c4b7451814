"""Any point K of the critical curve against dense sampling of the circle of eq. 32-33; what a turn costs against its closed form."""

import math

import numpy as np
import pytest

from vosc import Obstacle, Own, cap, threat
from vosc.critical_curve import G_MPS2, at_bearing, cheapest, demand, with_component
from vosc.direction import boundaries, point_on_cap, points_with_component
from vosc.methods import avoid

V = 50.0
TWO = [Obstacle((90, 10, 5), (-10, -20, 4), 25), Obstacle((80, -25, -8), (5, 25, 6), 30)]


def bearing_of(own, k):
    """Degrees clockwise from up, as the pilot sees it: written out with the horizontal right of the track."""
    u = np.array(own.vel_mps) / V
    right = np.array([u[1], -u[0], 0.0]) / math.hypot(u[0], u[1])
    up = np.cross(right, u)
    return math.degrees(math.atan2(k @ right, k @ up)) % 360.0


@pytest.fixture
def one(table_1):
    return table_1("azimuth_106")


@pytest.mark.parametrize("bearing", [0.0, 37.0, 90.0, 201.0, 300.0])
def test_the_angle_is_the_one_asked_for_and_the_point_lies_on_the_circle(one, bearing):
    own, obstacle = one
    answer = avoid("scoam", own, [obstacle], bearing_deg=bearing)
    assert bearing_of(own, answer.velocity_mps) == pytest.approx(bearing, abs=1e-6)
    found = cap(own, obstacle)
    centre = 0.5 * (found.nearest_mps + found.farthest_mps)
    assert np.linalg.norm(answer.velocity_mps) == pytest.approx(V)  # eq. 32
    assert (answer.velocity_mps - centre) @ centre == pytest.approx(0.0, abs=1e-6)  # eq. 33


def test_of_several_caps_the_union_is_left():
    own = Own((0, 0, 0), (V, 0, 0))
    cones = boundaries(own, TWO, "paper")
    sampled = [point_on_cap(cap(own, o), a) for o in TWO for a in np.linspace(0, 2 * np.pi, 720)]
    rim = [k for k in sampled if all(k @ np.array(c.axis) <= V * c.cos + 1e-6 for c in cones)]
    for bearing in np.linspace(0.0, 345.0, 24):
        k = np.array(at_bearing(cones, own.vel_mps, math.radians(bearing)))
        assert min(np.linalg.norm(k - r) for r in rim) < V * 2 * np.pi / 720


@pytest.mark.parametrize(("axis", "value"), [("x", 40.0), ("y", 25.0), ("z", 12.0)])
def test_one_component_is_given_the_others_follow(one, axis, value):
    own, obstacle = one
    answer = avoid("scoam", own, [obstacle], component=axis, component_mps=value)
    both = points_with_component(cap(own, obstacle), "xyz".index(axis), value)  # the closed form
    nearest = min(both, key=lambda k: np.linalg.norm(k - np.array(own.vel_mps)))
    np.testing.assert_allclose(answer.velocity_mps, nearest, atol=1e-6)
    assert avoid("scoam", own, [obstacle], component=axis, component_mps=51.0).status == "undefined"


def test_a_component_on_the_exact_curve_too(one):
    own, obstacle = one
    answer = avoid("scoam", own, [obstacle], component="z", component_mps=20.0, boundary="exact")
    assert answer.velocity_mps[2] == pytest.approx(20.0)
    assert answer.margin_rad == pytest.approx(0.0, abs=1e-9)


def test_the_lift_of_a_turn_is_that_of_the_coordinated_turn():
    """Level, right and left: tan(bank) = V omega / g; up and down: n = 1 +- V omega / g."""
    turn, within = math.radians(20.0), 2.0
    rate = V * turn / within / G_MPS2
    for side in (1.0, -1.0):
        found = demand((V, 0, 0), (V * math.cos(turn), -side * V * math.sin(turn), 0), within)
        assert found == pytest.approx((math.hypot(1.0, rate), side * math.atan(rate)))
        found = demand((V, 0, 0), (V * math.cos(turn), 0, side * V * math.sin(turn)), within)
        assert found.load_factor == pytest.approx(abs(1.0 + side * rate))


@pytest.mark.parametrize("by", ["least_load_factor", "least_roll"])
def test_no_sampled_point_costs_less(one, by):
    own, obstacle = one
    cones = boundaries(own, [obstacle], "exact")
    found = np.array(cheapest(cones, own.vel_mps, by, 2.0, 0.3))

    def cost(k):
        lift = demand(own.vel_mps, tuple(k), 2.0)
        return abs(lift.load_factor * np.sign(math.cos(lift.bank_rad)) - 1.0) if by == "least_load_factor" else abs(lift.bank_rad - 0.3)

    sampled = [at_bearing(cones, own.vel_mps, b) for b in np.linspace(0, 2 * np.pi, 400)]
    assert cost(found) <= min(map(cost, sampled)) + 1e-6


def test_a_faster_obstacle_from_behind_needs_six_degrees():
    """Closed form: the tangent from the origin of relative velocity, own 50 and obstacle 80 m/s on one line, R / d = 1 / 6."""
    own, obstacle = Own((0, 0, 0), (V, 0, 0)), Obstacle((-150, 0, 0), (80, 0, 0), 25)
    cosine = math.sqrt(1 - 1 / 36)
    lam = {"larger": 80 * cosine + math.sqrt(V**2 - (80 / 6) ** 2), "nearer": 80 * cosine - math.sqrt(V**2 - (80 / 6) ** 2)}
    for root, size in lam.items():
        answer = avoid("scoam", own, [obstacle], root=root)
        assert answer.deflection_rad == pytest.approx(math.atan2(size / 6, 80 - size * cosine))
    assert answer.deflection_rad == pytest.approx(avoid("least_deflection", own, [obstacle]).deflection_rad, abs=1e-9)


def test_the_corrected_cap_holds_what_the_cone_holds_in_the_avoidance_plane():
    """Near encounters: where the cone holds most of the avoidance plane, the printed cap (arcsine) is what it does not hold."""
    rng = np.random.default_rng(5)
    flipped = outside_its_own = 0
    for _ in range(300):
        p, v = rng.normal(size=3), rng.normal(size=3)
        p *= 25 * rng.uniform(1.005, 1.2) / np.linalg.norm(p)
        own, obstacle = Own((0, 0, 0), (V, 0, 0)), Obstacle(tuple(p), tuple(v * rng.uniform(5, 49) / np.linalg.norm(v)), 25)
        printed, right = cap(own, obstacle), cap(own, obstacle, half_angle="corrected")
        normal = np.cross(p, np.subtract(own.vel_mps, obstacle.vel_mps))  # of the plane through the apex, p and the relative velocity
        normal /= np.linalg.norm(normal)
        foot = (np.array(obstacle.vel_mps) @ normal) * normal
        one = np.cross(normal, p) / np.linalg.norm(p)
        round_ = np.arange(0.003, 2 * np.pi, 0.01)[:, None]
        ring = foot + math.sqrt(V**2 - foot @ foot) * (np.cos(round_) * one + np.sin(round_) * np.cross(normal, one))
        relative = ring - np.array(obstacle.vel_mps)
        held = relative @ p > np.linalg.norm(relative, axis=1) * math.sqrt(p @ p - 625)

        def inside(of, velocity):
            e = of.elevation_rad
            centre = [math.cos(e) * math.cos(of.azimuth_rad), math.cos(e) * math.sin(of.azimuth_rad), math.sin(e)]
            return velocity @ np.array(centre) > V * math.cos(of.half_angle_rad)

        assert (inside(right, ring) != held).sum() <= 2  # one sample next to either edge may fall on its other side
        assert right.radius_mps == pytest.approx(V * math.cos(right.half_angle_rad))
        flipped += right.half_angle_rad > np.pi / 2
        outside_its_own += threat(own, obstacle).is_threat and not inside(printed, np.array(own.vel_mps))
        assert not threat(own, obstacle).is_threat or inside(right, np.array(own.vel_mps))
    assert flipped > 20
    assert outside_its_own > 20


def test_what_forbids_nothing_is_left_out(one):
    own, obstacle = one
    running_away = Obstacle((300, 0, 0), (120, 0, 0), 20)  # faster, and going: no velocity of 50 m/s meets it
    assert cap(own, running_away) is None
    alone = avoid("scoam", own, [obstacle], consider="all", objective="least_deflection")
    both = avoid("scoam", own, [obstacle, running_away], consider="all")
    assert both.status == "avoided"
    np.testing.assert_array_equal(both.velocity_mps, alone.velocity_mps)


@pytest.mark.parametrize(
    "options",
    [
        {"root": "first"},
        {"half_angle": "obtuse"},
        {"bearing_deg": math.nan},
        {"component": "w", "component_mps": 1.0},
        {"component": "x"},
        {"bearing_deg": 1.0, "corners_only": True},
        {"objective": "least_roll", "bearing_deg": 1.0},
    ],
)
def test_options_that_mean_nothing_are_refused(one, options):
    with pytest.raises(ValueError, match=r"root|half_angle|bearing_deg|component|chosen"):
        avoid("scoam", one[0], [one[1]], **options)


def test_k_with_no_threat_left_is_none():
    assert with_component([], (V, 0.0, 0.0), 0, 10.0) is None
    assert at_bearing([], (0.0, 0.0, 0.0), 0.0) is None


def test_a_goal_that_is_nowhere_is_refused(one):
    with pytest.raises(ValueError, match="points nowhere"):
        avoid("scoam", one[0], [one[1]], objective="goal", goal=(0.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="from -360 to 360"):
        avoid("scoam", one[0], [one[1]], bearing_deg=4000.0)
