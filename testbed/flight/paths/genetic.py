"""Evolution of a population of paths: a few waypoints joined by PH curves.

Differential evolution, Storn and Price (1997), by scipy: of the genetic algorithms for real numbers the one that is well kept, already
installed, and judges a generation in one call.
"""

from typing import Annotated, Any

import numpy as np
from pydantic import Field

from testbed.flight.paths.course import Course, Found
from testbed.flight.paths.planner import Climb, PathPlanner, Share, Spare
from testbed.flight.paths.waypoints import Waypoints, with_more_and_more


class Genetic(PathPlanner):
    """One waypoint, then up to ``waypoints``, between the present state and the goal; a ``population`` of paths over ``generations`` for
    each.
    """

    name = "genetic"

    def __init__(
        self,
        waypoints: Annotated[int, Field(ge=1, le=5)] = 2,
        population: Annotated[int, Field(ge=8, le=1000)] = 40,
        generations: Annotated[int, Field(ge=1, le=1000)] = 30,
        spare_m: Spare = 5.0,
        limits_share: Share = 0.9,
        climb_at_most_deg: Climb = 20.0,
    ) -> None:
        super().__init__(spare_m, limits_share, climb_at_most_deg)
        self._waypoints, self._population, self._generations = waypoints, population, generations

    def search(self, course: Course, random: np.random.Generator) -> Found:
        """The last generation, from its best to its worst."""
        from scipy.optimize import differential_evolution

        evolved: Any = differential_evolution  # whose stubs know nothing of columns

        def improve(candidates: Waypoints) -> Found:
            result = evolved(
                lambda columns: candidates.costs(columns.T),
                [(0.0, 1.0)] * candidates.numbers,
                init=candidates.drawn(random, self._population),
                maxiter=self._generations,
                tol=0.0,
                polish=False,
                updating="deferred",
                vectorized=True,
                rng=random,
            )
            return candidates.best(result.population, self._population * (self._generations + 1))

        return with_more_and_more(course, self._waypoints, improve)
