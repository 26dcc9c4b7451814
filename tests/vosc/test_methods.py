"""What every method promises, on random encounters, against straight lines flown by code that shares nothing with the library."""

import math
import operator
from collections import Counter
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.vosc.draws import percent
from vosc import Obstacle, Own
from vosc.methods import METHODS, OPTIONS, Choice, avoid

STATUSES = {"clear", "avoided", "unsafe", "no_free_direction", "inside", "undefined"}
SAFE = [m for m in METHODS if m not in ("none",)]
FIELDS = {"potential_field", "interfered_fluid"}  # to be followed all the way: asked once they seldom leave the cone


def angle(a, b):
    """By half the chord between the unit vectors (Kahan), not by a cross product."""
    a, b = ([x / math.hypot(*v) for x in v] for v in (a, b))
    return 2.0 * math.atan2(math.dist(a, b), math.hypot(*map(operator.add, a, b)))


def test_names():
    more = {"planes", "random_planes", "potential_field", "differential_geometry", "orca"}
    more |= {"one_plane", "outward_search", "tangent_lyapunov", "interfered_fluid"}
    assert set(METHODS) == {"none", "scoam", "least_deflection", "droam_hp", "droam_vp"} | more


@pytest.mark.parametrize(
    ("method", "reading", "degrees", "towards"),
    [
        ("scoam", "azimuth_106", 12.308, (36.29, 17.08)),
        ("scoam", "direction_106_10", 10.80, (34.26, 17.59)),
        ("least_deflection", "azimuth_106", 11.413, (30.94, 21.73)),
        ("droam_hp", "azimuth_106", 13.625, (38.63, 12.0)),
        ("droam_vp", "azimuth_106", 12.361, (24.7, 24.36)),
        ("droam_vp", "direction_106_10", 10.77, (24.7, 22.77)),
    ],
)
def test_the_paper_s_single_case(table_1, method, reading, degrees, towards):
    own, obstacle = table_1(reading)
    answer = avoid(method, own, [obstacle])
    assert answer.status == "avoided"
    assert math.degrees(answer.deflection_rad) == pytest.approx(degrees, abs=0.006)
    x, y, z = answer.velocity_mps
    assert (math.degrees(math.atan2(y, x)), math.degrees(math.asin(z / 50))) == pytest.approx(towards, abs=0.006)


def test_droam_sides(table_1):
    own, obstacle = table_1("azimuth_106")
    assert math.degrees(avoid("droam_vp", own, [obstacle], side="down").deflection_rad) == pytest.approx(20.9, abs=0.05)
    left, right = (avoid("droam_hp", own, [obstacle], side=s).velocity_mps for s in ("left", "right"))
    azimuth = [math.degrees(math.atan2(v[1], v[0])) - 24.7 for v in (left, right)]
    assert azimuth == pytest.approx([13.93, -31.71], abs=0.01)


@pytest.mark.parametrize("method", METHODS)
def test_table_1_as_printed_is_clear(table_1, method):
    own, obstacle = table_1("as_printed")
    answer = avoid(method, own, [obstacle])
    assert (answer.status, answer.deflection_rad) == ("clear", 0.0)
    assert math.degrees(answer.margin_rad) == pytest.approx(16.79 - 14.57, abs=0.01)


@pytest.mark.parametrize("method", METHODS)
def test_no_obstacles(method):
    answer = avoid(method, Own((0, 0, 0), (1, 2, 3)), [])
    assert (answer.status, answer.deflection_rad, answer.margin_rad) == ("clear", 0.0, math.inf)


@pytest.mark.parametrize("method", METHODS)
def test_inside(method):
    answer = avoid(method, Own((0, 0, 0), (50, 0, 0)), [Obstacle((10, 0, 0), (0, 5, 0), 25), Obstacle((100, 0, 0), (0, 0, 0), 25)])
    assert (answer.status, answer.deflection_rad) == ("inside", 0.0)


def contract(own, obstacles, brute, answer, least_rad):
    velocity = answer.velocity_mps.tolist()
    assert answer.status in STATUSES
    assert all(map(math.isfinite, velocity))
    assert not math.isnan(answer.margin_rad)
    assert abs(answer.deflection_rad - angle(own.vel_mps, velocity)) < 1e-9
    if answer.status in ("avoided", "unsafe", "clear"):
        assert abs(math.hypot(*velocity) / math.hypot(*own.vel_mps) - 1.0) < 1e-9
    assert (answer.margin_rad >= -1e-9) == (answer.status in ("avoided", "clear")) or answer.status in ("no_free_direction", "undefined")
    if answer.status == "avoided":
        assert answer.deflection_rad >= least_rad - 1e-9
    if answer.status in ("avoided", "clear"):
        for o in obstacles:  # straight lines flown: how near does the commanded velocity come?
            p = [a - b for a, b in zip(o.pos_m, own.pos_m, strict=True)]
            w = [a - b for a, b in zip(velocity, o.vel_mps, strict=True)]
            t = max(0.0, sum(map(operator.mul, p, w))) / max(sum(x * x for x in w), 1e-30)
            assert math.dist(p, [x * t for x in w]) >= o.radius_m - 2e-9 * math.hypot(*p) - 1e-9
    if answer.status == "unsafe":
        assert brute.forbidden(own, obstacles, np.array([velocity]))[0]
    return answer.status


def run_contract(scenes, brute, seed, number, most=6):
    """Of ``number`` encounters those that are conflicts: of the others there is little to say."""
    rng = np.random.default_rng(seed)
    seen = {m: Counter() for m in METHODS}
    for k in range(number):
        own, obstacles = scenes.encounter(rng, int(rng.integers(1, most + 1)))
        if k % 10 and avoid("none", own, obstacles).status == "clear":
            continue
        answers = {method: avoid(method, own, obstacles) for method in METHODS}
        for method, answer in answers.items():
            seen[method][contract(own, obstacles, brute, answer, answers["least_deflection"].deflection_rad)] += 1
    return seen


def test_contract_on_encounters(scenes, brute):
    seen = run_contract(scenes, brute, 1, 60)
    assert seen["least_deflection"]["unsafe"] == seen["least_deflection"]["undefined"] == 0
    assert all(c["avoided"] > (2 if m in FIELDS else 12) for m, c in seen.items() if m != "none")


@pytest.mark.slow
def test_contract_on_800_encounters(scenes, brute):
    seen = run_contract(scenes, brute, 2, 800, most=8)
    for method in ("least_deflection", "planes", "random_planes", "droam_hp", "droam_vp"):
        assert seen[method]["unsafe"] == 0, method
    assert seen["none"]["unsafe"] > 480


@pytest.mark.slow
def test_least_deflection_equals_brute_force_on_50_conflicts(scenes, brute):
    """Mostly of several obstacles: with one or two the answer is a closed form's."""
    rng = np.random.default_rng(3)
    conflicts = 0
    while conflicts < 50:
        own, obstacles = scenes.encounter(rng, int(rng.integers(2, 8)))
        answer = avoid("least_deflection", own, obstacles)
        if answer.status == "clear":
            continue
        conflicts += 1
        found = brute.least_turn(own, obstacles)
        assert (found is None) == (answer.status == "no_free_direction")
        if found is not None and abs(found - answer.deflection_rad) > 1e-6:
            # a gap between cones narrower than the grid: only a denser one can contradict
            found = brute.least_turn(own, obstacles, rays=7200, rings=1600, keep=40)
            assert answer.deflection_rad == pytest.approx(found, abs=1e-6)


def test_least_deflection_equals_brute_force_on_a_few(scenes, brute):
    rng = np.random.default_rng(4)
    for _ in range(8):
        own, obstacles = scenes.encounter(rng, int(rng.integers(2, 6)))
        answer = avoid("least_deflection", own, obstacles)
        assert answer.deflection_rad == pytest.approx(brute.least_turn(own, obstacles), abs=1e-6)


def fibonacci_sphere(n):
    k = np.arange(n) + 0.5
    polar, turn = np.arccos(1 - 2 * k / n), np.pi * (1 + math.sqrt(5)) * k
    return np.stack([np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)], axis=1)


def test_no_free_direction_is_confirmed_by_dense_sampling(brute):
    rng, found = np.random.default_rng(5), 0
    sphere = 20.0 * fibonacci_sphere(20_000)
    for _ in range(120):
        own = Own((0, 0, 0), 20.0 * fibonacci_sphere(7)[int(rng.integers(7))])
        around = 25.0 * fibonacci_sphere(int(rng.integers(1, 9)))
        obstacles = [Obstacle(v, -v * rng.uniform(0.5, 2.0), rng.uniform(10.0, 24.0)) for v in around]
        answer = avoid("least_deflection", own, obstacles)
        free = ~brute.forbidden(own, obstacles, sphere)
        if answer.status == "no_free_direction":
            found += 1
            assert not free.any()
        elif free.any():
            assert answer.status in ("avoided", "clear")
    assert found > 20


def test_a_faster_obstacle_whose_cone_swallows_the_sphere():
    answer = avoid("least_deflection", Own((0, 0, 0), (10, 0, 0)), [Obstacle((60, 0, 0), (-100, 0, 0), 50)])
    assert (answer.status, answer.deflection_rad) == ("no_free_direction", 0.0)


def test_own_at_rest():
    for method in METHODS:
        answer = avoid(method, Own((0, 0, 0), (0, 0, 0)), [Obstacle((100, 0, 0), (-40, 0, 0), 25)])
        assert answer.status in ({"unsafe"} if method in ("none", "potential_field") else {"no_free_direction", "undefined"})
        assert answer.velocity_mps.tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize("method", SAFE)
def test_exactly_head_on_has_an_answer(method):
    answer = avoid(method, Own((0, 0, 0), (50, 0, 0)), [Obstacle((100, 0, 0), (-40, 0, 0), 25)])
    if method in FIELDS:
        assert answer.status in ("unsafe", "undefined")
        return
    assert answer.status == "avoided"
    if method not in ("planes", "random_planes", "droam_vp", "outward_search"):
        assert answer.velocity_mps[1] < -1.0  # the right
    exact = avoid("least_deflection", Own((0, 0, 0), (50, 0, 0)), [Obstacle((100, 0, 0), (-40, 0, 0), 25)]).deflection_rad
    if method == "outward_search":
        assert 0.0 <= answer.deflection_rad - exact < math.radians(1.0)
    elif method not in ("orca", "tangent_lyapunov"):  # ORCA turns out of a half-space, the other round a larger circle
        assert answer.deflection_rad == pytest.approx(exact, abs=1e-9)


@pytest.mark.parametrize(
    "obstacle", [((0, 0, 100), (0, 0, 0)), ((100, 0, 0), (0, 0, 0)), ((0, 0, 100), (0, 0, -50)), ((100, 0, 0), (-50, 0, 0))]
)
@pytest.mark.parametrize("method", METHODS)
def test_straight_at_it_along_an_axis(method, obstacle):
    pos, vel = obstacle
    own = Own((0, 0, 0), 0.5 * np.array(pos))
    answer = avoid(method, own, [Obstacle(pos, vel, 20)])
    assert answer.status in STATUSES - {"clear", "inside", "no_free_direction"}
    assert np.isfinite(answer.velocity_mps).all()
    if method == "least_deflection":
        assert answer.status == "avoided"


number = st.floats(-100.0, 100.0)
vector = st.tuples(number, number, number)
grid_number = st.sampled_from([-50.0, 0.0, 0.0, 50.0, 1e-9])
grid_vector = st.tuples(grid_number, grid_number, grid_number)


any_vector = st.one_of(vector, grid_vector)


@given(any_vector, st.lists(st.tuples(any_vector, any_vector, st.floats(0.5, 60.0)), max_size=3))
@percent(50)
def test_never_nan_never_an_exception(vel, drawn):
    own = Own((0, 0, 0), vel)
    obstacles = [Obstacle(*o) for o in drawn]
    for method in METHODS:
        answer = avoid(method, own, obstacles)
        assert answer.status in STATUSES
        assert np.isfinite(answer.velocity_mps).all()
        assert not math.isnan(answer.margin_rad)
        assert 0.0 <= answer.deflection_rad <= math.pi
        if answer.status == "avoided":
            assert answer.margin_rad >= -1e-9


def rotation(rng):
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return q if np.linalg.det(q) > 0 else -q


def turned(own, obstacles, m, length=1.0, time=1.0):
    pos, vel = length * m, length / time * m
    return Own(pos @ own.pos_m, vel @ own.vel_mps), [Obstacle(pos @ o.pos_m, vel @ o.vel_mps, length * o.radius_m) for o in obstacles]


UPRIGHT = {
    "droam_hp",
    "droam_vp",
    "planes",
    "random_planes",
    "outward_search",
}  # they know up and down: only turns about the vertical carry over
CHIRAL = {"random_planes", "outward_search"}  # drawn roll angles, and a search that goes round clockwise, have a handedness


@pytest.mark.parametrize("method", METHODS)
def test_turning_mirroring_and_changing_units_turns_the_answer(method, scenes):
    rng = np.random.default_rng(6)
    compared = 0
    for _ in range(40):
        own, obstacles = scenes.encounter(rng, int(rng.integers(1, 5)))
        a = rng.uniform(0, 2 * np.pi)
        about_z = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1.0]])
        m = about_z if method in UPRIGHT else rotation(rng)
        if method not in CHIRAL:
            m = m @ np.diag([1.0, rng.choice([-1.0, 1.0]), 1.0])
        length, time = rng.uniform(0.3, 4.0), rng.uniform(0.3, 4.0)
        one, other = avoid(method, own, obstacles), avoid(method, *turned(own, obstacles, m, length, time))
        if abs(one.margin_rad + 1e-9) < 1e-8 and one.status != "avoided":
            continue
        assert other.status == one.status
        np.testing.assert_allclose(other.velocity_mps, length / time * m @ one.velocity_mps, atol=1e-6 * 50 * length / time)
        compared += one.status != "clear"
    assert compared > 15


def test_order_of_the_obstacles_does_not_matter(scenes):
    rng = np.random.default_rng(7)
    for _ in range(30):
        own, obstacles = scenes.encounter(rng, 4)
        for method in ("scoam", "least_deflection", "orca", "planes", "droam_hp", "potential_field", "differential_geometry"):
            one, other = avoid(method, own, obstacles), avoid(method, own, obstacles[::-1])
            assert one.status == other.status
            np.testing.assert_allclose(one.velocity_mps, other.velocity_mps, atol=1e-9)


def test_asked_again_the_answer_is_kept(scenes):
    rng = np.random.default_rng(8)
    for _ in range(30):
        own, obstacles = scenes.encounter(rng, 3)
        answer = avoid("least_deflection", own, obstacles)
        if answer.status == "avoided":
            again = avoid("least_deflection", Own(own.pos_m, answer.velocity_mps), obstacles)
            assert (again.status, again.deflection_rad) == ("clear", 0.0)


def test_more_planes_come_closer_to_the_optimum(table_1):
    own, obstacle = table_1("azimuth_106")
    best = avoid("least_deflection", own, [obstacle]).deflection_rad
    excess = [avoid("planes", own, [obstacle], n=n).deflection_rad - best for n in (1, 3, 12, 120)]
    assert excess == sorted(excess, reverse=True)
    assert excess[0] > 0.01
    assert -1e-12 <= excess[-1] < 1e-5
    assert avoid("random_planes", own, [obstacle], seed=1).deflection_rad != avoid("random_planes", own, [obstacle], seed=2).deflection_rad


def test_speed_range(table_1, brute):
    own, obstacle = table_1("azimuth_106")
    constant = avoid("least_deflection", own, [obstacle])
    wide = avoid("least_deflection", own, [obstacle], speed_range_mps=(45.0, 55.0))
    assert wide.status == "avoided"
    assert wide.deflection_rad < constant.deflection_rad
    assert 45.0 - 1e-9 <= np.linalg.norm(wide.velocity_mps) <= 55.0 + 1e-9
    turns = []
    for speed in np.linspace(45.0, 55.0, 201):
        faster = Own(own.pos_m, np.array(own.vel_mps) * speed / 50.0)
        turns.append(avoid("least_deflection", faster, [obstacle]).deflection_rad)
    assert wide.deflection_rad <= min(turns) + 1e-9
    straight_on = avoid("least_deflection", own, [obstacle], speed_range_mps=(5.0, 55.0))
    assert straight_on.deflection_rad < 1e-9
    slowest = np.linalg.norm(straight_on.velocity_mps)
    direction = np.array(own.vel_mps) / 50.0
    assert brute.forbidden(own, [obstacle], direction[None] * (slowest + 0.01))[0]
    assert not brute.forbidden(own, [obstacle], direction[None] * (slowest - 0.001))[0]


@pytest.mark.parametrize(
    ("method", "options", "message"),
    [
        ("teleport", {}, "no avoidance method 'teleport'; there are: none, scoam"),
        ("none", {"k": 1}, "method 'none' has no option k; it has: none"),
        ("planes", {"number": 3}, "method 'planes' has no option number; it has: n, offset_rad"),
        ("planes", {"n": 0}, "n: give 1 to 10000 planes"),
        ("random_planes", {"n": 0}, "n: give 1 to 10000 planes"),
        ("droam_hp", {"side": "up"}, "side: 'least', 'left' or 'right'"),
        ("droam_vp", {"side": "left"}, "side: 'least', 'up' or 'down'"),
        ("scoam", {"objective": "fun"}, "objective: one of"),
        ("scoam", {"boundary": "fuzzy"}, "boundary: 'paper'"),
        ("scoam", {"consider": "some"}, "consider: 'threats' or 'all'"),
        ("scoam", {"objective": "goal"}, "goal: give a direction"),
        ("potential_field", {"gain": 0.0}, "gain, reach"),
        ("orca", {"responsibility": 0.0}, "responsibility"),
        ("orca", {"horizon_s": -1.0}, "horizon_s"),
        ("least_deflection", {"speed_range_mps": (60, 50)}, "speed_range_mps"),
    ],
)
def test_wrong_names_and_options_say_what_to_do(table_1, method, options, message):
    own, obstacle = table_1("azimuth_106")
    with pytest.raises(ValueError, match=message):
        avoid(method, own, [obstacle, obstacle], **options)


def test_options_are_those_of_the_functions():
    scoam = "boundary objective goal corners_only consider root half_angle bearing_deg component component_mps bank_rad"
    assert OPTIONS["scoam"] == set(scoam.split())
    assert OPTIONS["none"] == frozenset()


def test_obstacles_that_are_marked_as_no_threat_are_for_those_who_ask() -> None:
    """Every method answers as if they were not there; scoam with consider=all sees them, and so does a method of one's own."""
    own = Own((0, 0, 0), (50, 0, 0))
    met = Obstacle((150, -4, 0), (0, 0, 0), 25)
    beside = Obstacle((140, 40, 0), (0, 0, 0), 25, is_threat=False)
    for name in METHODS:
        alone, both = avoid(name, own, [met]), avoid(name, own, [met, beside])
        assert (alone.velocity_mps == both.velocity_mps).all(), name
        assert (alone.status, alone.margin_rad) == (both.status, both.margin_rad), name
    options = {"boundary": "exact", "consider": "all"}
    assert avoid("scoam", own, [met, beside], **options).deflection_rad > avoid("scoam", own, [met], **options).deflection_rad
    told: list[Obstacle] = []

    def listens(own: Own, obstacles: Sequence[Obstacle]) -> Choice:
        told.extend(obstacles)
        return Choice(own.vel_mps, "avoided")

    avoid(listens, own, [met, beside])
    assert told == [met, beside]
    assert avoid("scoam", own, [beside]).status == "clear"


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (None, "must return Choice"),
        ((1.0, 2.0, 3.0), "must return Choice"),
        (((1.0, 2.0), "avoided"), "the method's velocity: give three numbers"),
        (((np.nan, 2.0, 1.0), "avoided"), "the method's velocity: all three numbers must be finite"),
        (((50.0, 0.0, 0.0), "safe"), "the method's status must be one of avoided, no_free_direction, undefined, not 'safe'"),
    ],
)
def test_an_answer_that_is_none_is_refused_in_words(answer: object, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        avoid(lambda own, obstacles: answer, Own((0, 0, 0), (50, 0, 0)), [Obstacle((150, 0, 0), (0, 0, 0), 25)])  # type: ignore[arg-type,return-value]  # noqa: ARG005


@pytest.mark.parametrize("velocity", [np.array([30.0, 40.0, 0.0]), [30, 40, 0], (np.float64(30.0), 40.0, 0.0)])
def test_lists_and_arrays_are_answers_too(velocity: Sequence[float]) -> None:
    answer = avoid(lambda own, obstacles: (velocity, "avoided"), Own((0, 0, 0), (50, 0, 0)), [Obstacle((150, 0, 0), (0, 0, 0), 25)])  # noqa: ARG005
    assert answer.velocity_mps.tolist() == [30.0, 40.0, 0.0]
    assert answer.status == "avoided"
