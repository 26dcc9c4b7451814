"""Writes ``thirty.mat``: 30 encounters of two small aircraft, from a seed, in the form of MIT Lincoln Laboratory's sampled encounters.

They are of nobody's airspace: both fly level or climb gently, change what they do once or twice, and would come within 300 ft after
20 to 30 s if neither did. ``python campaigns/encounters/make.py``
"""

import math
from pathlib import Path

import numpy as np
from scipy.io import savemat

SEED, COUNT, RUN_S = 14, 30, 40.0


def made(random: np.random.Generator) -> dict[str, object]:
    """One encounter: the second aircraft is placed where it passes the first one ``miss`` away at ``meets``."""
    speed = np.array([164.0, random.uniform(100.0, 230.0)])
    heading = random.uniform(0.0, math.tau, 2)
    climb = np.array([0.0, random.uniform(-8.0, 8.0)])
    pitch = np.arcsin(climb / speed)
    flat = speed * np.cos(pitch)
    vel = np.column_stack([flat * np.cos(heading), flat * np.sin(heading), climb])  # north, east, up
    meets, miss, around = random.uniform(20.0, 30.0), random.uniform(0.0, 300.0), random.uniform(0.0, math.tau)
    offset = np.array([miss * math.cos(around), miss * math.sin(around), random.uniform(-80.0, 80.0)])
    start = np.array([np.zeros(3), offset - meets * (vel[1] - vel[0])])
    start[:, 2] += 1000.0
    calm = {"time_s": 0.0, "verticalRate_fps": 0.0, "turnRate_radps": 0.0, "longitudeAccel_ftpss": 0.0}
    times = np.array([0.0, *np.sort(random.uniform(5.0, RUN_S - 5.0, 2))])
    turns = np.array([0.0, *np.radians(random.uniform(-4.0, 4.0, 2))])
    rates = np.array([climb[1], *random.uniform(-10.0, 10.0, 2)])
    gains = np.array([0.0, *random.uniform(-1.0, 1.0, 2)])
    other = {"time_s": times, "verticalRate_fps": rates, "turnRate_radps": turns, "longitudeAccel_ftpss": gains}
    return {
        "v_ftps": speed,
        "n_ft": start[:, 0],
        "e_ft": start[:, 1],
        "h_ft": start[:, 2],
        "heading_rad": heading,
        "pitch_rad": pitch,
        "bank_rad": np.zeros(2),
        "a_ftpss": np.zeros(2),
        "runTime_s": RUN_S,
        "updates": struct_array([calm, other]),
    }


def struct_array(items: list[dict[str, object]]) -> np.ndarray:
    """What MATLAB calls a struct array."""
    made = np.empty(len(items), dtype=[(name, object) for name in items[0]])
    for k, item in enumerate(items):
        made[k] = tuple(item.values())
    return made


if __name__ == "__main__":
    drawn = np.random.default_rng(SEED)
    samples = struct_array([made(drawn) for _ in range(COUNT)])
    savemat(Path(__file__).with_name("thirty.mat"), {"samples": samples}, do_compression=True)
