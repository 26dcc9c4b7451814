"""When a flight past its obstacles is decided, so that the rest of it need not be flown."""

import math
from typing import TYPE_CHECKING

from testbed.flight.planning.rejoin import miss_along, opens
from testbed.flight.plants.base import State
from testbed.flight.record import inside
from testbed.flight.route.path import Path

if TYPE_CHECKING:
    from testbed.flight.scene import Scene


class Decided:
    """True when the flight is clear: outside of every sphere, every obstacle opens, and the rest of the active path, flown on at the
    present speed over the ground, keeps every radius. It ends a flight, it plans none: so it is told the truth.
    """

    def __init__(self, scene: "Scene") -> None:
        self._traffic = scene.traffic

    def __call__(self, time_s: float, state: State, path: Path, s_m: float) -> bool:
        pos = (state.x, state.y, state.z)
        bodies = self._traffic.at(time_s)
        for body in bodies:  # what costs nothing first
            if not opens(state, body, time_s) or inside(math.dist(pos, body.pos) - body.radius_m):
                return False
        speed = math.hypot(state.vx, state.vy, state.vz)
        return not any(inside(miss_along(path, s_m, speed, time_s, [body]) - body.radius_m) for body in bodies)
