"""Commands from outside of the flight: whoever steps it (``testbed.make_env``) says what a law would.

The flight is that of the loop, which stops wherever a path is to be made of such a command (``Pending``) and hands out an ``Asked``.
When it is asked is up to the planner: like a law, from the first threat until the flight is clear, or at every step of the guidance.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol

from testbed.core.chain import Chain
from testbed.core.frames import Vec3
from testbed.flight.planning.context import Answer, Context, Method, Pending, Planner, Step
from testbed.flight.planning.replan import Memory, Replanner
from testbed.flight.planning.steering import FROM_OUTSIDE, Steer
from testbed.flight.plants.base import State
from testbed.flight.route.path import Path
from testbed.flight.sensing.base import Seen
from vosc.vec import dot, sub

OUTSIDE = "outside"
"""What such a flight names as its method."""
LEAST_AHEAD_M = 100.0  # of a path for one step: more than a step, and less than where a flight looks whether it is at its goal
MOST_STEPS, NEAR_M = 10, 1e-3  # of Newton; the last of them leaves a thousandth of what it was
SHARPEST = 0.2  # of a step along the route: nearer to a bend's centre than this the nearest point runs away


class Asked(NamedTuple):
    """What is known where a command is asked for: the time, the aircraft, and everything in sight at the planner's last look."""

    time_s: float
    state: State
    seen: tuple[Seen, ...]


class AskingPlanner(Planner, Protocol):
    """A planner of whose context somebody outside may know, once it has one: a flight that cannot begin tells its planner nothing."""

    context: Context | None
    left_s_m: float
    """Arc length at which the flight last left the route."""


class AskingLaw:
    """A law over time that leaves every answer to whoever steps the flight."""

    def start(self, context: Context) -> None:
        """It remembers nothing."""

    def steer(self, memory: None, time_s: float, own: State, seen: Sequence[Seen]) -> tuple[None, Steer]:  # noqa: ARG002
        return None, FROM_OUTSIDE


class WhenThreatened(Replanner):
    """The planner that asks methods, with ``AskingLaw`` for the method of the plan. It leaves the path and comes back as for any law."""

    context: Context | None = None
    left_s_m = 0.0

    def start(self, context: Context) -> Memory:
        self.context = told = replace(context, method=Method(OUTSIDE, AskingLaw, {}))
        return super().start(told)

    def step(self, memory: Memory, time_s: float, state: State, seen: Sequence[Seen], path: Path, s_m: float) -> Answer:
        answer = super().step(memory, time_s, state, seen, path, s_m)
        self.left_s_m = answer[0].left_s_m
        return answer


class Always:
    """It asks at every step of the guidance, from the first to the last, and plans nothing. Its memory is how far along the route it is.

    A path for one step is as long as what is left of the route, so that the flight ends at the goal, and not where a course begins.
    """

    context: Context | None = None
    left_s_m = slowest_s = 0.0

    def start(self, context: Context) -> float:
        self.context, self._route, self.left_s_m = context, context.route, context.begin_s_m
        return context.begin_s_m

    def step(self, memory: float, time_s: float, state: State, seen: Sequence[Seen], path: Path, s_m: float) -> Step:  # noqa: ARG002
        along_m = abeam(self._route, memory, state[:3])
        return Step(along_m, Pending(s_m, max(LEAST_AHEAD_M, self._route.length_m - along_m)))


def abeam(route: Chain, s_m: float, pos: Vec3) -> float:
    """Arc length of the place of a route that is abeam, from one nearby, by Newton's steps; on the straight beyond either end."""
    for _ in range(MOST_STEPS):
        point, tangent, curvature = route.frame(s_m)
        off = sub(pos, point)
        on_m = dot(off, tangent) / max(SHARPEST, 1.0 - dot(off, curvature))
        s_m += on_m
        if abs(on_m) < NEAR_M:
            break
    return s_m
