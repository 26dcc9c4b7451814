"""The contract of a path-following law (``testbed.flight.guidance.law``): steps in closed form, then flights of a point with limits."""

import math
from collections.abc import Callable, Mapping
from typing import Any

from testbed.campaign.words.settings import FlightPlan
from testbed.contracts.promise import Promise, first_broken
from testbed.core.units import DEG
from testbed.flight.fly import fly
from testbed.flight.guidance.law import GuidanceSetting, Law, SpeedHold
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.plants.base import Command, State
from testbed.flight.record import Outcome
from testbed.flight.route.path import ActivePath
from vosc import ph

AIRCRAFT, SPEED_MPS, DT_S = "gtm_t2", 50.0, 1.0 / 60.0
STEPS_TRIED = 30
WITHIN_M = 20.0  # of its path stays a law that follows it
ROUTES: dict[str, dict[str, Any]] = {
    "a straight line": {"goal_enu_m": [900, 0, 0], "goal_direction_deg": [0, 0]},
    "a circle of 250 m": {"shape": {"kind": "circle", "radius_m": 250, "turns": 1}},
    "a racetrack": {"shape": {"kind": "racetrack", "straight_m": 300, "radius_m": 220}},
}


def promises(kind: str, make: Callable[..., Law], options: Mapping[str, Any]) -> list[Promise]:
    """Everything that a law promises, tried in turn. ``make(setting, **options)`` gives the law of one flight; ``kind`` its name."""

    def law(aircraft: str = AIRCRAFT) -> Law:
        hold = SpeedHold(SPEED_MPS, airspeed=True, keep_schedule=False)
        return make(GuidanceSetting(load_aircraft(aircraft), hold, DT_S), **options)

    made = first_broken("can be made with its options", [(f"for {AIRCRAFT}", lambda: _made(law()))])
    if made.broken:
        return [made]
    path = ActivePath((ph.hermite((0, 0, 0), (900, 0, 0), (900, 0, 0), (900, 0, 0)),))
    states = [
        (f"{left:g} m left of and {up:g} m above its path", _state(left, up)) for left in (-40.0, 0.0, 40.0) for up in (-20.0, 0.0, 20.0)
    ]
    return [
        made,
        first_broken("starts on a path with a memory that has s_m", [("at 0 m", lambda: _starts(law()))]),
        first_broken(
            "answers with finite commands within the aircraft's limits",
            [(name, lambda s=state: _commands(law(), s, path)) for name, state in states],  # type: ignore[misc]
        ),
        first_broken(
            "keeps what it remembers in its memory alone",
            [(name, lambda s=state: _pure(law(), s, path)) for name, state in states],  # type: ignore[misc]
        ),
        first_broken("banks towards its path", [("40 m to the left", lambda: _towards(law(), path))]),
        first_broken(
            f"follows a path within {WITHIN_M:g} m with a point mass of {AIRCRAFT}",
            [(name, lambda r=route: _follows(kind, options, r)) for name, route in ROUTES.items()],  # type: ignore[misc]
        ),
    ]


def _state(left_m: float, up_m: float) -> State:
    """Level flight along the x axis, beside it."""
    still = dict.fromkeys(State._fields, 0.0)
    return State(
        **still | {"x": 300.0, "y": left_m, "z": up_m, "vx": SPEED_MPS, "heading": 90.0 * DEG, "load_factor": 1.0, "airspeed": SPEED_MPS}
    )


def _made(law: Law) -> str:
    missing = [name for name in ("start", "step") if not callable(getattr(law, name, None))]
    return f"a guidance law needs start and step; {type(law).__name__} has no {' and no '.join(missing)}" if missing else ""


def _starts(law: Law) -> str:
    memory = law.start(0.0)
    return "" if getattr(memory, "s_m", None) == 0.0 else f"its memory is {memory!r}, whose s_m should be 0"


def _commands(law: Law, state: State, path: ActivePath) -> str:
    limits = load_aircraft(AIRCRAFT).limits
    memory = law.start(300.0)
    for _ in range(STEPS_TRIED):
        command, memory, telemetry = law.step(memory, state, path)
        if not all(map(math.isfinite, command)):
            return f"commands {command}"
        if abs(command.bank) > limits.bank_deg * DEG + 1e-9:
            return f"commands {command.bank / DEG:.0f} deg of bank; the limit is {limits.bank_deg:g} deg"
        if not limits.load_factor_min - 1e-9 <= command.load_factor <= limits.load_factor_max + 1e-9:
            return f"commands a load factor of {command.load_factor:.2f}, outside of the aircraft's limits"
        if len(telemetry) != 4 or not isinstance(command, Command):
            return "step() gives (Command, memory, Telemetry)"
    return ""


def _pure(law: Law, state: State, path: ActivePath) -> str:
    memory = law.start(300.0)
    for _ in range(3):
        first = law.step(memory, state, path)
        second = law.step(memory, state, path)
        if first != second:
            return "the same memory, state and path give another command the second time"
        memory = first[1]
    return ""


def _towards(law: Law, path: ActivePath) -> str:
    command, _, _ = law.step(law.start(300.0), _state(40.0, 0.0), path)
    return "" if command.bank > 0.0 else f"commands {command.bank / DEG:.1f} deg of bank; to the right is positive"


def _follows(kind: str, options: Mapping[str, Any], route: dict[str, Any]) -> str:
    who = {"flight_id": "", "campaign": "contract", "cell": "", "labels": {}, "replicate": 0, "seed": 0}
    start = {"start_enu_m": [0, 0, 0], "start_direction_deg": [0, 0]}
    parts = {"plant": {"kind": "point_mass"}, "method": {"kind": "none"}, "guidance": {"kind": kind, "options": dict(options)}}
    record = fly(FlightPlan.model_validate(who | parts | {"route": start | route}))
    worst = float(record.columns["path.cross_track_m"].max(initial=0.0))
    if record.outcome is not Outcome.REACHED:
        return f"{record.outcome.value}: {record.message}"
    return f"is {worst:.1f} m off" if worst > WITHIN_M else ""
