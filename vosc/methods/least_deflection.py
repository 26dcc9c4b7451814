"""Least deflection: the exact nearest direction outside every cone, at constant speed."""

from collections.abc import Sequence

from vosc.cone import exact_cones
from vosc.encounter import Obstacle, Own
from vosc.free import nearest_free
from vosc.methods.choice import Choice, none_free
from vosc.vec import norm


def least_deflection(own: Own, obstacles: Sequence[Obstacle]) -> Choice:
    """The velocity of present speed, outside all exact cones (eq. 3-4), that turns v_u least; ``no_free_direction`` if there is none.

    The paper's section 4.1 minimises the turn of the relative velocity instead; this one is the global optimum for v_u itself
    (``vosc.free``).
    """
    found = nearest_free(exact_cones(own, obstacles), norm(own.vel_mps), own.vel_mps)
    return none_free(own) if found is None else Choice(found, "avoided")
