"""How a flight ended, what its planner decided, and whether a radius was kept: one word and one rule for each."""

import math
from enum import StrEnum
from typing import Any


class Outcome(StrEnum):
    """How a flight ended, in order of precedence: the first that applies is reported."""

    CRASHED = "crashed"  # the program failed (a bug); the traceback is stored with the plan
    DIVERGED = "diverged"  # a state became non-finite or left the envelope of the model
    HIT_GROUND = "hit_ground"  # a wheel, a wing or the centre of gravity came down
    COLLIDED = "collided"  # came closer than the radius of an obstacle (the flight goes on)
    TRIM_FAILED = "trim_failed"
    NO_PATH = "no_path"  # no path could be planned from the present state
    TIMED_OUT = "timed_out"  # three times the planned time, or what the campaign's limits allow
    REACHED = "reached"  # crossed the goal's plane within 20 m
    STOPPED = "stopped"  # whoever had it flown had seen enough


class Decision(StrEnum):
    """What the planner did about a threat: a new path, or why the path did not change."""

    REPLANNED = "replanned"  # the path avoids
    STEERED = "steered"  # from here on a law steers, until the flight is clear
    PLANNED = "planned"  # a planner of somebody's own has another path
    HELD = "held"  # the path has come to lead through a sphere, and straight on does not: straight on
    REJOINED = "rejoined"  # the path leads back
    KEPT = "kept"  # decided anew, and nothing came of it: the path of the last decision goes on
    NONE = "none"  # the flight has no method
    CLEAR = "clear"  # the method finds no cone to leave: the path is kept
    NO_INSERTION_POINT = "no_insertion_point"
    NO_PATH = "no_path"
    NO_FREE_DIRECTION = "no_free_direction"  # as the method says, and so are the next two
    INSIDE = "inside"
    UNDEFINED = "undefined"


class PathFault(StrEnum):
    """What a new path is although its direction is free: an event's status, in the place of ``avoided``."""

    LEADS_THROUGH = "leads_through_the_sphere"  # flown as planned it comes inside a radius
    TURNS_BACK = "turns_back"  # by more than a right angle from the present velocity


AVOIDING = frozenset({Decision.REPLANNED, Decision.STEERED, Decision.PLANNED, Decision.HELD})
"""Decisions by which a flight left the path that it was on."""
NEW_PATH = AVOIDING | {Decision.REJOINED}
"""Decisions after which the flight follows another path."""
ANSWERED = NEW_PATH | {Decision.KEPT, Decision.NONE, Decision.CLEAR}
"""Decisions after which the flight is not one without a path."""


TOUCH_M = 1e-6
"""A velocity on the edge of a velocity obstacle passes at the radius exactly: up to so far inside is rounding and no collision."""


def inside(clearance_m: Any) -> Any:
    """Does a clearance (a float or an array) mean a collision? NaN does not."""
    return clearance_m < -TOUCH_M


LOST = frozenset({Outcome.DIVERGED, Outcome.HIT_GROUND})
"""Outcomes of a flight that did not go on, whatever it was clear of."""


def kept_clear(least_clearance_m: float) -> bool | None:
    """Was every radius kept? None where nothing was flown, or there was none to keep."""
    return None if math.isnan(least_clearance_m) else not inside(least_clearance_m)


def kept_and_flew_on(outcome: str, least_clearance_m: float) -> bool:
    """Did the flight keep every radius to its end? One that hit the ground or left its model's envelope did not."""
    return outcome not in LOST and kept_clear(least_clearance_m) is True
