"""The point with an aeroplane's limits: closed forms, convergence, and the way it joins the rungs above and below."""

import math

import numpy as np
import pytest
from scipy import signal

from testbed import fly, measure
from testbed.campaign.words.air import OneMinusCosineGust
from testbed.campaign.words.settings import Air
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.air import Wind, make_wind
from testbed.flight.air.gusts import make_gust
from testbed.flight.plants.aircraft import Aircraft, idealised, load_aircraft
from testbed.flight.plants.base import Command, Start, State
from testbed.flight.plants.point_mass import PointMassPlant
from tests.plans import C172P, GTM, paper_obstacle, plan

POINT = {"plant": {"kind": "point_mass"}}
IDEAL = {"plant": {"kind": "point_mass", "ideal": ["roll", "load_factor", "speed"]}}
GTM_T2 = load_aircraft("gtm_t2")


MODEL = GTM_T2.point_mass
LEVEL = Command(0.0, 1.0, 50.0, 0.0)
MODERATE = {"air": {"turbulence": {"kind": "dryden", "severity": "moderate", "height_m": 150}}}


def plant(aircraft: Aircraft = GTM_T2, hz: int = 120, hold: bool = False, wind: Wind | None = None) -> PointMassPlant:
    start = Start((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), 50.0, (0.0, 0.0, 0.0))
    return PointMassPlant(aircraft, start, wind or make_wind(Air()), hz, hold)


def sharp(x: float, y: float, z: float) -> Wind:
    """That air (ENU m/s) from 0.5 s on."""
    return lambda time_s, _pos: (x, y, z) if time_s > 0.5 - 1e-9 else (0.0, 0.0, 0.0)


def rounded_gust(size_mps: float, rise_m: float) -> Wind:
    """An updraught of a one-minus-cosine, from the start on."""
    return make_gust(
        OneMinusCosineGust(kind="one_minus_cosine", amplitude_mps=size_mps, rise_m=rise_m, at_time_s=0.0),
        lambda _: ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
        0.0,
        50.0,
    )


def step_of_gust(frequency: float, damping: float, time_s: float) -> float:
    """The step response of s^2 / (s^2 + 2 d w s + w^2), from its transfer function."""
    _, answer = signal.step(([1.0, 0.0, 0.0], [1.0, 2.0 * damping * frequency, frequency**2]), T=np.array([0.0, time_s]))
    return float(answer[1])


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


@pytest.mark.parametrize("size", [0.5, -0.5])
def test_a_sharp_edged_gust_adds_its_angle_times_the_lift_slope_and_washes_out(size: float) -> None:
    """n_alpha w/V at once, then s^2 / (s^2 + 2 d w s + w^2); the lift drawn from it sums up to nothing."""
    states = run(plant(wind=sharp(0.0, 0.0, size)), LEVEL, 6.0)
    jump = MODEL.load_factor_per_rad * size / 50.0
    assert states[59].load_factor == 1.0
    assert states[60].load_factor - 1.0 == pytest.approx(jump, abs=1.5 * (size / 50.0) ** 2)
    for k in (6, 24, 60, 120):
        expected = step_of_gust(MODEL.gust_frequency_rad_s, MODEL.gust_damping, k / 120)
        assert (states[60 + k].load_factor - 1.0) / jump == pytest.approx(expected, abs=2e-3)
    assert states[-1].vz == pytest.approx(0.0, abs=0.01 * abs(size)), "the autopilot keeps its load factor, so nothing is carried off"


def test_banked_it_feels_the_gust_along_its_lift() -> None:
    """At 60 deg of bank to the right, towards east: half of a gust from below, and a gust to the south by its sine."""
    bank = 60 * DEG
    for air, share in ((0.0, 0.0, 0.5), 0.5), ((0.0, -0.5, 0.0), math.sin(bank)), ((0.0, 0.5, 0.0), -math.sin(bank)):
        point = plant(wind=sharp(*air), hold=True)
        point._bank, point._load_factor = bank, 2.0
        point.command(point.state(point.sample()), Command(bank, 2.0, 50.0, 0.0))
        states = []
        for _ in range(60):
            point._track, point._climb = math.pi / 2, 0.0  # the turn taken out
            point.step()
            states.append(point.state(point.sample()))
        assert states[-1].load_factor - 2.0 == pytest.approx(MODEL.load_factor_per_rad * 0.01 * share, abs=5e-3)


def test_a_head_on_gust_adds_twice_its_share_of_the_airspeed() -> None:
    """2 n w/V at once, of lift that goes as V^2; its integral is what the aircraft takes to trim for the airspeed."""
    states = run(plant(wind=sharp(-0.5, 0.0, 0.0)), LEVEL, 3.0)
    assert states[60].load_factor - 1.0 == pytest.approx(2.0 * 0.5 / 50.0, rel=0.01)
    impulse = sum(state.load_factor - 1.0 for state in states[60:]) / 120
    assert impulse == pytest.approx(MODEL.gust_surge_s * 0.02, abs=1.5e-4)
    held = run(plant(wind=sharp(-0.5, 0.0, 0.0), hold=True), LEVEL, 0.6)
    assert {state.load_factor for state in held} == {1.0}


def test_a_gentle_gust_loads_by_its_second_derivative() -> None:
    """Of its speed u: n_alpha u'' / (V w^2), the slow limit of the same transfer function; at the crest, where u' is zero."""
    size, rise = 0.1, 500.0
    bend = -0.5 * size * (math.pi * 50.0 / rise) ** 2
    crest = run(plant(wind=rounded_gust(size, rise)), LEVEL, rise / 50.0)[-1]
    assert crest.load_factor - 1.0 == pytest.approx(MODEL.load_factor_per_rad * bend / (50.0 * MODEL.gust_frequency_rad_s**2), rel=0.05)


def test_the_gust_load_ends_with_the_lift_of_the_wing() -> None:
    """(V/V1)^2 either way; what the command asks for is another matter."""
    for size, sign in ((30.0, 1.0), (-30.0, -1.0)):
        state = run(plant(wind=sharp(0.0, 0.0, size)), LEVEL, 0.5)[-1]
        assert state.load_factor == pytest.approx(sign * (state.airspeed / GTM_T2.limits.alpha_max_1g_mps) ** 2)
    assert state.load_factor < GTM_T2.limits.load_factor_min
    point = plant()
    assert point._carried(5.0, 0.0, 50.0) == 5.0
    assert point._carried(5.0, 1.0, 50.0) == 5.0


def test_the_gust_load_does_not_hang_on_the_step() -> None:
    """A one-minus-cosine of 2 x 30 m at 120 and 480 Hz: what is left is half a tick of delay."""
    coarse, fine = (np.array([s.load_factor for s in run(plant(hz=hz, wind=rounded_gust(2.0, 30.0)), LEVEL, 2.0, hz)]) for hz in (120, 480))
    assert np.abs(fine[::4] - coarse).max() < 0.05 * np.abs(fine - 1.0).max()
    middle = np.array([s.load_factor for s in run(plant(hz=240, wind=rounded_gust(2.0, 30.0)), LEVEL, 2.0, 240)])
    assert np.abs(fine[::2] - middle).max() < 0.5 * np.abs(fine[::4] - coarse).max(), "first order, or better"


@pytest.mark.parametrize("ideal", [("gust",), ("load_factor",)])
def test_without_the_gust_load_air_only_carries_it(ideal: tuple[str, ...]) -> None:
    """The load factor is the lagged command, whatever the air does."""
    states = run(plant(idealised(GTM_T2, ideal), wind=sharp(-2.0, 1.0, 5.0)), LEVEL, 2.0)
    assert {state.load_factor for state in states} == {1.0}
    assert states[60].airspeed != 50.0


def test_the_gust_switch_costs_nothing_where_there_is_no_gust() -> None:
    """In calm air and in a steady wind, and where the load factor is ideal, with and without are equal to the last bit."""
    steady = {"air": {"wind": {"kind": "steady", "speed_mps": 10, "from_deg": 200}}}
    for more, ideal in ({}, []), (steady, []), (MODERATE, ["load_factor"]), (MODERATE, ["roll", "load_factor", "speed"]):
        a, b = (fly(plan(**(GTM | more | {"plant": {"kind": "point_mass", "ideal": names}}))) for names in (ideal, [*ideal, "gust"]))
        assert all(np.array_equal(a.columns[name], b.columns[name], equal_nan=True) for name in a.columns)


def test_in_turbulence_it_is_loaded_as_the_aeroplane_is() -> None:
    """Standard deviation of the load factor over a level kilometre in moderate turbulence: 16 % less as measured, since air that turns
    loads a wing as well; a tenth without the gust load.
    """
    level = {"start_enu_m": [0, 0, 0], "goal_enu_m": [1000, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}

    def deviation(**how: object) -> float:
        return float(np.std(fly(plan(route=level, aircraft="gtm_t2", **MODERATE, **how)).columns["own.load_factor"]))

    aeroplane = deviation(plant={"kind": "jsbsim"})
    assert deviation(**POINT) == pytest.approx(aeroplane, rel=0.2)
    assert deviation(plant={"kind": "point_mass", "ideal": ["gust"]}) < 0.1 * aeroplane


def test_wind_carries_it() -> None:
    air = {"wind": {"kind": "steady", "speed_mps": 10, "from_deg": 200}}
    metrics = measure(fly(plan(air=air, **(GTM | POINT))))
    assert metrics.outcome == "reached"
    assert metrics.cross_track_max_m < 0.5
