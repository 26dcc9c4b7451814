"""Interfered fluid: the relative velocity flows round each sphere as a stream does round a rock.

The paper's reference [6] is of this family; its text is not at hand. Followed is Wang, Lyu, Yao, Liang, Liu, Three-dimensional path
planning for unmanned aerial vehicle based on interfered fluid dynamical system, Chinese J. Aeronautics 28 (2015) 229. Each obstacle has
Gamma = |x - c|^2 / R^2, 1 on its surface, with the gradient n, and changes the relative velocity by the matrix

    M = I - n n' / (Gamma^(1/rho) n'n) + t n' / (Gamma^(1/sigma) |t| |n|)

t is tangent to the sphere; here it points along the part of the relative velocity across the line of sight, and n'v_uo in the last term
is taken without its sign, so that the stream turns to the side on which it passes already. Several obstacles are weighted by their
nearness, omega_k = prod (Gamma_i - 1) / (Gamma_i + Gamma_k - 2). The velocity that the field gives is turned into one of the present
speed: with the same direction relative to the obstacle where there is one, over the ground where there are several.
"""

import math
from collections.abc import Sequence

from vosc.encounter import Obstacle, Own, relative_velocity, threatening
from vosc.errors import WrongOption
from vosc.methods.choice import Choice, Status, undefined
from vosc.spherical_cap import critical_velocity
from vosc.vec import Vec, along, dot, norm, perpendicular, right_of, scale, sub, unit

NEAREST, FARTHEST = 1.0 + 1e-9, 1e100  # of Gamma: on the surface the weights of the others are 0


def interfered_fluid(own: Own, obstacles: Sequence[Obstacle], rho: float = 1.0, sigma: float = 1.0) -> Choice:
    """The direction of the disturbed stream.

    ``rho`` strengthens the repulsion, ``sigma`` the turn along the surface (both as exponents 1/rho, 1/sigma of Gamma). ``undefined``
    when the stream stands still, or no velocity of the present speed has its direction. ``WrongOption`` for exponents outside 0.05 to
    20.
    """
    if not (0.05 <= rho <= 20.0 and 0.05 <= sigma <= 20.0):
        raise WrongOption(f"rho, sigma: give numbers from 0.05 to 20, got {rho}, {sigma}")
    speed, met = norm(own.vel_mps), threatening(obstacles)
    if speed == 0.0 or not met:
        return undefined(own)
    if len(met) == 1:
        w = stream(own, met[0], rho, sigma)
        found = critical_velocity(own, met[0], unit(w)) if norm(w) > 0.0 else None
        return undefined(own) if found is None else Choice(found, Status.AVOIDED)
    gammas = [gamma(own, o) - 1.0 for o in met]
    total: Vec = (0.0, 0.0, 0.0)
    for k, obstacle in enumerate(met):
        weight = math.prod(other / (other + gammas[k]) for i, other in enumerate(gammas) if i != k)
        change = sub(stream(own, obstacle, rho, sigma), relative_velocity(own.vel_mps, obstacle.vel_mps)[0])
        total = along(total, weight, change)
    flow = along(own.vel_mps, 1.0, total)
    return Choice(scale(speed / norm(flow), flow), Status.AVOIDED) if norm(flow) > 1e-9 * speed else undefined(own)


def gamma(own: Own, obstacle: Obstacle) -> float:
    """|x - c|^2 / R^2 of the own position, as if on the surface where it is inside."""
    ratio = min(norm(sub(own.pos_m, obstacle.pos_m)) / obstacle.radius_m, math.sqrt(FARTHEST))
    return max(ratio * ratio, NEAREST)


def stream(own: Own, obstacle: Obstacle, rho: float, sigma: float) -> Vec:
    """M v_uo, m/s."""
    w, _ = relative_velocity(own.vel_mps, obstacle.vel_mps)
    n = unit(sub(own.pos_m, obstacle.pos_m))
    t = perpendicular(n, w, own.vel_mps, right_of(n))
    level, inwards = gamma(own, obstacle), dot(n, w)
    return along(along(w, -inwards * level ** (-1.0 / rho), n), abs(inwards) * level ** (-1.0 / sigma), t)
