"""Turning along a circle of the velocity sphere until every cone is left: the building block of methods that choose a plane first.

A circle is v(omega) = centre + ahead cos(omega) + aside sin(omega), from the present velocity at omega = 0. A great circle is a
turn in a plane through the velocity; a circle of latitude is a turn at constant climb angle.
"""

import math
from collections.abc import Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from vosc.cone import Cone, outside
from vosc.crowd import holding, is_free
from vosc.free import sides, within, zeros
from vosc.vec import BoolArray, FloatArray, Vec, cross, norm, scale, sub, unit

GRID = 64
WINDOWS = (4, 8, 16, GRID // 2)  # steps: a quarter of a right angle first, half a turn at last
ROUGH = 1e-7  # of a side: more than its rounding
EQUAL, SURELY_MORE = 1e-12, 1e-9  # rad: turns that count as equal, and those that no equal one can be beyond
_STEP = 2.0 * math.pi / GRID
_COS, _SIN = np.cos(_STEP * np.arange(GRID)), np.sin(_STEP * np.arange(GRID))


class Circle(NamedTuple):
    """The circle centre + ahead cos(omega) + aside sin(omega), m/s."""

    centre: Vec
    ahead: Vec
    aside: Vec

    def at(self, omega: float) -> Vec:
        """The velocity after a turn by omega."""
        c, s = math.cos(omega), math.sin(omega)
        z, a, b = self
        return (z[0] + c * a[0] + s * b[0], z[1] + c * a[1] + s * b[1], z[2] + c * a[2] + s * b[2])


def great_circle(velocity_mps: Vec, normal: Vec) -> Circle:
    """The turn about the unit vector ``normal``, which is perpendicular to the velocity; counter-clockwise seen from its tip."""
    return Circle((0.0, 0.0, 0.0), velocity_mps, cross(normal, velocity_mps))


def level_circle(velocity_mps: Vec) -> Circle:
    """The turn about the vertical: constant climb angle, to the left for positive omega."""
    x, y, z = velocity_mps
    return Circle((0.0, 0.0, z), (x, y, 0.0), (-y, x, 0.0))


def vertical_circle(velocity_mps: Vec) -> Circle | None:
    """The turn in the vertical plane through the velocity, up for positive omega; ``None`` for a vertical velocity (no such plane)."""
    x, y, _ = velocity_mps
    size = math.hypot(x, y)
    return great_circle(velocity_mps, (y / size, -x / size, 0.0)) if size > 1e-12 * abs(velocity_mps[2]) and size > 0.0 else None


def circle_in_plane(velocity_mps: Vec, other: Vec) -> Circle | None:
    """The turn in the plane of the velocity and ``other``, towards ``other`` for positive omega; ``None`` when the two are parallel."""
    u, v = unit(velocity_mps), unit(other)
    normal = cross(u, v)
    size = math.hypot(*normal)
    return great_circle(velocity_mps, scale(1.0 / size, normal)) if size > 1e-12 else None


def least_turn(cones: Sequence[Cone], circles: Sequence[Circle], senses: Sequence[int]) -> Vec | None:
    """The velocity after the least turn on any circle, to either of the sides ``senses`` (+1, -1), that leaves every cone; between
    equal turns the one named first. All circles start at the same velocity.

    Windows of more and more of the circle are looked at, with the cones that come into them only, until one holds an answer.
    """
    start, radius = circles[0].at(0.0), max(norm(c.ahead) for c in circles)
    for stop in WINDOWS:
        near = within(cones, start, 2.0 * radius * math.sin(0.5 * stop * _STEP) * (1.0 + 1e-9))
        if not near:
            return start
        best: tuple[float, int, Circle] | None = None
        for turn in first_free(near, circles, senses, stop):
            if best is None or turn[0] < best[0] - EQUAL:
                best = turn
        # a turn that ends with the window could be equal to one in the next
        if best is not None and (stop == WINDOWS[-1] or best[0] < stop * _STEP - SURELY_MORE):
            return best[2].at(best[1] * best[0])
    return None


def first_free(cones: Sequence[Cone], circles: Sequence[Circle], senses: Sequence[int], stop: int) -> list[tuple[float, int, Circle]]:
    """The least turns omega in the first ``stop`` steps of the circles that leave every cone: (omega, side, circle) by side, then by
    circle; without those that are surely more than the least of all.

    All circles are sampled at once. A stretch between two samples has a lower bound: the way to the edge of whatever cone it
    begins in. Stretches are refined to rounding, least bound first, until no other can hold less.
    """
    bounds, contacts = [], []
    rows = np.array(circles)
    turns = np.arange(-stop - 1, stop + 2) % GRID
    points = rows[:, None, 0] + _COS[turns, None] * rows[:, None, 1] + _SIN[turns, None] * rows[:, None, 2]
    table = sides(points.reshape(-1, 3), cones).reshape(len(circles), len(turns), len(cones))
    for sense in senses:
        bound, contact = _stretches(table[:, stop:] if sense > 0 else table[:, stop + 2 :: -1])
        bounds.append(bound)
        contacts.append(contact)
    bound = np.stack(bounds)
    held = holding(cones, circles[0].at(0.0))
    found: dict[tuple[int, int], float] = {}
    late: set[tuple[int, int]] = set()
    least = math.inf
    for side, c, k in _by_bound(bound):
        if bound[side, c, k] > least + SURELY_MORE:
            break
        if (side, c) in found or (side, c) in late:
            continue
        if found and _still_held(held, circles[c], senses[side], least + SURELY_MORE):
            late.add((side, c))
            continue
        touched = [cones[j] for j in np.nonzero(contacts[side][c, k])[0].tolist()]
        omega = _leave(cones, circles[c], senses[side], k * _STEP, touched)
        if omega is not None:
            found[side, c] = omega
            least = min(least, omega)
    return [(omega, senses[side], circles[c]) for (side, c), omega in sorted(found.items())]


def _by_bound(bound: FloatArray) -> Iterator[tuple[int, int, int]]:
    """Stretches (side, circle, number) by their lower bound; equal ones in strides over the circles, so that a good one comes early."""
    sides_, circles_, steps_ = (i.ravel() for i in np.indices(bound.shape))
    stride = (circles_ * 0.618034 + sides_ * 0.5) % 1.0
    order = np.lexsort((steps_, stride, bound.ravel()))[: int(np.isfinite(bound).sum())]
    return zip(sides_[order].tolist(), circles_[order].tolist(), steps_[order].tolist(), strict=True)


def _still_held(held: Sequence[Cone], circle: Circle, sense: int, omega: float) -> bool:
    """Whether one of the cones that hold the start surely holds the circle up to omega.

    A cone is convex: the depth below its surface is concave along the chord from the start. The arc lies above a point of the chord
    at the share u of it by at most u 2 r sin(omega / 2) tan(omega / 2), so a depth of that at the end is enough for all of the arc.
    """
    if omega > 0.25 * math.pi:
        return False
    end = circle.at(sense * omega)
    bulge = 2.0 * norm(circle.ahead) * math.sin(0.5 * omega) * math.tan(0.5 * omega)
    convex = (cone for cone in held if cone.cos >= 0.0)  # a cap of more than half of the sphere is none
    return any(-outside(cone, end) * norm(sub(end, cone.apex)) > bulge * (1.0 + ROUGH) + 1e-9 * norm(end) for cone in convex)


def _stretches(side: FloatArray) -> tuple[FloatArray, BoolArray]:
    """From the sides (circles, samples, cones) of samples -1, 0, 1...: a lower bound of the free turns in every stretch, inf where a
    cone surely covers it, and which cones have their edge in it.
    """
    bend = np.abs(side[:, :-2] - 2.0 * side[:, 1:-1] + side[:, 2:])
    slack = np.maximum(bend[:, :-1], bend[:, 1:])
    before, after = side[:, 1:-2], side[:, 2:-1]
    low, high = np.minimum(before, after), np.maximum(before, after)
    contact: BoolArray = np.logical_and(low <= slack, high >= -slack)
    covered = np.any(high < -slack, axis=2)
    deep = before < -slack  # the edge of a cone is not before the line from sample to sample comes within the slack of it
    fall = np.where(deep & (after > before), before - after, -math.inf)
    share = np.where(deep, (((1.0 - ROUGH) * before + slack) / fall), 0.0).max(axis=2, initial=0.0)
    bound: FloatArray = np.where(covered, math.inf, (np.arange(side.shape[1] - 3) + np.minimum(share, 1.0)) * _STEP)
    return bound, contact


def _leave(cones: Sequence[Cone], circle: Circle, sense: int, start: float, touched: Sequence[Cone]) -> float | None:
    """The first free turn in one stretch: its start, or a crossing of a cone that it touches."""
    found = [start]
    for cone in touched:
        found += zeros(partial(_side, cone, circle, sense), start, start + _STEP)
    for omega in sorted(found):
        if omega <= math.pi and is_free(cones, circle.at(sense * omega)):
            return omega
    return None


def _side(cone: Cone, circle: Circle, sense: int, omega: float) -> float:
    return outside(cone, circle.at(sense * omega))
