"""When a flight past its obstacles is decided, so that the rest of it need not be flown."""

import math

from testbed.flight.path import ActivePath
from testbed.flight.planning.rejoin import miss_along, opens
from testbed.flight.plants.base import State
from testbed.flight.record import inside
from testbed.flight.scene import Scene


class Decided:
    """True when the flight is clear: outside of every sphere, every obstacle opens, and the rest of the active path, flown on at the
    present speed over the ground, keeps every radius.
    """

    def __init__(self, scene: Scene) -> None:
        self._tracks = scene.tracks

    def __call__(self, time_s: float, state: State, path: ActivePath, s_m: float) -> bool:
        pos = (state.x, state.y, state.z)
        for track in self._tracks:  # what costs nothing first
            if not opens(state, track, time_s) or inside(math.dist(pos, track.at(time_s)) - track.radius):
                return False
        speed = math.hypot(state.vx, state.vy, state.vz)
        return not any(inside(miss_along(path, s_m, speed, time_s, [track]) - track.radius) for track in self._tracks)
