"""Avoidance planes through the velocity: a fixed fan of them, or random ones.

The fan follows Jenie, van Kampen, Ellerbroek, Hoekstra, Three-dimensional velocity obstacle method for uncoordinated avoidance
maneuvers of unmanned aerial vehicles, J. Guidance, Control and Dynamics 39 (2016) 2312: planes through the velocity at equal roll
angles, in each the two turns that just leave the cone. The paper's reference [22] used twelve planes. Random planes stand for its
reference [24], of which the paper says only that planes are selected at random; its text is not at hand.
"""

import math
from collections.abc import Sequence

import numpy as np

from vosc.cone import Cone
from vosc.crowd import exact_cones, scene_of
from vosc.encounter import Obstacle, Own
from vosc.errors import WrongOption
from vosc.methods.choice import Choice, Status, none_free, undefined
from vosc.turns import great_circle, least_turn
from vosc.vec import Vec, combine, up_and_right

MOST_PLANES = 10_000


def _least_of(own: Own, cones: Sequence[Cone], normals: Sequence[Vec]) -> Choice:
    found = least_turn(cones, [great_circle(own.vel_mps, normal) for normal in normals], (-1, 1))
    return undefined(own) if found is None else Choice(found, Status.AVOIDED)


def _normals(velocity: Vec, roll_rad: Sequence[float]) -> list[Vec]:
    """Normals of the planes through the velocity; roll 0 is the turn to the side (normal up), counted towards the right of the velocity."""
    up, right = up_and_right(velocity)
    return [combine(math.cos(a), up, math.sin(a), right) for a in roll_rad]


def _need_planes(n: int) -> None:
    if not 1 <= n <= MOST_PLANES:
        raise WrongOption(f"n: give 1 to {MOST_PLANES} planes, got {n}")


def planes(own: Own, obstacles: Sequence[Obstacle], n: int = 12, offset_rad: float = 0.0) -> Choice:
    """The least turn in any of ``n`` planes through v_u, at equal roll angles pi / n apart from ``offset_rad``.

    ``undefined`` when no direction in these planes is free. ``WrongOption`` for fewer than one plane, or more than 10,000.
    """
    _need_planes(n)
    if own.vel_mps == (0.0, 0.0, 0.0):
        return none_free(own)
    return _least_of(
        own, exact_cones(own, scene_of(obstacles).threats), _normals(own.vel_mps, [offset_rad + math.pi * k / n for k in range(n)])
    )


def random_planes(own: Own, obstacles: Sequence[Obstacle], n: int = 12, seed: int = 0) -> Choice:
    """The least turn in any of ``n`` planes through v_u at random roll angles; the same ``seed``, the same planes.

    ``undefined`` when no direction in these planes is free. ``WrongOption`` for fewer than one plane, or more than 10,000.
    """
    _need_planes(n)
    if own.vel_mps == (0.0, 0.0, 0.0):
        return none_free(own)
    if seed < 0:
        raise WrongOption(f"seed: give a whole number from 0 on, got {seed}")
    rolls = np.random.default_rng(seed).uniform(0.0, math.pi, n)
    return _least_of(own, exact_cones(own, scene_of(obstacles).threats), _normals(own.vel_mps, rolls.tolist()))
