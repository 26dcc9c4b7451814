"""When a threat that was answered is answered again: after a while, or when what was foretold of it no longer holds.

``every_s``: at even intervals, for as long as straight on is a collision or the path ahead leads through a sphere; what the method then
says is flown. ``on_change``: when the clearance from an obstacle in sight that the path ahead foretells is

    less than zero, or by more than ``grows_m`` less than at the last     the path ahead is no longer clear; it never was; or the
    decision where that left less, or less than ``-grows_m`` at last      conflict grows again
    less than ``grows_m``, and less than at the last decision, and the
    obstacle flies ``turns_deg`` elsewhere than then                      the obstacle has turned

and another path is then flown only where it foretells more than the present one does, by half of ``grows_m``. Two decisions lie at
least ``hold_s`` apart. So noise is not answered with every look, and two ways that are as good are not flown by turns.
"""

from collections.abc import Sequence
from typing import NamedTuple

from testbed.campaign.words.planning import Replan
from testbed.core.frames import Vec3
from testbed.core.units import DEG
from testbed.flight.planning.rejoin import ByArcLength, miss_along
from testbed.flight.planning.watch import Watch
from testbed.flight.plants.base import State
from testbed.flight.record import inside
from testbed.flight.sensing.base import Seen
from vosc.vec import angle, norm

LOOKED_EVERY_S = 0.1  # a path ahead is foretold so often: that costs more than a look
EARLY_S = 1e-6  # rounding of a time that is due


class Foretold(NamedTuple):
    """What a decision had of an obstacle: how it moved, and how close the path ahead would come to its sphere."""

    velocity: Vec3
    clearance_m: float


class Past(NamedTuple):
    """The last decision, by the names of those in sight; when it was, and when its foretelling was held against the present last."""

    time_s: float
    looked_s: float
    of: dict[str, Foretold]


class Again:
    """The rule of one flight."""

    def __init__(self, settings: Replan) -> None:
        self._settings, self._by = settings, settings.again
        self._watch = Watch(settings.swell_m)

    def past(self, time_s: float, state: State, seen: Sequence[Seen], path: ByArcLength, s_m: float) -> Past:
        """What is to be remembered of a decision after which the flight is at ``s_m`` of ``path``."""
        return Past(time_s, time_s, {one.name: Foretold(one.vel, self._clearance(time_s, state, one, path, s_m)) for one in seen})

    def asked(self, past: Past, time_s: float, state: State, seen: Sequence[Seen], path: ByArcLength, s_m: float) -> tuple[Past, str]:
        """Why it is to be decided anew, in words; empty if it need not be."""
        every_s = self._by.every_s if self._settings.policy == "every_s" else self._by.hold_s
        if time_s - past.time_s < every_s - EARLY_S or time_s - past.looked_s < LOOKED_EVERY_S - EARLY_S:
            return past, ""
        for one in seen:
            if why := self._why(past, time_s, state, one, path, s_m):
                return past, f"{one.name}: {why}"
        return past._replace(looked_s=time_s), ""

    def _why(self, past: Past, time_s: float, state: State, one: Seen, path: ByArcLength, s_m: float) -> str:
        now_m = self._clearance(time_s, state, one, path, s_m)
        if self._settings.policy == "every_s":
            return f"{self._by.every_s:g} s later" if inside(now_m) or self._watch.alarmed((), time_s, state, [one]) else ""
        before, grows_m = past.of.get(one.name, Foretold(one.vel, 0.0)), self._by.grows_m
        if inside(now_m) and now_m < max(before.clearance_m - grows_m, -grows_m):
            if not inside(before.clearance_m):
                return "the path ahead is no longer clear"
            return "the conflict grows again" if now_m < before.clearance_m - grows_m else "the path ahead never was clear"
        turned = norm(before.velocity) > 0.0 and angle(before.velocity, one.vel) > self._by.turns_deg * DEG
        return "the obstacle has turned" if turned and now_m < min(grows_m, before.clearance_m) else ""

    def better(self, time_s: float, state: State, seen: Sequence[Seen], path: ByArcLength, s_m: float, new: ByArcLength) -> bool:
        """Is a new path to be flown instead of the rest of the present one?"""
        if self._settings.policy == "every_s":
            return True
        here, there = (min(self._clearance(time_s, state, one, on, at_m) for one in seen) for on, at_m in ((path, s_m), (new, 0.0)))
        return there > here + 0.5 * self._by.grows_m

    def _clearance(self, time_s: float, state: State, one: Seen, path: ByArcLength, s_m: float) -> float:
        """Of the path ahead from one obstacle, as large as the planner takes it to be, for as long as a threat is one."""
        miss_m = miss_along(path, s_m, norm(state[3:6]), time_s, [one], self._settings.horizon_s)
        return miss_m - one.radius_m - self._settings.swell_m
