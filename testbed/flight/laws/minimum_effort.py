"""Minimum effort: the least integral of the squared acceleration that passes the spheres and then comes to the goal.

After Watanabe, Calise, Johnson, Minimum-effort guidance for vision-based collision avoidance, AIAA Atmospheric Flight Mechanics Conference
2006, which the paper's reference [20] is taken to be; its text is not at hand. The plan is in ``effort_plan.py``: a double integrator,
conditions at given times, the multipliers from their zero-effort misses in closed form. The goal is the last, at the time of flight
straight to it. An obstacle adds one where the plan without it would enter its sphere: to be a radius away, to the side on which that plan
comes closest, at the time of that approach. All of it is found anew at every step: of an optimum the rest is an optimum.

Ours: obstacles that move; which of several add conditions (the first that the plan so far enters, up to four); side and time are those of
the plan before it was added. Places and velocities over the ground, so that the goal is met in a wind; the acceleration is across the
velocity through the air, so that none of the effort is asked of the engine.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np

from testbed.core.frames import Vec3, vec3
from testbed.flight.laws.effort_plan import Condition, Plan
from testbed.flight.laws.meeting import MOST_MPS2, SPARE_M, Most, Setting, Spare, limited
from testbed.flight.planning.context import STILL, Context
from testbed.flight.planning.steering import STILL_MPS, Steer
from testbed.flight.plants.base import State
from testbed.flight.sensing.base import Seen
from testbed.flight.traffic.track import Approach, least_clearance
from vosc.vec import along, cross, dot, norm, perpendicular, right_of, sub, unit

GOAL_AT_S = 1.0  # a goal that is nearer than this has been come to
MOST_SPHERES = 4
NEAR_CENTRE = 0.2  # of the radius: a plan that passes nearer to the centre does not say on which side
LOOKED_AT = np.linspace(0.0, 1.0, 41)  # shares of the time that a plan is looked ahead
NOWHERE: Mapping[str, Vec3] = {}


class Memory(NamedTuple):
    """Of each obstacle that added a condition: the unit vector from its centre to where it is passed."""

    setting: Setting
    sides: Mapping[str, Vec3] = NOWHERE


class MinimumEffort:
    """``then``: after the spheres the goal, or nothing; without a goal the flight is straight while no sphere is entered."""

    def __init__(self, then: Literal["goal", "nothing"] = "goal", spare_m: Spare = SPARE_M, most_mps2: Most = MOST_MPS2) -> None:
        self._then, self._spare, self._most = then, spare_m, most_mps2

    def start(self, context: Context) -> Memory:
        return Memory(Setting.of(context, self._spare))

    def steer(self, memory: Memory, time_s: float, own: State, seen: Sequence[Seen]) -> tuple[Memory, Steer]:
        pos, vel = (own.x, own.y, own.z), (own.vx, own.vy, own.vz)
        replan, goal = memory.setting.replan, memory.setting.context.goal
        ahead, lasts_s = unit(memory.setting.own(time_s, own)[0].vel_mps), replan.horizon_s
        plan = Plan(pos, vel, ahead)
        if self._then == "goal" and norm(vel) >= STILL_MPS and math.dist(goal, pos) > GOAL_AT_S * norm(vel):
            due_s = math.dist(goal, pos) / norm(vel)
            plan, lasts_s = Plan(pos, vel, ahead, to_goal(pos, vel, goal, due_s)), min(lasts_s, due_s)
        spheres = [Sphere(one, time_s, replan.swell_m, lasts_s) for one in seen]
        plan, sides = round_spheres(spheres, plan, memory.sides)
        return Memory(memory.setting, sides), Steer(limited(plan.acceleration(), self._most))


def to_goal(pos: Vec3, vel: Vec3, goal: Vec3, due_s: float) -> tuple[Condition, ...]:
    """Across the velocity at the goal; along it the time says where, and the speed is held."""
    ahead = unit(vel)
    one = perpendicular(ahead, right_of(ahead))
    short = sub(sub(goal, pos), (vel[0] * due_s, vel[1] * due_s, vel[2] * due_s))
    return tuple(Condition(due_s, way, dot(way, short)) for way in (one, cross(ahead, one)))


class Sphere:
    """A sphere, as far ahead as a plan is looked at."""

    def __init__(self, seen: Seen, time_s: float, swell_m: float, lasts_s: float) -> None:
        self.name, self.radius_m = seen.name, seen.radius_m + swell_m
        self._now, self._vel = seen.at(time_s), seen.vel
        self._times = lasts_s * LOOKED_AT
        self._centres = np.array(self._now) + np.outer(self._times, self._vel)

    def met_by(self, plan: Plan) -> Approach:
        """Where the plan comes closest, and how close."""
        return least_clearance(self._times, plan.points(self._times), self._centres, self.radius_m)

    def passed(self, plan: Plan, before: Vec3 | None) -> Condition:
        """To be a radius away, to the side on which the plan comes closest, then; ``before``: the side where the plan does not say."""
        due_s = self.met_by(plan).time_s
        off = sub(vec3(plan.points(np.array([due_s]))[0]), along(self._now, due_s, self._vel))
        if norm(off) > NEAR_CENTRE * self.radius_m:
            side = unit(off)
        else:
            met = unit(sub(plan.vel, self._vel))
            side = before or (perpendicular(met, off, right_of(met)) if met != STILL else right_of(plan.vel))
        straight = sub(along(plan.pos, due_s, plan.vel), along(self._now, due_s, self._vel))
        return Condition(due_s, side, self.radius_m - dot(side, straight))


def round_spheres(spheres: Sequence[Sphere], plan: Plan, before: Mapping[str, Vec3]) -> tuple[Plan, dict[str, Vec3]]:
    """The plan round the spheres that it would enter, added one by one, the first first; and the sides on which they are passed."""
    last, entered, sides = plan.conditions, list[Sphere](), dict[str, Vec3]()
    for _ in range(MOST_SPHERES):
        met = [(sphere.met_by(plan), k) for k, sphere in enumerate(spheres) if sphere not in entered]
        ahead = [(approach.time_s, k) for approach, k in met if approach.clearance_m < 0.0]
        if not ahead:
            break
        entered.append(spheres[min(ahead)[1]])
        found = [sphere.passed(plan, before.get(sphere.name)) for sphere in entered]
        sides = {sphere.name: condition.way for sphere, condition in zip(entered, found, strict=True)}
        plan = Plan(plan.pos, plan.vel, plan.ahead, (*last, *found))
    return plan, sides
