"""``columns/<flight_id>.parquet``: what a flight did, before anything was computed from it, so that others can compute it again.

One row per plant tick, float64: ``time_s``, and x, y, z (east, north, up) of ``own.pos_enu_m``, ``own.vel_enu_mps`` and
``air.wind_enu_mps`` as columns ``own.pos_enu_m.x`` and so on. The metadata of the file have under ``flight`` a JSON object: who the
flight is, its rates, the ground, the time it was allowed, the end of the route, the planner's decisions, and each obstacle by its
radius, its centre at time 0 and its velocity: obstacles fly straight on, so their thousands of positions say no more. NaN is null there.

Without dictionary, with the bytes of each place of a number together (byte stream split): 46 kB for 1,190 rows in calm air, where
Parquet's defaults take 70 kB, and half the time to write.
"""

import json
import os
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from testbed.flight.record import FlightRecord
from testbed.flight.signals import flat
from testbed.results.plain import plain

KEPT = ("time_s", "own.pos_enu_m", "own.vel_enu_mps", "air.wind_enu_mps")
FLIGHT = "flight"  # key of the metadata


def write_columns(record: FlightRecord, path: Path) -> None:
    """Write the raw columns of one flight; a file of that name is replaced only when the new one is complete."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    try:
        pq.write_table(
            raw_table(record), part, compression="zstd", use_dictionary=False, use_byte_stream_split=True, write_statistics=False
        )
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def raw_table(record: FlightRecord) -> pa.Table:
    """The columns, and under ``flight`` in the metadata of the schema what is no column."""
    columns = flat({name: record.columns[name] for name in KEPT})
    metadata = {FLIGHT: json.dumps(plain(about(record)), allow_nan=False, separators=(",", ":"))}
    return pa.table({name: np.ascontiguousarray(values) for name, values in columns.items()}, metadata=metadata)


def about(record: FlightRecord) -> dict[str, Any]:
    """What is no column. ``goal_*``: the route's end and the direction in which it is passed; null where no route could be built."""
    plan = record.plan
    goal, direction = None, None
    if record.paths:
        route = record.paths[0].chain
        goal, direction, _ = route.frame(route.length_m)
    return {
        "flight_id": plan.flight_id,
        "cell": plan.cell,
        "labels": dict(plan.labels),
        "replicate": plan.replicate,
        "plant_hz": plan.rates.plant_hz,
        "guidance_hz": plan.rates.guidance_hz,
        "terrain_z_m": plan.terrain_z_m,
        "longest_s": record.longest_s,
        "goal_enu_m": goal,
        "goal_direction": direction,
        "obstacles": obstacles(record),
        "decisions": [asdict(event) for event in record.events],
    }


def obstacles(record: FlightRecord) -> list[dict[str, Any]]:
    """Radius, centre at time 0 and velocity of each; none of a flight that never began."""
    if not len(record.columns["time_s"]):
        return []
    return [
        {
            "name": spec.name,
            "radius_m": spec.radius_m,
            "pos_enu_m": record.columns[f"obstacle.{spec.name}.pos_enu_m"][0],
            "vel_enu_mps": record.columns[f"obstacle.{spec.name}.vel_enu_mps"][0],
        }
        for spec in record.plan.obstacles
    ]
