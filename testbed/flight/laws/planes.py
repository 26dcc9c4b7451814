"""Manoeuvres in one plane: the meeting seen in it, and the one direction across the own velocity that lies in it.

In the horizontal plane the sphere's shadow is a circle, and the aircraft turns level. In the vertical plane through the relative velocity
it is a circle too, and the aircraft pulls up or pushes over in the vertical plane of its own velocity. Who passes the shadow passes the
sphere, but not the other way round: a plane asks for more than is needed where the sphere lies off it.
"""

from typing import Literal

from testbed.core.frames import Vec3
from testbed.flight.laws.meeting import UP, Meeting
from vosc.vec import along, dot, norm, right_of, unit

Plane = Literal["horizontal", "vertical"]
UPRIGHT = 1e-6  # sine: a velocity nearer to the vertical than this has no heading


def larger_component(relative_mps: Vec3) -> Plane:
    """The plane of the larger component of the relative velocity."""
    x, y, z = relative_mps
    return "horizontal" if norm((x, y, 0.0)) >= abs(z) else "vertical"


def in_plane(meeting: Meeting, plane: Plane) -> tuple[Meeting, Vec3 | None]:
    """The meeting as the plane has it, and the direction to accelerate along, unit vector; as it is, and None, where the own velocity is
    vertical: a turn has no plane then, and the vertical plane is any.
    """
    ahead = unit(meeting.air_mps)
    if norm((ahead[0], ahead[1], 0.0)) < UPRIGHT:
        return meeting, None
    if plane == "horizontal":
        return meeting.seen_along(UP), right_of(ahead)
    return meeting.seen_along(right_of(meeting.relative_mps)), unit(along(UP, -dot(UP, ahead), ahead))
