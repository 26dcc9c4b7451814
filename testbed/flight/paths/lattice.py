"""A* on a lattice of poses about the path that the flight is on: the shortest way through it within all limits.

Hart, Nilsson and Raphael (1968), on a state lattice (Pivtoraiko, Knepper and Kelly 2009) whose edges are PH curves: poses stand at
equal distances ahead, in equal cells aside and above, and lean by equal angles. An edge begins with the curvature that the one before
ends with, and is dropped unless it is within the limits where and when it is flown. Every pose also tries the way straight to the end
(the analytic expansion of Dolgov et al. 2010). Time and curvature are no coordinates of the lattice: of several ways to the same pose
the shorter is kept. numpy only.
"""

import heapq
import math
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from testbed.flight.paths.course import Course, Found, beyond, look, piece, units
from testbed.flight.paths.planner import Climb, PathPlanner, Share, Spare
from testbed.flight.paths.validity import FORBIDS
from vosc import ph
from vosc.vec import FloatArray, IntArray

SPANS = (1, 2, 3)  # steps ahead that an edge may take
GREED = 1.1  # what is still ahead counts so much more: a way is found sooner, and may be longer than the shortest by as much
EASES = np.array([0.0, 1.0])  # of each edge both forms are tried
AROUND = (-1, 0, 1)  # cells about where the two directions of an edge lead


class Pose(NamedTuple):
    """A pose that was reached. ``key``: step, cells and leans; ``began`` is the pose before, ``None`` at the start."""

    key: tuple[int, int, int, int, int]
    point: FloatArray
    tangent: FloatArray
    bend: FloatArray
    length_m: float
    time_s: float
    began: "Pose | None" = None
    curve: ph.Curve | None = None

    def curves(self) -> tuple[ph.Curve, ...]:
        """The way here."""
        return (*self.began.curves(), self.curve) if self.began and self.curve else ()


class Lattice(PathPlanner):
    """Poses every ``step_s`` of flight, in cells of ``cell_m``, leaning by up to twice ``lean_deg``; ``poses`` are looked on from."""

    name = "lattice"

    def __init__(
        self,
        poses: Annotated[int, Field(ge=1, le=100_000)] = 150,
        step_s: Annotated[float, Field(ge=0.2, le=5)] = 1.0,
        cell_m: Annotated[float, Field(ge=1, le=200)] = 8.0,
        lean_deg: Annotated[float, Field(ge=1, le=30)] = 10.0,
        spare_m: Spare = 5.0,
        limits_share: Share = 0.9,
        climb_at_most_deg: Climb = 20.0,
    ) -> None:
        super().__init__(spare_m, limits_share, climb_at_most_deg)
        self._poses, self._step_s, self._cell_m, self._lean = poses, step_s, cell_m, math.tan(math.radians(lean_deg))
        leans = np.array((-2, -1, 0, 1, 2))
        grid = np.meshgrid(np.array(SPANS), leans, leans, np.array(AROUND), np.array(AROUND), indexing="ij")
        self._edges = np.stack([axis.ravel() for axis in grid], axis=1)

    def search(self, course: Course, random: np.random.Generator) -> Found:  # noqa: ARG002
        """Poses in the order of what the way through them is at least."""
        search = _Search(course, self._edges, self._step_s * course.pace.speed_mps, self._cell_m, self._lean)
        while search.open and search.expanded < self._poses:
            found = search.next()
            if found:
                return found
        return search.nearest._replace(looked=search.looked)


class _Search:
    """What is open, and what is reached already."""

    def __init__(self, course: Course, edges: IntArray, step_m: float, cell_m: float, lean: float) -> None:
        self._course, self._edges, self._step_m, self._cell_m, self._lean = course, edges, step_m, cell_m, lean
        self._last, self._cells = int(course.reach_m / step_m), int(course.aside_m / cell_m)
        self._frames = course.frames(np.arange(self._last + 1, dtype=float) * step_m)
        first = Pose((0, 0, 0, 0, 0), course.point, course.tangent, course.bend, 0.0, 0.0)
        self.open: list[tuple[float, int, Pose]] = [(0.0, 0, first)]
        self._reached: dict[tuple[int, ...], float] = {first.key: 0.0}
        self.expanded, self.looked, self._pushed = 0, 0, 0
        self.nearest = Found(None, np.full(len(FORBIDS), math.inf), 0)

    def next(self) -> Found | None:
        """Take the most promising pose: the answer if it is the end, else look on from there."""
        _, _, pose = heapq.heappop(self.open)
        if pose.key[0] < 0:
            found = Found(pose.curves(), self._course.closely(pose.curves()), self.looked)
            if beyond(found) < beyond(self.nearest):
                self.nearest = found
            return found if found.keeps else None
        if pose.length_m > self._reached[pose.key]:  # reached by a shorter way since
            return None
        self.expanded += 1
        self._to_the_end(pose)
        self._on(pose)
        return None

    def _to_the_end(self, pose: Pose) -> None:
        course = self._course
        end, along = (np.broadcast_to(x, (len(EASES), 3)) for x in course.tail[:2])
        curves = piece(pose.point, pose.tangent, pose.bend, end, along, EASES)
        excess, length, when = course.judged([curves], np.full(len(EASES), pose.time_s))
        self.looked += len(EASES)
        for k in range(len(EASES)):
            if (excess[k] <= 0.0).all():
                there = Pose(
                    (-1, 0, 0, 0, 0), end[k], along[k], course.bend, pose.length_m + float(length[k]), float(when[k]), pose, curves.curve(k)
                )
                self._push(there, there.length_m)
            elif beyond(found := Found(None, excess[k], 0)) < beyond(self.nearest):
                self.nearest = found

    def _on(self, pose: Pose) -> None:
        """The poses that an edge within the limits leads to."""
        keys = np.tile(self._keys(pose), (len(EASES), 1))
        if not len(keys):
            return
        points, tangents, left, up = (frame[keys[:, 0]] for frame in self._frames)
        aside, leans = self._cell_m * keys[:, 1:3, None], self._lean * keys[:, 3:5, None]
        points = points + aside[:, 0] * left + aside[:, 1] * up
        tangents = units(tangents + leans[:, 0] * left + leans[:, 1] * up)
        curves = piece(pose.point, pose.tangent, pose.bend, points, tangents, np.repeat(EASES, len(keys) // len(EASES)))
        excess, length, when = self._course.judged([curves], np.full(len(keys), pose.time_s))
        bends = look(curves).bends[:, -1]
        self.looked += len(keys)
        for k in np.flatnonzero((excess <= 0.0).all(axis=1)):
            key, reached_m = tuple(keys[k].tolist()), pose.length_m + float(length[k])
            if reached_m < self._reached.get(key, math.inf):
                self._reached[key] = reached_m
                there = Pose(key, points[k], tangents[k], bends[k], reached_m, float(when[k]), pose, curves.curve(int(k)))
                self._push(there, reached_m + GREED * float(np.linalg.norm(self._course.tail.point - points[k])))

    def _keys(self, pose: Pose) -> IntArray:
        """Step, cells and leans (n,5) of poses about where its direction and theirs lead."""
        step, left, up, lean_left, lean_up = pose.key
        span, to_left, to_up, by_left, by_up = self._edges.T
        drift = 0.5 * self._lean * self._step_m / self._cell_m * span
        cells_left = np.rint(left + drift * (lean_left + to_left)).astype(int) + by_left
        cells_up = np.rint(up + drift * (lean_up + to_up)).astype(int) + by_up
        inside = (step + span <= self._last) & (np.abs(cells_left) <= self._cells) & (np.abs(cells_up) <= self._cells)
        return np.stack([step + span, cells_left, cells_up, to_left, to_up], axis=1)[inside]

    def _push(self, pose: Pose, at_least_m: float) -> None:
        self._pushed += 1  # of equals the one that was found first
        heapq.heappush(self.open, (at_least_m, self._pushed, pose))
