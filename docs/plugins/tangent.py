"""A direction: turn level, to one side, just as far as every threat's sphere asks for.

plugins: [./tangent.py]
method: {kind: "tangent:avoid", options: {side: left}}
"""

import math
from collections.abc import Sequence
from typing import Literal

from vosc import Obstacle, Own, threat, threatening
from vosc.methods import Choice


def avoid(own: Own, obstacles: Sequence[Obstacle], side: Literal["left", "right"] = "right", step_deg: float = 0.5) -> Choice:
    """``obstacles`` is everything in sight; ``threatening`` leaves out what is marked as no threat."""
    if not 0.0 < step_deg <= 10.0:
        raise ValueError(f"step_deg: give an angle above 0 deg, at most 10 deg, got {step_deg}")
    (vx, vy, vz), turn = own.vel_mps, math.radians(step_deg if side == "left" else -step_deg)
    for k in range(1, int(120.0 / step_deg)):
        cos, sin = math.cos(k * turn), math.sin(k * turn)
        velocity = (cos * vx - sin * vy, sin * vx + cos * vy, vz)
        if not any(threat(Own(own.pos_m, velocity), obstacle).is_threat for obstacle in threatening(obstacles)):
            return Choice(velocity, "avoided")
    return Choice(own.vel_mps, "undefined")
