"""Extended proportional navigation in one plane: the relative velocity's angle is linear in that of the tangent, reached continuously.

After Belkhouche, Bendjilali, Reactive path planning for 3-D autonomous vehicles, IEEE Transactions on Control Systems Technology 20
(2012) 249, which the paper's reference [19] is taken to be, and Belkhouche, Belkhouche, Wheeled mobile robot navigation using
proportional navigation, Advanced Robotics 21 (2007). Neither text is at hand; the form of the law is that of the family:

    phi = N theta + c + b exp(-d t)        phi' = N theta' - b d exp(-d t)

phi is the angle of the relative velocity in the plane of the manoeuvre, theta that of the line to the point where its near tangent touches
the sphere's shadow. At the decision, t = 0: c = (1 - N) theta_0, so that the tangent of that instant is a course of the law; b = phi_0 -
theta_0, so that phi begins where it is. Then delta = theta - phi = -b exp(-d t) - (N - 1)(theta - theta_0), and since theta runs away while
delta > 0, with N > 1 the tangent is reached in finite time and not only tended to.

A stand-in: the choice of c and of the point aimed at are ours, and so is the last term of what is commanded, phi' + d (phi_law - phi):
it brings an aircraft that lags back to the law and is zero for one that does not.
"""

import math
from collections.abc import Sequence
from typing import Annotated, Literal, NamedTuple

from pydantic import Field

from testbed.core.frames import Vec3
from testbed.flight.laws.meeting import MOST_MPS2, SPARE_M, UP, Aim, Most, Setting, Spare, imminent, near_tangent, pull
from testbed.flight.laws.planes import Plane, in_plane, larger_component
from testbed.flight.planning.context import STILL, Context
from testbed.flight.planning.steering import Steer
from testbed.flight.plants.base import State
from testbed.flight.sensing.base import Seen
from vosc.vec import cross, dot


class Memory(NamedTuple):
    """The obstacle that is answered, in which plane and since when; delta and the direction of the tangent then; the last side taken."""

    setting: Setting
    name: str = ""
    plane: Plane = "horizontal"
    since_s: float = 0.0
    short_rad: float = 0.0
    line: Vec3 = UP
    side: Vec3 = UP


class ExtendedNavigation:
    """``gain``: N; ``decay_1ps``: d. ``plane: larger`` is that of the larger component of the relative velocity at the decision."""

    def __init__(
        self,
        gain: Annotated[float, Field(gt=1.0, le=100.0)] = 2.0,
        decay_1ps: Annotated[float, Field(gt=0.0, le=100.0)] = 3.0,
        plane: Literal["larger", "horizontal", "vertical"] = "horizontal",
        spare_m: Spare = SPARE_M,
        most_mps2: Most = MOST_MPS2,
    ) -> None:
        self._gain, self._decay, self._plane, self._spare, self._most = gain, decay_1ps, plane, spare_m, most_mps2

    def start(self, context: Context) -> Memory:
        return Memory(Setting.of(context, self._spare))

    def steer(self, memory: Memory, time_s: float, own: State, seen: Sequence[Seen]) -> tuple[Memory, Steer]:
        meeting = imminent(memory.setting, time_s, own, seen)
        if meeting is None:
            return memory._replace(name=""), Steer(STILL)
        again = meeting.name == memory.name
        plane = memory.plane if again else larger_component(meeting.relative_mps) if self._plane == "larger" else self._plane
        shown, only = in_plane(meeting, plane)
        aim = near_tangent(shown, memory.side)
        if aim is None:
            return memory, Steer(STILL)
        if not again:
            memory = Memory(memory.setting, meeting.name, plane, time_s, aim.short_rad, aim.line)
        rate = self._rate(memory, aim, time_s - memory.since_s)
        return memory._replace(side=aim.side), Steer(pull(meeting.air_mps, aim, rate, self._most, only))

    def _rate(self, memory: Memory, aim: Aim, since_s: float) -> float:
        """Phi' of the law, and what brings phi back to it, towards the tangent, rad/s."""
        turned = cross(memory.line, aim.line)
        run = math.atan2(dot(turned, cross(aim.line, aim.across)), dot(memory.line, aim.line))
        left = memory.short_rad * math.exp(-self._decay * since_s)
        off = (self._gain - 1.0) * run - left + aim.short_rad
        return self._gain * aim.runs_rad_s + self._decay * (left + off)
