"""Many obstacles at once: which of them can matter at all.

Whether a velocity is inside a cone is decided by the scalar formulas (``vosc.cone``, ``vosc.encounter``), one cone at a time. Of a
hundred obstacles most are far from every decision. So all of them are looked at roughly first, with the same formulas over arrays,
and what comes within ``MARGIN`` of a decision, or is not a number, is decided by the scalar formulas. Rough and scalar values differ by
rounding only (most, 2e-8 rad, where a sphere is touched), so the answers are those of the scalar formulas to the bit.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from typing import cast

import numpy as np

from vosc.columns import Columns, chosen, cross, dot, length, minus, over
from vosc.cone import ON_THE_CONE, Cone, cone_of, outside
from vosc.cone import is_free as is_free_of_all
from vosc.encounter import SAME_VELOCITY, Obstacle, Own, cone_margin, threatening
from vosc.vec import BoolArray, FloatArray, Vec

FEW = 12  # up to so many the scalar formulas alone are quicker
MARGIN = 1e-7  # rad


class Rough:
    """Lines of sight ``p`` to many obstacles, their length, direction and half-angle of the cone."""

    def __init__(self, own_pos_m: Vec, pos_m: Columns, radius_m: FloatArray) -> None:
        p = minus(pos_m, own_pos_m)
        self.distance = length(p)
        with np.errstate(all="ignore"):
            self.axis = over(p, self.distance)
            self.alpha0 = np.where(self.distance > radius_m, np.arcsin(np.minimum(radius_m / self.distance, 1.0)), 0.5 * math.pi)
        self.p = p


class Scene(tuple[Obstacle, ...]):
    """Obstacles, and the arrays made of them once; a tuple for everybody else."""

    @cached_property
    def arrays(self) -> tuple[Columns, Columns, FloatArray]:
        """Positions, velocities, radii (n,)."""
        x, y, z, u, v, w, r = np.array([(*o.pos_m, *o.vel_mps, o.radius_m) for o in self], dtype=np.float64).reshape(-1, 7).T.copy()
        return (x, y, z), (u, v, w), r

    @cached_property
    def speeds(self) -> FloatArray:
        """Sizes of the velocities (n,)."""
        return length(self.arrays[1])

    @cached_property
    def threats(self) -> "Scene":
        """Those that are not marked as no threat."""
        met = threatening(self)
        return met if isinstance(met, Scene) else Scene(met)

    def rough(self, own_pos_m: Vec) -> Rough:
        """Relative positions, kept for the last ``own_pos_m``."""
        kept: tuple[Vec, Rough] | None = self.__dict__.get("_rough")
        if kept is None or kept[0] is not own_pos_m:
            positions, _, radii = self.arrays
            kept = own_pos_m, Rough(own_pos_m, positions, radii)
            self.__dict__["_rough"] = kept
        return kept[1]

    def near_the_least_margin(self, pos_m: Vec, vel_mps: Vec) -> Sequence[Obstacle]:
        """The obstacles among which the least ``cone_margin`` of a velocity is."""
        if len(self) <= FEW:
            return self
        margin = self._margins(pos_m, vel_mps)
        return self._chosen(~(margin > np.fmin.reduce(margin) + MARGIN))

    def in_their_cones(self, own: Own) -> list[Obstacle]:
        """The obstacles in whose cone the present velocity is."""
        asked = self._chosen(~(self._margins(own.pos_m, own.vel_mps) > MARGIN)) if len(self) > FEW else self
        return [o for o in asked if cone_margin(own.pos_m, own.vel_mps, o) < 0.0]

    def has_inside(self, pos_m: Vec) -> bool:
        """Whether a point is inside one of the spheres."""
        asked: Sequence[Obstacle] = self
        if len(self) > FEW:
            asked = self._chosen(~(self.rough(pos_m).distance > self.arrays[2] * (1.0 + MARGIN)))
        return any(math.dist(pos_m, o.pos_m) < o.radius_m for o in asked)

    def _chosen(self, mask: BoolArray) -> list[Obstacle]:
        return [self[k] for k in np.nonzero(mask)[0].tolist()]

    def _margins(self, pos_m: Vec, vel_mps: Vec) -> FloatArray:
        rough, velocities = self.rough(pos_m), self.arrays[1]
        w = minus(velocities, vel_mps)  # minus the relative velocity: one subtraction less
        size = length(w)
        still = (size <= SAME_VELOCITY * (math.hypot(*vel_mps) + self.speeds)) | (rough.distance == 0.0)
        with np.errstate(all="ignore"):
            w = over(w, size)
            alpha = np.arctan2(length(cross(rough.axis, w)), -dot(rough.axis, w))
        margin: FloatArray = np.where(still, 0.5 * math.pi, alpha) - rough.alpha0
        return margin


class Crowd(Sequence[Cone]):
    """Many cones: a rough table of all, and each exact one made when it is asked for."""

    def __init__(self, apex: Columns, axis: Columns, cos: FloatArray, sin: FloatArray, make: Callable[[int], Cone]) -> None:
        self.apex, self.axis, self.cos, self.sin = apex, axis, cos, sin
        self._make, self._made = make, dict[int, Cone]()

    def __len__(self) -> int:
        return len(self.cos)

    def __getitem__(self, k: int) -> Cone:  # type: ignore[override]  # no slices
        if k not in self._made:
            self._made[k] = self._make(k)
        return self._made[k]

    def __iter__(self) -> Iterator[Cone]:
        return (self[k] for k in range(len(self)))

    def _seen_from(self, velocity: Vec) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Size of the relative velocity, its part along the axis, its part across."""
        w = minus(self.apex, velocity)
        return length(w), -dot(w, self.axis), length(cross(self.axis, w))

    def unsure(self, velocity: Vec) -> Iterable[Cone]:
        """The cones that may hold a velocity."""
        size, along, across = self._seen_from(velocity)
        with np.errstate(all="ignore"):
            sine = (across * self.cos - along * self.sin) / size
        return (self[k] for k in np.nonzero(~(sine > ON_THE_CONE + MARGIN))[0].tolist())

    def within(self, velocity: Vec, distance: float) -> "Crowd":
        """The cones that come within ``distance`` of a velocity."""
        size, along, across = self._seen_from(velocity)
        reach = np.where(along * self.cos + across * self.sin > 0.0, np.maximum(across * self.cos - along * self.sin, 0.0), size)
        near = np.nonzero(~(reach > distance + MARGIN * (size + distance)))[0]
        known = near.tolist()
        return Crowd(chosen(self.apex, near), chosen(self.axis, near), self.cos[near], self.sin[near], lambda k: self[known[k]])


def scene_of(obstacles: Iterable[Obstacle]) -> Scene:
    """The same, with what was already made of them."""
    return obstacles if isinstance(obstacles, Scene) else Scene(obstacles)


def exact_cones(own: Own, obstacles: Sequence[Obstacle]) -> Sequence[Cone]:
    """The exact cones of all obstacles, without those whose sphere the own aircraft is inside."""
    if len(obstacles) <= FEW:
        return [c for c in (cone_of(own, o) for o in obstacles) if c is not None]
    scene = scene_of(obstacles)
    rough, (_, velocities, radii) = scene.rough(own.pos_m), scene.arrays
    outside_all = rough.distance > radii * (1.0 + MARGIN)
    for k in np.nonzero(~outside_all)[0].tolist():
        outside_all[k] = cone_of(own, scene[k]) is not None
    known = np.nonzero(outside_all)[0]
    alpha0, numbers = rough.alpha0[known], known.tolist()

    def make(k: int) -> Cone:
        return cast(Cone, cone_of(own, scene[numbers[k]]))

    return Crowd(chosen(velocities, known), chosen(rough.axis, known), np.cos(alpha0), np.sin(alpha0), make)


def holding(cones: Sequence[Cone], velocity: Vec) -> list[Cone]:
    """The cones that hold a velocity."""
    return [c for c in (cones.unsure(velocity) if isinstance(cones, Crowd) else cones) if outside(c, velocity) < ON_THE_CONE]


def is_free(cones: Sequence[Cone], velocity: Vec) -> bool:
    """Outside or on the boundary of every cone."""
    return is_free_of_all(cones.unsure(velocity) if isinstance(cones, Crowd) else cones, velocity)
