"""What an aircraft can do in straight flight, for its data sheet."""

import math
from typing import NamedTuple

import numpy as np

from testbed.airframe.trim import TrimPoint, stall_speed, steepest_climb, trim_table
from testbed.core.units import DEG
from testbed.flight.plants.aircraft import Aircraft

SPEEDS = 6
CLIMB_STEP_DEG = 5


class Performance(NamedTuple):
    """Everything on the page that is flown or trimmed."""

    speeds_mps: list[float]
    climbs_rad: list[float]
    trims: list[list[TrimPoint | None]]
    steepest_rad: list[float]
    stall_mps: float


def measure(aircraft: Aircraft, speed: float) -> Performance:
    """Trims over the envelope's airspeeds and over climbs in steps of five degrees, as far as they trim."""
    limits = aircraft.limits
    low, high = math.ceil(limits.speed_min_mps), math.floor(limits.speed_max_mps)
    speeds = sorted({float(round(v)) for v in np.linspace(low, high, SPEEDS - 1)} | {speed})
    steepest = [steepest_climb(aircraft, v) for v in speeds]
    most = max((climb for climb in steepest if not math.isnan(climb)), default=0.0)
    climbs = [k * CLIMB_STEP_DEG * DEG for k in range(int(most / DEG / CLIMB_STEP_DEG) + 1)]
    trims: list[list[TrimPoint | None]] = []
    for climb in climbs:
        (row,) = trim_table(aircraft, [v for v, most_here in zip(speeds, steepest, strict=True) if climb <= most_here + 1e-9], [climb])
        by_speed = {point.speed_mps: point for point in row if point is not None}
        trims.append([by_speed.get(v) for v in speeds])
    return Performance(speeds, climbs, trims, steepest, stall_speed(aircraft, speed))
