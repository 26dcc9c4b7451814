"""Chains of PH pieces, and the courses built of them, against closed forms and brute force."""

import math
import pickle

import numpy as np
import pytest
from scipy.spatial import cKDTree

from testbed.core.chain import FEW, Chain
from testbed.core.units import DEG
from testbed.flight.route.courses import route_pieces
from testbed.flight.route.path import ActivePath
from tests.plans import plan
from vosc import ph


def course(replicate: int = 0, **shape: object) -> Chain:
    route = {"start_enu_m": [10, -20, 30], "start_direction_deg": [30, 0], "shape": shape}
    return Chain([ph.hermite(*piece) for piece in route_pieces(plan(route=route, replicate=replicate))])


def test_a_circle_is_a_circle() -> None:
    chain = course(kind="circle", radius_m=300, turns=1.5, side="right")
    s = np.linspace(0.0, chain.length_m, 997)
    points, _, curvature = chain.sample(s)
    azimuth = 30 * DEG
    centre = np.array([10, -20, 30]) + 300 * np.array([math.sin(azimuth), -math.cos(azimuth), 0.0])
    assert np.abs(np.linalg.norm(points - centre, axis=1) - 300).max() < 1e-3
    assert np.abs(np.linalg.norm(curvature, axis=1) * 300 - 1).max() < 2e-3
    assert chain.length_m == pytest.approx(3 * math.pi * 300, rel=1e-5)
    assert np.linalg.norm(chain.frame(math.pi * 600)[0] - points[0]) < 1e-2, "once around"


def test_one_by_one_and_many_at_once_are_the_same_before_on_and_past_the_chain() -> None:
    chain = course(kind="circle", radius_m=300, turns=1.5, side="right")
    s = np.linspace(-100.0, chain.length_m + 100.0, 301)
    frames = [chain.frame(float(x)) for x in s]
    for column, rows in enumerate(chain.sample(s)):
        np.testing.assert_allclose(rows, [frame[column] for frame in frames], atol=1e-9)
    np.testing.assert_array_equal(chain.points(s), chain.sample(s)[0])


def test_a_racetrack_closes() -> None:
    chain = course(kind="racetrack", straight_m=1000, radius_m=250, laps=2)
    assert chain.length_m == pytest.approx(2 * (2000 + 2 * math.pi * 250), rel=1e-6)
    start, end = chain.frame(0.0), chain.frame(chain.length_m)
    assert np.allclose(start[0], end[0], atol=1e-6)
    assert np.allclose(start[1], end[1], atol=1e-9)


def test_a_swerve_swings_between_its_headings_and_begins_without_curvature() -> None:
    chain = course(kind="swerve", heading_deg=15, swing_m=150, swings=3)
    _, tangents, curvature = chain.sample(np.linspace(0.0, chain.length_m, 2001))
    heading = np.arctan2(tangents[:, 1], tangents[:, 0]) / DEG - 30.0
    assert heading.min() == pytest.approx(-15.0, abs=0.01)
    assert heading.max() == pytest.approx(15.0, abs=0.01)
    peak = math.pi * 15 * DEG / 150
    assert np.linalg.norm(curvature, axis=1).max() == pytest.approx(peak, rel=0.01)
    assert np.linalg.norm(curvature[[0, -1]], axis=1).max() < 0.02 * peak


@pytest.mark.parametrize("replicate", range(8))
def test_a_random_path_keeps_its_radius_and_climb_and_joins_smoothly(replicate: int) -> None:
    shape = {"kind": "random", "least_radius_m": [150, 300], "climb_at_most_deg": 8}
    route = {"start_enu_m": [0, 0, 0], "start_direction_deg": [0, 0], "shape": shape}
    chain = Chain([ph.hermite(*piece) for piece in route_pieces(plan(route=route, replicate=replicate))])
    assert 150 * 0.97 <= 1 / chain.max_curvature() <= 300 * 1.03
    s = np.linspace(0.0, chain.length_m, 4001)
    _, tangents, curvature = chain.sample(s)
    assert np.abs(np.arcsin(tangents[:, 2])).max() <= 8.2 * DEG
    assert np.linalg.norm(np.diff(curvature, axis=0), axis=1).max() < 0.1 * chain.max_curvature(), "no jump of bank"


def test_random_paths_differ_by_replicate_and_not_by_aircraft() -> None:
    shape = {"kind": "random", "least_radius_m": [150, 300], "climb_at_most_deg": 8}
    route = {"start_enu_m": [0, 0, 0], "start_direction_deg": [0, 0], "shape": shape}
    first, again, other = (
        np.concatenate(route_pieces(plan(route=route, replicate=k, aircraft=name))[0])
        for k, name in ((1, "gtm_t2"), (1, "c172p"), (2, "gtm_t2"))
    )
    assert (first == again).all()
    assert not np.array_equal(first, other)


@pytest.mark.parametrize("pieces", [3, 3 * FEW])
def test_nearest_against_a_fine_search(pieces: int) -> None:
    chain = course(kind="circle", radius_m=200, turns=pieces / 24)
    rng = np.random.default_rng(3)
    s = rng.uniform(50.0, chain.length_m - 50.0, 60)  # away from the seam of the closed circle
    points = chain.sample(s)[0] + rng.normal(size=(60, 3)) * 15
    fine = chain.sample(np.linspace(0.0, chain.length_m, 200_001))[0]
    found, distance = chain.nearest(points, s)
    brute, at = cKDTree(fine).query(points)
    inside = (at > 0) & (at < 200_000)
    assert inside.sum() > 40
    assert distance[inside] == pytest.approx(brute[inside], abs=1e-3)
    assert found[inside] == pytest.approx(at[inside] * chain.length_m / 200_000, abs=0.1)


def test_a_guess_saves_time_and_changes_nothing() -> None:
    chain = Chain([ph.hermite((0, 0, 0), (500, 200, 60), (500, 100, 50), (500, -100, 0))])
    rng = np.random.default_rng(8)
    s = rng.uniform(0.0, chain.length_m, 300)
    points = chain.sample(s)[0] + rng.normal(size=(300, 3)) * rng.choice([0.1, 3.0, 80.0], (300, 1))
    guessed, found = chain.nearest(points, s + rng.uniform(-0.5, 0.5, 300)), chain.nearest(points)
    assert np.allclose(guessed[0], found[0], atol=1e-4)
    assert np.allclose(guessed[1], found[1], atol=1e-7)


def test_nearest_past_the_end_and_not_finite() -> None:
    chain = Chain([ph.hermite((0, 0, 0), (100, 0, 0), (100, 0, 0), (100, 0, 0))])
    s, distance = chain.nearest(np.array([[40.0, 3.0, 4.0], [112.0, 0.0, 2.0], [np.nan, 0.0, 0.0]]))
    assert s[:2] == pytest.approx([40.0, 112.0])
    assert distance[:2] == pytest.approx([5.0, 2.0])
    assert np.isnan([s[2], distance[2]]).all()


@pytest.mark.parametrize(
    "shape",
    [
        {"kind": "racetrack", "straight_m": 700, "radius_m": 180, "laps": 1},
        {"kind": "swerve", "heading_deg": 40, "swing_m": 300, "swings": 5},
        {"kind": "random", "least_radius_m": [120, 200], "climb_at_most_deg": 10},
        {"kind": "circle", "radius_m": 150, "turns": 0.7},
    ],
    ids=lambda shape: str(shape["kind"]),
)
@pytest.mark.parametrize("far_m", [1.0, 60.0, 3000.0])
def test_nearest_of_many_pieces_without_a_guess_is_the_nearest_of_all(shape: dict[str, object], far_m: float) -> None:
    chain = course(1, **shape)  # the second random course is one of many pieces
    assert len(chain.curves) > FEW
    rng = np.random.default_rng(11)
    s = np.linspace(0.0, chain.length_m, 40_001)
    fine = chain.points(s)
    points = fine[rng.integers(0, len(fine), 80)] + far_m * rng.normal(size=(80, 3))
    found, distance = chain.nearest(points)
    end, along, _ = chain.frame(chain.length_m)
    nearest = cKDTree(fine).query(points)[0]
    for point, s_m, apart, sampled in zip(points, found, distance, nearest, strict=True):
        beyond = max(0.0, float((point - end) @ np.asarray(along)))  # the straight line past the end counts
        brute = min(sampled, np.linalg.norm(point - end - beyond * np.asarray(along)))
        assert apart == pytest.approx(brute, abs=2e-3)
        assert apart <= brute + 1e-9, "exact: no sample is nearer"
        assert np.linalg.norm(np.asarray(chain.frame(float(s_m))[0]) - point) == pytest.approx(apart, abs=1e-9)


def test_many_points_are_searched_in_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    chain = course(kind="racetrack", straight_m=700, radius_m=180)
    points = np.random.default_rng(2).uniform(-900.0, 900.0, (50, 3))
    whole = chain.nearest(points)
    monkeypatch.setattr("testbed.core.chain.BLOCK", 7 * len(chain.curves))
    assert np.allclose(chain.nearest(points), whole, atol=1e-9)


def test_a_lap_is_told_from_the_next_by_the_guess() -> None:
    chain = course(kind="racetrack", straight_m=500, radius_m=150, laps=3)
    lap = chain.length_m / 3
    point = np.array([chain.frame(200.0)[0]])
    for k in range(3):
        assert chain.nearest(point, np.array([200.0 + k * lap + 5.0]))[0][0] == pytest.approx(200.0 + k * lap, abs=1e-3)


def test_straight_on_before_and_past() -> None:
    path = ActivePath([ph.hermite((0, 0, 0), (1000, 0, 0), (1000, 0, 0), (1000, 0, 0))])
    assert path.frame(1010.0)[0] == pytest.approx((1010.0, 0.0, 0.0))
    assert path.frame(-10.0)[0] == pytest.approx((-10.0, 0.0, 0.0))
    assert path.leg(5.0) == 0


@pytest.mark.parametrize("pieces", [1, 3, 3 * FEW])
def test_frames_are_the_frames_one_by_one_to_the_last_bit(pieces: int) -> None:
    chain = course(kind="circle", radius_m=200, turns=pieces / 24)
    assert len(chain.curves) == pieces
    s = np.concatenate([[0.0, *chain.starts_m, chain.length_m], np.random.default_rng(6).uniform(0.0, chain.length_m, 90)])
    for part, columns in enumerate(chain.frames(s)):
        assert np.array(columns).T.tolist() == [list(chain.frame(float(x))[part]) for x in s]
    beyond = np.concatenate([s, [-30.0, chain.length_m + 30.0]])
    assert [chain.tangent(float(x)) for x in beyond] == [chain.frame(float(x))[1] for x in beyond]
    assert np.array_equal(chain.tangents(beyond), chain.sample(beyond)[1])


def test_places_of_many_pieces_are_the_points() -> None:
    chain = course(kind="racetrack", straight_m=500, radius_m=150)
    s = np.linspace(-50.0, chain.length_m + 50.0, 777)
    np.testing.assert_allclose(chain.places(s), chain.points(s), atol=1e-9)


def test_nearest_of_many_pieces_from_a_guess_settles_within_a_micrometre() -> None:
    chain = course(1, kind="random", least_radius_m=[120, 200], climb_at_most_deg=10)
    rng = np.random.default_rng(5)
    s = rng.uniform(5.0, chain.length_m - 5.0, 200)
    points = chain.points(s) + rng.normal(size=(200, 3)) * 2.0
    found, distance = chain.nearest(points, s + rng.uniform(-2.0, 2.0, 200))
    foot, along, _ = chain.sample(found)
    assert np.abs(np.einsum("ij,ij->i", points - foot, along)).max() < 1e-6, "it is the foot of a perpendicular"
    assert np.linalg.norm(points - foot, axis=1) == pytest.approx(distance, abs=1e-9)
    assert np.abs(found - chain.nearest(points)[0]).max() < 1e-6


def test_a_used_chain_pickles_like_a_fresh_one() -> None:
    chain, path = course(kind="circle", radius_m=200), ActivePath(course(kind="circle", radius_m=200).curves, 7.0)
    fresh = pickle.dumps(chain), pickle.dumps(path)
    for used in (chain, path):
        used.tangent(3.0), used.places(np.array([4.0])), used.nearest(np.zeros((1, 3)))
    assert (pickle.dumps(chain), pickle.dumps(path)) == fresh
    again = pickle.loads(fresh[1])
    assert isinstance(again, ActivePath)
    assert (again.begin_s_m, again.curves, again.look_up(5.0)) == (7.0, path.curves, path.look_up(5.0))
