"""What a campaign may say of the planner: what it sees, who plans, by which method, how the flight comes back."""

import inspect
import math
from collections.abc import Callable, Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from testbed.campaign.words.pluggable import Pluggable
from testbed.campaign.words.route import Magnitude
from testbed.core import registry
from testbed.core.frames import Vec3
from testbed.core.section import Between, Distance, Duration, NonNegative, Number, Range, Section
from vosc import Obstacle, Own
from vosc.methods import checked_choice


def completed(options: Mapping[str, Any], goal: Callable[[], Vec3], bank_rad: float = 0.0) -> dict[str, Any]:
    """Options of a method with what its objective needs and the campaign need not say: the direction of the route's goal, the bank."""
    objective = options.get("objective")
    if objective == "goal" and options.get("goal") is None:
        return {**options, "goal": goal()}
    if objective == "least_roll" and "bank_rad" not in options and math.isfinite(bank_rad):
        return {**options, "bank_rad": bank_rad}
    return dict(options)


class Sensor(Pluggable):
    """What the planner sees of the obstacles."""

    family = "sensor"
    role, needs = "a sensor", ("start", "sense")

    kind: str = "truth"
    """truth: position and velocity without error. imperfect: with a field of view, a rate, a delay, noise, gaps and false tracks
    (docs/sensors.md). `file:name` is a sensor of a plug-in."""
    range_m: Range = 100.0
    """An obstacle is seen when its centre is this near, m; or its surface, with the option `range_to: surface`."""

    @classmethod
    def _try(cls, part: Any, options: dict[str, Any]) -> None:
        made = part(**options)
        cls._has_all(made, type(made))

    def reach_m(self, radius_m: float) -> float | None:
        """From how far, to the centre, a sphere of that radius is seen; None where the sensor does not say."""
        reach = getattr(registry.part(self.family, self.kind), "reach_m", None)
        return float(reach(self.range_m, radius_m, **self.options)) if reach else None

    def shown_reach_m(self, radius_m: float) -> float:
        """The same for pictures and words: to the centre within the range, where the sensor does not say."""
        reach_m = self.reach_m(radius_m)
        return self.range_m if reach_m is None else reach_m


class TrackerSpec(Pluggable):
    """What stands between the sensor and the planner."""

    family = "tracker"
    role, needs = "a tracker", ("start", "track")

    kind: str = "none"
    """none: the planner has what the sensor tells. alpha_beta, kalman, imm (interacting multiple models): tracks of it (docs/sensors.md).
    `file:name` is a tracker of a plug-in."""

    @classmethod
    def _try(cls, part: Any, options: dict[str, Any]) -> None:
        made = part(**options)
        cls._has_all(made, type(made))


class PlannerSpec(Pluggable):
    """Who turns what is seen into a new path."""

    family = "planner"
    role, needs = "a planner", ("start", "step")

    kind: str = "replan"
    """replan: the paper's, with the settings of `method` and `replan`. survivor: predicts the aircraft and takes what keeps the radius
    when flown (docs/survivor.md); `replan` says how it comes back. lattice, rrt, genetic, particle_swarm: search for a whole path in space
    and time within the aircraft's limits (docs/methods). `file:name` is a planner of a plug-in."""

    @classmethod
    def _try(cls, part: Any, options: dict[str, Any]) -> None:
        made = part(**options)
        cls._has_all(made, type(made))


class MethodSpec(Pluggable):
    """The avoidance method and its options."""

    family = "method"
    role, needs = "a steering law", ("start", "steer")

    kind: str = "scoam"
    """Avoidance method; `testbed list methods` shows them. `file:function` is a direction of a plug-in, `file:Class` its steering law."""

    @classmethod
    def _fits(cls, part: Any, options: dict[str, Any]) -> None:
        if inspect.isclass(part):
            super()._fits(part, options)

    @classmethod
    def _try(cls, part: Any, options: dict[str, Any]) -> None:
        if inspect.isclass(part):
            made = part(**options)
            cls._has_all(made, type(made))
        else:
            own, obstacle = Own((0.0, 0.0, 0.0), (50.0, 0.0, 0.0)), Obstacle((100.0, 0.0, 0.0), (0.0, 0.0, 0.0), 25.0, is_threat=True)
            checked_choice(part(own, (obstacle,), **completed(options, goal=lambda: own.vel_mps)))


class Rejoin(Section):
    """How the flight comes back after an avoidance."""

    to: Literal["goal", "route"] = "goal"
    """goal: straight for the goal. route: back to the original path, and along it."""
    when: Literal["insertion_point", "clear"] = "insertion_point"
    """insertion_point: planned at once, from there on (the paper). clear: the avoidance direction is held until every obstacle opens
    and the way back keeps its radius. A direct answer has no insertion point and always waits until it is clear."""
    margin_m: Distance = 1.0
    """The way back is clear when it passes every obstacle with this much to spare, m."""
    bank_deg: Annotated[Number, Field(ge=5, le=70)] = 45.0
    """The way back to the route turns no tighter than a level turn with this bank, deg."""


class FlyableSearch(Section):
    """Where `path: flyable` looks: the paths tried are its points times its directions times the square of `magnitudes`."""

    k_factors: Annotated[tuple[Annotated[Number, Field(ge=1, le=100)], ...], Field(min_length=1, max_length=8)] = (1.0, 1.5, 2.0, 3.0)
    """Insertion points: `replan.k` times each of these."""
    bearings: Annotated[int, Field(ge=0, le=36)] = 8
    """Points K of the critical curve beside the method's own direction, at equal angles round the present velocity."""
    magnitudes: Annotated[int, Field(ge=3, le=25)] = 7
    """Lengths of each end tangent, between 0.4 and 3 chords."""
    climb_at_most_deg: Annotated[Number, Field(gt=0, le=90)] = 30.0
    """Steepest climb and descent of the path, deg."""


class Again(Section):
    """When a threat that was answered is answered again."""

    every_s: Duration = 1.0
    """With `policy: every_s`: so often, s."""
    hold_s: Annotated[NonNegative, Field(le=3600)] = 0.5
    """No decision is changed, and no way back taken, for so long, s. A new threat is answered at once."""
    grows_m: Distance = 2.0
    """With `policy: on_change`: by how much the clearance that is foretold has to fall, m."""
    turns_deg: Annotated[Number, Field(gt=0, le=180)] = 10.0
    """With `policy: on_change`: an obstacle has turned when it flies so far elsewhere than at the last decision, deg."""


class Replan(Section):
    """How a threat becomes a new path (sections 4.3, 5 of the paper)."""

    policy: Literal["once", "every_s", "on_change"] = "once"
    """once: one re-plan per new threat (the paper). every_s: at even intervals, until the threat is none. on_change: when the path ahead
    is no longer clear, the conflict grows again or the obstacle turns; `again` says by how much."""
    again: Again = Again()
    """When a threat is answered again."""
    answer: Literal["insertion_point", "direct"] = "insertion_point"
    """insertion_point: a path through the insertion point, with the avoidance direction there (the paper). direct: the avoidance
    direction at once; a kinematic plant's velocity then jumps to it."""
    rejoin: Rejoin = Rejoin()
    """How the flight comes back."""
    k: Annotated[Number, Field(ge=1), Between("the insertion point would be nowhere near the obstacle", most=1000.0)] = 1.25
    """The insertion point lies k radii ahead of the obstacle's centre, along its velocity (eq. 35)."""
    time_rule: Literal["arrival", "paper_4_3_2"] = "arrival"
    """When the insertion point is reached: arrival (own travel time to it) or the rule of section 4.3.2."""
    insertion_side: Literal["ahead", "behind"] = "ahead"
    """Where the insertion point lies from the obstacle's centre: ahead on its course (eq. 35), or behind it (the words of section
    4.3.1)."""
    arrival_root: Literal["smallest", "forward"] = "smallest"
    """Of the times at which the aircraft could meet the insertion point: the smallest, or the first whose point lies ahead of the
    aircraft; against a faster obstacle from behind the smallest may lie behind."""
    path: Literal["hermite", "flyable"] = "hermite"
    """How the path to the insertion point is found: hermite joins the present state to it and asks nobody (the paper's examples).
    flyable is the paper's step 5 (iii): the shortest PH path within the aircraft's bank, load factor, roll rate and climb, that
    continues the present bend; direction, insertion point and end tangents are searched for, and where no path is within the limits
    the decision is no_path and says which limit forbids it."""
    search: FlyableSearch = FlyableSearch()
    """Where a flyable path is looked for."""
    swell_m: Distance = 0.0
    """Added to the radius of every obstacle that the planner knows; clearance is still counted from the radius itself, m."""
    horizon_s: Duration = 10.0
    """A threat further away in time than this is ignored, s."""
    magnitude_chords: Magnitude = 1.0
    """Length of the end tangents of each new piece of path, in its chord lengths."""
    vo_frame: Literal["air", "ground_naive"] = "air"
    """air: velocities less the known wind, own sphere of radius airspeed. ground_naive: velocities over the ground, as in calm air."""
    wind_known: Literal["exact", "estimated", "none"] = "exact"
    """What the planner knows of the mean wind where it is: all of it, with an error that is drawn once a flight, or nothing."""
    wind_estimate_sigma_mps: Annotated[NonNegative, Between("no wind is as strong", most=100.0)] = 1.0
    """Standard deviation of the error of an estimated wind, for each horizontal component, m/s."""

    @model_validator(mode="after")
    def _has_a_path_to_find(self) -> "Replan":
        if self.path == "flyable" and self.answer == "direct":
            raise ValueError("path: flyable is a path to an insertion point, and answer: direct has none")
        return self
