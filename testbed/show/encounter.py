"""The part of a flight that everybody wants to see: from the decision to a little after the closest approach."""

import math
from typing import NamedTuple

import numpy as np

from testbed.flight.record import AVOIDING, FlightRecord
from testbed.results.columns import FlightMetrics

Array = np.ndarray
LEAD_S = 2.0  # where nothing was decided, so long before the closest approach it begins
AFTER_S = 1.5  # so long after the closest approach it ends


class Window(NamedTuple):
    """Times of the flight between which the encounter is, when it is closest, and to which obstacle; the whole flight without one."""

    begin_s: float
    end_s: float
    closest_s: float
    obstacle: str


def decision_time(record: FlightRecord) -> float:
    """When the flight first left its path; else when its planner first decided anything; NaN where it did not."""
    left = [event.time_s for event in record.events if event.decision in AVOIDING] or [event.time_s for event in record.events]
    return min(left, default=math.nan)


def window_of(record: FlightRecord, metrics: FlightMetrics) -> Window:
    """The encounter of a flight. A flight without a row, an obstacle or a measured approach is its own encounter."""
    time_s, closest = record.columns["time_s"], metrics.time_at_least_clearance_s
    first, last = (float(time_s[0]), float(time_s[-1])) if len(time_s) else (0.0, 0.0)
    if not metrics.nearest_obstacle or not math.isfinite(closest):
        return Window(first, last, math.nan, "")
    decided = decision_time(record)
    begin = decided if math.isfinite(decided) and decided < closest else closest - LEAD_S
    return Window(max(first, begin), min(last, closest + AFTER_S), closest, metrics.nearest_obstacle)


def to_surface(own: Array, centre: Array, radius_m: float) -> Array:
    """From each place (n, 3) to the nearest point of a sphere's surface; from the centre itself, straight up."""
    away = centre - own
    distance = np.linalg.norm(away, axis=1, keepdims=True)
    direction = np.where(distance > 0.0, away / np.maximum(distance, 1e-12), [0.0, 0.0, -1.0])
    return direction * (distance - radius_m)
