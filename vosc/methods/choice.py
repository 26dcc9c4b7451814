"""What a method hands back before ``avoid`` checks it."""

from typing import NamedTuple

from vosc.encounter import Own
from vosc.vec import Vec


class Choice(NamedTuple):
    """A commanded velocity, m/s, and what the method says of it: ``avoided`` (believes it safe), ``no_free_direction`` or ``undefined``."""

    velocity_mps: Vec
    status: str


def undefined(own: Own) -> Choice:
    """The present velocity, because the method's construction does not exist here."""
    return Choice(own.vel_mps, "undefined")


def none_free(own: Own) -> Choice:
    """The present velocity, because every direction is forbidden."""
    return Choice(own.vel_mps, "no_free_direction")
