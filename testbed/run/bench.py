"""What a flight costs beside what its physics costs alone, side by side in one process, in processor time.

The physics alone is JSBSim loading and trimming the aircraft and stepping as often as the flight has ticks, without reading anything. A
flight is everything up to its row: scene, trim, loop, log, metrics; not page and recording. The two are timed in turn, pair by pair,
and the ratio of each pair is what counts: the machine's speed cancels. Flights are those of a worker that has flown such before.
"""

import statistics
from collections.abc import Iterator
from time import process_time
from typing import Any, NamedTuple

from testbed.campaign.words.settings import FlightPlan
from testbed.flight.fly import fly, start_of
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.plants.jsbsim_start import load_model, trim_level
from testbed.flight.scene import make_scene
from testbed.results.metrics import measure
from testbed.run.job import Job, run_job

FLIGHT_S = 12.0
ROUTE_M = 557.917  # length of the paper's route
PAIRS = 21
SPEED_MPS = ROUTE_M / FLIGHT_S
AIRCRAFT = "gtm_t2"

STEADY = {"kind": "steady", "speed_mps": 8.0, "from_deg": 290.0}
AIRS: dict[str, dict[str, Any]] = {
    "calm": {},
    "wind": {"air": {"wind": STEADY}, "traffic": {"in_wind": "anchored"}},
    "shear": {"air": {"wind": {**STEADY, "kind": "power_law"}}, "traffic": {"in_wind": "drifts"}},
    "turbulence": {"air": {"wind": STEADY, "turbulence": {"kind": "dryden", "severity": "moderate"}}},
}
FLYERS = {"jsbsim": AIRCRAFT, "jsbsim c172p": "c172p", "point_mass": AIRCRAFT, "kinematic": AIRCRAFT}
SHAPED = {"shape": {"kind": "racetrack", "straight_m": 200.0, "radius_m": 150.0}, "start_enu_m": [0, 0, 0], "start_direction_deg": [0, 0]}
LIMITS = {"whole": 2.0, "loop": 1.5, "of jsbsim": 0.5, "log ms": 2.0}
"""What is promised of each figure: not more than this."""
ONLY_JSBSIM = ("whole", "loop")


class Cost(NamedTuple):
    """Medians over the pairs of one case."""

    case: str
    whole: float  # flight over physics alone
    least: float
    most: float
    loop: float  # the loop over bare stepping
    log_ms: float  # log and metrics of a flight of ``FLIGHT_S``
    flight_ms: float
    of_jsbsim: float  # over the JSBSim flight of the same aircraft in the same air

    def figures(self) -> dict[str, float]:
        """What is promised, and what history remembers."""
        return {"whole": self.whole, "loop": self.loop, "of jsbsim": self.of_jsbsim, "log ms": self.log_ms}


def plans() -> Iterator[tuple[str, FlightPlan, FlightPlan]]:
    """Case, its plan, and the plan of JSBSim that it is compared with."""
    for air, changes in AIRS.items():
        for flyer, aircraft in FLYERS.items():
            kind = flyer.split()[0]
            yield f"{flyer}, {air}", _plan(aircraft, kind, **changes), _plan(aircraft, "jsbsim", **changes)
    for kind in ("jsbsim", "kinematic"):
        yield f"{kind}, racetrack", _plan(AIRCRAFT, kind, route=SHAPED, obstacles=[]), _plan(AIRCRAFT, "jsbsim", route=SHAPED, obstacles=[])


def bench(pairs: int = PAIRS) -> tuple[str, dict[str, float]]:
    """The table, and every figure of it under the name that history knows it by."""
    costs = [_cost(case, plan, beside, pairs) for case, plan, beside in plans()]
    lines = [
        f"Processor time of {FLIGHT_S:g} s at 120 Hz, guidance at 60 Hz, the paper's obstacle, no method; medians of {pairs} pairs",
        "whole: flight over bare load, trim and stepping of as many steps; loop: over that stepping; of jsbsim: over its flight there",
        f"{'':<26}{'whole':>8}{'':>14}{'loop':>8}{'of jsbsim':>12}{'log+metrics ms':>17}{'flight ms':>12}",
    ]
    for cost in costs:
        shown = {name: f"{value:.2f}{mark(cost.case, name, value)}" for name, value in cost.figures().items()}
        lines.append(
            f"{cost.case:<26}{shown['whole']:>8}{f'({cost.least:.2f}-{cost.most:.2f})':>14}{shown['loop']:>8}"
            f"{shown['of jsbsim']:>12}{shown['log ms']:>17}{cost.flight_ms:>12.1f}"
        )
    lines.append(
        f"* more than promised: whole {LIMITS['whole']:g} and loop {LIMITS['loop']:g} of jsbsim, "
        f"{LIMITS['of jsbsim']:g} of a JSBSim flight for the others, log and metrics {LIMITS['log ms']:g} ms"
    )
    return "\n".join(lines), {f"{cost.case}, {name}": value for cost in costs for name, value in cost.figures().items()}


def mark(case: str, name: str, value: float) -> str:
    """A star behind what is more than promised; nothing where nothing is."""
    promised = name == "log ms" or (name in ONLY_JSBSIM) == case.startswith("jsbsim")
    return "*" if promised and value > LIMITS[name] else " "


def _plan(aircraft: str, plant: str, **changes: Any) -> FlightPlan:
    """The paper's encounter as printed, turned level, at the speed that makes the route last ``FLIGHT_S``; threats are met with nothing."""
    obstacle = {
        "name": "O",
        "radius_m": 25,
        "position_enu_m": [254, 63.6, 60.7],
        "speed_mps": 40,
        "direction_deg": [135, 12.4],
        "when": {"own_reaches_enu_m": [162, 101, 64.3]},
    }
    who = {"flight_id": "bench", "campaign": "bench", "cell": "bench", "labels": {}, "replicate": 0, "seed": 0}
    route = {
        "start_enu_m": [0, 0, 0],
        "goal_enu_m": [500, 200, 100],
        "start_direction_deg": [40.87, 26.13],
        "goal_direction_deg": [10.0, 2.84],
    }
    flight = {"route": route, "geometry": "level", "speed_mps": SPEED_MPS, "obstacles": [obstacle], "aircraft": aircraft}
    flight |= {"method": {"kind": "none"}, "plant": {"kind": plant}}
    return FlightPlan.model_validate(who | flight | changes)


def _cost(case: str, plan: FlightPlan, beside: FlightPlan, pairs: int) -> Cost:
    for _ in range(3):  # what a worker keeps is there from its third flight on
        run_job(Job(plan))
        run_job(Job(beside))
    whole, loop, log_ms, flight_ms, of_jsbsim = zip(*(_pair(plan, beside) for _ in range(pairs)), strict=True)
    middle = statistics.median
    return Cost(case, middle(whole), min(whole), max(whole), middle(loop), middle(log_ms), middle(flight_ms), middle(of_jsbsim))


def _pair(plan: FlightPlan, beside: FlightPlan) -> tuple[float, float, float, float, float]:
    """One flight whole, one in parts, the physics alone, and the flight in JSBSim: see ``Cost``."""
    flight = _timed(lambda: run_job(Job(plan)))
    record = fly(plan, clock=process_time)
    measuring = _timed(lambda: measure(record))
    stages = dict(record.timings)
    ticks = len(record.columns["time_s"]) - 1
    ready, stepping = _alone(beside, ticks)
    other = flight if plan.plant.kind == "jsbsim" else _timed(lambda: run_job(Job(beside)))
    per_flight = FLIGHT_S * plan.rates.plant_hz / ticks
    log_ms = 1e3 * (stages["log_s"] + measuring) * per_flight
    return flight / (ready + stepping), stages["fly_s"] / stepping, log_ms, 1e3 * flight * per_flight, flight / other


def _alone(plan: FlightPlan, ticks: int) -> tuple[float, float]:
    """Seconds for loading and trimming the aircraft at the start of a plan, and for bare steps."""
    scene, aircraft = make_scene(plan), load_aircraft(plan.aircraft)
    start = start_of(plan, scene)
    began = process_time()
    fdm = load_model(aircraft, plan.rates.plant_hz)
    trim_level(fdm, aircraft, start.speed, start.pos[2] - plan.terrain_z_m)
    ready = process_time()
    run = fdm.run
    for _ in range(ticks):
        run()
    return ready - began, process_time() - ready


def _timed(work: Any) -> float:
    began = process_time()
    work()
    return process_time() - began
