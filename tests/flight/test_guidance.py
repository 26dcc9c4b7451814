"""The path-following law and the inner loops, without a simulator."""

import math

import numpy as np
import pytest

from testbed.core.units import DEG, G0_MPS2
from testbed.flight.guidance.l1 import L1Law
from testbed.flight.guidance.law import BANK_LIMITED, LIFT_LIMITED, SpeedHold
from testbed.flight.guidance.look_ahead import LookAheadLaw
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.plants.autopilot import Autopilot, Memory
from testbed.flight.plants.base import Command, State
from testbed.flight.route.path import STEP_M, ActivePath
from vosc import ph

LEVEL = State(0, 0, 0, 50, 0, 0, 0, 0.05, math.pi / 2, 1.0, 50, 0.05, 0, 0, 0, 0, 0.4, 0, 0, 0)
GTM = load_aircraft("gtm_t2")


def straight() -> ActivePath:
    return ActivePath((ph.hermite((0, 0, 0), (1000, 0, 0), (1000, 0, 0), (1000, 0, 0)),))


HOLD = SpeedHold(50.0, airspeed=True, keep_schedule=False)
LAWS = {"look_ahead": LookAheadLaw(GTM, HOLD, 1 / 60), "l1": L1Law(GTM, HOLD, 1 / 60)}


def law() -> LookAheadLaw:
    return LookAheadLaw(GTM, HOLD, 1 / 60)


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize(
    ("change", "bank_sign", "pull_sign"),
    [
        ({}, 0, 0),
        ({"y": 5.0}, 1, 0),  # left of the path (north of an eastbound one): bank right
        ({"y": -5.0}, -1, 0),
        ({"vy": 3.0}, 1, 0),  # drifting left: bank right
        ({"z": -4.0}, 0, 1),  # low: pull
        ({"z": 4.0}, 0, -1),
    ],
)
def test_commands_point_back_to_the_path(name: str, change: dict, bank_sign: int, pull_sign: int) -> None:
    law = LAWS[name]
    command, _, _ = law.step(law.start(100.0), LEVEL._replace(x=100.0, **change), straight())
    assert np.sign(round(command.bank, 9)) == bank_sign
    assert np.sign(round(command.load_factor - 1.0, 2)) == pull_sign


def test_a_height_error_asks_for_the_stiffness_of_the_loop() -> None:
    command, _, _ = law().step(law().start(100.0), LEVEL._replace(x=100.0, z=-4.0), straight())
    assert command.load_factor == pytest.approx(1.0 + 4.0 * GTM.guidance.bandwidth_rad_s**2 / G0_MPS2, abs=1e-6)


def test_l1_is_the_published_formula_in_level_flight() -> None:
    """A = 2 V^2 / L1 sin(eta), with L1 = sqrt(2) V / w and eta between the velocity and the line to the reference point."""
    length = math.sqrt(2.0) * 50.0 / GTM.guidance.bandwidth_rad_s
    off = 12.0
    one = LAWS["l1"]
    command, _, _ = one.step(one.start(100.0), LEVEL._replace(x=100.0, y=-off), straight())
    assert command.bank == pytest.approx(-math.atan(2 * 2500.0 / length * (off / length) / G0_MPS2), rel=1e-9)


@pytest.mark.parametrize(("behind", "airspeed"), [(2.0, 51.0), (-2.0, 49.0), (100.0, 53.0), (-100.0, 47.0)])
def test_time_lost_is_made_up_for_within_bounds(behind: float, airspeed: float) -> None:
    kept = SpeedHold(50.0, airspeed=True, keep_schedule=True).solve(LEVEL.airspeed, 50.0, behind)
    assert kept == (pytest.approx(airspeed), 50.0)
    assert HOLD.solve(LEVEL.airspeed, 50.0, behind) == (50.0, 50.0)


def test_what_is_held_in_a_wind() -> None:
    """Tail wind of 8 m/s: an airspeed hold flies on with its schedule at 58 m/s, a ground-speed hold asks for 42 m/s of airspeed."""
    assert HOLD.solve(LEVEL.airspeed, 58.0, 0.0) == (50.0, 58.0)
    assert SpeedHold(50.0, airspeed=False, keep_schedule=False).solve(LEVEL.airspeed, 58.0, 0.0) == (42.0, 50.0)


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
    assert telemetry.limited == LIFT_LIMITED
    assert (memory.left, memory.up) == (0.0, 0.0), "no wind-up at a limit"


def test_a_bank_limit_is_told_from_a_lift_limit() -> None:
    """High and to the left: the push-over leaves so little lift that the turn would need more bank than it may have."""
    command, _, telemetry = law().step(law().start(100.0), LEVEL._replace(x=100.0, y=6.0, z=5.5), straight())
    assert command.bank == pytest.approx(GTM.limits.bank_deg * DEG)
    assert telemetry.limited == BANK_LIMITED


def test_a_slow_aircraft_is_not_asked_for_lift_it_does_not_have() -> None:
    slow = LEVEL._replace(x=100.0, z=-300.0, vx=40.0, airspeed=40.0)
    command, _, _ = law().step(law().start(100.0), slow, straight())
    assert command.load_factor == pytest.approx((40.0 / GTM.limits.alpha_max_1g_mps) ** 2)


@pytest.mark.parametrize(("share", "most"), [(1.0, 1.0), (0.95, 0.6), (0.9, 0.2)])
def test_speed_before_height(share: float, most: float) -> None:
    """At the least speed nothing is left to climb with; slower than that the aircraft unloads and gains speed."""
    slow = share * GTM.limits.speed_min_mps
    command, _, telemetry = law().step(law().start(100.0), LEVEL._replace(x=100.0, z=-50.0, vx=slow, airspeed=slow), straight())
    assert command.load_factor == pytest.approx(most, abs=1e-9)
    assert telemetry.limited == LIFT_LIMITED


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


def test_the_table_goes_on_straight_past_both_ends() -> None:
    """A flight thrown far behind the start of its path once looked up rows from the end of the table."""
    path = ActivePath((ph.hermite((0, 0, 0), (60, 60, 20), (300, 60, 30), (150, -20, 0)),))
    beyond = path.length_m + 1000.0
    for s in (-5000.0, -40.0, -2.0, beyond):
        d, row = path.look_up(s)
        assert np.allclose(np.array(row[:3]) + d * np.array(row[3:6]), path.frame(s)[0], atol=0.05)
        assert row[6:] == (0.0, 0.0, 0.0)
    before, start, after = path.rows_at(-5000.0, 0.0, beyond)
    assert before == (*start[:6], 0.0, 0.0, 0.0)
    assert after[6:] == (0.0, 0.0, 0.0)


def test_the_path_goes_on_straight_past_both_ends() -> None:
    path = straight()
    assert path.frame(1010.0)[0] == pytest.approx((1010.0, 0.0, 0.0))
    assert path.frame(-10.0)[0] == pytest.approx((-10.0, 0.0, 0.0))
    assert path.leg(5.0) == 0


@pytest.mark.parametrize(
    ("command", "surface", "sign"),
    [
        (Command(0.3, 1.0, 50, 0), "aileron", 1),
        (Command(-0.3, 1.0, 50, 0), "aileron", -1),
        (Command(0.0, 1.5, 50, 0), "elevator", -1),
        (Command(0.0, 0.5, 50, 0), "elevator", 1),
    ],
)
def test_surfaces_move_the_way_that_jsbsim_understands(command: Command, surface: str, sign: int) -> None:
    surfaces, _ = Autopilot(GTM, 0.4, 1 / 60).step(Memory(), LEVEL._replace(pitch=0.0), command)
    assert np.sign(getattr(surfaces, surface)) == sign


def test_throttle_follows_speed_and_climb_and_does_not_wind_up() -> None:
    autopilot = Autopilot(GTM, 0.4, 1 / 60)
    slow, memory = autopilot.step(Memory(), LEVEL, Command(0, 1, 55, 0))
    climb, _ = autopilot.step(Memory(), LEVEL, Command(0, 1, 50, 0.1))
    assert slow.throttle > 0.4 < climb.throttle
    assert memory.throttle > 0.0
    _, memory = autopilot.step(Memory(), LEVEL, Command(0, 1, 90, 0))
    assert memory.throttle == 0.0
