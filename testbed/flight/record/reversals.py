"""How often a flight turned the other way than it had decided before."""

import math
from collections.abc import Sequence

from testbed.core.frames import Vec3
from testbed.core.units import DEG
from testbed.flight.record.outcome import AVOIDING
from testbed.flight.record.record import ReplanEvent
from vosc.vec import along, angle, dot

STRAIGHT_RAD = 1.0 * DEG  # a command that turns by less has no side


def reversals(events: Sequence[ReplanEvent]) -> tuple[float, ...]:
    """Times (s) of decisions that turn to the other side than the one before: the parts of the two commands across the velocities at
    which they were given lie more than a right angle apart. Decisions without a command, or straight on, are passed over.
    """
    found: list[float] = []
    before: Vec3 | None = None
    for event in events:
        if event.decision not in AVOIDING or not all(map(math.isfinite, event.command_enu_mps)):
            continue
        if angle(event.own_vel_enu_mps, event.command_enu_mps) < STRAIGHT_RAD:
            continue
        velocity, command = event.own_vel_enu_mps, event.command_enu_mps
        side = along(command, -dot(command, velocity) / dot(velocity, velocity), velocity)
        if before is not None and dot(side, before) < 0.0:
            found.append(event.time_s)
        before = side
    return tuple(found)
