"""What a method hands back before ``avoid`` checks it."""

from enum import StrEnum
from typing import NamedTuple

from vosc.encounter import Own
from vosc.vec import Vec


class Status(StrEnum):
    """What an answer is worth; ``vosc.methods`` says what each means. Equal to its text."""

    CLEAR = "clear"
    AVOIDED = "avoided"
    UNSAFE = "unsafe"
    NO_FREE_DIRECTION = "no_free_direction"
    INSIDE = "inside"
    UNDEFINED = "undefined"


class Choice(NamedTuple):
    """A commanded velocity, m/s, and what the method says of it: ``avoided`` (believes it safe), ``no_free_direction`` or ``undefined``."""

    velocity_mps: Vec
    status: Status


def undefined(own: Own) -> Choice:
    """The present velocity, because the method's construction does not exist here."""
    return Choice(own.vel_mps, Status.UNDEFINED)


def none_free(own: Own) -> Choice:
    """The present velocity, because every direction is forbidden."""
    return Choice(own.vel_mps, Status.NO_FREE_DIRECTION)
