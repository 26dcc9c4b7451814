"""Proportional navigation of the relative velocity to the point where its near tangent touches the sphere.

After Han, Bang, Yoo, Proportional navigation-based collision avoidance for UAVs, International Journal of Control, Automation, and
Systems 7 (2009) 553, which the paper's reference [18] is taken to be. Of it we have the abstract: the relative velocity is guided to the
vector from the aircraft to the safety boundary; and the paper's own words, that the manoeuvre lies in the vertical or the horizontal plane.

The line to the point of tangency turns at |w| sin(delta) / L, and the relative velocity w is turned N times as fast:

    a = N |w|^2 sin(delta) / L      so that  delta' = -(N - 1) |w| sin(delta) / L

For small delta, delta / delta_0 = (L / L_0)^(N - 1): with N > 1 the relative velocity is on the tangent when the sphere is reached, and the
miss falls short of the radius by (L / L_0)^N of what it fell short by.

Ours: ``plane: larger`` compares the horizontal with the vertical size of the relative velocity when the obstacle is first answered, and
keeps to that plane; how the sphere is seen in a plane is in ``planes.py``. ``plane: free`` is the plane of line of sight and relative
velocity.
"""

from collections.abc import Sequence
from typing import Annotated, Literal, NamedTuple

from pydantic import Field

from testbed.core.frames import Vec3
from testbed.flight.laws.meeting import MOST_MPS2, SPARE_M, UP, Most, Setting, Spare, imminent, near_tangent, pull
from testbed.flight.laws.planes import Plane, in_plane, larger_component
from testbed.flight.planning.context import STILL, Context
from testbed.flight.planning.steering import Steer
from testbed.flight.plants.base import State
from testbed.flight.sensing.base import Seen


class Memory(NamedTuple):
    """The obstacle that is answered, the plane of the answer (None: free) and the last side taken."""

    setting: Setting
    name: str = ""
    plane: Plane | None = None
    side: Vec3 = UP


class ProportionalNavigation:
    """``gain``: N."""

    def __init__(
        self,
        gain: Annotated[float, Field(gt=1.0, le=100.0)] = 3.0,
        plane: Literal["larger", "free", "horizontal", "vertical"] = "larger",
        spare_m: Spare = SPARE_M,
        most_mps2: Most = MOST_MPS2,
    ) -> None:
        self._gain, self._plane, self._spare, self._most = gain, plane, spare_m, most_mps2

    def start(self, context: Context) -> Memory:
        return Memory(Setting.of(context, self._spare))

    def steer(self, memory: Memory, time_s: float, own: State, seen: Sequence[Seen]) -> tuple[Memory, Steer]:
        meeting = imminent(memory.setting, time_s, own, seen)
        if meeting is None:
            return memory, Steer(STILL)
        if meeting.name != memory.name:
            memory = memory._replace(name=meeting.name, plane=self._plane_of(meeting.relative_mps))
        shown, only = in_plane(meeting, memory.plane) if memory.plane else (meeting, None)
        aim = near_tangent(shown, memory.side)
        if aim is None:
            return memory, Steer(STILL)
        return memory._replace(side=aim.side), Steer(pull(meeting.air_mps, aim, self._gain * aim.runs_rad_s, self._most, only))

    def _plane_of(self, relative_mps: Vec3) -> Plane | None:
        if self._plane == "free":
            return None
        return larger_component(relative_mps) if self._plane == "larger" else self._plane
