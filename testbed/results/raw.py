"""``columns/<flight_id>.parquet``: what a flight did, before anything was computed from it, so that others can compute it again.

One row per plant tick, float64: ``time_s``, and x, y, z (east, north, up) of ``own.pos_enu_m``, ``own.vel_enu_mps`` and
``air.wind_enu_mps`` as columns ``own.pos_enu_m.x`` and so on. The metadata of the file have under ``flight`` a JSON object: who the
flight is, its rates, the ground, the time it was allowed, the end of the route, the planner's decisions, and each obstacle by its
name and radius. One that flies straight on has its centre at time 0 and its velocity there too, since its thousands of positions say
no more; any other has columns ``obstacle.<name>.pos_enu_m.x`` and so on, and ``vel_enu_mps``, NaN where it is absent. NaN is null in JSON.

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
from testbed.flight.record.signals import flat
from testbed.results.plain import plain

ALWAYS_STORED = ("time_s", "own.pos_enu_m", "own.vel_enu_mps", "air.wind_enu_mps")
FLIGHT = "flight"  # key of the metadata
ROUNDING = 1e-9  # m and m/s: what the arithmetic of a straight line leaves, and no turn of any obstacle


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
    said = about(record)
    bent = [obstacle["name"] for obstacle in said["obstacles"] if "pos_enu_m" not in obstacle]
    columns = flat({name: record.columns[name] for name in (*ALWAYS_STORED, *(column for obstacle in bent for column in way(obstacle)))})
    metadata = {FLIGHT: json.dumps(plain(said), allow_nan=False, separators=(",", ":"))}
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


def way(obstacle: str) -> tuple[str, str]:
    """The columns of a record that say where an obstacle is and how it moves."""
    return f"obstacle.{obstacle}.pos_enu_m", f"obstacle.{obstacle}.vel_enu_mps"


def flies_straight(record: FlightRecord, obstacle: str) -> bool:
    """Do its first row and the time say where an obstacle is in every row? Not where it is absent from some."""
    pos, vel = (record.columns[name] for name in way(obstacle))
    line = pos[0] + np.outer(record.columns["time_s"], vel[0])
    return bool((np.abs(pos - line) <= ROUNDING).all() and (np.abs(vel - vel[0]) <= ROUNDING).all())


def obstacles(record: FlightRecord) -> list[dict[str, Any]]:
    """Name and radius of each, centre at time 0 and velocity of those that fly straight; none of a flight that never began."""
    if not len(record.columns["time_s"]):
        return []
    said = []
    for spec in record.plan.obstacles:
        line = {}
        if flies_straight(record, spec.name):
            pos, vel = way(spec.name)
            line = {"pos_enu_m": record.columns[pos][0], "vel_enu_mps": record.columns[vel][0]}
        said.append({"name": spec.name, "radius_m": spec.radius_m, **line})
    return said
