"""Avoidance methods: one file each, all behind one call.

A method is a function ``(own, obstacles, **options) -> Choice``; ``METHODS`` names them. A new one is a file in this folder and a
line in the dict; every contract test then runs on it. It is given every obstacle that is seen; those that are known to be no threat
are marked so (``Obstacle.is_threat``), and the methods here look at the others, scoam with ``consider="all"`` at all.

Status of an answer, the same for all methods. It and the margin are about the exact cones, whatever the method believes, of the
obstacles that are not marked as no threat:

=====================  ================================================================================================
``clear``              the present velocity is outside every cone: it is kept
``avoided``            the velocity is outside every cone
``unsafe``             the method's own formula gives a velocity inside a cone; the margin says by how much
``no_free_direction``  every direction at the own speed is inside a cone; the velocity is the present one
``inside``             the own aircraft is inside an obstacle's sphere: no cone exists; the velocity is the present one
``undefined``          the method's construction does not exist in this encounter; the velocity is the present one
=====================  ================================================================================================
"""

import inspect
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

from vosc.crowd import Scene
from vosc.encounter import Obstacle, Own, cone_margin
from vosc.errors import WrongAnswer, WrongOption
from vosc.methods.choice import Choice, Status
from vosc.methods.differential_geometry import differential_geometry
from vosc.methods.droam import droam_hp, droam_vp
from vosc.methods.interfered_fluid import interfered_fluid
from vosc.methods.least_deflection import least_deflection
from vosc.methods.none import none
from vosc.methods.one_plane import one_plane
from vosc.methods.orca import orca
from vosc.methods.outward_search import outward_search
from vosc.methods.planes import planes, random_planes
from vosc.methods.potential_field import potential_field
from vosc.methods.scoam import scoam
from vosc.methods.tangent_lyapunov import tangent_lyapunov
from vosc.vec import FloatArray, array, deflection, three

__all__ = ["CHOICES", "MARGIN_RAD", "METHODS", "OPTIONS", "Avoidance", "Choice", "Method", "Status", "avoid", "checked_choice"]

Method = Callable[..., Choice]

METHODS: Final[dict[str, Method]] = {
    "none": none,
    "scoam": scoam,
    "least_deflection": least_deflection,
    "droam_hp": droam_hp,
    "droam_vp": droam_vp,
    "planes": planes,
    "random_planes": random_planes,
    "potential_field": potential_field,
    "differential_geometry": differential_geometry,
    "orca": orca,
    "one_plane": one_plane,
    "outward_search": outward_search,
    "tangent_lyapunov": tangent_lyapunov,
    "interfered_fluid": interfered_fluid,
}

OPTIONS: Final[dict[str, frozenset[str]]] = {
    name: frozenset(list(inspect.signature(method).parameters)[2:]) for name, method in METHODS.items()
}

CHOICES: Final = (Status.AVOIDED, Status.NO_FREE_DIRECTION, Status.UNDEFINED)  # what a method may say of its velocity
MARGIN_RAD = 1e-9  # a velocity this far inside a cone still counts as on it: critical velocities lie on cones by construction


@dataclass(frozen=True, eq=False)
class Avoidance:
    """What ``avoid`` answers.

    ``velocity_mps`` (3,) commanded velocity, m/s; ``deflection_rad`` space angle from the present velocity; ``status`` see the module;
    ``margin_rad`` least angle of ``velocity_mps`` outside the exact cones (negative: inside one; inf without obstacles).
    """

    velocity_mps: FloatArray
    deflection_rad: float
    status: Status
    margin_rad: float


def avoid(method: str | Method, own: Own, obstacles: Sequence[Obstacle], **options: Any) -> Avoidance:
    """The velocity that a method, by name or as a function, commands against ``obstacles``; never NaN, never an exception for a
    physical input.

    ``WrongOption`` for a name not in ``METHODS``, an option the method does not have or a value it does not take; ``WrongAnswer`` or
    ``NotNumbers`` for an answer that is none.
    """
    if isinstance(method, str):
        name, method = method, _named(method)
        if not options.keys() <= OPTIONS[name]:
            unknown = ", ".join(sorted(options.keys() - OPTIONS[name]))
            raise WrongOption(f"method '{name}' has no option {unknown}; it has: {', '.join(sorted(OPTIONS[name])) or 'none'}")
    obstacles = Scene(obstacles)
    met = obstacles.threats
    present = min((cone_margin(own.pos_m, own.vel_mps, o) for o in met.near_the_least_margin(own.pos_m, own.vel_mps)), default=math.inf)
    if met.has_inside(own.pos_m):
        choice = Choice(own.vel_mps, Status.INSIDE)
    elif present >= -MARGIN_RAD:
        choice = Choice(own.vel_mps, Status.CLEAR)
    else:
        choice = checked_choice(method(own, obstacles, **options))
    kept = choice.velocity_mps == own.vel_mps
    margin = (
        present
        if kept
        else min(cone_margin(own.pos_m, choice.velocity_mps, o) for o in met.near_the_least_margin(own.pos_m, choice.velocity_mps))
    )
    status = Status(choice.status)
    if status is Status.AVOIDED and margin < -MARGIN_RAD:
        status = Status.UNSAFE
    return Avoidance(array(choice.velocity_mps), 0.0 if kept else deflection(own.vel_mps, choice.velocity_mps), status, margin)


def checked_choice(answer: Any) -> Choice:
    """What a method handed back, as a ``Choice`` of floats; ``WrongAnswer`` or ``NotNumbers`` in words when it is no such thing."""
    try:
        velocity, status = answer
    except (TypeError, ValueError):
        raise WrongAnswer(f"the method must return Choice(velocity_mps, status), not {answer!r}") from None
    if not (isinstance(status, str) and status in CHOICES):
        raise WrongAnswer(f"the method's status must be one of {', '.join(CHOICES)}, not {status!r}")
    return Choice(three("the method's velocity", velocity), Status(status))


def _named(name: str) -> Method:
    if name not in METHODS:
        raise WrongOption(f"no avoidance method '{name}'; there are: {', '.join(METHODS)}")
    return METHODS[name]
