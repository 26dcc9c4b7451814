"""Finite but absurd numbers: an answer without NaN, or a refusal by name; never another exception, never a warning.

The suite turns warnings into errors. ``absurd.py`` draws the scenes; what its long runs found has a test of its kind here.
"""

import math

import numpy as np
import pytest

from tests.vosc import absurd
from vosc import (
    Degenerate,
    NoCurve,
    NoDirection,
    NotNumbers,
    Obstacle,
    OutOfProportion,
    Own,
    SamePoint,
    WrongAnswer,
    WrongOption,
    cap,
    ph,
    widest_join,
)
from vosc.encounter import closest_point
from vosc.methods import METHODS, avoid

EVERYTHING = {"Curve.frame", "hermite_many", "closest_point", *(f"avoid {m} " for m in METHODS)}


@pytest.mark.parametrize("block", range(2))
def test_everything_answers_or_refuses_by_name(block):
    """Scenes without the two long searches."""
    log = absurd.Log()
    for number in range(40 * block, 40 * block + 20):
        if number % 4:
            absurd.scene(log, 1_000_000 + number)
    assert not log.failures, str(log)
    assert sum(log.answers.values()) > 300
    assert log.answers.keys() >= EVERYTHING


@pytest.mark.slow
def test_the_long_searches_answer_or_refuse_by_name():
    log = absurd.Log()
    for number in range(0, 48, 4):
        absurd.scene(log, 2_000_000 + number)
    assert not log.failures, str(log)
    assert log.answers.keys() >= EVERYTHING | {"flyable", "widest_join", "Join.frames"}


def test_the_log_tells_what_is_wrong():
    """A NaN, another exception, a warning and a refusal without words are failures; an answer and a refusal are not."""
    log = absurd.Log()
    log.tried("good", lambda: (1.0, np.ones(3)))
    log.tried("good", lambda: Own((math.nan, 0, 0), (1, 0, 0)))
    assert not log.failures
    log.tried("nan", lambda: [1.0, (2.0, math.nan)])
    log.tried("array", lambda: np.array([1.0, math.inf]))
    log.tried("divided", lambda: 1 / 0)
    log.tried("warned", lambda: np.float64(1e300) * np.float64(1e300))
    assert len(log.failures) == 4


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


@pytest.mark.parametrize("speed", [50.0, 1e-90, 1e-170, 1e-323])
def test_the_closest_point_depends_on_the_direction_of_the_motion_alone(speed):
    """Of small speeds the square is lost: nothing is divided by it."""
    point = closest_point(Own((0, 0, 0), (speed, 0, speed)), Obstacle((90, 30, 10), (0, 0, 0), 5))
    np.testing.assert_allclose(point, (-40, -30, 40), atol=1e-9)


def test_a_turn_that_a_cone_holds_equally_deep_all_round_divides_by_nothing():
    """The way to the edge of the cone is estimated from how fast the depth falls; here it does not fall at all."""
    own = Own((0, 0, 0), (1e20, 0, 0))
    above = Obstacle((0, 0, 100), (0, 0, -1e21), 50)
    assert avoid("droam_hp", own, [above]).status == "undefined"


@pytest.mark.parametrize("t", [0.0, 0.3, 1.0])
def test_a_point_of_a_curve_whose_speed_has_no_square_is_a_cusp(t):
    """The preimage passes through 1e-80 of a root of metres at one end, so the speed is 1e-160 there and its square is lost."""
    curve = ph.Curve((1, 2, 3), (1, 0, 0), ((1e-80, 0, 0), (0.3, 1, 0), (1, 3, 0.4)))
    point, tangent, bend = curve.frame(t * curve.length_m)
    points, tangents, bends = curve.sample(np.array([t]) * curve.length_m)
    assert np.isfinite([*point, *tangent, *bend]).all()
    np.testing.assert_allclose([*point, *tangent, *bend], np.concatenate([points[0], tangents[0], bends[0]]), rtol=1e-9, atol=1e-12)
    if t == 0.0:
        assert tangent == (1.0, 0.0, 0.0)
        assert bend == (0.0, 0.0, 0.0)


def test_a_curve_made_of_numpy_numbers_is_one_of_floats():
    """Sums of single-precision numbers overflow at 3e38, with a warning."""
    given = np.full((3, 3), 1e25, dtype=np.float32)
    curve = ph.Curve(np.zeros(3), np.array([1.0, 0.0, 0.0]), given)
    assert curve == ph.Curve((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), tuple(map(tuple, given.astype(float))))
    assert curve.length_m == pytest.approx(3e50, rel=1e-6)


def test_a_speed_whose_square_has_no_room_is_refused():
    with pytest.raises(WrongOption, match="speed"):
        ph.Limits(1.7e308)
    assert ph.flyable((0, 0, 0), (1, 0, 0), (90, 40, 9), (1, 0, 0), ph.Limits(1e30), grid=3).curve is not None


@pytest.mark.parametrize("speed", [0.0, 5e-324, 1e-170])
def test_at_rest_there_is_no_cap_however_slow_the_obstacle(speed):
    """The circle's half-angle is a length over the own speed."""
    own, slow = Own((0, 0, 0), (speed, 0, 0)), Obstacle((-50, 300, -690), (5e-324, -1e-310, -5e-324), 27)
    assert cap(own, slow) is None
    assert avoid("scoam", own, [slow]).velocity_mps.tolist() == [speed, 0.0, 0.0]
