"""What a hundred obstacles cost beside one, and where a track is beside where a line is: processor time, side by side in one process.

    python tests/benchmarks/bench_crowd.py [--rounds N]

Obstacle 0 crosses the route and is avoided; the others fly at random, 1.5 to 6 km away, as traffic does. A flight is everything up to
its row, in a worker that has flown such before: scene, trim, loop, log, metrics. Each round flies every case with one obstacle and with
a hundred; the ratios are of a round, and their medians are told. Promised are at most 2 for a hundred obstacles, and 3 for a look-up of
a recorded track in the order of time, as a flight asks. The exit code is 1 if not.
"""

import argparse
import math
import random
import statistics
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from testbed.campaign.words.settings import FlightPlan
from testbed.flight.record import Outcome
from testbed.flight.traffic import Track, TrackSetting
from testbed.flight.traffic.legs import Leg, Legs
from testbed.flight.traffic.pieces import Pieces, smooth
from testbed.flight.traffic.straight import make_track
from testbed.run.job import Job, run_job

MANY, MOST_OF_MANY, MOST_OF_LOOK_UP = 100, 2.0, 3.0
PLANTS, KINDS = ("jsbsim", "kinematic"), ("straight", "file", "legs")
LEGS = [{"duration_s": 9}, {"duration_s": 8, "turn_rate_dps": 9, "climb_mps": 2}, {"duration_s": 6, "turn_rate_dps": -5}]
ROUTE = {"start_enu_m": [0, 0, 500], "goal_enu_m": [1500, 0, 500], "start_direction_deg": [0, 0], "goal_direction_deg": [0, 0]}
LOOKS_HZ, POINTS = 60, 100_000


def plan(plant: str, kind: str, count: int, track: Path) -> FlightPlan:
    """A flight past so many obstacles of a kind."""
    chance = random.Random(3)
    obstacles: list[dict[str, Any]] = []
    for k in range(count):
        far = [chance.uniform(-2000, 3500), chance.choice([-1, 1]) * chance.uniform(1500, 6000), chance.uniform(300, 700)]
        place, azimuth = ([460, 0, 500], 90.0) if k == 0 else (far, chance.uniform(-180, 180))
        one: dict[str, Any] = {"name": f"O{k}", "kind": kind, "radius_m": 25, "position_enu_m": place}
        if k == 0:
            one["when"] = {"own_reaches_enu_m": place}
        if kind == "file":
            one["options"] = {"path": str(track), "azimuth_deg": azimuth, "at_track_s": 20}
        else:
            one |= {"speed_mps": 30, "direction_deg": [azimuth, 0]} | ({"options": {"legs": LEGS}} if kind == "legs" else {})
        obstacles.append(one)
    who = {"flight_id": "crowd", "campaign": "crowd", "cell": "crowd", "labels": {}, "replicate": 0, "seed": 0}
    flight = {"route": ROUTE, "speed_mps": 46.0, "aircraft": "gtm_t2", "sensor": {"range_m": 400}, "replan": {"swell_m": 10}}
    return FlightPlan.model_validate(who | flight | {"obstacles": obstacles, "method": {"kind": "scoam"}, "plant": {"kind": plant}})


def flown_s(one: FlightPlan) -> float:
    """Processor seconds of a flight that reaches its goal, avoiding somebody."""
    began = process_time()
    row = run_job(Job(one)).row
    took = process_time() - began
    if row["outcome"] != Outcome.REACHED.value or not row["replans"]:
        raise SystemExit(f"{row['outcome']}, {row['replans']} re-plans: {row['message']} {row['traceback']}")
    return took


def looked_up_s(track: Track, times: Sequence[float]) -> float:
    """Processor seconds of asking a track where it is."""
    at, began = track.at, process_time()
    for time_s in times:
        at(time_s)
    return process_time() - began


def crowds(rounds: int, folder: Path) -> Iterator[tuple[str, float, float]]:
    """Case, the ratio of a hundred to one, and what is promised."""
    track = folder / "track.csv"
    rows = [f"{t},{30 * t + 40 * math.sin(t / 7)},{60 * math.cos(t / 9)},{5 * math.sin(t / 5)}" for t in range(200)]
    track.write_text("\n".join(["time_s,east_m,north_m,up_m", *rows]))
    for plant in PLANTS:
        for kind in KINDS:
            one, many = (plan(plant, kind, count, track) for count in (1, MANY))
            for each in (one, many, one, many):  # what a worker keeps is there from then on
                flown_s(each)
            ratios = [flown_s(many) / flown_s(one) for _ in range(rounds)]
            yield f"{plant}, {kind}: {MANY} obstacles over one", statistics.median(ratios), MOST_OF_MANY


def look_ups(rounds: int) -> Iterator[tuple[str, float, float]]:
    """Case, the ratio to a line, and what is promised."""
    random_of = np.random.default_rng(0)
    setting = TrackSetting("O", 25.0, (1.0, 2.0, 3.0), (30.0, 4.0, 1.0), 1.0, random_of)
    line, legs = make_track(setting), Legs(setting, tuple(Leg(**leg) for leg in LEGS * 5))
    recorded = Pieces("O", 25.0, smooth(np.arange(float(POINTS)), random_of.normal(size=(POINTS, 3)).cumsum(axis=0)))
    in_order = [k / LOOKS_HZ for k in range(6000)]
    anywhere = random_of.uniform(0.0, POINTS - 2.0, len(in_order)).tolist()
    cases = {
        f"a look-up in {POINTS:,} rows, in order of time, over a line": (recorded, in_order, MOST_OF_LOOK_UP),
        f"a look-up in {POINTS:,} rows, anywhere, over a line": (recorded, anywhere, math.inf),
        "a look-up of legs, in order of time, over a line": (legs, in_order, math.inf),
    }
    for case, (track, times, promised) in cases.items():
        yield case, statistics.median(looked_up_s(track, times) / looked_up_s(line, times) for _ in range(3 * rounds)), promised


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=11)
    rounds, missed = parser.parse_args().rounds, 0
    with tempfile.TemporaryDirectory() as folder:
        for case, ratio, most in (*crowds(rounds, Path(folder)), *look_ups(rounds)):
            missed += ratio > most
            promise = f"   at most {most:g}{'' if ratio <= most else '   MISSED'}" if math.isfinite(most) else ""
            print(f"{case:62s} {ratio:6.2f}{promise}", flush=True)
    return int(missed > 0)


if __name__ == "__main__":
    sys.exit(main())
