"""DROAM, the dimension-reduction methods the paper compares with: turn in the horizontal or in the vertical plane only.

After Belkhouche and Bendjilali, Reactive path planning for 3-D autonomous vehicles, IEEE Trans. Control Systems Technology 20
(2012) 249, the paper's reference [19], whose text is not at hand: here the exact cones are cut by the circle of the manoeuvre, so
that the answer is the least safe turn of its kind. Horizontal: azimuth at constant climb angle. Vertical: climb angle at constant
azimuth.
"""

from collections.abc import Sequence
from typing import Literal

from vosc.cone import exact_cones
from vosc.encounter import Obstacle, Own, threatening
from vosc.errors import WrongOption
from vosc.methods.choice import Choice, Status, none_free, undefined
from vosc.turns import Circle, least_turn, level_circle, vertical_circle


def _best(own: Own, obstacles: Sequence[Obstacle], circle: Circle, senses: tuple[int, ...]) -> Choice:
    if own.vel_mps == (0.0, 0.0, 0.0):
        return none_free(own)
    found = least_turn(exact_cones(own, threatening(obstacles)), [circle], senses)
    return undefined(own) if found is None else Choice(found, Status.AVOIDED)


def droam_hp(own: Own, obstacles: Sequence[Obstacle], side: Literal["least", "left", "right"] = "least") -> Choice:
    """The least azimuth change at constant climb angle that leaves every cone, to ``side`` = ``left``, ``right`` or ``least``
    (right if equal).

    ``undefined`` when no azimuth is free, as for a vertical velocity.
    """
    senses = {"least": (-1, 1), "left": (1,), "right": (-1,)}
    if side not in senses:
        raise WrongOption(f"side: 'least', 'left' or 'right', got {side!r}")
    return _best(own, obstacles, level_circle(own.vel_mps), senses[side])


def droam_vp(own: Own, obstacles: Sequence[Obstacle], side: Literal["least", "up", "down"] = "least") -> Choice:
    """The least change of climb angle in the vertical plane of v_u that leaves every cone, to ``side`` = ``up``, ``down`` or
    ``least`` (up if equal).

    The turn may go over the vertical. ``undefined`` when no direction of the plane is free, and for a vertical velocity, which has
    no such plane.
    """
    senses = {"least": (1, -1), "up": (1,), "down": (-1,)}
    if side not in senses:
        raise WrongOption(f"side: 'least', 'up' or 'down', got {side!r}")
    circle = vertical_circle(own.vel_mps)
    return undefined(own) if circle is None else _best(own, obstacles, circle, senses[side])
