"""Can an aircraft reach the pose that a re-plan asks for: the insertion point, in the commanded direction?

The widest curve to it without a loop (`vosc.widest_join`) is flown in coordinated flight at constant speed and with instant roll.
Every other curve to that pose has a place that bends more. What is compared:

- ``level_turn_radius_m``, V^2 / (g sqrt(n^2 - 1)) at the aircraft's load factor: what it can bend in a level turn. A turn with gravity's
  help bends more: ``steepest_radius_m``, V^2 / (g (n + 1)), inverted at the top of a loop, is a limit that nothing gets below.
- load factor and bank along the curve itself, gravity included. Within the limits all the way: ``reachable``. If not, a narrower curve
  might still ask for less where gravity helps, so only ``radius_m < steepest_radius_m`` rules the pose out for every curve without a loop.
"""

import math
from dataclasses import dataclass

import numpy as np

from testbed.airframe.proof_courses import turn_radius_at
from testbed.core.frames import Vec3, vec3
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.plants.aircraft import Limits
from testbed.flight.plants.kinematic import coordinated
from testbed.flight.record import ReplanEvent
from vosc import Join, widest_join
from vosc.arc_line_arc import arc_line_arc_frames

SAMPLES = 400


@dataclass(frozen=True)
class PoseReach:
    """What the pose needs, and what the aircraft has. Bank right positive, its extreme of either sign; load factors along the curve."""

    radius_m: float  # of the widest curve found; 0 where there is none
    is_bound: bool  # no curve without a loop is wider (``Join.kind`` is not ``arc_line_arc``)
    turn_deg: float
    bank_deg: float
    load_factor: float
    load_factor_least: float
    level_turn_radius_m: float
    steepest_radius_m: float
    reachable: bool

    @property
    def wide_enough(self) -> bool:
        """Whether a level turn at the aircraft's load factor is as tight as the curve."""
        return self.radius_m >= self.level_turn_radius_m


def pose_reach(pos_m: Vec3, vel_mps: Vec3, insertion_m: Vec3, command_mps: Vec3, limits: Limits) -> PoseReach:
    """From position and velocity (of the air mass' frame, z up) to the insertion point in the commanded direction, at constant speed."""
    speed = math.hypot(*vel_mps)
    join = widest_join(pos_m, vel_mps, insertion_m, command_mps)
    loads, banks = _least_demanding(join, speed)
    most, least = max(loads), min(loads)
    bank = max(banks, key=abs)
    within = limits.load_factor_min <= least and most <= limits.load_factor_max and abs(bank) <= limits.bank_deg * DEG
    return PoseReach(
        radius_m=join.radius_m,
        is_bound=join.kind != "arc_line_arc",
        turn_deg=join.turn_rad / DEG,
        bank_deg=bank / DEG,
        load_factor=most,
        load_factor_least=least,
        level_turn_radius_m=turn_radius_at(speed, limits.load_factor_max),
        steepest_radius_m=speed * speed / (G0_MPS2 * (limits.load_factor_max + 1.0)),
        reachable=within and limits.speed_min_mps <= speed <= limits.speed_max_mps,
    )


def event_reach(event: ReplanEvent, limits: Limits) -> PoseReach | None:
    """The pose of a re-plan, in the air mass as the planner knew it; ``None`` where the decision gave no pose."""
    if not all(math.isfinite(v) for v in (*event.insertion_enu_m, *event.command_enu_mps)):
        return None
    wind, time = np.array(event.wind_known_enu_mps), event.insertion_time_s
    velocity, command = np.array(event.own_vel_enu_mps) - wind, np.array(event.command_enu_mps) - wind
    insertion = np.array(event.insertion_enu_m) - time * wind
    return pose_reach(event.own_pos_enu_m, vec3(velocity), vec3(insertion), vec3(command), limits)


def _least_demanding(join: Join, speed: float) -> tuple[list[float], list[float]]:
    """Load factors and banks (rad) along the curve, or along the widest arc, line, arc where that asks for less.

    Between its two bends a helicoidal arc rolls through half a turn in a metre or so, past the side on which gravity adds to the load;
    two arcs and a line jump there, which is what instant roll means.
    """
    if join.kind == "none":
        return [math.inf], [math.nan]
    curves = [join.frames(SAMPLES)]
    if join.arcs is not None:
        curves.append(arc_line_arc_frames(join.arcs, *join.start, join.end[1], SAMPLES))
    choices = []
    for _, tangents, curvatures in curves:
        needed = [coordinated(vec3(speed * t), vec3(speed * speed * c)) for t, c in zip(tangents, curvatures, strict=True)]
        choices.append(([n for _, n in needed], [bank for bank, _ in needed]))
    return min(choices, key=lambda choice: max(choice[0]))
