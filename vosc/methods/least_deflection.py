"""Least deflection: the exact nearest direction outside every cone."""

import math
from collections.abc import Callable, Sequence

from vosc.cone import exact_cones
from vosc.encounter import Obstacle, Own, threatening
from vosc.errors import WrongOption
from vosc.free import nearest_free
from vosc.methods.choice import Choice, Status, none_free
from vosc.vec import Vec, deflection, norm

SPEEDS = 33  # the grid of a speed range, refined round its best
NO_TURN = 1e-9  # rad; below this the direction is kept and only the speed changes


def least_deflection(own: Own, obstacles: Sequence[Obstacle], speed_range_mps: tuple[float, float] | None = None) -> Choice:
    """The velocity outside all exact cones (eq. 3-4) that turns v_u least; ``no_free_direction`` if there is none.

    The paper's section 4.1 minimises the turn of the relative velocity instead; this one is the global optimum for v_u itself
    (``vosc.free``). The speed is the present one. With ``speed_range_mps`` (low, high) it may change: least turn over all speeds of
    the range, and among equal turns the least change of speed (a grid of 33 speeds, refined round its best). ``WrongOption`` unless
    0 < low <= high.
    """
    cones = exact_cones(own, threatening(obstacles))

    def at_speed(speed: float) -> Vec | None:
        return nearest_free(cones, speed, own.vel_mps)

    if speed_range_mps is None:
        found = at_speed(norm(own.vel_mps))
    else:
        low, high = speed_range_mps
        if not 0.0 < low <= high < math.inf:
            raise WrongOption(f"speed_range_mps: give (low, high) with 0 < low <= high, got {speed_range_mps}")
        found = _over_speeds(own, at_speed, low, high) if norm(own.vel_mps) > 0.0 else None
    return none_free(own) if found is None else Choice(found, Status.AVOIDED)


def _over_speeds(own: Own, at_speed: Callable[[float], Vec | None], low: float, high: float) -> Vec | None:
    present = min(max(norm(own.vel_mps), low), high)
    grid = sorted({present, *(low + (high - low) * k / (SPEEDS - 1) for k in range(SPEEDS))})

    def cost(speed: float) -> tuple[float, float]:
        velocity = at_speed(speed)
        turn = math.inf if velocity is None else deflection(own.vel_mps, velocity)
        return (0.0 if turn < NO_TURN else turn, abs(speed - present))

    costs = [cost(s) for s in grid]
    k = min(range(len(grid)), key=lambda i: costs[i])
    if math.isinf(costs[k][0]):
        return None
    best, best_cost = grid[k], costs[k]
    left, right = grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]
    if best_cost[0] == 0.0:  # straight on: towards the present speed as far as it stays free
        other = right if best < present else left
        for _ in range(40):
            middle = 0.5 * (best + other)
            if cost(middle)[0] == 0.0:
                best = middle
            else:
                other = middle
        return at_speed(best)
    ratio = 0.5 * (math.sqrt(5.0) - 1.0)
    for _ in range(40):
        a, b = right - ratio * (right - left), left + ratio * (right - left)
        at_a, at_b = cost(a), cost(b)
        if at_a < at_b:
            right = b
        else:
            left = a
        best, best_cost = min((best_cost, best), (at_a, a), (at_b, b))[::-1]
    return at_speed(best)
