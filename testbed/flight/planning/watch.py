"""When the planner need not think: a necessary condition of a new threat among what is seen, asked at every look.

It is a little wider than the threat test, which decides; most looks of a flight end here.
"""

from collections.abc import Container, Sequence

from testbed.flight.plants.base import State
from testbed.flight.sensing.base import Seen

WIDER = 1.000001  # of a squared length: rounding must not hide a threat


class Watch:
    """``swell_m`` is what the planner adds to every radius."""

    def __init__(self, swell_m: float) -> None:
        self._swell = swell_m

    def alarmed(self, handled: Container[str], time_s: float, state: State, seen: Sequence[Seen]) -> bool:
        """May a seen obstacle that is not among ``handled`` be on a collision course, both flying straight on?"""
        for one in seen:
            if one[0] in handled:
                continue
            _, radius, (cx, cy, cz), (ux, uy, uz), since, _ = one
            x, y, z, vx, vy, vz = state[:6]
            elapsed, reach = time_s - since, radius + self._swell
            px, py, pz = cx + ux * elapsed - x, cy + uy * elapsed - y, cz + uz * elapsed - z
            wx, wy, wz = vx - ux, vy - uy, vz - uz
            closing = px * wx + py * wy + pz * wz
            if closing <= 0.0:
                continue
            square, speed2 = px * px + py * py + pz * pz, wx * wx + wy * wy + wz * wz
            # least distance of the straight lines, squared, against the radius, both times speed2; what is added is for rounding only
            if square * speed2 - closing * closing <= (WIDER * reach * reach + 1e-9 * square) * speed2:
                return True
        return False
