"""The algebra of closed loops, against forms that can be worked out by hand."""

import math

import numpy as np
import pytest

from testbed.airframe.gains import MOST_SENSITIVITY, lateral_gains, pitch_gains, search
from testbed.airframe.linearise import linearise
from testbed.airframe.loops import ClosedLoop, elevator_per_load_factor, lateral, pitch
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.plants.rig import Rig

LAGS = (0.04, 0.0, 0.0125)


def third_order(gain: float) -> ClosedLoop:
    """L = gain / (s + 1)^3: crosses -180 deg at sqrt 3 rad/s, where the gain margin is 8 / gain."""
    a = np.array([[-1.0, 1.0, 0.0], [0.0, -1.0, 1.0], [0.0, 0.0, -1.0]])
    b, row = np.array([0.0, 0.0, 1.0]), np.array([-gain, 0.0, 0.0])
    return ClosedLoop(a + np.outer(b, row), gain * b, np.array([1.0, 0.0, 0.0]), b, ((a, b, row),))


def test_margins_of_a_third_order_loop() -> None:
    loop = third_order(2.0)
    phase, gain = loop.margins(0)
    crossover = math.sqrt(2.0 ** (2.0 / 3.0) - 1.0)
    assert gain == pytest.approx(4.0, rel=0.1)  # on the frequency grid
    assert phase == pytest.approx(math.pi - 3.0 * math.atan(crossover), abs=0.03)
    assert loop.stable
    assert not third_order(8.5).stable


def test_step_of_a_loop_ends_where_it_must() -> None:
    response = third_order(2.0).step(40.0, 0.05)
    assert response[0] == 0.0
    assert response[-1] == pytest.approx(2.0 / 3.0, abs=1e-6)


def test_search_finds_a_minimum_in_a_corner() -> None:
    found = search(lambda g: abs(math.log(g["a"] / 3.0)) + 5.0 * abs(math.log(g["a"] * g["b"])), {"a": 0.1, "b": 0.1})
    assert found["a"] == pytest.approx(3.0, rel=0.05)
    assert found["b"] == pytest.approx(1.0 / 3.0, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "speed"), [("gtm_t2", 50.0), ("t37", 90.0)])
def test_inner_loops_are_stable_and_as_robust_as_they_should_be(name: str, speed: float) -> None:
    aircraft = load_aircraft(name)
    model = linearise(Rig(aircraft, speed))
    gains = pitch_gains(model, lateral_gains(model, aircraft.autopilot, LAGS), LAGS)
    for loop in (lateral(model, gains, LAGS), pitch(model, gains, LAGS)):
        assert loop.stable
        assert loop.sensitivity() <= MOST_SENSITIVITY + 1e-3
        assert loop.step(20.0, 0.02)[-1] == pytest.approx(1.0, abs=0.05)
    assert elevator_per_load_factor(model) == pytest.approx(-gains.elevator_per_load_factor, rel=5e-3)


@pytest.mark.slow
def test_feed_forward_of_the_rudder_makes_a_turn_without_sideslip() -> None:
    """Steady turn by hand: with v = p = 0 and r = (g / V) cos(pitch) bank, the yawing moments of turn rate, aileron and rudder cancel."""
    aircraft = load_aircraft("t37")  # adverse yaw: its aileron yaws as much as its rudder
    model = linearise(Rig(aircraft, 90.0))
    gains = lateral_gains(model, aircraft.autopilot, LAGS)
    turn_rate, aileron = 0.1, 0.2
    rudder = gains.rudder_per_aileron * aileron + gains.rudder_per_turn_rate_s * turn_rate
    moment = model.a_lat[2, 2] * turn_rate + model.b_lat[2] @ [aileron, rudder]
    assert moment == pytest.approx(0.0, abs=0.01 * abs(model.b_lat[2, 1] * rudder))


@pytest.mark.parametrize(("name", "speed"), [("gtm_t2", 50.0), ("c172p", 50.0), ("t37", 90.0)])
def test_an_upset_of_the_rudder_leaves_no_sideslip(name: str, speed: float) -> None:
    """A rudder out of trim by what would hold one radian of sideslip: the integral takes it out."""
    aircraft = load_aircraft(name)
    loop = lateral(linearise(Rig(aircraft, speed)), aircraft.autopilot, LAGS, "sideslip")
    slip = np.abs(loop.step(20.0, 0.02, disturbed=True))
    assert 0.01 < slip.max() < 1.0
    assert slip[-1] < 0.01 * slip.max()
