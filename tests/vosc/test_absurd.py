"""Finite but absurd numbers: an answer without NaN, or a refusal by name; never another exception, never a warning.

The numbers are drawn from those that break formulas (denormals, 1e-160 whose square is lost, 1e30, 1e300, equal vectors, zeros) mixed
with ordinary ones. The suite turns warnings into errors.
"""

# ruff: noqa: B023, E731, PT017  (what is called is called at once)

import dataclasses
import math

import numpy as np
import pytest

from vosc import (
    Degenerate,
    NoCurve,
    NoDirection,
    NotNumbers,
    Obstacle,
    OutOfProportion,
    Own,
    Refusal,
    SamePoint,
    WrongAnswer,
    WrongOption,
    cap,
    insertion_point,
    ph,
    threat,
    widest_join,
)
from vosc.direction import boundary_curves, cap_gap, choose, corner_points, point_on_cap
from vosc.encounter import closest_point, cone_margin
from vosc.insertion import major_obstacle
from vosc.methods import METHODS, avoid

ODD = [0.0, -0.0, 5e-324, 1e-310, -1e-300, 1e-160, 1e-154, 1e-30, 1e-12, 1.0, 1e9, -1e15, 1e20, 9.9e29, -1e30, 1e31, 1e160, -1e300]


class Draws:
    """Numbers and vectors of one scene; vectors come back, so that points coincide and velocities are equal."""

    def __init__(self, seed):
        self.rng, self.pool = np.random.default_rng(seed), []
        self.share = float(self.rng.choice([0.0, 0.1, 0.4, 0.9]))

    def number(self, size=250.0, share=0.3):
        return float(self.rng.choice(ODD)) if self.rng.random() < share else float(self.rng.normal() * size)

    def vector(self, size=250.0):
        if self.pool and self.rng.random() < 0.15:
            return self.pool[self.rng.integers(len(self.pool))]
        out = (0.0, 0.0, 0.0) if self.rng.random() < 0.08 else tuple(self.number(size, self.share) for _ in range(3))
        self.pool.append(out)
        return out


def check(value):
    """No NaN anywhere; arrays are finite."""
    if isinstance(value, np.ndarray):
        assert value.dtype.kind != "f" or np.isfinite(value).all()
    elif isinstance(value, float):
        assert not math.isnan(value)
    elif isinstance(value, tuple | list):
        for part in value:
            check(part)
    elif dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            check(getattr(value, field.name))


def answered(call):
    """The answer, looked at; ``None`` for a refusal by name."""
    try:
        out = call()
    except Refusal as refusal:
        assert len(str(refusal)) > 15
        return None
    check(out)
    return out


def encounters(draws):
    own = answered(lambda: Own(draws.vector(), draws.vector(60.0)))
    if own is None:
        return None, []
    obstacles = []
    for _ in range(int(draws.rng.choice([1, 2, 3, 15]))):
        near = np.array(own.pos_m) + draws.rng.normal(size=3) * draws.rng.choice([1e-12, 1.0, 100.0, 1e20])
        place = near if draws.rng.random() < 0.6 else draws.vector()
        one = answered(lambda place=place: Obstacle(place, draws.vector(60.0), abs(draws.number(20.0, 0.2))))
        obstacles += [] if one is None else [one]
    return own, obstacles


@pytest.mark.parametrize("block", range(6))
def test_every_method_answers_or_refuses_by_name(block):
    several = 0
    for seed in range(25):
        draws = Draws([41, block, seed])
        own, obstacles = encounters(draws)
        if not obstacles:
            continue
        several += 1
        size = lambda draws=draws: abs(draws.number(30.0))
        options = [(m, {}) for m in METHODS] + [
            ("scoam", {"boundary": "exact", "consider": "all"}),
            ("scoam", {"consider": "all", "corners_only": True}),
            ("scoam", {"consider": "all", "objective": "least_climb_change"}),
            ("scoam", {"consider": "all", "objective": "goal", "goal": draws.vector()}),
            ("orca", {"horizon_s": size()}),
            ("orca", {"keep_speed": False}),
            ("least_deflection", {"speed_range_mps": (size(), size())}),
            ("potential_field", {"gain": size(), "reach": size(), "goal": draws.vector()}),
            ("planes", {"n": 5, "offset_rad": draws.number(1.0)}),
        ]
        for method, chosen in options:
            answered(lambda m=method, c=chosen: avoid(m, own, obstacles, **c))
        answered(lambda: major_obstacle(own, obstacles))
        for objective in ("least_deflection", "least_climb_change", "right_of_way"):
            answered(lambda o=objective: choose(own, obstacles, o, "paper"))
        for o in obstacles[:2]:
            for call in (threat, cap, closest_point, insertion_point, boundary_curves, cap_gap):
                answered(lambda call=call, o=o: call(own, o))
            answered(lambda o=o: insertion_point(own, o, 1.0 + size(), "paper_4_3_2"))
            answered(lambda o=o: cone_margin(own.pos_m, own.vel_mps, o))
        caps = [c for c in (cap(own, o) for o in obstacles[:2]) if c is not None]
        for c in caps:
            answered(lambda c=c: point_on_cap(c, 1.0))
        if len(caps) == 2:
            answered(lambda: corner_points(*caps, math.hypot(*own.vel_mps)))
    assert several > 8


@pytest.mark.parametrize("block", range(6))
def test_every_path_is_one_or_is_refused_by_name(block):
    for seed in range(40):
        draws = Draws([42, block, seed])
        ends = tuple(draws.vector() for _ in range(4))
        curve = answered(lambda: ph.hermite(*ends))
        if curve is not None:
            s = np.array([0.0, 0.3, 1.0]) * curve.length_m
            answered(lambda: (curve.length_m, curve.min_radius_m, curve.min_speed, curve.climb_range_rad()))
            assert not math.isnan(curve.max_curvature())
            for call in (curve.frame, curve.point, curve.tangent, curve.curvature):
                answered(lambda call=call: tuple(call(x) for x in (*s.tolist(), draws.number())))
            answered(lambda: (curve.sample(s), curve.points(s), curve.tail(0.4 * curve.length_m).climb_range_rad()))
            answered(lambda: curve.nearest(np.array([draws.vector(), (1.0, 2.0, 3.0)])))
        many = ph.hermite_many(*(np.array([x, (1.0, 2.0, 3.0)], dtype=float) for x in ends))
        lost = np.isnan(many.length_m())
        assert (np.isnan([*many.e, *(c for a in many.a for c in a)]).all(axis=0) == lost).all()  # a row is lost as a whole
        many.evaluate(np.linspace(0.0, 1.0, 5))
        answered(lambda: many.curve(0))
        if seed % 4 == 0:
            join = answered(lambda: widest_join(*ends))
            if join is not None:
                answered(lambda: join.frames(7))
            limits = answered(lambda: ph.Limits(50.0, abs(draws.number(0.01)), -0.3, abs(draws.number(0.2)), abs(draws.number(0.5))))
            if limits is not None:
                bend = None if seed % 8 else draws.vector(0.01)
                answered(lambda: ph.flyable(*ends, limits, bend, grid=3))


@pytest.mark.parametrize(
    ("call", "refusal"),
    [
        (lambda: Own((10**400, 0, 0), (1, 0, 0)), NotNumbers),
        (lambda: Obstacle((0, 0, 0), (1, 0, 0), 0.0), NotNumbers),
        (lambda: Obstacle((0, 0, 0), (1, 0, 0), 10**400), NotNumbers),
        (lambda: ph.hermite((0, 0, 0), (0, 0, 0), (1, 0, 0), (1, 0, 0)), NoDirection),
        (lambda: ph.hermite((1, 0, 0), (1, 0, 0), (1, 0, 0), (1, 0, 0)), SamePoint),
        (lambda: ph.hermite((0, 0, 0), (1, 0, 0), (1e-200, 0, 0), (1, 0, 0)), SamePoint),
        (lambda: ph.hermite((0, 0, 0), (1e-200, 0, 0), (1, 0, 0), (1, 0, 0)), OutOfProportion),
        (lambda: ph.hermite((0, 0, 0), (1, 0, 0), (1, 0, 0), (0, 1e6, 0)), OutOfProportion),
        (lambda: ph.Curve((0, 0, 0), (1, 0, 0), ((0, 0, 0),) * 3), NoCurve),
        (lambda: ph.Curve((0, 0, 0), (1, 0, 0), ((math.nan, 0, 0),) * 3), NotNumbers),
        (lambda: ph.hermite_many(*np.zeros((4, 1, 3))).curve(0), NoCurve),
        (lambda: ph.flyable((0, 0, 0), (1, 0, 0), (9, 0, 0), (1, 0, 0), ph.Limits(50.0), (0, 1e9, 0)), OutOfProportion),
        (lambda: ph.flyable((0, 0, 0), (1, 0, 0), (9, 0, 0), (1, 0, 0), ph.Limits(50.0), grid=1), WrongOption),
        (lambda: widest_join((0, 0, 0), (1, 0, 0), (1e-200, 0, 0), (1, 0, 0)), SamePoint),
        (lambda: widest_join((0, 0, 0), (0, 0, 0), (1, 0, 0), (1, 0, 0)), NoDirection),
        (lambda: widest_join((0, 0, 0), (1, 0, 0), (-5, 0, 0), (1, 0, 0)).frames(), NoCurve),
        (lambda: avoid("swerve", Own((0, 0, 0), (1, 0, 0)), []), WrongOption),
        (lambda: avoid(lambda *_: None, Own((0, 0, 0), (9, 0, 0)), [Obstacle((99, 0, 0), (0, 0, 0), 9)]), WrongAnswer),
    ],
)
def test_a_refusal_has_the_name_of_its_reason(call, refusal):
    with pytest.raises(refusal) as told:
        call()
    assert type(told.value) is refusal
    assert isinstance(told.value, ValueError)
    assert isinstance(told.value, Degenerate) == (refusal in (SamePoint, NoDirection, OutOfProportion, NoCurve))


def test_limits_that_nothing_meets_are_missed_without_a_warning():
    found = ph.flyable((0, 0, 0), (1, 0, 0), (90, 40, 9), (1, 0, 0), ph.Limits(50.0, 5e-324, -0.1, 0.1, 5e-324), grid=3)
    assert not found.ok
    assert found.curve is not None
    assert "curvature" in found.missed


def test_a_sphere_that_is_touched_and_one_that_is_a_point():
    own = Own((0, 0, 0), (50, 0, 0))
    for radius in (5e-324, 1e-300, math.nextafter(100.0, 0.0), 100.0):
        answer = avoid("least_deflection", own, [Obstacle((100, 0, 0), (0, 0, 0), radius)])
        assert answer.status in ("clear", "avoided")
