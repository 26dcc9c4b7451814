"""Search outward from the present velocity, ring by ring, until a direction is free.

A stand-in for the paper's reference [17], whose text is not at hand: the paper says of it that an iterative method determines the
direction from the relative movement, and that it is slow. Here directions are tried at growing angles from v_u, each ring from its top
on clockwise, and the first one outside every cone is taken.
"""

import math
from collections.abc import Sequence

from vosc.crowd import exact_cones, is_free, scene_of
from vosc.encounter import Obstacle, Own
from vosc.errors import WrongOption
from vosc.methods.choice import Choice, Status, none_free
from vosc.vec import combine, norm, unit, up_and_right

FINEST_DEG = 0.05
MOST_BEARINGS = 720


def outward_search(own: Own, obstacles: Sequence[Obstacle], step_deg: float = 1.0, bearings: int = 36) -> Choice:
    """The first free direction on rings ``step_deg`` apart, ``bearings`` directions on each; too far by less than a step.

    ``no_free_direction`` when no direction that was tried is free. ``WrongOption`` for a step outside 0.05 to 90 degrees, or other than
    4 to 720 bearings.
    """
    if not FINEST_DEG <= step_deg <= 90.0:
        raise WrongOption(f"step_deg: give {FINEST_DEG} to 90 degrees, got {step_deg}")
    if not 4 <= bearings <= MOST_BEARINGS:
        raise WrongOption(f"bearings: give 4 to {MOST_BEARINGS}, got {bearings}")
    speed = norm(own.vel_mps)
    if speed == 0.0:
        return none_free(own)
    cones = exact_cones(own, scene_of(obstacles).threats)
    u = unit(own.vel_mps)
    up, right = up_and_right(u)
    around = [2.0 * math.pi * k / bearings for k in range(bearings)]
    sides = [combine(math.cos(a), up, math.sin(a), right) for a in around]
    for ring in range(1, math.floor(180.0 / step_deg) + 1):
        turn = math.radians(ring * step_deg)
        for side in sides:
            found = combine(speed * math.cos(turn), u, speed * math.sin(turn), side)
            if is_free(cones, found):
                return Choice(found, Status.AVOIDED)
    return none_free(own)
