"""Flights that show how an aircraft differs from its prediction: one manoeuvre is held past one obstacle, and predicted again and again.

The encounters are drawn anew from a seed for every aircraft and air: obstacles that stand, cross, meet and overtake, seen from as near as
60 m, asked for with as little to spare as nothing. No campaign is read.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from testbed.campaign.words.population import OBSTACLE_NAME, Encounters
from testbed.campaign.words.settings import FlightPlan
from testbed.core.frames import Vec3
from testbed.core.seeds import stream
from testbed.flight.fly import fly
from testbed.flight.planning.prediction import AirKind
from testbed.flight.plants.aircraft import Aircraft
from testbed.flight.plants.base import State
from testbed.flight.record import Decision, FlightRecord
from testbed.flight.route.path import Path
from testbed.flight.scene import Scene
from testbed.flight.traffic.track import least_clearance
from vosc.vec import unit

Array = np.ndarray
WIND_MPS = 10.0
SEVERITY = "moderate"
SETTLED_S, LONG_S = 3.0, 20.0  # of the route before the encounter, and in all
NEAREST_M, FARTHEST_M = 60.0, 250.0  # from which the obstacle is seen
ASKED_M = 6.0  # at most
PAST_S = 0.5  # so long after the closest approach a flight has shown what it was to show


class Trial(NamedTuple):
    """One flight: what was flown, and each prediction of it (time of the flight, time to go, clearance)."""

    record: FlightRecord
    direction: Vec3 | None  # that was held; None for a programme
    from_s: float  # the manoeuvre was flown from then on ...
    until_s: float  # ... up to then
    flown_m: float  # least clearance of it
    predictions: tuple[tuple[float, float, float], ...]


def trial_plan(name: str, aircraft: Aircraft, air: AirKind, seed: int, number: int, model: str) -> FlightPlan:
    """The plan of one flight; every second holds a direction, the others fly a programme. ``model``: which one predicts (``Survivor``)."""
    rng = stream(seed, number, f"identify.{air}")
    speed = aircraft.autopilot.reference_mps
    range_m, asked_m, wind_from = rng.uniform(NEAREST_M, FARTHEST_M), rng.uniform(0.0, ASKED_M), rng.uniform(0.0, 360.0)
    meets = Encounters.model_validate(
        {
            "own_at_enu_m": [SETTLED_S * speed, 0.0, 0.0],
            "own_direction_deg": [0.0, 0.0],
            "trigger": {"range_m": range_m},
            "obstacle_speed_mps": [0.0, 1.2 * speed],
            "radius_m": [10.0, 40.0],
            "longest_s": 6.0,
        }
    )
    wind = {"kind": "steady", "speed_mps": min(WIND_MPS, 0.3 * speed), "from_deg": wind_from}
    weather: dict[AirKind, dict[str, Any]] = {
        "calm": {},
        "wind": {"wind": wind},
        "turbulence": {"turbulence": {"kind": "dryden", "severity": SEVERITY}},
    }
    options = {"shape": ("directions", "programmes")[number % 2], "margin_m": float(asked_m), "trial": model, "every_s": 0.15}
    ends = {"start_enu_m": [0, 0, 0], "goal_enu_m": [LONG_S * speed, 0, 0], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
    return FlightPlan.model_validate(
        {
            "flight_id": "",
            "campaign": f"identify {name}",
            "cell": "",
            "labels": {},
            "replicate": number,
            "seed": seed,
            "aircraft": name,
            "speed_mps": speed,
            "route": ends,
            "obstacles": meets.drawn(speed, seed, number),
            "plant": {"kind": "jsbsim"},
            "method": {"kind": "none"},
            "planner": {"kind": "survivor", "options": options},
            "sensor": {"range_m": float(range_m)},
            "replan": {"rejoin": {"when": "clear"}},
            "air": weather[air],
        }
    )


class _Passed:
    """True some time after the obstacle was nearest, or when the flight comes back."""

    def __init__(self, scene: Scene) -> None:
        self._traffic, self._nearest, self._off = scene.traffic, (math.inf, math.inf), False

    def __call__(self, time_s: float, state: State, path: Path, s_m: float) -> bool:  # noqa: ARG002
        self._nearest = min(self._nearest, (math.dist(self._traffic.at(time_s)[0].pos, state[:3]), time_s))
        self._off = self._off or not path.lasting
        return self._off and (path.lasting or time_s > self._nearest[1] + PAST_S)


def flown_trial(plan: FlightPlan) -> Trial | None:
    """Fly it; None where no manoeuvre came of it."""
    record = fly(plan, until=_Passed)
    steered = [event for event in record.events if event.decision is Decision.STEERED]
    time_s, pos = record.columns["time_s"], record.columns["own.pos_enu_m"]
    if not steered or not np.isfinite(pos).all():
        return None
    from_s, until_s = steered[0].time_s, float(time_s[-1])
    held = time_s >= from_s
    obstacle = record.columns[f"obstacle.{OBSTACLE_NAME}.pos_enu_m"][held]
    nearest = least_clearance(time_s[held], pos[held], obstacle, plan.obstacles[0].radius_m)
    told = tuple((e.time_s, e.time_to_cpa_s, e.path_clearance_m) for e in steered if e.time_s < nearest.time_s)
    direction = unit(steered[0].command_enu_mps) if plan.planner.options["shape"] == "directions" else None
    return Trial(record, direction, from_s, until_s, nearest.clearance_m, told)
