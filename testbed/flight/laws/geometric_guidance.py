"""Aim at the near tangent of the sphere: nonlinear geometric guidance, and differential geometric guidance by dynamic inversion.

After Mujumdar, Padhi, Reactive collision avoidance using nonlinear geometric and differential geometric guidance, Journal of Guidance,
Control, and Dynamics 34 (2011) 303, and their report IISc/SID/AE/LINCGODS/AOARD/2009/01, which the paper's reference [15] is taken to
be. Of it we have the idea and the form of the law, not the text.

With delta the angle from the relative velocity to the near tangent, V its size (the own speed, where the obstacle stands still) and L
the length of the tangent:

    nonlinear       a = K V sin(delta)
    differential    a = V (K delta + V sin(delta) / L)      so that  delta' = -K delta

The second inverts the motion of delta, of which the tangent's own turn is a part. Under the first the miss falls short of the radius by
the fraction exp(-K t) of what it fell short by, t the time to the closest approach and delta small.

Ours: the inversion counts the tangent's turn; for an obstacle that moves, a is the acceleration across the own velocity whose part across
the relative one is the above.
"""

import math
from collections.abc import Sequence
from typing import Annotated, Literal

from pydantic import Field

from testbed.core.frames import Vec3
from testbed.flight.laws.meeting import MOST_MPS2, SPARE_M, UP, Most, Setting, Spare, imminent, near_tangent, pull
from testbed.flight.planning.context import STILL, Context
from testbed.flight.planning.steering import Steer
from testbed.flight.plants.base import State
from testbed.flight.sensing.base import Seen

Memory = tuple[Setting, Vec3]
"""The last side taken, for an obstacle straight ahead."""


class GeometricGuidance:
    """``gain_1ps``: K."""

    def __init__(
        self,
        form: Literal["nonlinear", "differential"] = "nonlinear",
        gain_1ps: Annotated[float, Field(gt=0.0, le=100.0)] = 3.0,
        spare_m: Spare = SPARE_M,
        most_mps2: Most = MOST_MPS2,
    ) -> None:
        self._form, self._gain, self._spare, self._most = form, gain_1ps, spare_m, most_mps2

    def start(self, context: Context) -> Memory:
        return Setting.of(context, self._spare), UP

    def steer(self, memory: Memory, time_s: float, own: State, seen: Sequence[Seen]) -> tuple[Memory, Steer]:
        setting, side = memory
        meeting = imminent(setting, time_s, own, seen)
        aim = near_tangent(meeting, side) if meeting else None
        if meeting is None or aim is None:
            return memory, Steer(STILL)
        rate = self._gain * math.sin(aim.short_rad) if self._form == "nonlinear" else self._gain * aim.short_rad + aim.runs_rad_s
        return (setting, aim.side), Steer(pull(meeting.air_mps, aim, rate, self._most))
