"""Things that a sensor sees and that are not there."""

import math
from typing import NamedTuple

import numpy as np

from testbed.core.frames import Vec3, vec3
from testbed.flight.sensing.base import Seen
from testbed.flight.traffic.track import Array

DRAWN = 6
"""Numbers, even from 0 to 1, that are drawn at every measurement: is there a new one, and where and whither."""


class Phantom(NamedTuple):
    """As it was when it appeared, and until when it is seen."""

    first: Seen
    until_s: float

    def at(self, time_s: float) -> Seen:
        """It flies straight on."""
        return self.first._replace(pos=self.first.at(time_s), time_s=time_s)


def phantom(
    number: int,
    time_s: float,
    until_s: float,
    size: tuple[float, float, float],
    own: tuple[Vec3, Array],
    half_fields: tuple[float, float],
    even: Array,
) -> Phantom:
    """A new one, even in the volume that is in sight, and in all directions.

    ``size``: radius (m), speed (m/s), from how far its centre is seen (m). ``own``: the aircraft's place, and what turns its body axes
    into ENU. ``half_fields``: half of the field of view in azimuth and elevation, rad. ``even``: the numbers drawn. No obstacle has
    such a name: theirs have no spaces.
    """
    far, aside, above, azimuth, climb = even.tolist()
    radius_m, speed_mps, reach_m = size
    nearest_m = min(2.0 * radius_m, reach_m)
    distance_m = (nearest_m**3 + far * (reach_m**3 - nearest_m**3)) ** (1.0 / 3.0)
    right, up = half_fields[0] * (2.0 * aside - 1.0), math.asin(math.sin(half_fields[1]) * (2.0 * above - 1.0))
    ahead = np.array([math.cos(up) * math.cos(right), math.cos(up) * math.sin(right), -math.sin(up)])
    sine = 2.0 * climb - 1.0
    flat = math.sqrt(1.0 - sine * sine)
    course = (flat * math.cos(math.tau * azimuth), flat * math.sin(math.tau * azimuth), sine)
    place = np.asarray(own[0]) + distance_m * (own[1] @ ahead)
    vel = (speed_mps * course[0], speed_mps * course[1], speed_mps * course[2])
    return Phantom(Seen(f"false track {number}", radius_m, vec3(place), vel, time_s), until_s)
