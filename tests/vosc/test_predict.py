"""The fast point mass: the equations of the plant in batches, a second lag in closed form, distances in closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest

from testbed.core.units import DEG
from testbed.flight.guidance.bank_to_turn import BankToTurn
from testbed.flight.planning.prediction import Lags, aeroplane_of
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.plants.base import Command, Start
from testbed.flight.plants.point_mass import PointMassPlant
from vosc.predict import Aeroplane, Directions, Flown, Motion, Spheres, fly_on, least_clearance, step
from vosc.predict.aeroplane import drag, thrust_wanted
from vosc.predict.guided import asked_for

WIND = (4.0, -3.0, 0.0)
DT_S = 1.0 / 120.0
ROLLS_AT_ONCE = aeroplane_of(load_aircraft("gtm_t2"), None)


def steady_wind(_time_s: float, _pos: tuple[float, float, float]) -> tuple[float, float, float]:
    return WIND[0], 0.0, 0.0


def batch(aeroplane: Aeroplane, count: int, speed: float = 50.0) -> Motion:
    """Level flight along x."""
    thrust = drag(aeroplane, speed, 1.0)
    values = (0.0, 0.0, 0.0, speed, 0.0, 0.5 * math.pi, 0.0, 0.0, 1.0, 0.0, thrust)
    return Motion(*(np.full(count, value) for value in values))


@pytest.mark.parametrize("name", ["gtm_t2", "c172p"])
def test_a_batch_moves_as_the_plant_does_step_for_step(name: str) -> None:
    aircraft = load_aircraft(name)
    aeroplane, speed = aeroplane_of(aircraft, None), aircraft.autopilot.reference_mps
    commands = [(60 * DEG, 2.2), (-40 * DEG, 1.5), (0.0, 0.2), (25 * DEG, 1.0)]
    ground = speed + WIND[0]
    start = Start((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), speed, (WIND[0], 0.0, 0.0))
    plants = [PointMassPlant(aircraft, start, steady_wind, 120, hold_speed=False) for _ in commands]
    now, (bank, load) = batch(aeroplane, len(commands), speed), np.array(commands).T
    assert plants[0].state(plants[0].sample()).vx == pytest.approx(ground)
    for _ in range(240):
        thrust = thrust_wanted(aeroplane, now.speed, load, 0.1, speed + 3.0)
        now = step(aeroplane, now, bank, load, thrust, DT_S, (WIND[0], 0.0, 0.0))
        for plant, (bank_cmd, load_cmd) in zip(plants, commands, strict=True):
            # the plant's thrust takes the drag at the load factor that is commanded, as here
            plant.command(plant.state(plant.sample()), Command(bank_cmd, load_cmd, speed + 3.0, 0.1))
            plant.step()
    for k, plant in enumerate(plants):
        state = plant.state(plant.sample())
        got = (now.x[k], now.y[k], now.z[k], now.bank[k], now.load[k], now.speed[k])
        assert got == pytest.approx((state.x, state.y, state.z, state.bank, state.load_factor, state.airspeed), abs=1e-8)


def test_a_rate_that_comes_about_with_a_lag_is_a_second_order_answer() -> None:
    """With x'' = ((c - x) / lag - x') / start, lag 0.2 s and start 0.1 s: frequency 7.07 rad/s, damping 0.707."""
    slow = replace(ROLLS_AT_ONCE, bank_lag_s=0.2, roll_start_s=0.1, roll_rate_radps=1e3)
    now, dt = batch(slow, 1), 1e-4
    frequency, damping, command = 1.0 / math.sqrt(0.02), math.sqrt(0.5), 0.5
    for _ in range(3000):
        now = step(slow, now, command, 1.0, 0.1, dt, (0.0, 0.0, 0.0))
    t, ringing = 0.3, frequency * math.sqrt(1.0 - damping**2)
    exact = 1.0 - math.exp(-damping * frequency * t) * (math.cos(ringing * t) + damping * frequency / ringing * math.sin(ringing * t))
    assert now.bank[0] == pytest.approx(command * exact, rel=1e-3)


def test_limits_are_those_of_the_guidance() -> None:
    aircraft = load_aircraft("gtm_t2")
    rng = np.random.default_rng(3)
    left, up, bank, speed = rng.normal(0, 25, 200), rng.normal(8, 25, 200), rng.uniform(-1.2, 1.2, 200), rng.uniform(5, 90, 200)
    banks, loads = asked_for(ROLLS_AT_ONCE, left, up, bank, speed)
    law = BankToTurn(aircraft.limits)
    for row in zip(left, up, bank, speed, banks, loads, strict=True):
        assert law.solve(row[0], row[0], row[1], row[2], row[3])[:2] == pytest.approx(row[4:], abs=1e-12)


def test_a_held_direction_is_reached_and_a_coarse_prediction_is_near_a_fine_one() -> None:
    lagged = aeroplane_of(load_aircraft("gtm_t2"), Lags(bank_lag_s=0.137, roll_start_s=0.125, load_lag_s=0.174, load_start_s=0.022))
    to = np.array([[math.cos(0.6), math.sin(0.6), 0.0], [math.cos(0.3), 0.0, math.sin(0.3)], [math.cos(0.4), -math.sin(0.4), 0.0]]).T
    places = []
    for dt in (0.05, 0.0125):
        flown = fly_on(lagged, batch(lagged, 3), Directions(*to), np.arange(0.0, 3.0 + 0.5 * dt, dt), WIND, 50.0)
        places.append(np.array([flown.x[-1], flown.y[-1], flown.z[-1]]))
        velocity = np.array([flown.end_vx, flown.end_vy, flown.end_vz])
        assert ((velocity * to).sum(axis=0) / np.linalg.norm(velocity, axis=0) > math.cos(3 * DEG)).all()
    assert np.linalg.norm(places[0] - places[1], axis=0).max() < 1.2


def test_clearance_is_exact_between_the_times_and_after_them() -> None:
    times = np.array([0.0, 1.0, 2.0])
    x = np.outer(times, [50.0, 0.0])
    flown = Flown(times, x, np.zeros((3, 2)), np.zeros((3, 2)), np.array([50.0, 0.0]), np.zeros(2), np.zeros(2), np.zeros(2), x)
    spheres = Spheres(np.array([[75.0, 7.0, 0.0], [300.0, 4.0, 0.0]]), np.array([[0.0, 0.0, 0.0], [-50.0, 0.0, 0.0]]), np.array([5.0, 1.0]))
    clearance, when = least_clearance(flown, spheres)
    assert clearance == pytest.approx([2.0, 3.0])  # the first passes a standing one at 1.5 s; the other, which stands, is met at 6 s
    assert when == pytest.approx([1.5, 6.0])
