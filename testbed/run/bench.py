"""What a flight costs beside bare JSBSim stepping of as many steps, measured side by side in one process.

The two are timed in turn, pair by pair, and the ratio of each pair is what counts: the machine's speed cancels.
"""

import statistics
from time import perf_counter

from testbed.campaign.words.settings import FlightPlan
from testbed.flight.fly import fly, start_of
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.plants.jsbsim import JsbsimPlant
from testbed.flight.scene import make_scene

FLIGHT_S = 12.0
ROUTE_M = 557.917  # length of the paper's route
PAIRS = 21


def bench() -> str:
    """A table: microseconds per tick of the closed loop and of bare stepping, their ratio, the same with the log's columns, and set-up."""
    lines = [
        f"{FLIGHT_S:g} s at 120 Hz, guidance at 60 Hz, the paper's obstacle, against bare stepping: medians of {PAIRS} pairs",
        f"{'aircraft':<10}{'loop us/tick':>14}{'bare us/tick':>14}{'ratio':>8}{'':>16}{'with log':>10}{'set-up ms':>12}",
    ]
    for name in ("gtm_t2", "c172p"):
        loop, bare, set_up, log = zip(*(_pair(_plan(name)) for _ in range(PAIRS)), strict=True)
        ratios = sorted(a / b for a, b in zip(loop, bare, strict=True))
        logged = [(a + c) / b for a, b, c in zip(loop, bare, log, strict=True)]
        spread = f"({ratios[0]:.2f}-{ratios[-1]:.2f})"
        middle = statistics.median
        lines.append(
            f"{name:<10}{middle(loop) * 1e6:>14.2f}{middle(bare) * 1e6:>14.2f}{middle(ratios):>8.2f}{spread:>16}"
            f"{middle(logged):>10.2f}{middle(set_up) * 1e3:>12.1f}"
        )
    return "\n".join(lines)


def _plan(aircraft: str) -> FlightPlan:
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
    flight = {"route": route, "geometry": "level", "speed_mps": ROUTE_M / FLIGHT_S, "obstacles": [obstacle], "aircraft": aircraft}
    flight["method"] = {"kind": "none"}
    return FlightPlan.model_validate(who | flight)


def _pair(plan: FlightPlan) -> tuple[float, float, float, float]:
    """Seconds per tick in the loop, seconds per tick bare, seconds of set-up, seconds per tick of turning the log into columns."""
    record = fly(plan)
    timings = dict(record.timings)
    ticks = len(record.columns["time_s"]) - 1
    scene = make_scene(plan)
    plant = JsbsimPlant(load_aircraft(plan.aircraft), start_of(plan, scene), plan.rates.plant_hz, plan.rates.guidance_hz, plan.terrain_z_m)
    run = plant.step_bare
    began = perf_counter()
    for _ in range(ticks):
        run()
    bare = perf_counter() - began
    return timings["fly_s"] / ticks, bare / ticks, timings["set_up_s"], timings["log_s"] / ticks
