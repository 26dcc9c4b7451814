"""Differential geometry: turn in the plane of the line of sight and the own velocity, away from the most imminent threat.

After White, Shin, Tsourdos, UAV obstacle avoidance using differential geometry concepts, IFAC World Congress 2011 (the line of work
of the paper's references [12-14], whose texts are not at hand): the manoeuvre plane is spanned by the sightline and the own
velocity, and the own velocity is turned in it until the relative velocity touches the safety sphere. Their guidance law then steers
the curvature to that direction; here only the direction is asked for. One obstacle at a time: the one that is reached first.
"""

from collections.abc import Sequence

from vosc.crowd import exact_cones
from vosc.encounter import Obstacle, Own, first_threat
from vosc.methods.choice import Choice, Status, none_free, undefined
from vosc.turns import circle_in_plane, least_turn
from vosc.vec import right_of, sub, unit


def differential_geometry(own: Own, obstacles: Sequence[Obstacle]) -> Choice:
    """The least turn in the plane of sightline and v_u that leaves the cone of the first threat; other obstacles are not looked at.

    Flying straight at the obstacle, where the plane is undefined, the turn is a horizontal one, to the right if both sides are
    equal. ``undefined`` when no direction of the plane is free.
    """
    first = first_threat(own, obstacles)
    if own.vel_mps == (0.0, 0.0, 0.0) or first is None:
        return undefined(own) if first is None else none_free(own)
    sight = sub(first.pos_m, own.pos_m)
    circle = circle_in_plane(own.vel_mps, sight) or circle_in_plane(own.vel_mps, right_of(unit(own.vel_mps)))
    if circle is None:
        return undefined(own)
    found = least_turn(exact_cones(own, [first]), [circle], (1, -1))
    return undefined(own) if found is None else Choice(found, Status.AVOIDED)
