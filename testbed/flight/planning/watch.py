"""When the planner need not look: a necessary condition of a new threat, in half a microsecond, asked at every planner tick.

It is a little wider than the sensor's range and the threat test, which decide; most ticks of a flight end here.
"""

from collections.abc import Container, Sequence

from testbed.flight.plants.base import State
from testbed.flight.traffic.track import Track

WIDER = 1.000001  # of a squared length: rounding must not hide a threat


class Watch:
    """The obstacles of one flight. ``swell_m`` is what the planner adds to their radii."""

    def __init__(self, tracks: Sequence[Track], range_m: float, swell_m: float) -> None:
        self._range2 = WIDER * range_m * range_m
        self._tracks = [(track.name, *track.pos, *track.vel, WIDER * (track.radius + swell_m) ** 2) for track in tracks]

    def alarmed(self, handled: Container[str], time_s: float, state: State) -> bool:
        """May an obstacle that is not among ``handled`` be in range and on a collision course, both flying straight on?"""
        x, y, z, vx, vy, vz = state[:6]
        for name, cx, cy, cz, ux, uy, uz, reach2 in self._tracks:
            px, py, pz = cx + ux * time_s - x, cy + uy * time_s - y, cz + uz * time_s - z
            square = px * px + py * py + pz * pz
            if square > self._range2 or name in handled:
                continue
            wx, wy, wz = vx - ux, vy - uy, vz - uz
            closing = px * wx + py * wy + pz * wz
            speed2 = wx * wx + wy * wy + wz * wz
            # least distance of the straight lines, squared, against the radius, both times speed2; what is added is for rounding only
            if closing > 0.0 and square * speed2 - closing * closing <= (reach2 + 1e-9 * square) * speed2:
                return True
        return False
