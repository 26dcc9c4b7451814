"""Whether a flight came into the volumes that a campaign's section ``daa`` asks about, by its raw columns."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from .raw import Array, Raw

FOOT_M = 0.3048
STANDARDS = {  # radius and half height in feet, and whether the limit itself is inside: the table of docs/daa.md
    "nmac": (500.0, 100.0, False),
    "do365_non_cooperative": (2200.0, 450.0, True),
    "do365_terminal": (1500.0, 450.0, True),
    "astm_f3442": (2000.0, 250.0, False),
}
Volume = tuple[float, float | None, bool]


def volumes_of(campaign: Mapping[str, Any]) -> dict[str, Volume]:
    """Those of a campaign that are judged here: radius, half height (none of a sphere), whether the limit is inside."""
    daa: Mapping[str, Any] | None = campaign.get("daa")
    if daa is None:
        return {}
    asked = {name: STANDARDS[name] for name in daa["standards"] if name in STANDARDS}
    found: dict[str, Volume] = {name: (FOOT_M * r, FOOT_M * h, closed) for name, (r, h, closed) in asked.items()}
    for name, said in daa["volumes"].items():
        found.pop(name, None)
        if not said["tau_s"]:
            found[name] = (said["radius_m"], said["half_height_m"], said["edge"] == "in")
    return found


def entered(raw: Raw, volume: Volume) -> bool | None:
    """Whether the aircraft was ever in a volume about an obstacle; nothing of a flight without one.

    Between two ticks the relative place is a + (b - a) t. The time in the layer is an interval; in it the horizontal distance is least
    at the foot of the perpendicular, or else at an end of it.
    """
    radius, half, closed = volume
    known, ever = False, False
    for obstacle in raw.obstacles:
        relative = raw.pos - obstacle.pos
        there = np.isfinite(relative).all(axis=1)
        both = there[:-1] & there[1:] & (np.diff(raw.time_s) > 0.0)
        known |= bool(both.any())
        a, b = relative[:-1][both], relative[1:][both]
        first, last = (np.zeros(len(a)), np.ones(len(a))) if half is None else layer(a[:, 2], b[:, 2], half, closed)
        flat = 3 if half is None else 2
        least = least_between(a[:, :flat], b[:, :flat], first, last)
        ever |= bool(((least <= radius if closed else least < radius) & (first <= last if closed else first < last)).any())
    return ever if known else None


def layer(a: Array, b: Array, half: float, closed: bool) -> tuple[Array, Array]:
    """Between which shares of each step a height that goes from a to b is less than ``half`` from 0; 1 and 0 for never."""
    climb = b - a
    with np.errstate(divide="ignore", invalid="ignore"):
        crossings = np.sort(np.column_stack([(-half - a) / climb, (half - a) / climb]), axis=1)
    first, last = np.maximum(crossings[:, 0], 0.0), np.minimum(crossings[:, 1], 1.0)
    level = climb == 0.0
    within = np.abs(a) <= half if closed else np.abs(a) < half
    return np.where(level, np.where(within, 0.0, 1.0), first), np.where(level, np.where(within, 1.0, 0.0), last)


def least_between(a: Array, b: Array, first: Array, last: Array) -> Array:
    """Least distance from the origin on the stretch of each step."""
    d = b - a
    length2 = (d**2).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        foot = np.where(length2 > 0.0, -(a * d).sum(axis=1) / length2, 0.0)
    at = np.minimum(np.maximum(foot, first), last)
    return np.asarray(np.sqrt(((a + at[:, None] * d) ** 2).sum(axis=1)))


def entries_of(raw: Raw, volumes: Mapping[str, Volume]) -> dict[str, str]:
    """The columns of the results that say so, as they are written there."""
    found = {name: entered(raw, volume) for name, volume in volumes.items()}
    return {f"entered_{name}": "" if flag is None else str(flag).lower() for name, flag in found.items()}
