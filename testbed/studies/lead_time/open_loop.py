"""The best open-loop manoeuvre: each of a family is flown once on a plant, and what it does to an encounter is then arithmetic.

In calm air or a uniform wind the displacement d(t) of a manoeuvre from straight flight does not depend on the encounter. Begun a lead tau
before the closest approach (miss vector m, closing velocity w), the position relative to the obstacle's centre is

    r(t) = m + (t - tau) w + d(t)        t from the trigger on

and the manoeuvre keeps the radius R when |r(t)| >= R at all t, between samples too. The manoeuvre is commanded through the plant's own
loops: bank and load factor are steps within the limits that guidance has, and what actuators and lags make of them is flown. A point on
rails has neither: its velocity jumps to a direction.

The least lead of the family is an upper bound of what the best manoeuvre of all needs. It is monotone by definition: whoever has more
time than it may wait first.
"""

import json
import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from testbed.campaign.words.air import Air
from testbed.campaign.words.planning import MethodSpec
from testbed.campaign.words.settings import FlightPlan
from testbed.campaign.words.study import StudySpec
from testbed.core.units import DEG
from testbed.flight.fly import make_plant, start_of
from testbed.flight.guidance.bank_to_turn import BankToTurn
from testbed.flight.plants.aircraft import Aircraft, idealised, load_aircraft
from testbed.flight.plants.base import Command, TrimFailedError
from testbed.flight.record import inside
from testbed.flight.scene import Scene, make_scene
from testbed.studies.lead_time.searched_encounter import Encounter

Array = np.ndarray
FLOWN_S = 6.0  # a manoeuvre is flown so long; after that it goes on straight
BANK_STEP_DEG = 10.0
MOST_LOAD_FACTOR = 20.0  # asked for where nothing limits it
DIRECTIONS = 4000  # of a point on rails, spread evenly over the sphere
SEARCH_STEP_S = 0.1
SAMPLES_HZ = 30  # of a displacement; between them it is straight, 4 mm off in a turn at 2.6 g
STRAIGHT_ON_S = 60.0  # long enough for everything to be past


@dataclass(frozen=True)
class Manoeuvres:
    """Displacements from straight flight: ``time_s`` (n,) from the trigger on, ``offset_m`` (k, n, 3) ENU."""

    time_s: Array
    offset_m: Array


def manoeuvres(plan: FlightPlan) -> Manoeuvres:
    """The family of a plan's plant, aircraft, set speed and mean wind; flown when it is first asked for in a process."""
    bare = plan.model_copy(
        update={
            "obstacles": (),
            "method": MethodSpec(kind="none"),
            "air": Air(wind=plan.air.wind),
            "study": StudySpec(),
            **dict.fromkeys(("flight_id", "campaign", "cell"), ""),
            "labels": {},
            "replicate": 0,
        }
    )
    return _family(json.dumps(bare.model_dump(mode="json"), sort_keys=True))


@lru_cache(maxsize=64)
def _family(plan_json: str) -> Manoeuvres:
    plan = FlightPlan.model_validate(json.loads(plan_json))
    scene = make_scene(plan)
    aircraft = idealised(load_aircraft(plan.aircraft), plan.plant.ideal)
    if plan.plant.kind == "kinematic":
        return _jumps(plan, scene)
    flown = [_flown(plan, aircraft, scene, bank, load) for bank, load in steps(aircraft)]
    every = max(1, plan.rates.guidance_hz // SAMPLES_HZ)
    time_s = np.arange(0, len(flown[0]), every) / plan.rates.guidance_hz
    straight = np.asarray(start_of(plan, scene).pos) + np.outer(time_s, _straight(plan, scene))
    return Manoeuvres(time_s, np.array(flown)[:, ::every] - straight)


def steps(aircraft: Aircraft) -> list[tuple[float, float]]:
    """Bank (rad) and load factor of each manoeuvre: all banks that guidance may ask for, with four load factors."""
    limits = aircraft.limits
    most_bank = min(limits.bank_deg, 180.0)
    count = math.ceil(most_bank / BANK_STEP_DEG)
    banks = np.linspace(-most_bank, most_bank, 2 * count + 1) * DEG
    low, high = max(limits.load_factor_min, -MOST_LOAD_FACTOR), min(limits.load_factor_max, MOST_LOAD_FACTOR)
    return [(float(bank), load) for bank in banks for load in (high, 0.5 * (1.0 + high), 1.0, low)]


def _straight(plan: FlightPlan, scene: Scene) -> Array:
    """Velocity over the ground of straight flight, ENU (3,)."""
    start = start_of(plan, scene)
    along = np.array(start.tangent)
    wind = np.array(start.wind)
    across = wind - (wind @ along) * along
    return (float(wind @ along) + math.sqrt(start.speed**2 - float(across @ across))) * along


def _flown(plan: FlightPlan, aircraft: Aircraft, scene: Scene, bank: float, load_factor: float) -> Array:
    """Points (n,3) at the guidance rate of one manoeuvre, begun at once."""
    try:
        plant = make_plant(plan, aircraft, start_of(plan, scene), scene)
    except TrimFailedError as error:
        raise ValueError(f"no open-loop manoeuvre: {error}") from None
    most = BankToTurn(aircraft.limits).most_load_factor
    each = range(plan.rates.plant_hz // plan.rates.guidance_hz)
    points = []
    for _ in range(round(FLOWN_S * plan.rates.guidance_hz)):
        state = plant.state(plant.sample())
        points.append((state.x, state.y, state.z))
        plant.command(state, Command(bank, min(load_factor, most(state.airspeed)), plan.speed_mps, 0.0))
        for _ in each:
            plant.step()
    return np.array(points)


def _jumps(plan: FlightPlan, scene: Scene) -> Manoeuvres:
    """Every direction at once, at the set airspeed: two samples are enough for straight lines."""
    k = np.arange(DIRECTIONS) + 0.5
    sine, azimuth = 1.0 - 2.0 * k / DIRECTIONS, math.pi * (1.0 + math.sqrt(5.0)) * k  # Fibonacci's spiral
    flat = np.sqrt(1.0 - sine * sine)
    start = start_of(plan, scene)
    velocity = start.speed * np.column_stack([flat * np.cos(azimuth), flat * np.sin(azimuth), sine]) + np.array(start.wind)
    change = velocity - _straight(plan, scene)
    return Manoeuvres(np.array([0.0, FLOWN_S]), np.stack([np.zeros_like(change), FLOWN_S * change], axis=1))


def best_clearance(family: Manoeuvres, encounter: Encounter, lead_s: float) -> float:
    """Clearance (m) of the best of the family, begun that long before the closest approach; the least over all time after it."""
    position = encounter.miss_m + np.outer(family.time_s - lead_s, encounter.closing_mps) + family.offset_m
    onward = position[:, -1] + STRAIGHT_ON_S * (position[:, -1] - position[:, -2]) / (family.time_s[-1] - family.time_s[-2])
    position = np.concatenate([position, onward[:, None]], axis=1)
    step = np.diff(position, axis=1)
    square = np.einsum("kni,kni->kn", step, step)
    inner = -np.einsum("kni,kni->kn", position[:, :-1], step)
    share = np.clip(inner / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    nearest = position[:, :-1] + share[..., None] * step
    least = np.sqrt(np.min(np.einsum("kni,kni->kn", nearest, nearest), axis=1))
    return float(np.max(least)) - encounter.radius_m


def best_lead(family: Manoeuvres, encounter: Encounter, longest_s: float, tolerance_s: float) -> float:
    """The least lead from which one of the family keeps the radius: the first on a grid of 0.1 s, bisected; infinite for none."""

    def keeps(lead_s: float) -> bool:
        return not inside(best_clearance(family, encounter, lead_s))

    low = encounter.entry_s
    grid = low + SEARCH_STEP_S * np.arange(1, math.ceil((longest_s - low) / SEARCH_STEP_S) + 1)
    high = next((float(lead_s) for lead_s in grid if keeps(float(lead_s))), math.inf)
    low = max(low, high - SEARCH_STEP_S)
    while math.isfinite(high) and high - low > tolerance_s:
        middle = 0.5 * (low + high)
        if keeps(middle):
            high = middle
        else:
            low = middle
    return high
