"""Critical velocities and the velocity-obstacle spherical cap G = (r, psi_r, theta_r, gamma) (paper section 3, eq. 5-28, closed form).

At constant own speed the forbidden velocities are the part of the velocity sphere inside the obstacle's cone. The paper measures
that part in one plane, the *avoidance plane* through the line of sight and the relative velocity: the plane cuts the cone in two
generatrices, l3 (near) and l3' (far), which pierce the velocity sphere at the critical velocities. The cap is the circle over their
chord. It is the exact boundary only when the obstacle stands still (``vosc.cone`` has the exact one).

Choices where the paper leaves one open:

- Avoidance plane undefined (relative velocity along the line of sight, or none): the plane of the line of sight and v_u; when all
  three are parallel, the horizontal turn to the right. The near generatrix is then the one that turns v_u less.
- A generatrix that misses the velocity sphere (possible only for |v_o| >= |v_u|), and d_0 < R, where there is no cone: ``cap``
  returns ``None``.
- |v_o| > |v_u|: a generatrix may pierce the sphere twice. Eq. 14 takes the larger relative speed (``root="larger"``, default), which
  may turn the aircraft round where a few degrees suffice: overtaken from straight behind at 80 m/s, one of 50 m/s turns by 155 degrees.
  ``root="nearer"`` takes the solution of eq. 13 that turns v_u less.
- Eq. 28 gives gamma as an arcsine, so never more than a right angle. Where more than half of the velocity sphere is forbidden along the
  avoidance plane, the chord belongs to the free side, and v_u lies outside its own cap. ``half_angle="corrected"`` takes the side of the
  chord that lies inside the cone: the centre opposite to AM, and gamma above a right angle.
"""

import math
from dataclasses import dataclass
from typing import Literal, get_args

from vosc.encounter import Obstacle, Own, cone_half_angle, relative_velocity
from vosc.errors import WrongOption
from vosc.vec import (
    SMALLEST_SINE,
    FloatArray,
    Vec,
    add,
    along,
    array,
    azimuth_elevation,
    combine,
    cross,
    dot,
    norm,
    perpendicular,
    right_of,
    scale,
    sub,
)

Root = Literal["larger", "nearer"]
HalfAngle = Literal["arcsine", "corrected"]
TOUCHES = 1e-12  # a relative speed below this fraction of the own speed: the generatrix starts on the sphere and leaves it


@dataclass(frozen=True, eq=False)
class Cap:
    """The paper's G and the two critical velocities.

    ``radius_mps`` r, distance of the cap's plane from the centre of the velocity sphere, towards the cap's centre (so negative for a
    corrected cap of more than half of the sphere); ``azimuth_rad``, ``elevation_rad``
    direction of the cap's centre (eq. 26-27, with atan2); ``half_angle_rad`` gamma in [0, pi/2] (eq. 28), corrected in [0, pi];
    ``nearest_mps`` v-hat_u on l3, ``farthest_mps`` v-hat'_u on l3', both (3,), m/s.
    """

    radius_mps: float
    azimuth_rad: float
    elevation_rad: float
    half_angle_rad: float
    nearest_mps: FloatArray
    farthest_mps: FloatArray


def generatrices(own: Own, obstacle: Obstacle, root: Root = "larger") -> tuple[Vec, Vec] | None:
    """Unit vectors q, q' of l3 (near) and l3' (far) in the avoidance plane (eq. 5-10); ``None`` inside the sphere (no cone)."""
    p = sub(obstacle.pos_m, own.pos_m)
    distance = norm(p)
    if distance < obstacle.radius_m:
        return None
    axis = scale(1.0 / distance, p)
    alpha0 = cone_half_angle(distance, obstacle.radius_m)
    c, s = math.cos(alpha0), math.sin(alpha0)
    w, speed = relative_velocity(own.vel_mps, obstacle.vel_mps)
    if speed > 0.0 and norm(cross(axis, w)) > SMALLEST_SINE * speed:
        side = perpendicular(axis, w)
        return combine(c, axis, s, side), combine(c, axis, -s, side)
    side = perpendicular(axis, own.vel_mps, right_of(axis))
    one, other = combine(c, axis, s, side), combine(c, axis, -s, side)
    to_one, to_other = critical_velocity(own, obstacle, one, root), critical_velocity(own, obstacle, other, root)
    if to_other is not None:
        tie = 1e-12 * dot(to_other, to_other)
        if to_one is None or dot(to_other, own.vel_mps) > dot(to_one, own.vel_mps) + tie:
            return other, one
    return one, other


def critical_velocity(own: Own, obstacle: Obstacle, generatrix: Vec, root: Root = "larger") -> Vec | None:
    """Eq. 12-18: the velocity of own speed whose relative velocity lies along the unit vector ``generatrix``; ``None`` if there is none.

    |v_o + lambda q| = |v_u|, lambda > 0. ``root``: the larger lambda (eq. 14), or the one that turns v_u less. ``WrongOption`` for
    another.
    """
    if root not in get_args(Root):
        raise WrongOption(f"root: {' or '.join(map(repr, get_args(Root)))}, got {root!r}")
    vo = obstacle.vel_mps
    b = dot(vo, generatrix)
    speed2 = dot(own.vel_mps, own.vel_mps)
    # |v_o|^2 - b^2, the squared distance of the generatrix from the sphere's centre; as a cross product it keeps its digits
    off = cross(vo, generatrix)
    under_root = speed2 - dot(off, off)
    if under_root < 0.0 or speed2 == 0.0:  # at rest, or so slow that the square is lost: no direction to fly
        return None
    least = TOUCHES * math.sqrt(speed2)
    larger = math.sqrt(under_root) - b
    if larger <= least:
        return None
    found = along(vo, larger, generatrix)
    # the product of the two is |v_o|^2 - |v_u|^2: that form keeps its digits where the two roots are nearly equal in size
    smaller = (dot(vo, vo) - speed2) / larger
    if root == "nearer" and smaller > least:
        other = along(vo, smaller, generatrix)
        return other if dot(other, own.vel_mps) > dot(found, own.vel_mps) else found
    return found


def cap(own: Own, obstacle: Obstacle, root: Root = "larger", half_angle: HalfAngle = "arcsine") -> Cap | None:
    """The spherical cap of ``obstacle`` on the velocity sphere of ``own`` (eq. 24-28), threat or not.

    ``root`` as in ``critical_velocity``; ``half_angle`` as printed, or corrected where the cap is more than half of the sphere (see the
    module). ``None`` when a critical velocity does not exist: inside the sphere, own speed zero, or an obstacle so fast that a
    generatrix of the avoidance plane misses the velocity sphere. ``WrongOption`` for an unknown option.
    """
    if half_angle not in get_args(HalfAngle):
        raise WrongOption(f"half_angle: {' or '.join(map(repr, get_args(HalfAngle)))}, got {half_angle!r}")
    pair = generatrices(own, obstacle, root)
    if pair is None:
        return None
    near, far = critical_velocity(own, obstacle, pair[0], root), critical_velocity(own, obstacle, pair[1], root)
    if near is None or far is None:
        return None
    middle = scale(0.5, add(near, far))
    radius = norm(middle)
    gamma = math.asin(min(1.0, 0.5 * norm(sub(near, far)) / norm(own.vel_mps)))
    if half_angle == "corrected" and _free_side(own, obstacle, middle, gamma, root):
        middle, radius, gamma = scale(-1.0, middle), -radius, math.pi - gamma
    azimuth, elevation = azimuth_elevation(middle)
    return Cap(
        radius_mps=radius,
        azimuth_rad=azimuth,
        elevation_rad=elevation,
        half_angle_rad=gamma,
        nearest_mps=array(near),
        farthest_mps=array(far),
    )


def _free_side(own: Own, obstacle: Obstacle, middle: Vec, gamma: float, root: Root) -> bool:
    """Does the printed cap cover the free side of the chord? Asked of the velocity that would fly straight at the obstacle's centre."""
    sight = sub(obstacle.pos_m, own.pos_m)
    aimed = critical_velocity(own, obstacle, scale(1.0 / norm(sight), sight), root)
    return aimed is not None and dot(aimed, middle) < norm(aimed) * norm(middle) * math.cos(gamma)
