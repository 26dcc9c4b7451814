"""Differential-geometric guidance with constant curvature: one arc, at whose end the relative velocity touches the sphere.

After White, Shin, Tsourdos, UAV obstacle avoidance using differential geometry concepts, IFAC World Congress 2011, and Shin, Tsourdos,
White, of the line of work of the paper's references [12]-[14], whose texts are not at hand. Followed is the idea: the own velocity turns in
the plane of line of sight and velocity, on an arc of constant curvature, until the relative velocity is a tangent of the sphere; then
the flight is straight.

A turn by chi in a time T, at the rate chi / T, leads from the velocity u to u' and over T (sin(chi) / chi u + (1 - cos(chi)) / chi m x u),
m the axis of the turn. What is solved for is the least chi after which the straight lines of aircraft and obstacle miss each other by the
radius. T is a share of the time to the closest approach: that choice of the curvature is ours. It is solved when a
threat is first answered; the curvature is then kept until the relative velocity leaves the cone, later than T for an aircraft that lags.
"""

import math
from collections.abc import Sequence
from typing import Annotated, NamedTuple

from pydantic import Field

from testbed.core.frames import Vec3
from testbed.flight.laws.meeting import MOST_MPS2, SPARE_M, Meeting, Most, Setting, Spare, imminent
from testbed.flight.planning.context import STILL, Context
from testbed.flight.planning.steering import Steer
from testbed.flight.plants.base import State
from testbed.flight.sensing.base import Seen
from vosc.vec import SMALLEST_SINE, Vec, along, combine, cross, dot, norm, right_of, scale, sub, unit

STEP_RAD, STEPS, HALVINGS = math.radians(4.0), 40, 40  # turns that are tried, either way, and how finely the one is found


class Memory(NamedTuple):
    """The obstacle that is answered, and the angular velocity of the turn, rad/s, ENU."""

    setting: Setting
    name: str = ""
    turn_rad_s: Vec3 = STILL


class ConstantCurvature:
    """``share``: how much of the time to the closest approach the turn is to take."""

    def __init__(self, share: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.5, spare_m: Spare = SPARE_M, most_mps2: Most = MOST_MPS2) -> None:
        self._share, self._spare, self._most = share, spare_m, most_mps2

    def start(self, context: Context) -> Memory:
        return Memory(Setting.of(context, self._spare))

    def steer(self, memory: Memory, time_s: float, own: State, seen: Sequence[Seen]) -> tuple[Memory, Steer]:
        meeting = imminent(memory.setting, time_s, own, seen)
        if meeting is None:
            return memory._replace(name=""), Steer(STILL)
        if meeting.name != memory.name:
            memory = memory._replace(name=meeting.name, turn_rad_s=self._turn(meeting))
        return memory, Steer(cross(memory.turn_rad_s, meeting.air_mps))

    def _turn(self, meeting: Meeting) -> Vec3:
        """The angular velocity, within the largest acceleration."""
        speed = norm(meeting.air_mps)
        if speed == 0.0:
            return STILL
        axis, lasts_s, most = turning_axis(meeting), self._share * meeting.time_s, self._most / speed
        angle = least_turn(meeting, axis, lasts_s)
        rate = math.copysign(most, angle) if abs(angle) >= most * lasts_s else angle / lasts_s
        return scale(rate, axis)


def turning_axis(meeting: Meeting) -> Vec3:
    """Unit normal of the plane of velocity and line of sight; of the horizontal turn where they are parallel."""
    ahead, sight = unit(meeting.air_mps), unit(meeting.sight_m)
    axis = cross(ahead, sight)
    return unit(axis) if norm(axis) > SMALLEST_SINE else cross(right_of(ahead), ahead)


def after(meeting: Meeting, axis: Vec3, angle_rad: float, lasts_s: float) -> tuple[Vec, Vec]:
    """Line of sight and relative velocity after a turn of the own velocity about ``axis``."""
    u = meeting.air_mps
    aside, half = cross(axis, u), 0.5 * angle_rad
    turned = combine(math.cos(angle_rad), u, math.sin(angle_rad), aside)
    forth, across = (math.sin(angle_rad) / angle_rad, math.sin(half) ** 2 / half) if angle_rad else (1.0, 0.0)
    flown = combine(lasts_s * forth, u, lasts_s * across, aside)
    obstacle = sub(u, meeting.relative_mps)
    return along(sub(meeting.sight_m, flown), lasts_s, obstacle), sub(turned, obstacle)


def spare_after(meeting: Meeting, axis: Vec3, angle_rad: float, lasts_s: float) -> float:
    """By how much the straight lines after the turn miss the sphere, m; negative where they hit it."""
    sight, relative = after(meeting, axis, angle_rad, lasts_s)
    speed, distance = norm(relative), norm(sight)
    miss = norm(cross(sight, relative)) / speed if speed > 0.0 and dot(sight, relative) > 0.0 else distance
    return min(miss, distance) - meeting.radius_m


def least_turn(meeting: Meeting, axis: Vec3, lasts_s: float) -> float:
    """The least turn (rad, either way about the axis) after which the sphere is missed; the largest that is tried where none does."""
    for step in range(1, STEPS + 1):
        for way in (1.0, -1.0):
            if spare_after(meeting, axis, way * step * STEP_RAD, lasts_s) >= 0.0:
                enough, short = way * step * STEP_RAD, way * (step - 1) * STEP_RAD
                for _ in range(HALVINGS):
                    middle = 0.5 * (enough + short)
                    enough, short = (middle, short) if spare_after(meeting, axis, middle, lasts_s) >= 0.0 else (enough, middle)
                return enough
    return -STEPS * STEP_RAD
