"""A method that is a law over time: from the first threat until the flight is clear it is asked at the guidance rate how to move.

What it answers becomes a path for one step, an arc that leaves the aircraft in the direction and with the curvature asked for. The
guidance follows it as it follows any path: an aircraft turns within its limits of bank and load factor and with its lags, a point on
rails at once. The speed is held as on any path.
"""

import math
from collections.abc import Sequence
from typing import Any, Final, NamedTuple, Protocol

from testbed.core.frames import Vec3
from testbed.core.units import DEG
from testbed.flight.planning.context import Context, Pending
from testbed.flight.plants.base import State
from testbed.flight.route.path import Arc
from testbed.flight.sensing.base import Seen
from vosc.vec import along, combine, dot, norm, scale, three, unit

HELD_M = 600.0  # length of such a path: long enough that its end is not the goal
STILL_MPS = 1e-3  # slower than that over the ground an aircraft has no direction
WIDEST_COS = math.cos(85.0 * DEG)  # a direction further aside than this is turned to by way of it


class Steer(NamedTuple):
    """How to move now, ENU: an acceleration (m/s^2; gravity is made up for, what is along the velocity is left out, since the speed is
    held), or a velocity over the ground (m/s), of which the direction is flown. Exactly one of them.
    """

    acceleration_enu_mps2: Vec3 | None = None
    velocity_enu_mps: Vec3 | None = None


FROM_OUTSIDE: Final = Steer()
"""The answer of a law that does not know it: whoever steps the flight will say (``outside.py``)."""


class SteeringLaw(Protocol):
    """A law of one flight, made by ``Class(**options)``; its memory goes in and comes out."""

    def start(self, context: Context) -> Any:
        """Fresh memory, when the first threat is there."""

    def steer(self, memory: Any, time_s: float, own: State, seen: Sequence[Seen]) -> tuple[Any, Steer]:
        """Asked at the guidance rate; ``seen`` is everything in sight at the planner's last look, threat or not."""


def steered(answer: Steer, state: State, s_m: float) -> Arc | Pending:
    """The path for one step by a law's answer, or by the one that is still to come."""
    return Pending(s_m, HELD_M) if answer is FROM_OUTSIDE else arc(answer, state, s_m)


def arc(answer: Steer, state: State, s_m: float, ahead_m: float = HELD_M) -> Arc:
    """The path for one step, on which the aircraft stands at ``s_m``. ``ValueError`` in words when the law's answer is none."""
    pos, velocity = (state.x, state.y, state.z), (state.vx, state.vy, state.vz)
    if not isinstance(answer, Steer) or (answer.acceleration_enu_mps2 is None) == (answer.velocity_enu_mps is None):
        raise ValueError(f"a law must return (memory, Steer) with an acceleration or a velocity, not {answer!r}")
    acceleration, wanted = answer
    speed = norm(velocity)
    if speed < STILL_MPS:  # nothing to turn
        return Arc(pos, (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), s_m, ahead_m)
    tangent = unit(velocity)
    if acceleration is not None:
        pull = three("Steer.acceleration_enu_mps2", acceleration)
        across = along(pull, -dot(pull, tangent), tangent)
        return Arc(pos, tangent, scale(1.0 / (speed * speed), across), s_m, ahead_m)
    assert wanted is not None
    direction = unit(three("Steer.velocity_enu_mps", wanted))
    if direction == (0.0, 0.0, 0.0):
        raise ValueError("Steer.velocity_enu_mps: a velocity of zero has no direction")
    return Arc(pos, _aside(tangent, direction), (0.0, 0.0, 0.0), s_m, ahead_m)


def _aside(tangent: Vec3, wanted: Vec3) -> Vec3:
    """The wanted direction, or the one 85 deg aside on the way to it: a path is followed ahead, not back."""
    cos = dot(tangent, wanted)
    if cos >= WIDEST_COS:
        return wanted
    across = along(wanted, -cos, tangent)
    size = norm(across)
    if size < 1e-9:  # straight back: no side is nearer
        across, size = (-tangent[1], tangent[0], 0.0), math.hypot(tangent[0], tangent[1])
    return combine(WIDEST_COS, tangent, math.sqrt(1.0 - WIDEST_COS**2) / size, across)
