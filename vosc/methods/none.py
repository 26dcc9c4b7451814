"""No avoidance: the control every method is compared with."""

from collections.abc import Sequence

from vosc.encounter import Obstacle, Own
from vosc.methods.choice import Choice, Status


def none(own: Own, obstacles: Sequence[Obstacle]) -> Choice:  # noqa: ARG001  (a method's signature)
    """The present velocity: ``clear`` outside every cone, ``unsafe`` inside one."""
    return Choice(own.vel_mps, Status.AVOIDED)
