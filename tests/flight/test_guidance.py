"""The path-following law and the inner loops, without a simulator."""

import math

import numpy as np
import pytest

from testbed.flight.aircraft import load_aircraft
from testbed.flight.autopilot import Autopilot, Memory
from testbed.flight.guidance import LookAheadLaw
from testbed.flight.path import STEP_M, ActivePath
from testbed.flight.plants.base import Command, State
from testbed.units import DEG, G0_MPS2
from vosc import ph

LEVEL = State(0, 0, 0, 50, 0, 0, 0, 0.05, math.pi / 2, 1.0, 50, 0.05, 0, 0, 0, 0, 0.4, 0, 0, 0)
GTM = load_aircraft("gtm_t2")


def straight() -> ActivePath:
    return ActivePath((ph.hermite((0, 0, 0), (1000, 0, 0), (1000, 0, 0), (1000, 0, 0)),))


def law() -> LookAheadLaw:
    return LookAheadLaw(GTM, 50.0, True, 1 / 60)


@pytest.mark.parametrize(
    ("change", "bank_sign", "load_factor"),
    [
        ({}, 0, 1.0),
        ({"y": 5.0}, 1, None),  # left of the path (north of an eastbound one): bank right
        ({"y": -5.0}, -1, None),
        ({"vy": 3.0}, 1, None),  # drifting left: bank right
        ({"z": -4.0}, 0, 1.5),  # low: pull
        ({"z": 4.0}, 0, 0.4),
    ],
)
def test_commands_point_back_to_the_path(change: dict, bank_sign: int, load_factor: float | None) -> None:
    command, _, _ = law().step(law().start(100.0), LEVEL._replace(x=100.0, **change), straight())
    assert np.sign(round(command.bank, 9)) == bank_sign
    if load_factor is not None:
        expected = 1.0 - (change.get("z", 0.0)) * GTM.guidance.bandwidth_rad_s**2 / G0_MPS2
        assert command.load_factor == pytest.approx(expected, abs=1e-6)


def test_on_a_curve_the_bank_is_that_of_the_turn_ahead() -> None:
    """tan(bank) = V^2 kappa / g with the curvature at the look-ahead."""
    angle = 20 * DEG
    end = (400.0 * math.sin(angle), 400.0 * (1 - math.cos(angle)), 0.0)
    chord = math.hypot(*end)
    arc = ActivePath((ph.hermite((0, 0, 0), (chord, 0, 0), end, (chord * math.cos(angle), chord * math.sin(angle), 0)),))
    s = arc.length_m / 2 - 20.0
    (x, y, z), (tx, ty, tz), _ = arc.frame(s)
    state = LEVEL._replace(x=x, y=y, z=z, vx=50 * tx, vy=50 * ty, vz=50 * tz)
    command, memory, telemetry = law().step(law().start(s - 0.1), state, arc)
    assert telemetry.s_m == pytest.approx(s, abs=1e-3)
    ahead = np.linalg.norm(arc.frame(s + 50.0 * GTM.guidance.bank_lead_s)[2])
    assert command.bank == pytest.approx(-math.atan(2500.0 * ahead / G0_MPS2), rel=0.03)
    assert memory.s_m == pytest.approx(s + 50 / 60, abs=1e-3)


def test_limits_are_kept_and_flagged() -> None:
    command, memory, telemetry = law().step(law().start(100.0), LEVEL._replace(x=100.0, y=300.0, z=-300.0), straight())
    assert abs(command.bank) <= GTM.limits.bank_deg * DEG
    assert GTM.limits.load_factor_min <= command.load_factor <= GTM.limits.load_factor_max
    assert telemetry.saturated == 1.0
    assert (memory.ix, memory.iy, memory.iz) == (0.0, 0.0, 0.0), "no wind-up at a limit"


def test_a_slow_aircraft_is_not_asked_for_lift_it_does_not_have() -> None:
    slow = LEVEL._replace(x=100.0, z=-300.0, vx=32.0, airspeed=32.0)
    command, _, _ = law().step(law().start(100.0), slow, straight())
    assert command.load_factor == pytest.approx((32.0 / GTM.limits.alpha_max_1g_mps) ** 2)


def test_the_table_agrees_with_the_exact_path() -> None:
    first = ph.hermite((0, 0, 0), (90, 10, 5), (80, 30, 10), (60, 60, 20))
    path = ActivePath((first, ph.hermite((80, 30, 10), (60, 60, 20), (300, 60, 30), (150, -20, 0))))
    for s in np.linspace(0.3, path.length_m - 0.3, 997):
        d, (px, py, pz, tx, ty, tz, kx, ky, kz) = path.look_up(float(s))
        assert abs(d) <= STEP_M / 2 + 1e-9
        near = np.array([px, py, pz]) + d * np.array([tx, ty, tz]) + d * d / 2 * np.array([kx, ky, kz])
        point, tangent, _ = path.frame(float(s))
        assert np.linalg.norm(near - point) < 1e-3
        assert np.linalg.norm(np.array([tx, ty, tz]) + d * np.array([kx, ky, kz]) - tangent) < 0.01


def test_the_path_goes_on_straight_past_both_ends() -> None:
    path = straight()
    assert path.frame(1010.0)[0] == pytest.approx((1010.0, 0.0, 0.0))
    assert path.frame(-10.0)[0] == pytest.approx((-10.0, 0.0, 0.0))
    assert path.leg(5.0) == 0


@pytest.mark.parametrize(
    ("command", "surface", "sign"),
    [
        (Command(0.3, 1.0, 50, 0, 0), "aileron", 1),
        (Command(-0.3, 1.0, 50, 0, 0), "aileron", -1),
        (Command(0.0, 1.5, 50, 0, 0), "elevator", -1),
        (Command(0.0, 0.5, 50, 0, 0), "elevator", 1),
    ],
)
def test_surfaces_move_the_way_that_jsbsim_understands(command: Command, surface: str, sign: int) -> None:
    surfaces, _ = Autopilot(GTM, 0.4, 1 / 60).step(Memory(), LEVEL._replace(pitch=0.0), command)
    assert np.sign(getattr(surfaces, surface)) == sign


def test_throttle_follows_speed_and_climb_and_does_not_wind_up() -> None:
    autopilot = Autopilot(GTM, 0.4, 1 / 60)
    slow, memory = autopilot.step(Memory(), LEVEL, Command(0, 1, 55, 0, 0))
    climb, _ = autopilot.step(Memory(), LEVEL, Command(0, 1, 50, 0.1, 0))
    assert slow.throttle > 0.4 < climb.throttle
    assert memory.throttle > 0.0
    _, memory = autopilot.step(Memory(), LEVEL, Command(0, 1, 90, 0, 0))
    assert memory.throttle == 0.0
