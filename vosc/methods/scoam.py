"""SCOAM, the paper's own method: rotate the relative velocity out of the cone (3.2.1, 4.1); several obstacles by their caps (4.2)."""

import math
from collections.abc import Sequence
from typing import Literal, get_args

from vosc.cone import is_free
from vosc.critical_curve import at_bearing, with_component
from vosc.crowd import scene_of
from vosc.direction import OBJECTIVES, Boundary, Objective, best_free, boundaries, corner_points, time_to_turn
from vosc.encounter import Obstacle, Own
from vosc.errors import WrongOption
from vosc.methods.choice import Choice, Status, undefined
from vosc.spherical_cap import HalfAngle, Root, cap, critical_velocity, generatrices
from vosc.vec import Vec, deflection, norm, three

Component = Literal["x", "y", "z"]


def scoam(
    own: Own,
    obstacles: Sequence[Obstacle],
    boundary: Boundary = "paper",
    objective: Objective | None = None,
    goal: tuple[float, float, float] | None = None,
    corners_only: bool = False,
    consider: Literal["threats", "all"] = "threats",
    root: Root = "larger",
    half_angle: HalfAngle = "arcsine",
    bearing_deg: float | None = None,
    component: Component | None = None,
    component_mps: float | None = None,
    bank_rad: float = 0.0,
) -> Choice:
    """The paper's avoidance direction.

    One threat: the critical velocity on the near generatrix (eq. 14-18), the least rotation of the relative velocity, not of v_u.
    Two and more: the point K of the boundary of the union of their caps that is best by ``objective`` (default ``least_deflection``;
    see ``vosc.direction``), for one threat too if it is given. K may be chosen otherwise, one way at a time: with ``corners_only`` the
    better of S and S' (eq. 29-31, all pairs, those that no third cap covers); ``bearing_deg``, the angle at which it lies from v_u as
    the pilot sees it (0 up, 90 to the right); ``component`` and ``component_mps``, one component of the velocity (eq. 32-33).

    ``boundary="exact"`` puts the exact cones in the place of the caps. ``consider="all"`` takes obstacles into account that are no
    threat now. ``root`` of eq. 13 and ``half_angle`` of eq. 28: see ``vosc.spherical_cap``. ``bank_rad`` is the present bank, for
    ``least_roll``.

    ``undefined`` when a cap or critical velocity does not exist, or no point qualifies. ``WrongOption`` for options that do not go
    together.
    """
    _need_one_choice(consider, half_angle, objective, goal, corners_only, bearing_deg, component, component_mps)
    if consider == "threats":
        obstacles = scene_of(obstacles).threats.in_their_cones(own)
    chosen = objective is not None or bearing_deg is not None or component is not None
    if len(obstacles) == 1 and not chosen:
        pair = generatrices(own, obstacles[0], root)
        velocity = None if pair is None else critical_velocity(own, obstacles[0], pair[0], root)
        return undefined(own) if velocity is None else Choice(velocity, Status.AVOIDED)
    cones = boundaries(own, obstacles, boundary, root, half_angle)
    if cones is None:
        return undefined(own)
    found: Vec | None
    if corners_only:
        caps = [c for c in (cap(own, o, root, half_angle) for o in obstacles) if c is not None]
        speed = norm(own.vel_mps)
        corners = [three("S", s) for i, first in enumerate(caps) for second in caps[:i] for s in corner_points(first, second, speed)]
        found = min((s for s in corners if is_free(cones, s)), key=lambda s: deflection(own.vel_mps, s), default=None)
    elif bearing_deg is not None:
        found = at_bearing(cones, own.vel_mps, math.radians(bearing_deg))
    elif component is not None and component_mps is not None:
        found = with_component(cones, own.vel_mps, get_args(Component).index(component), component_mps)
    else:
        goal_mps = None if goal is None else three("goal", goal)
        found = best_free(cones, own.vel_mps, objective or "least_deflection", goal_mps, time_to_turn(own, obstacles), bank_rad)
    return undefined(own) if found is None else Choice(found, Status.AVOIDED)


def _need_one_choice(
    consider: str,
    half_angle: str,
    objective: str | None,
    goal: Sequence[float] | None,
    corners_only: bool,
    bearing_deg: float | None,
    component: str | None,
    component_mps: float | None,
) -> None:
    """Raises ``WrongOption`` in words."""
    if consider not in ("threats", "all"):
        raise WrongOption(f"consider: 'threats' or 'all', got {consider!r}")
    if half_angle not in get_args(HalfAngle):
        raise WrongOption(f"half_angle: one of {', '.join(get_args(HalfAngle))}, got {half_angle!r}")
    if objective is not None and objective not in OBJECTIVES:
        raise WrongOption(f"objective: one of {', '.join(OBJECTIVES)}, got {objective!r}")
    if (goal is not None) != (objective == "goal"):
        raise WrongOption("goal: give a direction with objective='goal', and only with it")
    if goal is not None and norm(three("goal", goal)) == 0.0:
        raise WrongOption("goal: a direction of length zero points nowhere")
    if component is not None and component not in get_args(Component):
        raise WrongOption(f"component: one of {', '.join(get_args(Component))}, got {component!r}")
    if (component is None) != (component_mps is None):
        raise WrongOption("component: give it with component_mps, and only with it")
    if bearing_deg is not None and not -360.0 <= bearing_deg <= 360.0:
        raise WrongOption(f"bearing_deg: give an angle from -360 to 360, got {bearing_deg}")
    if component_mps is not None and not math.isfinite(component_mps):
        raise WrongOption("component_mps: give a finite number")
    if sum((objective is not None, corners_only, bearing_deg is not None, component is not None)) > 1:
        raise WrongOption("K is chosen by objective, corners_only, bearing_deg or component: give one of them")
