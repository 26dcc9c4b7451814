"""Artificial potential field: the velocity follows the sum of an attraction ahead and repulsions from the spheres.

Khatib, Real-time obstacle avoidance for manipulators and mobile robots, Int. J. Robotics Research 5 (1986) 90, as used in the
family of the paper's reference [7]. Positions only: the field does not know where the obstacles are going, which is what it is here
to show.
"""

import math
from collections.abc import Iterable, Sequence

from vosc.encounter import Obstacle, Own, threatening
from vosc.errors import WrongOption
from vosc.methods.choice import Choice, Status, undefined
from vosc.vec import Vec, along, norm, scale, sub, three, unit


def potential_field(
    own: Own, obstacles: Sequence[Obstacle], gain: float = 1.0, reach: float = 4.0, goal: tuple[float, float, float] | None = None
) -> Choice:
    """The present speed along  g + gain sum (rho0/rho - 1) (rho0/rho)^2 n  over obstacles nearer than rho0.

    rho is the distance to the sphere, rho0 = ``reach`` radii of it, n points away from its centre, g is the unit vector of ``goal``
    (a direction, three floats; default: of v_u). Khatib's repulsion made dimensionless, so that the answer does not depend on the
    unit of length. ``undefined`` when the forces cancel, as they can when flying straight at an obstacle. ``WrongOption`` for a gain
    or reach that is not above 0.
    """
    if not (0.0 < gain < math.inf and 0.0 < reach < math.inf):
        raise WrongOption(f"gain, reach: give numbers above 0, got {gain}, {reach}")
    attraction = unit(own.vel_mps if goal is None else three("goal", goal))
    found = force(own.pos_m, attraction, [(o.pos_m, o.radius_m) for o in threatening(obstacles)], gain, reach)
    size = norm(found)
    return Choice(scale(norm(own.vel_mps) / size, found), Status.AVOIDED) if size > 1e-9 else undefined(own)


def force(pos: Vec, attraction: Vec, spheres: Iterable[tuple[Vec, float]], gain: float, reach: float) -> Vec:
    """The attraction and the repulsions of spheres (centre, radius), the slope down gain/2 rho0 (rho0/rho - 1)^2 each.

    A sphere whose centre is here has no direction to repel in, and does not.
    """
    found = attraction
    for centre, radius in spheres:
        away = sub(pos, centre)
        distance = norm(away)
        ratio = reach * radius / max(distance - radius, 1e-6 * radius)
        if ratio > 1.0 and distance > 0.0:
            found = along(found, gain * (ratio - 1.0) * ratio * ratio / distance, away)
    return found
