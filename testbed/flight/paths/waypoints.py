"""Paths as a few numbers, for what searches by trying and improving.

A waypoint is six numbers in [0, 1]: so far ahead in a stretch of its own, so far to the left, so far above, and how much its direction
leans to the left and upwards from that of the circle through it and its neighbours, and how early the piece to it bends (``piece``). One
number more is that of the last piece.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from testbed.flight.paths.course import Course, Found, better, units
from vosc.ph_batch import Curves
from vosc.vec import FloatArray

NEAREST = 0.08  # share of the reach: a waypoint nearer than that leaves no room to turn
LEANS = 0.6  # tangent of the farthest lean
EACH = 6


class Waypoints(NamedTuple):
    """So many waypoints on a course."""

    course: Course
    many: int

    @property
    def numbers(self) -> int:
        """How many numbers are a candidate."""
        return EACH * self.many + 1

    def drawn(self, random: np.random.Generator, number: int) -> FloatArray:
        """Candidates (number, numbers) to begin with, from near the present path to far aside."""
        free = np.isin(np.arange(self.numbers) % EACH, (0, EACH - 1))  # how far ahead, how early
        far = np.where(free, 1.0, np.minimum(1.0, 2.0 * random.random((number, 1))))
        return np.asarray(0.5 + far * (random.random((number, self.numbers)) - 0.5))

    def paths(self, numbers: FloatArray) -> list[Curves]:
        """The pieces of candidates (n, numbers)."""
        course = self.course
        x = numbers[:, :-1].reshape(len(numbers), self.many, EACH)
        eases = np.concatenate([x[..., 5], numbers[:, -1:]], axis=1)
        ahead = course.reach_m * (NEAREST + (1.0 - NEAREST) * (np.arange(self.many) + x[..., 0]) / self.many)
        aside, lean = course.aside_m * (2.0 * x[..., 1:3, None] - 1.0), LEANS * (2.0 * x[..., 3:5, None] - 1.0)
        points, _, left, up = course.frames(ahead)
        points = points + aside[..., 0, :] * left + aside[..., 1, :] * up
        return course.joined(points, units(course.headings(points) + lean[..., 0, :] * left + lean[..., 1, :] * up), eases)

    def costs(self, numbers: FloatArray) -> FloatArray:
        """What candidates are worth (n,), as ``Course.cost`` says."""
        return self.course.cost(self.paths(numbers))[0]

    def best(self, numbers: FloatArray, looked: int) -> Found:
        """Of candidates (n, numbers) the best that passes when looked at closely."""
        pieces = self.paths(numbers)
        return self.course.best(pieces, self.course.cost(pieces)[0], looked)


def with_more_and_more(course: Course, most: int, improve: Callable[[Waypoints], Found]) -> Found:
    """The best of what is found with one waypoint, with two, ...: one is found at once, several fit a crowd closer."""
    found = improve(Waypoints(course, 1))
    for count in range(2, most + 1):
        more = improve(Waypoints(course, count))
        found = better(found, more)._replace(looked=found.looked + more.looked)
    return found
