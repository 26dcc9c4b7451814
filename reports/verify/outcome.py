"""Where a flight ended, and how."""

import math
from dataclasses import dataclass

import numpy as np

from .approach import TOUCH_M
from .raw import Raw

GATE_M = 20.0  # a flight that crosses the goal's plane this near to it has reached the goal
ON_PLANE_M = 1e-9
HIGHEST_M = 1e5  # a state above this has diverged
REACH_M = 50.0  # no wing is longer
AVOIDING = ("replanned", "steered", "planned", "held")  # decisions by which a flight leaves the path that it is on
NO_LOSS = (*AVOIDING, "rejoined", "kept", "none", "clear")  # decisions that leave a flight with a path


@dataclass(frozen=True)
class End:
    """Where a flight counts until: the last row before the goal's plane, and the part of the next step up to it."""

    row: int
    share: float
    at_goal: bool


def end_of(raw: Raw) -> End:
    """A flight that stopped at the goal's gate counts until the plane, any other until its last row."""
    last = len(raw.pos) - 1
    if raw.about["goal_enu_m"] is None or last < 1:
        return End(last, 0.0, False)
    offset = raw.pos - np.array(raw.about["goal_enu_m"])
    beyond = offset @ np.array(raw.about["goal_direction"])
    at_goal = bool(-ON_PLANE_M <= beyond[-1] <= GATE_M and math.hypot(*offset[-1]) <= GATE_M)
    before = np.nonzero(beyond <= -ON_PLANE_M)[0]
    if not at_goal or not len(before):
        return End(last, 0.0, at_goal)
    k = int(before[-1])
    return End(k, min(1.0, -float(beyond[k]) / float(beyond[k + 1] - beyond[k])), True)


def outcome_of(raw: Raw, clearance: float, end: End) -> str:
    """How the flight ended, by the order of precedence: diverged, ground, collision, no path, time, goal."""
    if not len(raw.pos):
        return "no_path"
    z, limit_s = raw.pos[-1, 2], raw.about["longest_s"]
    height = z - raw.about["terrain_z_m"]
    if not z < HIGHEST_M or not np.isfinite(raw.vel[-1]).all():
        return "diverged"
    # a wing or a wheel touches before the centre of gravity does, and nothing else ends a flight before its time and its goal
    early = not end.at_goal and limit_s is not None and raw.time_s[-1] < limit_s
    if height <= 0.0 or (height < REACH_M and early):
        return "hit_ground"
    if clearance < -TOUCH_M:
        return "collided"
    if not end.at_goal:
        return "timed_out"
    return "reached" if all(decision["decision"] in NO_LOSS for decision in raw.about["decisions"]) else "no_path"
