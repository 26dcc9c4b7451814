"""Particle swarm over a few waypoints joined by PH curves.

Kennedy and Eberhart (1995), with the constriction of Clerc and Kennedy (2002); every particle hears of the best of all. The lines of a
swarm are few, and the packages that have one bring a plotting library along or have had no release for years: it is ours.
"""

import math
from typing import Annotated

import numpy as np
from pydantic import Field

from testbed.flight.paths.course import Course, Found
from testbed.flight.paths.planner import Climb, PathPlanner, Share, Spare
from testbed.flight.paths.waypoints import Waypoints, with_more_and_more
from vosc.vec import FloatArray

PULL = 2.05  # to one's own best place, and as much to the best of all
CONSTRICTION = 2.0 / abs(2.0 - 2.0 * PULL - math.sqrt((2.0 * PULL) ** 2 - 8.0 * PULL))


class ParticleSwarm(PathPlanner):
    """One waypoint, then up to ``waypoints``, between the present state and the goal; ``particles`` that move ``rounds`` times for each."""

    name = "particle_swarm"

    def __init__(
        self,
        waypoints: Annotated[int, Field(ge=1, le=5)] = 2,
        particles: Annotated[int, Field(ge=4, le=1000)] = 40,
        rounds: Annotated[int, Field(ge=1, le=1000)] = 30,
        spare_m: Spare = 5.0,
        limits_share: Share = 0.9,
        climb_at_most_deg: Climb = 20.0,
    ) -> None:
        super().__init__(spare_m, limits_share, climb_at_most_deg)
        self._waypoints, self._particles, self._rounds = waypoints, particles, rounds

    def search(self, course: Course, random: np.random.Generator) -> Found:
        """The best place of each particle, and of all."""

        def improve(candidates: Waypoints) -> Found:
            place = candidates.drawn(random, self._particles)
            velocity = random.uniform(-0.25, 0.25, place.shape)
            best, least = place, candidates.costs(place)
            for _ in range(self._rounds):
                leader = best[int(np.argmin(least))]
                own, common = random.random(place.shape), random.random(place.shape)
                velocity = CONSTRICTION * (velocity + PULL * own * (best - place) + PULL * common * (leader - place))
                place, velocity = _kept_in(place + velocity, velocity)
                cost = candidates.costs(place)
                better = cost < least
                best, least = np.where(better[:, None], place, best), np.where(better, cost, least)
            return candidates.best(best, self._particles * (self._rounds + 1))

        return with_more_and_more(course, self._waypoints, improve)


def _kept_in(place: FloatArray, velocity: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A particle stops at the wall."""
    inside = np.clip(place, 0.0, 1.0)
    return inside, np.where(inside == place, velocity, 0.0)
