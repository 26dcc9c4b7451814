"""Tangent outside a circle about the obstacle, Lyapunov vector field inside it, both in the plane of the relative motion.

After Chen, Chang, Agate, UAV path planning with tangent-plus-Lyapunov vector field guidance and obstacle avoidance, IEEE Transactions
on Aerospace and Electronic Systems 49 (2013) 840, which the paper's reference [16] is taken to be; its text is not at hand, and it is
two-dimensional. Here the plane is that of the line of sight and the relative velocity, and what the field gives is the direction of the
relative velocity; the own velocity of the present speed follows as in the paper's eq. 12-18. Outside the circle that is SCOAM's answer to
a sphere of the circle's radius.

With x, y the place of the own aircraft from the obstacle's centre, r its distance, R_s the circle's radius, the field is

    f = -V / (r (r^2 + R_s^2)) [x (r^2 - R_s^2) + 2 y r R_s,  y (r^2 - R_s^2) - 2 x r R_s]

It leads out to the circle inside it and runs along it on it; y is counted so that it runs round on the side to which the relative
velocity already points.
"""

import math
from collections.abc import Sequence

from vosc.encounter import Obstacle, Own, first_threat, relative_velocity
from vosc.errors import WrongOption
from vosc.methods.choice import Choice, Status, none_free, undefined
from vosc.spherical_cap import critical_velocity
from vosc.vec import Vec, combine, norm, perpendicular, right_of, sub, unit


def tangent_lyapunov(own: Own, obstacles: Sequence[Obstacle], standoff: float = 1.2) -> Choice:
    """The direction against the first threat; other obstacles are not looked at.

    ``standoff`` >= 1: radius of the circle in radii of the obstacle. ``undefined`` when no velocity of the present speed has the
    relative direction. ``WrongOption`` for a standoff below 1, or above 100.
    """
    if not 1.0 <= standoff <= 100.0:
        raise WrongOption(f"standoff: give 1 to 100 radii, got {standoff}")
    first = first_threat(own, obstacles)
    if own.vel_mps == (0.0, 0.0, 0.0) or first is None:
        return undefined(own) if first is None else none_free(own)
    found = critical_velocity(own, first, wanted(own, first, standoff * first.radius_m))
    return undefined(own) if found is None else Choice(found, Status.AVOIDED)


def wanted(own: Own, obstacle: Obstacle, circle_m: float) -> Vec:
    """The direction of the relative velocity (unit vector): the tangent of the circle, or the field inside it."""
    sight = sub(obstacle.pos_m, own.pos_m)
    r, axis = norm(sight), unit(sight)
    w, _ = relative_velocity(own.vel_mps, obstacle.vel_mps)
    side = perpendicular(axis, w, own.vel_mps, right_of(axis))
    if r >= circle_m:
        sine = circle_m / r
        return combine(math.sqrt(1.0 - sine * sine), axis, sine, side)
    ratio = r / circle_m  # the aircraft on the x axis, y = 0: f is a vector of -(r^2 - R_s^2) outwards and 2 r R_s along ``side``
    return unit(combine(ratio * ratio - 1.0, axis, 2.0 * ratio, side))
