"""Velocity space over time: for each obstacle in sight its velocity-obstacle cone, and its spherical cap while it is a threat."""

import math
from dataclasses import dataclass

import numpy as np

from testbed.flight.record import FlightRecord, inside
from vosc import Obstacle, Own, cap, threat

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
    half_angle_rad: Array  # (n,) of the collision cone, alpha_0
    cap_axis: Array  # (n, 3) unit; centre of the spherical cap
    cap_half_angle_rad: Array  # (n,)

    def states(self) -> list[str]:
        """Per row: ``inside``, ``threat``, ``in range`` or ``out of range``."""
        return [
            "inside" if inside else "threat" if is_threat else "in range" if in_range else "out of range"
            for inside, is_threat, in_range in zip(self.inside, self.is_threat, self.in_range, strict=True)
        ]


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
        in_range = (distance <= plan.sensor.range_m) & ~hit
        half_angle = np.arcsin(np.clip(radius / np.maximum(distance, 1e-9), 0.0, 1.0))
        is_threat = np.zeros(len(rows), bool)
        cap_axis, cap_half_angle = np.full((len(rows), 3), math.nan), np.full(len(rows), math.nan)
        for k in np.flatnonzero(in_range & (distance > radius)):
            own, obstacle = Own(tuple(own_pos[k]), tuple(own_vel[k])), Obstacle(tuple(pos[k]), tuple(vel[k]), radius)
            test = threat(own, obstacle, plan.replan.horizon_s)
            is_threat[k] = test.is_threat and test.alpha0_rad - test.alpha_rad > EDGE_RAD
            area = cap(own, obstacle) if is_threat[k] else None
            if area is not None and math.isfinite(area.half_angle_rad):
                flat = math.cos(area.elevation_rad)
                cap_axis[k] = flat * math.cos(area.azimuth_rad), flat * math.sin(area.azimuth_rad), math.sin(area.elevation_rad)
                cap_half_angle[k] = area.half_angle_rad
        half_angle[~in_range] = math.nan
        sights.append(Sight(spec.name, in_range, hit, is_threat, vel, axis, half_angle, cap_axis, cap_half_angle))
    return sights
