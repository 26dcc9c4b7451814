"""Where a recording is filmed from: close to the encounter, and from behind the aircraft. Geometry only."""

from dataclasses import dataclass

import numpy as np

Array = np.ndarray
UP = np.array([0.0, 0.0, 1.0])
FOV_DEG = 45.0  # from the lower edge of the picture to the upper one
ASPECT = 1.5
SPANS = 7.0  # the close camera comes no closer than that many wing spans
ROOM = 1.3  # and keeps the way to the sphere's surface in the picture: so many times its length away
BETWEEN = 0.52  # in the middle of the picture is that part of this way
CHASE_SPANS = (5.0, 1.3)  # the chase camera is so many spans behind and above
CHASE_LAG_S = 0.35  # it turns after the aircraft with this lag, or a gust would shake it


@dataclass(frozen=True)
class Shot:
    """A camera over time: places ``eye`` (n, 3), axes ``axes`` (n, 3, 3) with columns right, down and forward, and the picture's height
    ``height_m`` (n,) at what it looks at.
    """

    eye: Array
    axes: Array
    height_m: Array

    def some(self, rows: Array) -> "Shot":
        """At some of the rows."""
        return Shot(self.eye[rows], self.axes[rows], self.height_m[rows])

    def repeated(self, rows: int) -> "Shot":
        """A camera that stands still, so many times."""
        return Shot(*(np.repeat(part[:1], rows, axis=0) for part in (self.eye, self.axes, self.height_m)))

    def at(self, places: Array, beside: Array | None = None) -> Array:
        """The points (n, 3) that are seen at these places (n, 2), as far away as what the camera looks at, or as the points ``beside``."""
        height = self.height_m
        if beside is not None:
            height = 2.0 * np.tan(np.radians(FOV_DEG) / 2.0) * np.einsum("ni,ni->n", beside - self.eye, self.axes[:, :, 2])
        ahead = height / (2.0 * np.tan(np.radians(FOV_DEG) / 2.0))
        across = places[:, :1] * self.axes[:, :, 0] - places[:, 1:] * self.axes[:, :, 1]
        return np.asarray(self.eye + height[:, None] * across + ahead[:, None] * self.axes[:, :, 2])

    def seen(self, points: Array) -> Array:
        """Where points (n, 3) are in the picture (n, 2): right and up from its middle, in heights of the picture."""
        local = np.einsum("nji,nj->ni", self.axes, points - self.eye)
        half = np.tan(np.radians(FOV_DEG) / 2.0)
        return np.column_stack([local[:, 0], -local[:, 1]]) / (2.0 * half * local[:, 2:3])


def looking(forward: Array) -> Array:
    """Axes (n, 3, 3) of cameras that look along ``forward`` (n, 3), the horizon level."""
    z = forward / np.linalg.norm(forward, axis=1, keepdims=True)
    right = np.cross(z, UP)
    steep = np.linalg.norm(right, axis=1) < 1e-6
    right[steep] = [1.0, 0.0, 0.0]
    right = right / np.linalg.norm(right, axis=1, keepdims=True)
    return np.stack([right, np.cross(z, right), z], axis=2)


def close_up(
    own: Array,
    own_vel: Array,
    centre: Array,
    centre_vel: Array,
    gap: Array,
    closest: int,
    span_m: float,
    others_m: Array | float = 0.0,
    beside: float = BETWEEN,
) -> Shot:
    """The aircraft and the nearest point of the sphere's surface, ``gap`` (n, 3) away, from one side throughout.

    The plane of the relative motion is seen nearly at right angles, so that the clearance has its true length in the picture; a little
    from behind, and from the aircraft's side of the sphere. ``closest``: the row of the closest approach. ``others_m``: so far from the
    aircraft others are that shall be in the picture. ``beside``: which part of the way to the surface is in the middle of it.
    """
    relative, away = own_vel[closest] - centre_vel[closest], own[closest] - centre[closest]
    forward, away = _unit(own_vel[closest]), _unit(away)
    normal = np.cross(_unit(relative), away)
    normal = _unit(normal) if np.linalg.norm(normal) > 0.1 else UP
    if normal[2] < 0.0:
        normal = -normal
    towards = _unit(0.8 * normal - 0.6 * forward + 0.25 * away)
    if towards[2] < 0.2:  # never from below: the ground's grid would hide everything
        towards = _unit(towards * [1.0, 1.0, 0.0] + 0.3 * UP)
    distance = np.hypot(SPANS * span_m, ROOM * np.maximum(np.linalg.norm(gap, axis=1), 2.0 * np.asarray(others_m)))
    eye = own + beside * gap + distance[:, None] * towards
    axes = np.repeat(looking(-towards[None]), len(own), axis=0)
    return Shot(eye, axes, _height(distance))


def fixed(target: Array, towards: Array, height_m: float, rows: int) -> Shot:
    """A camera that stands still, ``towards`` from what it looks at, with so much of it in the picture."""
    distance = height_m / (2.0 * np.tan(np.radians(FOV_DEG) / 2.0))
    eye = np.repeat((target + distance * towards)[None], rows, axis=0)
    return Shot(eye, np.repeat(looking(-towards[None]), rows, axis=0), np.full(rows, height_m))


def velocity_space(heading: Array, speed_mps: float, rows: int) -> Shot:
    """The velocity sphere from its right-hand side, a little from the front and above, so that a cap round the heading is seen."""
    forward = _unit(heading)
    aside = np.array([forward[1], -forward[0], 0.0])
    target = speed_mps * (0.35 * forward + 0.2 * aside - 0.15 * UP)
    way = speed_mps * (1.55 * forward + 2.5 * aside + 1.1 * UP)
    return fixed(target, _unit(way), float(_height(np.linalg.norm(way[None], axis=1))[0]), rows)


def chase(time_s: Array, own: Array, own_vel: Array, span_m: float) -> Shot:
    """From behind and above the aircraft, level, turning with its velocity."""
    forward = np.empty_like(own_vel)
    heading = _unit(own_vel[0])
    for k, velocity in enumerate(own_vel):
        step = time_s[k] - time_s[k - 1] if k else 0.0
        heading = heading + (_unit(velocity) - heading) * (1.0 - np.exp(-step / CHASE_LAG_S))
        forward[k] = _unit(heading)
    behind, above = CHASE_SPANS
    eye = own + span_m * (above * UP - behind * forward)
    ahead = own + span_m * (behind * forward + 0.2 * UP)
    return Shot(eye, looking(ahead - eye), _height(np.full(len(own), span_m * np.hypot(behind, above))))


def _height(distance: Array) -> Array:
    return np.asarray(2.0 * np.tan(np.radians(FOV_DEG) / 2.0) * distance)


def _unit(vector: Array) -> Array:
    size = float(np.linalg.norm(vector))
    return vector / size if size > 1e-12 else np.array([1.0, 0.0, 0.0])
