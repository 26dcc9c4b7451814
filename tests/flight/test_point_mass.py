"""The point with an aeroplane's limits: closed forms, convergence, and the way it joins the rungs above and below."""

import math

import numpy as np
import pytest

from testbed import fly, measure
from testbed.flight.air import make_wind
from testbed.flight.aircraft import Aircraft, idealised, load_aircraft
from testbed.flight.plants.base import Command, Start, State
from testbed.flight.plants.point_mass import PointMassPlant
from testbed.spec.model import Air
from testbed.units import DEG, G0_MPS2
from tests.plans import C172P, GTM, paper_obstacle, plan

POINT = {"plant": {"kind": "point_mass"}}
IDEAL = {"plant": {"kind": "point_mass", "ideal": ["roll", "load_factor", "speed"]}}
GTM_T2 = load_aircraft("gtm_t2")


def plant(aircraft: Aircraft = GTM_T2, hz: int = 120, hold: bool = False) -> PointMassPlant:
    start = Start((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), 50.0, (0.0, 0.0, 0.0))
    return PointMassPlant(aircraft, start, make_wind(Air()), hz, hold)


def run(point: PointMassPlant, command: Command, seconds: float, hz: int = 120) -> list[State]:
    states = [point.state(point.sample())]
    for k in range(round(seconds * hz)):
        if k % (hz // 60) == 0:
            point.command(states[-1], command)
        point.step()
        states.append(point.state(point.sample()))
    return states


def test_a_steady_turn_has_the_radius_of_the_textbook() -> None:
    """V^2 / (g tan bank), level, at constant speed."""
    bank = 45 * DEG
    states = run(plant(hold=True), Command(bank, 1 / math.cos(bank), 50.0, 0.0), 20.0)
    late = np.array([[s.x, s.y] for s in states[600:]])
    centre = np.linalg.lstsq(np.column_stack([2 * late, np.ones(len(late))]), (late**2).sum(axis=1), rcond=None)[0][:2]
    radius = np.linalg.norm(late - centre, axis=1)
    assert radius.mean() == pytest.approx(2500.0 / (G0_MPS2 * math.tan(bank)), rel=1e-3)
    assert states[-1].heading > states[900].heading, "a right bank turns to the right"


def test_bank_follows_as_a_first_order_lag_no_faster_than_the_roll_rate() -> None:
    lag, limit = GTM_T2.point_mass.bank_lag_s, GTM_T2.limits.roll_rate_dps * DEG
    small = run(plant(), Command(5 * DEG, 1.0, 50.0, 0.0), 1.0)
    for k in (6, 12, 60):
        assert small[k].bank == pytest.approx(5 * DEG * (1 - math.exp(-k / 120 / lag)), rel=1e-9)
    large = run(plant(), Command(70 * DEG, 1.0, 50.0, 0.0), 0.2)
    assert large[12].bank == pytest.approx(0.1 * limit, rel=1e-9)


def test_full_thrust_climbs_at_the_specific_excess_power() -> None:
    """Held at constant speed by its climb angle, sin(gamma) = (T - D)/W; the steepest climb of gtm_t2 is 20.25 deg at 50 m/s."""
    model = GTM_T2.point_mass
    steepest = math.asin(model.thrust_max - model.drag_zero - model.drag_lift)
    assert steepest / DEG == pytest.approx(20.25, abs=0.4)


def test_energy_balance() -> None:
    """d/dt (g z + V^2/2) = g V (T - D)/W, integrated over a manoeuvre; the residual is the integration's second-order error."""
    point = plant()
    states = [point.state(point.sample())]
    work = 0.0
    for k in range(480):
        point.command(states[-1], Command(0.8 * math.sin(k / 40), 1.0 + 0.5 * math.sin(k / 30), 50.0, 0.1))
        point.step()
        now = point.state(point.sample())
        before = states[-1]
        power = [G0_MPS2 * s.airspeed * (point._thrust - point._drag(s.airspeed, s.load_factor)) for s in (before, now)]
        work += sum(power) / 2 / 120
        states.append(now)
    energy = [G0_MPS2 * s.z + 0.5 * s.airspeed**2 for s in (states[0], states[-1])]
    assert energy[1] - energy[0] == pytest.approx(work, abs=0.02 * abs(energy[0]) / 50)


def test_second_order_in_the_step() -> None:
    """The end of a rolling pull-up at 60 to 480 Hz against 3840 Hz: the error falls as the square of the step."""

    def end(hz: int) -> np.ndarray:
        command = Command(1.0, 2.0, 50.0, 0.2)
        point = plant(hz=hz, hold=True)
        point.command(point.state(point.sample()), command)
        for _ in range(2 * hz):
            point.step()
        state = point.state(point.sample())
        return np.array([state.x, state.y, state.z])

    truth, rates = end(7680), np.array([60, 120, 240, 480])
    errors = [np.linalg.norm(end(int(hz)) - truth) for hz in rates]
    assert -np.polyfit(np.log(rates), np.log(errors), 1)[0] > 0.9


@pytest.mark.parametrize("case", [GTM, C172P])
def test_ideal_it_is_the_point_on_rails(case: dict) -> None:
    metrics = measure(fly(plan(**(case | IDEAL))))
    assert metrics.cross_track_max_m < 0.1
    assert metrics.min_airspeed_mps == pytest.approx(50.0)
    assert metrics.max_airspeed_mps == pytest.approx(50.0)


@pytest.mark.parametrize("case", [GTM, C172P])
def test_on_the_original_path_it_agrees_with_six_degrees_of_freedom(case: dict) -> None:
    point, aeroplane = (measure(fly(plan(**(case | kind)))) for kind in (POINT, {}))
    assert point.cross_track_max_m < 0.5
    assert aeroplane.cross_track_max_m < 0.5
    assert abs(point.flight_time_s - aeroplane.flight_time_s) < 0.1


def test_on_a_gentle_level_path_all_plants_agree() -> None:
    """Radius above 1500 m, calm: within 0.5 m of the path and 0.05 s of each other."""
    gentle = {"start_enu_m": [0, 0, 0], "goal_enu_m": [600, 60, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [11.4, 0]}
    cases = [{"plant": {"kind": "kinematic"}}]
    cases += [{"plant": {"kind": kind}, "aircraft": name} for kind in ("point_mass", "jsbsim") for name in ("gtm_t2", "c172p")]
    flown = [measure(fly(plan(route=gentle, **case))) for case in cases]
    assert flown[0].planned_min_radius_m > 1500.0
    assert max(metrics.cross_track_max_m for metrics in flown) < 0.5
    times = [metrics.flight_time_s for metrics in flown]
    assert max(times) - min(times) < 0.05


def test_each_limit_costs_clearance_and_roll_costs_most() -> None:
    """Section 5.1: with every limit ideal the plan's own clearance is kept; no other limit gives as much back as roll does."""

    def clearance(*ideal: str) -> float:
        case = GTM | {"plant": {"kind": "point_mass", "ideal": list(ideal)}}
        return measure(fly(plan(obstacles=[paper_obstacle()], **case))).least_clearance_m

    everything = clearance("roll", "load_factor", "speed")
    assert everything == pytest.approx(2.25, abs=0.1)
    assert clearance() < min(clearance("load_factor"), clearance("speed"))
    assert max(clearance("load_factor"), clearance("speed")) < 0.0 < clearance("roll")


def test_idealised_changes_only_what_it_names() -> None:
    roll = idealised(GTM_T2, ("roll",))
    assert roll.limits.load_factor_max == GTM_T2.limits.load_factor_max
    assert roll.guidance.load_factor_lead_s == GTM_T2.guidance.load_factor_lead_s
    assert roll.guidance.bank_lead_s == 0.0
    assert idealised(GTM_T2, ()) == GTM_T2


def test_wind_carries_it() -> None:
    air = {"wind": {"kind": "steady", "speed_mps": 10, "from_deg": 200}}
    metrics = measure(fly(plan(air=air, **(GTM | POINT))))
    assert metrics.outcome == "reached"
    assert metrics.cross_track_max_m < 0.5
