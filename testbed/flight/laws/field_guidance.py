"""The potential field followed over time: an acceleration down its slope, at every step.

Khatib, Real-time obstacle avoidance for manipulators and mobile robots, International Journal of Robotics Research 5 (1986) 90, as a
stand-in for the paper's reference [7]. The field is that of the direction ``potential_field``, with the goal of the route for attraction:

    U = |x - goal| + gain / 2 sum_i rho0 (rho0 / rho - 1)^2        a = -pull grad U

over obstacles nearer than rho0 = ``reach`` radii, rho the distance to the sphere. The part of a across the velocity over the ground acts,
because the speed is held: Khatib's damping has nothing to do. Positions over the ground only: neither the wind nor where the obstacles are
going enters, and every obstacle in sight does, threat or not.
"""

from collections.abc import Sequence
from typing import Annotated

from pydantic import Field

from testbed.flight.laws.meeting import MOST_MPS2, SPARE_M, Most, Setting, Spare, limited
from testbed.flight.planning.context import Context
from testbed.flight.planning.steering import Steer
from testbed.flight.plants.base import State
from testbed.flight.sensing.base import Seen
from vosc.methods.potential_field import force
from vosc.vec import along, dot, scale, sub, unit


class FieldGuidance:
    """``pull_mps2``: the acceleration of the attraction, m/s^2."""

    def __init__(
        self,
        gain: Annotated[float, Field(gt=0.0, le=1e6)] = 1.0,
        reach: Annotated[float, Field(gt=0.0, le=1e3)] = 4.0,
        pull_mps2: Annotated[float, Field(gt=0.0, le=1e3)] = 15.0,
        spare_m: Spare = SPARE_M,
        most_mps2: Most = MOST_MPS2,
    ) -> None:
        self._gain, self._reach, self._pull, self._spare, self._most = gain, reach, pull_mps2, spare_m, most_mps2

    def start(self, context: Context) -> Setting:
        return Setting.of(context, self._spare)

    def steer(self, memory: Setting, time_s: float, own: State, seen: Sequence[Seen]) -> tuple[Setting, Steer]:
        pos, ahead = (own.x, own.y, own.z), unit((own.vx, own.vy, own.vz))
        spheres = [(one.at(time_s), one.radius_m + memory.replan.swell_m) for one in seen]
        slope = scale(self._pull, force(pos, unit(sub(memory.context.goal, pos)), spheres, self._gain, self._reach))
        return memory, Steer(limited(along(slope, -dot(slope, ahead), ahead), self._most))
