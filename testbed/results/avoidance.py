"""What an avoidance cost and when it was over: deflections, times, the way back, and where the clearance went.

Deflection is the 3-D angle from the velocity at the trigger to (a) the commanded direction, (b) the velocity flown at the closest
passage of the insertion point, (c) the velocity flown farthest from it before the flight is clear; over the ground and through the air.
*Clear* is the first time at which every obstacle opens and the rest of the flight keeps the radius of every one of them.
"""

import math
from dataclasses import dataclass

import numpy as np

from testbed.core.units import DEG
from testbed.flight.record import AVOIDING, FlightRecord, ReplanEvent, inside
from testbed.flight.record.columns import contenders
from testbed.flight.traffic.track import least_clearance

Array = np.ndarray
NAN = math.nan
BACK_M = 5.0  # a flight is back on its route from where it stays this near
LOOK_EVERY_S = 0.1  # the way back is timed this finely


@dataclass(frozen=True)
class Avoidance:
    """Metrics of the first avoidance of a flight, named as the columns; NaN where there is none."""

    deflection_ground_deg: float = NAN
    flown_deflection_deg: float = NAN
    flown_deflection_air_deg: float = NAN
    peak_deflection_deg: float = NAN
    peak_deflection_air_deg: float = NAN
    avoidance_time_s: float = NAN
    insertion_miss_m: float = NAN
    clear_time_s: float = NAN
    rejoin_time_s: float = NAN
    rejoin_length_m: float = NAN


def avoidance(record: FlightRecord, end: int) -> Avoidance:
    """Of a flight whose row ``end`` is its last on this side of the goal's plane."""
    event = next((event for event in record.events if event.decision in AVOIDING), None)
    hz = record.plan.rates.plant_hz
    if event is None or (first := round(event.time_s * hz)) >= end:
        return Avoidance()
    ground = turned(record.columns["own.vel_enu_mps"], first)
    air = turned(record.columns["own.vel_enu_mps"] - record.columns["air.wind_enu_mps"], first)
    clear = clear_row(record, first, end)
    until = slice(first, (end if clear is None else clear) + 1)
    passed, miss = passage(record, event, first, end)
    back, length = rejoined(record, first, end)
    return Avoidance(
        deflection_ground_deg=float(angle_deg(np.array(event.own_vel_enu_mps), np.array(event.command_enu_mps))),
        flown_deflection_deg=float(ground[passed]) if passed else NAN,
        flown_deflection_air_deg=float(air[passed]) if passed else NAN,
        peak_deflection_deg=float(np.max(ground[until])),
        peak_deflection_air_deg=float(np.max(air[until])),
        avoidance_time_s=(passed - first) / hz if passed else NAN,
        insertion_miss_m=miss,
        clear_time_s=NAN if clear is None else (clear - first) / hz,
        rejoin_time_s=(back - first) / hz if back else NAN,
        rejoin_length_m=length,
    )


def turned(velocity: Array, first: int) -> Array:
    """Angle (n,) in degrees of velocities (n,3) from the one in row ``first``."""
    return angle_deg(velocity, velocity[first])


def angle_deg(a: Array, b: Array) -> Array:
    """Angle in degrees between vectors (..., 3) and (3,), good at small angles too."""
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), a @ b) / DEG


def clear_row(record: FlightRecord, first: int, end: int) -> int | None:
    """The first row from which on every obstacle opens at first, or is gone, and none is met any more; None when there is none."""
    clear = np.ones(end + 1 - first, dtype=bool)
    for spec in record.plan.obstacles:
        if not clear.any():
            return None
        skipped = int(np.argmax(clear))  # no row before it is clear, whatever the others do
        first, clear, rows = first + skipped, clear[skipped:], slice(first + skipped, end + 1)
        pos, vel, distance = (record.columns[f"obstacle.{spec.name}.{part}"][rows] for part in ("pos_enu_m", "vel_enu_mps", "clearance_m"))
        relative, moving = pos - record.columns["own.pos_enu_m"][rows], vel - record.columns["own.vel_enu_mps"][rows]
        gone = np.isnan(pos[:, 0])
        clearance = np.where(gone, np.inf, distance)
        least = np.minimum.accumulate(clearance[::-1])[::-1]
        clear &= ((np.einsum("ij,ij->i", relative, moving) > 0.0) | gone) & ~inside(least)
    found = np.flatnonzero(clear)
    return first + int(found[0]) if len(found) else None


def passage(record: FlightRecord, event: ReplanEvent, first: int, end: int) -> tuple[int, float]:
    """Row and distance (m) of the closest passage of the insertion point; (0, NaN) where there is no such point."""
    if not np.isfinite(event.insertion_enu_m).all():
        return 0, NAN
    distance = np.linalg.norm(record.columns["own.pos_enu_m"][first : end + 1] - np.array(event.insertion_enu_m), axis=1)
    nearest = int(np.argmin(distance))
    return first + nearest, float(distance[nearest])


def rejoined(record: FlightRecord, first: int, end: int) -> tuple[int, float]:
    """Row from which on the flight stays within ``BACK_M`` of its route, and the ground arc flown until then (m)."""
    pos = record.columns["own.pos_enu_m"]
    every = max(1, round(LOOK_EVERY_S * record.plan.rates.plant_hz))
    rows = np.arange(end, first, -every)  # from the end backwards
    away = np.flatnonzero(record.paths[0].chain.nearest(pos[rows], record.columns["guidance.s_m"][rows])[1] > BACK_M)
    if len(away) and away[0] == 0:
        return 0, NAN
    back = int(rows[away[0] - 1]) if len(away) else first
    return back, float(np.linalg.norm(np.diff(pos[first : back + 1], axis=0), axis=1).sum())


def followed_clearance(record: FlightRecord) -> float:
    """Least clearance (m) of the places of the active paths that the flight was nearest to, when it was: timing as flown, no offset."""
    if not record.plan.obstacles or not record.paths or not len(record.columns["time_s"]):
        return NAN
    point = np.full_like(record.columns["own.pos_enu_m"], NAN)
    for active, path in enumerate(record.paths):
        mine = np.flatnonzero(record.columns["path.index"] == active)
        if len(mine):
            point[mine] = path.chain.places(record.columns["path.s_m"][mine])
    return clearance_of(record, point)


def clearance_of(record: FlightRecord, point: Array) -> float:
    """Least clearance (m) that a point at places (n,3), one a row, would have had."""
    time_s = record.columns["time_s"]
    least = [
        least_clearance(time_s, point, record.columns[f"obstacle.{spec.name}.pos_enu_m"], spec.radius_m).clearance_m
        for spec in contenders(record.columns, point, record.plan.obstacles)
    ]
    return float(np.nanmin(least)) if np.isfinite(least).any() else NAN
