"""Velocity space over time: for each obstacle in sight its collision cones, and while it is a threat its spherical cap, as in the paper."""

import math
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from testbed.flight.record import FlightRecord, inside
from vosc import Cap, Obstacle, Own, cap, threat
from vosc.direction import corner_points

Array = np.ndarray
EDGE_RAD = 1e-9  # a velocity on the edge of the cone, where a method puts it, is no threat that comes and goes by rounding


@dataclass(frozen=True)
class Sight:
    """What one obstacle forbids at each of the sampled rows; NaN where it is out of range, inside or no threat."""

    name: str
    in_range: Array  # (n,) bool: within the detection range, outside the sphere
    inside: Array  # (n,) bool: within the sphere, where there is no cone
    is_threat: Array  # (n,) bool: the straight lines meet within the planner's horizon
    apex_mps: Array  # (n, 3) the obstacle's velocity
    axis: Array  # (n, 3) line of sight, own to obstacle
    alpha_rad: Array  # (n,) of the relative velocity off the line of sight
    half_angle_rad: Array  # (n,) of the collision cone, alpha_0
    caps: tuple[Cap | None, ...]  # (n) G while it is a threat

    def of_caps(self, name: str, parts: int = 0) -> Array:
        """A field of the caps by rows (n,) or (n, parts); NaN without a cap."""
        empty = np.full(parts, math.nan) if parts else math.nan
        return np.array([empty if found is None else getattr(found, name) for found in self.caps], float).reshape(
            -1, *([parts] * bool(parts))
        )

    @property
    def cap_axis(self) -> Array:
        """(n, 3) unit; towards the centre M of the cap."""
        azimuth, elevation = self.of_caps("azimuth_rad"), self.of_caps("elevation_rad")
        return np.column_stack([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])

    def states(self) -> list[str]:
        """Per row: ``inside``, ``threat``, ``in range`` or ``out of range``."""
        return [
            "inside" if inside else "threat" if is_threat else "in range" if in_range else "out of range"
            for inside, is_threat, in_range in zip(self.inside, self.is_threat, self.in_range, strict=True)
        ]


@dataclass(frozen=True)
class Corners:
    """S and S' of two caps (n, 2, 3), m/s; NaN while not both are threats, or where the circles do not meet."""

    names: tuple[str, str]
    points_mps: Array


def look(record: FlightRecord, rows: Array) -> list[Sight]:
    """What the planner could know, at some rows of a record."""
    columns, plan = record.columns, record.plan
    own_pos, own_vel = columns["own.pos_enu_m"][rows], columns["own.vel_enu_mps"][rows]
    sights = []
    for spec in plan.obstacles:
        pos, vel = columns[f"obstacle.{spec.name}.pos_enu_m"][rows], columns[f"obstacle.{spec.name}.vel_enu_mps"][rows]
        axis = pos - own_pos
        distance = np.linalg.norm(axis, axis=1)
        hit, radius = inside(distance - spec.radius_m), spec.radius_m + plan.replan.swell_m  # the planner's
        in_range = (distance <= plan.sensor.shown_reach_m(spec.radius_m)) & ~hit
        half_angle = np.arcsin(np.clip(radius / np.maximum(distance, 1e-9), 0.0, 1.0))
        is_threat, alpha = np.zeros(len(rows), bool), np.full(len(rows), math.nan)
        caps: list[Cap | None] = [None] * len(rows)
        for k in np.flatnonzero(in_range & (distance > radius)):
            own, obstacle = Own(tuple(own_pos[k]), tuple(own_vel[k])), Obstacle(tuple(pos[k]), tuple(vel[k]), radius)
            test = threat(own, obstacle, plan.replan.horizon_s)
            alpha[k] = test.alpha_rad
            is_threat[k] = test.is_threat and test.alpha0_rad - test.alpha_rad > EDGE_RAD
            found = cap(own, obstacle) if is_threat[k] else None
            if found is not None and math.isfinite(found.half_angle_rad):
                caps[k] = found
        half_angle[~in_range] = math.nan
        sights.append(Sight(spec.name, in_range, hit, is_threat, vel, axis, alpha, half_angle, tuple(caps)))
    return sights


def corners(sights: list[Sight], speed_mps: Array) -> list[Corners]:
    """S and S' of each pair of obstacles whose caps ever meet."""
    found = []
    for first, second in combinations(sights, 2):
        points = np.full((len(speed_mps), 2, 3), math.nan)
        for k, (one, other) in enumerate(zip(first.caps, second.caps, strict=True)):
            if one is not None and other is not None and (both := corner_points(one, other, float(speed_mps[k]))):
                points[k] = both
        if np.isfinite(points).any():
            found.append(Corners((first.name, second.name), points))
    return found
