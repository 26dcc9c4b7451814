"""One avoidance plane, chosen first: the part of v_u in it is turned until the first threat is cleared.

After Carbone, Ciniglio, Corraro, Luongo, A novel 3D geometric algorithm for aircraft autonomous collision avoidance, IEEE Conference on
Decision and Control (2006), as the paper describes its reference [21]: a plane is selected, the velocities are projected on it, and the
rotation is found there. The text of the reference is not at hand. What is across the plane stays as it is, so the speed does too. In the
plane of the line of sight and the relative velocity (``plane="encounter"``) the relative velocity stays in the plane, and the answer
to one threat is SCOAM's, or, where the other side of the cone is nearer to v_u in that plane, a smaller turn.
"""

import math
from collections.abc import Sequence
from typing import Literal, get_args

from vosc.crowd import exact_cones
from vosc.encounter import Obstacle, Own, first_threat, relative_velocity
from vosc.errors import WrongOption
from vosc.methods.choice import Choice, Status, none_free, undefined
from vosc.turns import Circle, least_turn
from vosc.vec import SMALLEST_SINE, Vec, along, cross, dot, norm, right_of, scale, sub, unit

Plane = Literal["encounter", "horizontal", "vertical"]


def one_plane(own: Own, obstacles: Sequence[Obstacle], plane: Plane = "encounter") -> Choice:
    """The least turn of the part of v_u in one plane that leaves the cone of the first threat; other obstacles are not looked at.

    ``plane``: of line of sight and relative velocity (where the two are parallel: of line of sight and v_u, else the horizontal one),
    the horizontal, or the vertical one through v_u. ``undefined`` when no direction of the plane is free, or v_u has no part in it.
    ``WrongOption`` for another plane.
    """
    if plane not in get_args(Plane):
        raise WrongOption(f"plane: one of {', '.join(get_args(Plane))}, got {plane!r}")
    first = first_threat(own, obstacles)
    if own.vel_mps == (0.0, 0.0, 0.0) or first is None:
        return undefined(own) if first is None else none_free(own)
    normal = _normal(own, first, plane)
    across = dot(own.vel_mps, normal)
    ahead = along(own.vel_mps, -across, normal)
    if norm(ahead) <= SMALLEST_SINE * norm(own.vel_mps):
        return undefined(own)
    circle = Circle(scale(across, normal), ahead, cross(normal, ahead))
    found = least_turn(exact_cones(own, [first]), [circle], (-1, 1))
    return undefined(own) if found is None else Choice(found, Status.AVOIDED)


def _normal(own: Own, obstacle: Obstacle, plane: Plane) -> Vec:
    """Unit normal of the plane."""
    up = (0.0, 0.0, 1.0)
    if plane == "vertical":
        return right_of(unit(own.vel_mps))
    if plane == "encounter":
        sight = unit(sub(obstacle.pos_m, own.pos_m))
        for other in (relative_velocity(own.vel_mps, obstacle.vel_mps)[0], own.vel_mps):
            normal = cross(sight, unit(other)) if math.hypot(*other) > 0.0 else (0.0, 0.0, 0.0)
            if norm(normal) > SMALLEST_SINE:
                return unit(normal)
    return up
