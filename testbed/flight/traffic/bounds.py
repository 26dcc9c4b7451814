"""What holds of a track at all times: with it a track that is far away need not be asked where it is, time and again."""

from typing import TYPE_CHECKING, NamedTuple, cast

if TYPE_CHECKING:
    from testbed.flight.traffic.track import Track


class Bounds(NamedTuple):
    """While a track is there, from ``from_s`` to ``to_s`` and never outside of them, it gets no farther in any time than at ``top_mps``."""

    top_mps: float
    from_s: float
    to_s: float


def bounds_of(track: "Track") -> Bounds | None:
    """Of a track whose class has a method ``bounds``; None: nothing is known of it, so it is asked whenever it matters.

    A class that says anew where it is, and not within which bounds, is not held to those of the class that it was made from.
    """
    for kind in type(track).__mro__:
        if "bounds" in vars(kind):
            return cast("Bounds | None", track.bounds())  # type: ignore[attr-defined]
        if "at" in vars(kind):
            return None
    return None
