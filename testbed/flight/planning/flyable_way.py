"""Step 5 (iii) of the paper taken at its word: a flyable PH path to the insertion point, searched within the aircraft's limits.

Free are the avoidance direction (the method's own, and points K of the exact critical curve at equal angles round the present velocity),
the insertion point (its factor k) and the lengths of the two end derivatives. The path continues the curvature of the present one, so
that the bank does not jump. The shortest path within all limits is taken; where there is none, the limits that forbid it are named. The
speed is the present one over the ground; a turn carries at most the load factor and the bank of the aircraft.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from testbed.campaign.words.planning import FlyableSearch
from testbed.core.frames import Vec3, vec3
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.impossible import NoWayError
from testbed.flight.plants.aircraft import Limits
from vosc import Insertion, Obstacle, Own, Refusal, insertion_point, ph
from vosc.critical_curve import at_bearing
from vosc.crowd import exact_cones
from vosc.encounter import cone_margin
from vosc.methods import Avoidance, Status
from vosc.vec import add, along, array, deflection, norm

FORBIDS = {
    "join": "no curve continues the present bend",
    "climb_up": "climb angle",
    "climb_down": "descent angle",
    "bank_rate": "roll rate",
}
"""What a limit of ``vosc.ph.flyable`` is for an aircraft; that of its curvature is the bank or the load factor, whichever is less."""


class FlyableWay(NamedTuple):
    """The path to an insertion point, and the direction and the point that were chosen."""

    curve: ph.Curve
    answer: Avoidance
    insertion: Insertion


def limits_of(aircraft: Limits, speed_mps: float, climb_at_most_deg: float) -> ph.Limits:
    """What the aircraft can do at a speed: curvature of the steepest level turn that bank and load factor allow, and its roll rate."""
    steepest, _ = _steepest(aircraft)
    climb = climb_at_most_deg * DEG
    return ph.Limits(speed_mps, G0_MPS2 * steepest / speed_mps**2, -climb, climb, aircraft.roll_rate_dps * DEG)


def _steepest(aircraft: Limits) -> tuple[float, str]:
    """The steepest level turn, as its sideways pull over g, and the limit that it is due to."""
    by_bank = math.tan(min(aircraft.bank_deg, 89.0) * DEG)
    by_lift = math.sqrt(max(aircraft.load_factor_max**2 - 1.0, 0.0))
    return (
        (by_bank, f"bank of {aircraft.bank_deg:g} deg") if by_bank < by_lift else (by_lift, f"load factor of {aircraft.load_factor_max:g}")
    )


def flyable_way(
    own: Own,
    answer: Avoidance,
    threats: Sequence[Obstacle],
    major: Obstacle,
    wind: Vec3,
    bend: Vec3,
    aircraft: Limits,
    search: FlyableSearch,
    rule: tuple[float, str, str, str],
) -> FlyableWay:
    """The shortest path within the limits. Raises ``NoWayError``.

    ``own`` and obstacles are those of the planner's frame, which moves with ``wind``; ``bend`` is the present curvature vector, 1/m;
    ``rule`` are k, the time rule, the side and the root of the insertion point, whose k is also taken times the factors of the search.
    """
    directions = _directions(own, answer, threats, search.bearings)
    points = [insertion_point(own, major, rule[0] * factor, *rule[1:]) for factor in search.k_factors]  # type: ignore[arg-type]
    insertions = [point for point in points if point is not None]
    if not insertions:
        raise NoWayError("no insertion point of the factors of the search is ever met")
    ground = add(own.vel_mps, wind)
    ends = np.array([along(vec3(point.point_m), point.time_s, wind) for point in insertions])
    commands = np.array([add(direction, wind) for direction in directions])
    try:
        limits = limits_of(aircraft, norm(ground), search.climb_at_most_deg)
        found = ph.flyable(own.pos_m, ground, ends, commands, limits, bend, grid=search.magnitudes)
    except Refusal as error:  # coincident points; a command that stands still over the ground
        raise NoWayError(str(error)) from error
    if not found.ok or found.curve is None:
        of_a_turn = _steepest(aircraft)[1]
        reasons = " and ".join(FORBIDS.get(name, of_a_turn) for name in found.missed)
        together = ", which can be kept one by one but not together" if found.together else ""
        raise NoWayError(f"of {len(ends) * len(commands)} ends none is within the aircraft's limits: {reasons}{together}")
    chosen = directions[found.direction]
    margin = min(cone_margin(own.pos_m, chosen, obstacle) for obstacle in threats)
    taken = answer if found.direction == 0 else Avoidance(array(chosen), deflection(own.vel_mps, chosen), Status.AVOIDED, margin)
    return FlyableWay(found.curve, taken, insertions[found.point])


def _directions(own: Own, answer: Avoidance, threats: Sequence[Obstacle], bearings: int) -> list[Vec3]:
    """The method's own direction, then the points K of the exact critical curve at equal angles round v_u, upwards first."""
    cones = exact_cones(own, threats)
    around = (at_bearing(cones, own.vel_mps, 2.0 * math.pi * k / bearings) for k in range(bearings))
    return [vec3(answer.velocity_mps), *(k for k in around if k is not None)]
