"""Frames: local ENU (x east, y north, z up), body FRD (x forward, y right, z down), WGS84.

Rotations are named ``to_from``.  Paper directions are (azimuth counter-clockwise from +x = east, elevation up).
A compass heading is clockwise from north.  Wind is given by the compass direction it comes FROM.
"""

import math

import numpy as np

from testbed.core.units import DEG

Vec3 = tuple[float, float, float]
Array = np.ndarray


def vec3(array: Array) -> Vec3:
    """An array (3,) as a tuple of floats."""
    x, y, z = (float(v) for v in array)
    return x, y, z


def unit_from_direction(azimuth_deg: float, elevation_deg: float) -> Vec3:
    """Unit ENU vector of a paper direction (azimuth counter-clockwise from east, elevation up), degrees."""
    azimuth, elevation = azimuth_deg * DEG, elevation_deg * DEG
    flat = math.cos(elevation)
    return flat * math.cos(azimuth), flat * math.sin(azimuth), math.sin(elevation)


def direction_deg(vector: Vec3) -> tuple[float, float]:
    """Paper direction (azimuth, elevation) of an ENU vector, degrees; azimuth in (-180, 180]."""
    x, y, z = vector
    return math.atan2(y, x) / DEG, math.atan2(z, math.hypot(x, y)) / DEG


def wind_enu_from_compass(speed_mps: float, from_deg: float) -> Vec3:
    """Velocity of the air over the ground (ENU, m/s) of a wind that blows FROM a compass direction."""
    return -speed_mps * math.sin(from_deg * DEG), -speed_mps * math.cos(from_deg * DEG), 0.0


def ground_speed_along(tangent: Vec3, airspeed_mps: float, wind: Vec3) -> float:
    """Speed over the ground along a unit tangent at a given true airspeed: |v_g T - W| = TAS, the forward root; 0 if there is none."""
    along = sum(t * w for t, w in zip(tangent, wind, strict=True))
    square = along * along - (sum(w * w for w in wind) - airspeed_mps * airspeed_mps)
    return max(0.0, along + square**0.5) if square > 0.0 else 0.0


def enu_from_wind_axes(air_velocity: Vec3, bank: float, alpha: float) -> Array:
    """Rotation (3,3) ``enu_from_body`` of an aircraft with that air velocity (ENU), bank about it (right positive) and angle of attack.

    No sideslip.  Body x forward, y right, z down.
    """
    vx, vy, vz = air_velocity
    flat = math.hypot(vx, vy)
    climb, track = math.atan2(vz, flat), math.atan2(vx, vy)
    along = np.array([math.sin(track) * math.cos(climb), math.cos(track) * math.cos(climb), math.sin(climb)])
    level_right = np.array([math.cos(track), -math.sin(track), 0.0])
    down = np.cross(along, level_right)
    right = math.cos(bank) * level_right + math.sin(bank) * down
    below = np.cross(along, right)
    nose = math.cos(alpha) * along - math.sin(alpha) * below
    return np.column_stack([nose, right, np.cross(nose, right)])


def euler_from_enu_from_body(enu_from_body: Array) -> Vec3:
    """(bank, pitch, compass heading) in radians of a rotation (3,3) from body FRD to ENU; heading in [0, 2 pi)."""
    nose, right, below = enu_from_body.T
    pitch = math.asin(max(-1.0, min(1.0, float(nose[2]))))
    heading = math.atan2(nose[0], nose[1]) % math.tau
    return math.atan2(-right[2], -below[2]), pitch, heading


def enu_from_body(bank: float, pitch: float, heading: float) -> Array:
    """Rotation (3,3), v_enu = rotation @ v_body, from Euler angles in rad (compass heading). Inverse of ``euler_from_enu_from_body``."""
    (cb, sb), (cp, sp), (ch, sh) = ((math.cos(a), math.sin(a)) for a in (bank, pitch, heading))
    return np.array(
        [
            [cp * sh, sb * sp * sh + cb * ch, cb * sp * sh - sb * ch],
            [cp * ch, sb * sp * ch - cb * sh, cb * sp * ch + sb * sh],
            [sp, -sb * cp, -cb * cp],
        ]
    )


def body_rates(enu_from_body: Array, tangent: Vec3, curvature: Vec3, speed_mps: float) -> Vec3:
    """(p, q, r) in rad/s of an aircraft that turns with a path of unit ``tangent`` and curvature vector (1/m) at that speed."""
    turn = speed_mps * np.cross(tangent, curvature)
    p, q, r = (enu_from_body.T @ turn).tolist()
    return p, q, r


def quat_xyzw_from_euler(bank: Array, pitch: Array, heading: Array) -> Array:
    """Quaternions (n,4), x y z w, of ``enu_from_body`` for arrays (n,) of Euler angles."""
    # ENU from NED is half a turn about (1,1,0)/sqrt 2; NED from body is the usual yaw, pitch, roll.
    (cb, sb), (cp, sp), (ch, sh) = ((np.cos(a / 2), np.sin(a / 2)) for a in (bank, pitch, heading))
    w = cb * cp * ch + sb * sp * sh
    x = sb * cp * ch - cb * sp * sh
    y = cb * sp * ch + sb * cp * sh
    z = cb * cp * sh - sb * sp * ch
    half = math.sqrt(0.5)
    return np.column_stack([half * (w + z), half * (w - z), half * (y - x), -half * (x + y)])
