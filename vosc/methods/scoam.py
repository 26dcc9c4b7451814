"""SCOAM, the paper's own method: rotate the relative velocity out of the cone (3.2.1, 4.1); several obstacles by their caps (4.2)."""

from collections.abc import Sequence
from typing import Literal

from vosc.cone import is_free
from vosc.direction import OBJECTIVES, Boundary, Objective, best_free, boundaries, corner_points
from vosc.encounter import Obstacle, Own, cone_margin, threatening
from vosc.errors import WrongOption
from vosc.methods.choice import Choice, Status, undefined
from vosc.spherical_cap import cap, critical_velocity, generatrices
from vosc.vec import deflection, norm, three


def scoam(
    own: Own,
    obstacles: Sequence[Obstacle],
    boundary: Boundary = "paper",
    objective: Objective | None = None,
    goal: tuple[float, float, float] | None = None,
    corners_only: bool = False,
    consider: Literal["threats", "all"] = "threats",
) -> Choice:
    """The paper's avoidance direction.

    One threat: the critical velocity on the near generatrix (eq. 14-18), the least rotation of the relative velocity, not of v_u.
    Two and more: the point of the boundary of the union of their caps that is best by ``objective`` (default ``least_deflection``;
    see ``vosc.direction``), or, with ``corners_only``, the better of S and S' (eq. 29-31, all pairs, those that no third cap
    covers). ``boundary="exact"`` puts the exact cones in the place of the caps. ``consider="all"`` takes obstacles into account
    that are no threat now.

    ``undefined`` when a cap or critical velocity does not exist, or no point qualifies.
    """
    if consider not in ("threats", "all"):
        raise WrongOption(f"consider: 'threats' or 'all', got {consider!r}")
    if objective is not None and objective not in OBJECTIVES:
        raise WrongOption(f"objective: one of {', '.join(OBJECTIVES)}, got {objective!r}")
    if (goal is not None) != (objective == "goal"):
        raise WrongOption("goal: give a direction with objective='goal', and only with it")
    if consider == "threats":
        obstacles = [o for o in threatening(obstacles) if cone_margin(own.pos_m, own.vel_mps, o) < 0.0]
    if len(obstacles) == 1 and objective is None:
        pair = generatrices(own, obstacles[0])
        velocity = None if pair is None else critical_velocity(own, obstacles[0], pair[0])
        return undefined(own) if velocity is None else Choice(velocity, Status.AVOIDED)
    cones = boundaries(own, obstacles, boundary)
    if cones is None:
        return undefined(own)
    if not corners_only:
        found = best_free(cones, own.vel_mps, objective or "least_deflection", None if goal is None else three("goal", goal))
        return undefined(own) if found is None else Choice(found, Status.AVOIDED)
    caps = [c for c in (cap(own, o) for o in obstacles) if c is not None]
    speed = norm(own.vel_mps)
    corners = [three("S", s) for i, first in enumerate(caps) for second in caps[:i] for s in corner_points(first, second, speed)]
    corners = [s for s in corners if is_free(cones, s)]
    return Choice(min(corners, key=lambda s: deflection(own.vel_mps, s)), Status.AVOIDED) if corners else undefined(own)
