"""The raw columns of one flight: where everything was, tick by tick."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from .run import BadInputError

Array = np.ndarray


@dataclass(frozen=True)
class Obstacle:
    """A sphere and its way: places and velocities (n,3) of its centre in ENU, NaN in the rows in which it is not there."""

    name: str
    radius_m: float
    pos: Array
    vel: Array


@dataclass(frozen=True)
class Raw:
    """One flight as it was kept: ``time_s`` (n,), places, velocities and wind (n,3) in ENU, and what the file says about it."""

    time_s: Array
    pos: Array
    vel: Array
    wind: Array
    obstacles: tuple[Obstacle, ...]
    about: Mapping[str, Any]


def read_raw(path: Path) -> Raw:
    """The raw columns of a flight."""
    try:
        table = pq.read_table(path)
        about = json.loads((table.schema.metadata or {})[b"flight"])
        pos, vel, wind = (vectors(table, name) for name in ("own.pos_enu_m", "own.vel_enu_mps", "air.wind_enu_mps"))
        raw = Raw(table["time_s"].to_numpy(), pos, vel, wind, tuple(way_of(table, one) for one in about["obstacles"]), about)
        _ = [about[key] for key in ("flight_id", "plant_hz", "terrain_z_m", "goal_enu_m", "goal_direction", "decisions")]
    except (OSError, pa.ArrowException, KeyError, ValueError, TypeError) as problem:
        raise BadInputError(f"{path}: not the raw columns of a flight ({problem})") from None
    return raw


def vectors(table: pa.Table, name: str) -> Array:
    """A vector (n,3) that is kept as columns x, y, z."""
    return np.column_stack([table[f"{name}.{axis}"].to_numpy() for axis in "xyz"])


def way_of(table: pa.Table, said: Mapping[str, Any]) -> Obstacle:
    """An obstacle by its columns, tick by tick; one that has none flies straight on from where it is at time 0."""
    name, time_s = said["name"], table["time_s"].to_numpy()
    pos, vel = f"obstacle.{name}.pos_enu_m", f"obstacle.{name}.vel_enu_mps"
    if f"{pos}.x" in table.column_names:
        return Obstacle(name, said["radius_m"], vectors(table, pos), vectors(table, vel))
    steady = np.tile(np.array(said["vel_enu_mps"], dtype=float), (len(time_s), 1))
    return Obstacle(name, said["radius_m"], np.array(said["pos_enu_m"]) + time_s[:, None] * steady, steady)
