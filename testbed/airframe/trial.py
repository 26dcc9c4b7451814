"""Fly an aircraft with its own autopilot, along a path or through a step of a command. No planner, no obstacles, no record."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from testbed.core.frames import Vec3
from testbed.flight.air import AirModel
from testbed.flight.guidance.law import SpeedHold
from testbed.flight.guidance.look_ahead import LookAheadLaw
from testbed.flight.plants.aircraft import Aircraft
from testbed.flight.plants.base import Command, Start, State
from testbed.flight.plants.jsbsim import JsbsimPlant
from testbed.flight.route.path import ActivePath

Array = np.ndarray
PLANT_HZ, GUIDANCE_HZ = 120, 60
GROUND_BELOW_M = 150.0  # of the lowest point of a path
NEAR_M = 0.5  # spacing of the points among which the nearest is sought; the offset is then taken square to the path there
STILL: Vec3 = (0.0, 0.0, 0.0)


class Trial(NamedTuple):
    """A flight: a column for every field of ``State`` and ``Command``, time, and the distance from the path."""

    columns: dict[str, Array]
    cross_track_m: Array

    @property
    def rms_m(self) -> float:
        """Root mean square of the distance from the path; NaN when the flight left it for good."""
        return float(np.sqrt(np.mean(self.cross_track_m**2)))

    @property
    def most_m(self) -> float:
        """Greatest distance from the path."""
        return float(np.max(self.cross_track_m))


def follow(aircraft: Aircraft, path: ActivePath, speed_mps: float, wind: Vec3 = STILL, from_s_m: float = 0.0) -> Trial:
    """Fly the path from there to its end, or until half as long again as it should take has passed."""
    start = Start(*path.frame(from_s_m), speed_mps, wind)
    samples = [curve.sample(np.arange(0.0, curve.length_m, NEAR_M)) for curve in path.curves]
    points, tangents = (np.vstack([sample[k] for sample in samples]) for k in (0, 1))
    terrain_m = float(points[:, 2].min()) - GROUND_BELOW_M
    plant = JsbsimPlant(aircraft, start, PLANT_HZ, GUIDANCE_HZ, terrain_m)
    law = LookAheadLaw(aircraft, SpeedHold(speed_mps, airspeed=True, keep_schedule=False), 1.0 / GUIDANCE_HZ)
    memory = law.start(from_s_m)
    slowest = max(1.0, speed_mps - float(np.linalg.norm(wind)))
    rows: list[tuple[float, ...]] = []
    for tick in range(round(1.5 * path.length_m / slowest * PLANT_HZ)):
        state = plant.state(plant.sample())
        if memory.s_m >= path.length_m or not state.z > terrain_m:
            break
        if tick % (PLANT_HZ // GUIDANCE_HZ) == 0:
            command, memory, _ = law.step(memory, state, path)
            plant.command(state, command)
        rows.append((*state, *command))
        plant.step()
    columns = _columns(rows)
    position = np.column_stack([columns[axis] for axis in "xyz"])
    offset = position - points[nearest := cKDTree(points).query(position)[1]]
    along = np.sum(offset * tangents[nearest], axis=1)
    return Trial(columns, np.sqrt(np.maximum(np.sum(offset**2, axis=1) - along**2, 0.0)))


def hold(
    aircraft: Aircraft, speed_mps: float, seconds: float, command: Callable[[float, State], Command], air: AirModel | None = None
) -> dict[str, Array]:
    """Columns of a flight from straight and level, with commands as a function of time and state; the air is still, or as given."""
    start = Start((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), STILL, speed_mps, STILL)
    plant = JsbsimPlant(aircraft, start, PLANT_HZ, GUIDANCE_HZ, -GROUND_BELOW_M, air)
    rows: list[tuple[float, ...]] = []
    for tick in range(round(seconds * PLANT_HZ) + 1):
        state = plant.state(plant.sample())
        if tick % (PLANT_HZ // GUIDANCE_HZ) == 0:
            told = command(tick / PLANT_HZ, state)
            plant.command(state, told)
        rows.append((*state, *told))
        plant.step()
    return _columns(rows)


def _columns(rows: list[tuple[float, ...]]) -> dict[str, Array]:
    names = [*State._fields, *(f"{name}_cmd" for name in Command._fields)]
    table = np.array(rows)
    return {"time_s": np.arange(len(rows)) / PLANT_HZ} | dict(zip(names, table.T, strict=True))
