"""Of many obstacles only those that can matter are decided exactly: the answer is that of the library without any pruning."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.vosc.draws import percent
from vosc import Obstacle, Own, crowd
from vosc.cone import cone_of, is_free, outside
from vosc.free import zeros
from vosc.methods import METHODS, avoid
from vosc.methods.orca import forbidden_circles, half_space, rough_half_spaces
from vosc.turns import GRID, great_circle, least_turn, level_circle

CASES = [(m, {}) for m in METHODS] + [
    ("scoam", {"boundary": "exact", "consider": "all"}),
    ("scoam", {"consider": "all", "objective": "right_of_way"}),
    ("orca", {"horizon_s": 4.0}),
    ("orca", {"responsibility": 0.5}),
    ("planes", {"n": 31, "offset_rad": 0.1}),
]


def told(answer):
    return answer.status, answer.velocity_mps.tolist(), answer.deflection_rad, answer.margin_rad


@pytest.mark.parametrize("kind", range(8))
def test_the_rough_look_at_many_does_not_change_an_answer(scenes, monkeypatch, kind):
    rng = np.random.default_rng([31, kind])
    drawn = [scenes.awkward(rng, n, kind) for n in ([2, 3, 5, 14] if kind == 4 else [2, 3, 5, 14, 40])]
    monkeypatch.setattr(crowd, "FEW", 1)
    rough = [[told(avoid(m, *scene, **options)) for m, options in CASES] for scene in drawn]
    monkeypatch.setattr(crowd, "FEW", 10**9)
    for scene, found in zip(drawn, rough, strict=True):
        assert [told(avoid(m, *scene, **options)) for m, options in CASES] == found


near_number = st.one_of(st.floats(-300.0, 300.0), st.sampled_from([-50.0, 0.0, 50.0, 1e-9, 100.0]))
near_vector = st.tuples(near_number, near_number, near_number)


@given(near_vector, st.lists(st.tuples(near_vector, near_vector, st.floats(0.5, 60.0)), min_size=1, max_size=5))
@percent(40)
def test_drawn_scenes_too(velocity, drawn):
    own, obstacles = Own((0, 0, 0), velocity), [Obstacle(*o) for o in drawn]
    found = []
    for few in (1, 10**9):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(crowd, "FEW", few)
            found.append([told(avoid(m, own, obstacles)) for m in ("least_deflection", "orca", "planes", "scoam")])
    assert found[0] == found[1]


def least_turn_of_all(cones, circles, senses):
    """Every circle to both sides, every stretch, every cone: nothing left out."""
    best = None
    step = 2 * math.pi / GRID
    for sense, circle in itertools.product(senses, circles):
        for k in range(GRID // 2):
            found = [k * step]
            for cone in cones:
                found += zeros(lambda x, cone=cone: outside(cone, circle.at(sense * x)), k * step, (k + 1) * step)  # noqa: B023
            free = [x for x in sorted(found) if x <= math.pi and is_free(cones, circle.at(sense * x))]
            if free:
                if best is None or free[0] < best[0] - 1e-12:
                    best = free[0], circle.at(sense * free[0])
                break
    return None if best is None else best[1]


@pytest.mark.parametrize("kind", range(8))
def test_the_least_turn_is_the_least_of_all(scenes, kind):
    rng = np.random.default_rng([32, kind])
    answers = 0
    for count in (1, 2, 4, 8):
        own, obstacles = scenes.awkward(rng, count, kind)
        obstacles = [Obstacle(np.array(own.pos_m) + 3 * np.array(own.vel_mps), (0, 0, 0), rng.uniform(5, 140)), *obstacles]
        cones = [c for c in (cone_of(own, o) for o in obstacles) if c is not None]
        u = np.array(own.vel_mps) / 50.0
        across = [np.cross(u, scenes.sized(rng, 1.0)) for _ in range(4)]
        circles = [great_circle(own.vel_mps, tuple(a / np.linalg.norm(a))) for a in across]
        for some, senses in ((circles, (-1, 1)), ([level_circle(own.vel_mps)], (1, -1))):
            expected = least_turn_of_all(cones, some, senses)
            found = least_turn(cones, some, senses)
            assert (found is None) == (expected is None)
            if found is not None:
                answers += 1
                assert np.linalg.norm(np.subtract(found, expected)) < 1e-6
    assert answers > 2


@pytest.mark.parametrize("horizon_s", [math.inf, 4.0])
def test_rough_half_spaces_are_those_of_the_scalar_formula_where_they_are_given(scenes, horizon_s):
    rng = np.random.default_rng(33)
    known = 0
    for kind in range(8):
        own, obstacles = scenes.awkward(rng, 30, kind)
        normals, offsets = rough_half_spaces(own, crowd.Scene(obstacles), 1.0, horizon_s)
        for o, offset, *normal in zip(obstacles, offsets, *normals, strict=True):
            if not math.isnan(offset):
                known += 1
                space = half_space(own, o, 1.0, horizon_s)
                assert np.allclose(space.normal, normal, rtol=0, atol=1e-8)
                assert abs(space.offset - offset) < 1e-8 * 50.0
    assert known > 100


def test_a_half_space_beyond_the_own_speed_is_seen_among_many():
    own = Own((0, 0, 0), (10, 0, 0))
    far = [Obstacle((1000.0 + k, 0, 0), (0, 0, 0), 1.0) for k in range(20)]
    assert forbidden_circles(own, crowd.Scene(far), 1.0, math.inf) is not None
    assert forbidden_circles(own, crowd.Scene([*far, Obstacle((60, 0, 0), (-100, 0, 0), 50)]), 1.0, math.inf) is None
