"""How close a flight came to its obstacles, and from when on it was clear of them."""

import math

import numpy as np

from .raw import Array, Obstacle, Raw

TOUCH_M = 1e-6  # a sphere that is touched is not entered


def nearest_between(relative: Array) -> tuple[Array, Array]:
    """Least distance (n-1,) of each step of a relative place (n,3) from the origin, and where on the step, 0 to 1.

    The step is straight. Where the foot of the perpendicular lies on it, the distance is |r x d| / |d|; else it is that of an end.
    """
    a, b = relative[:-1], relative[1:]
    d = b - a
    length = np.sqrt((d**2).sum(axis=1))
    ends = np.sqrt((a**2).sum(axis=1)), np.sqrt((b**2).sum(axis=1))
    with np.errstate(divide="ignore", invalid="ignore"):
        share = -(a * d).sum(axis=1) / length**2
        perpendicular = np.sqrt((np.cross(a, d) ** 2).sum(axis=1)) / length
    on_it = (share > 0.0) & (share < 1.0)
    least = np.where(on_it, perpendicular, np.minimum(*ends))
    return least, np.where(on_it, share, np.where(ends[0] <= ends[1], 0.0, 1.0))


def approach_of(raw: Raw, obstacle: Obstacle) -> tuple[float, float] | None:
    """Least distance to the surface of an obstacle (m, negative inside) and when (s); None where both are never there.

    Between ticks both fly straight. A step that begins or ends without one of them is none: nothing is known of it.
    """
    relative = raw.pos - obstacle.pos
    there = np.isfinite(relative).all(axis=1)
    if not there.any():
        return None
    ticks = np.where(there, np.sqrt((relative**2).sum(axis=1)), math.inf)
    k = int(ticks.argmin())
    distance, at = float(ticks[k]), float(raw.time_s[k])
    if (there[:-1] & there[1:]).any():
        between, share = nearest_between(relative)
        between = np.where(there[:-1] & there[1:], between, math.inf)
        k = int(between.argmin())
        if between[k] <= distance:
            distance, at = float(between[k]), float(raw.time_s[k] + share[k] * (raw.time_s[k + 1] - raw.time_s[k]))
    return distance - obstacle.radius_m, at


def closest(raw: Raw) -> tuple[float, float, str]:
    """Least distance to any surface (m, negative inside), when (s), and whose."""
    best = (math.nan, math.nan, "")
    for obstacle in raw.obstacles:
        approach = approach_of(raw, obstacle)
        if approach is not None and not best[0] <= approach[0]:
            best = (*approach, obstacle.name)
    return best


def clear_at(raw: Raw, first: int, last: int) -> int | None:
    """The first row from ``first`` on in which every obstacle that is there opens, and from which on none is entered until ``last``."""
    good = np.ones(last + 1 - first, dtype=bool)
    for obstacle in raw.obstacles:
        relative = (obstacle.pos - raw.pos)[first : last + 1]
        opens = (relative * (obstacle.vel - raw.vel)[first : last + 1]).sum(axis=1) > 0.0
        absent = ~np.isfinite(obstacle.pos[first : last + 1]).all(axis=1)
        inside = np.nonzero(np.linalg.norm(relative, axis=1) < obstacle.radius_m - TOUCH_M)[0]
        good &= opens | absent
        good[: inside[-1] + 1 if len(inside) else 0] = False
    return first + int(good.argmax()) if good.any() else None
