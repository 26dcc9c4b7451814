"""Any point K of the critical curve (paper section 4.2.2, eq. 32-33): by the angle at which it lies, by one component, by what it costs.

The critical curve is the boundary of the union of what the obstacles forbid on the velocity sphere. The paper lets the task choose K on
it and shows one way: give one component, the others follow. The angle here is the one at which K lies from the present velocity, as the
pilot sees it: 0 up, 90 degrees to the right. What a turn costs the aircraft is the lift that it needs: the turn from v_u to K in a given
time, and gravity.
"""

import math
from collections.abc import Sequence
from typing import Final, Literal, NamedTuple

from vosc.cone import Cone, Loop, is_free, loop_point, loops_of
from vosc.free import zeros
from vosc.turns import great_circle, least_turn
from vosc.vec import G_MPS2, Vec, angle, combine, cross, dot, norm, perpendicular, unit, up_and_right

Performance = Literal["least_load_factor", "least_roll"]
BEARINGS: Final = 48  # directions in which a boundary point is looked for, before the best is refined
REFINED: Final = 20  # steps of the golden section: a bearing to 1e-4 of the first step
SAMPLES: Final = 96
GOLDEN: Final = 0.5 * (math.sqrt(5.0) - 1.0)


class Demand(NamedTuple):
    """What a turn asks of the aircraft: lift over weight, and the bank angle of the lift (right wing down positive), rad."""

    load_factor: float
    bank_rad: float


def at_bearing(cones: Sequence[Cone], velocity_mps: Vec, bearing_rad: float) -> Vec | None:
    """The first free velocity on the way from v_u straight to one side, m/s; ``None`` where that side has none, or nothing moves.

    ``bearing_rad``: 0 up, pi / 2 to the right. Where v_u is free it is v_u itself.
    """
    if norm(velocity_mps) == 0.0:
        return None
    up, right = up_and_right(velocity_mps)
    aside = combine(math.cos(bearing_rad), up, math.sin(bearing_rad), right)
    return least_turn(cones, [great_circle(velocity_mps, cross(unit(velocity_mps), aside))], (1,))


def with_component(cones: Sequence[Cone], velocity_mps: Vec, axis: int, value_mps: float) -> Vec | None:
    """Eq. 32-33 as the paper uses them: the point K with one component given (``axis`` 0, 1, 2), m/s.

    Of several the one nearest to v_u; ``None`` where the critical curve has no such point.
    """
    speed = norm(velocity_mps)
    step = 2.0 * math.pi / SAMPLES

    def crossings(loop: Loop) -> list[Vec]:
        def off(theta: float) -> float:
            return loop_point(loop, theta)[axis] - value_mps

        return [loop_point(loop, theta) for k in range(SAMPLES) for theta in zeros(off, k * step, (k + 1) * step)]

    found = [v for cone in cones for loop in loops_of(cone, speed) for v in crossings(loop) if is_free(cones, v)]
    return min(found, key=lambda v: angle(v, velocity_mps), default=None)


def demand(velocity_mps: Vec, command_mps: Vec, within_s: float) -> Demand:
    """The lift of a steady turn from one velocity to another of the same size in ``within_s`` seconds, at its beginning."""
    up, right = up_and_right(velocity_mps)
    turn = angle(velocity_mps, command_mps)
    rate = norm(velocity_mps) * turn / within_s
    aside = perpendicular(unit(velocity_mps), command_mps) if 0.0 < turn < math.pi else right
    lift = combine(rate, aside, G_MPS2 * up[2], up)
    return Demand(norm(lift) / G_MPS2, math.atan2(dot(lift, right), dot(lift, up)))


def cheapest(cones: Sequence[Cone], velocity_mps: Vec, by: Performance, within_s: float, bank_rad: float = 0.0) -> Vec | None:
    """The point K that costs the aircraft least, m/s: looked for at every side of v_u, and refined about the best.

    ``least_load_factor``: the load factor nearest to 1 (more is lift, less is a push-over). ``least_roll``: the least change of bank from
    ``bank_rad``. ``within_s`` is the time in which the turn is to be done. ``None`` where no side has a free velocity.
    """

    def cost(k: Vec) -> float:
        load_factor, bank = demand(velocity_mps, k, within_s)
        if by == "least_load_factor":
            return abs(math.copysign(load_factor, math.cos(bank)) - 1.0)
        return abs(math.remainder(bank - bank_rad, 2.0 * math.pi))

    def best_of(bearings: Sequence[float]) -> tuple[float, float, Vec] | None:
        points = ((bearing, at_bearing(cones, velocity_mps, bearing)) for bearing in bearings)
        return min(((cost(k), bearing, k) for bearing, k in points if k is not None), default=None)

    step = 2.0 * math.pi / BEARINGS
    best = best_of([k * step for k in range(BEARINGS)])
    if best is None:
        return None
    low, high = best[1] - step, best[1] + step
    for _ in range(REFINED):
        inner = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        found = best_of(inner)
        if found is None:
            break
        best = min(best, found)
        low, high = (low, inner[1]) if found[1] == inner[0] else (inner[0], high)
    return best[2]
