"""The part of a flight that the page pictures: few samples, the extreme ones among them, rounded so that its bytes are stable."""

import hashlib
import json
import math
from typing import Any

import numpy as np

from testbed.core.units import DEG
from testbed.flight.record import FlightRecord, PlannedPath
from testbed.results.quantities import demanded_roll_rate
from testbed.show.close_up import axes_of, close_up, rounded
from testbed.show.flight_summary import path_points, who

Array = np.ndarray
Series = dict[str, Any]

MOST_SAMPLES = 240
MOST_EVENTS = 20  # so many decisions have a sample of their own
PATH_SAMPLES = 40  # per planned curve
TRACK_S = 2.5  # of an obstacle, either side of its closest approach

# Curve of the page, column of the record, factor to the unit shown, decimals kept.
CURVES = (
    ("cross_track_m", "path.cross_track_m", 1.0, 3),
    ("bank_deg", "own.bank_rad", 1.0 / DEG, 2),
    ("airspeed_mps", "own.airspeed_mps", 1.0, 2),
    ("load_factor", "own.load_factor", 1.0, 3),
)
ROLL_RATE = "roll_rate_dps"  # of the body; of a point, what its path demands


def flight_series(record: FlightRecord) -> Series:
    """What the page needs of one flight, as JSON-able values; NaN becomes ``None``."""
    time_s = record.columns["time_s"]
    clearance = _clearance(record)
    roll_rate = _roll_rate(record)
    rows = _chosen_rows(record, clearance, roll_rate)
    return {
        "who": who(record),
        "method": record.plan.avoids_by,
        "encounter": encounter_key(record),
        "geometry": record.plan.geometry,
        "time_s": rounded(time_s[rows], 3),
        **axes_of(record.columns["own.pos_enu_m"][rows]),
        "clearance_m": rounded(clearance[rows], 3) if record.plan.obstacles else [],
        **{name: rounded(record.columns[column][rows] * factor, digits) for name, column, factor, digits in CURVES},
        ROLL_RATE: rounded(roll_rate[rows] / DEG, 1),
        "paths": [_path(path) for path in record.paths],
        "obstacles": _obstacles(record) if len(time_s) else [],
        "decisions": [
            {
                "time_s": round(event.time_s, 3),
                "decision": event.decision,
                "obstacle": event.obstacle,
                "insertion_enu_m": rounded(np.array(event.insertion_enu_m), 2) if np.isfinite(event.insertion_enu_m).all() else None,
            }
            for event in record.events
        ],
        "close_up": close_up(record, clearance, roll_rate),
    }


def encounter_key(record: FlightRecord) -> str:
    """The same for flights that meet the same obstacles on the same route, whoever flies and avoids."""
    said = record.plan.model_dump(mode="json", include={"route", "geometry", "obstacles"})
    return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()[:12]


def _clearance(record: FlightRecord) -> Array:
    """To the nearest obstacle at each row."""
    each = [record.columns[f"obstacle.{spec.name}.clearance_m"] for spec in record.plan.obstacles if len(record.columns["time_s"])]
    return np.fmin.reduce(each) if each else np.full(len(record.columns["time_s"]), math.nan)


def _roll_rate(record: FlightRecord) -> Array:
    rate = record.columns["own.rates_body_radps"][:, 0]
    return demanded_roll_rate(record) if np.isnan(rate).all() else rate


def _chosen_rows(record: FlightRecord, clearance: Array, roll_rate: Array) -> Array:
    """Evenly spaced rows, with both ends, the extremes of every curve and the decisions among them."""
    n = len(record.columns["time_s"])
    if n <= MOST_SAMPLES:
        return np.arange(n)
    chosen = {0, n - 1}
    curves = [record.columns[column] for _, column, _, _ in CURVES]
    curves += [record.columns[f"obstacle.{spec.name}.clearance_m"] for spec in record.plan.obstacles[:MOST_EVENTS]]
    for curve in (clearance, roll_rate, *curves):
        if np.isfinite(curve).any():
            chosen |= {int(np.nanargmin(curve)), int(np.nanargmax(curve))}
    chosen |= {int(np.argmin(np.abs(record.columns["time_s"] - event.time_s))) for event in record.events[:MOST_EVENTS]}
    even = np.linspace(0, n - 1, MOST_SAMPLES - len(chosen)).round().astype(int)
    return np.union1d(even, sorted(chosen))


def _path(path: PlannedPath) -> dict[str, Any]:
    pieces = path_points(path, PATH_SAMPLES)
    return {"from_s": round(path.from_time_s, 3), **axes_of(np.vstack(pieces))}


def _obstacles(record: FlightRecord) -> list[dict[str, Any]]:
    """Where each obstacle was when it was nearest, and both ends of its straight track for a few seconds around that."""
    told = []
    for spec in record.plan.obstacles:
        pos, clearance = record.columns[f"obstacle.{spec.name}.pos_enu_m"], record.columns[f"obstacle.{spec.name}.clearance_m"]
        nearest = int(np.nanargmin(clearance)) if np.isfinite(clearance).any() else 0
        around = np.flatnonzero(np.abs(record.columns["time_s"] - record.columns["time_s"][nearest]) <= TRACK_S)
        told.append(
            {
                "name": spec.name,
                "radius_m": spec.radius_m,
                **axes_of(pos[around[[0, -1]]]),
                "nearest_time_s": round(float(record.columns["time_s"][nearest]), 3),
                "nearest_enu_m": rounded(pos[nearest], 2),
            }
        )
    return told
