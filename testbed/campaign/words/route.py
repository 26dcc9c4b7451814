"""The path that is planned before anything threatens: by its ends (the paper's way), or by a shape that tests a flight."""

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from testbed.core.section import Between, Direction, Flat, Number, Point, Positive, Section, Whole

Side = Literal["left", "right"]
Magnitude = Annotated[Positive, Field(le=3), Between("shorter tangents make a kink of either end", least=0.01)]
Stretch = Annotated[Positive, Between("less is no stretch to fly", least=1.0), Flat]
LONGEST_ROUTE_M = 200_000.0
LONGEST_SWERVE_M = 50_000.0  # it is built from a point every 5 cm
NEAREST_GOAL_M = 1.0
MOST_PIECES = 10_000
"""Of a route: each is a curve of its own, with tables of its own."""


def _bounded(length_m: float, pieces: float, longest_m: float = LONGEST_ROUTE_M) -> None:
    """Refuse a course that is too long, or of too many pieces."""
    if length_m > longest_m:
        raise ValueError(f"the course is {length_m / 1000.0:,.0f} km long; at most {longest_m / 1000.0:g} km, which a computer can hold")
    if pieces > MOST_PIECES:
        raise ValueError(f"the course has {pieces:,.0f} pieces; at most {MOST_PIECES:,}, which a computer can hold")


class Circle(Section):
    """A level circle, entered on its tangent."""

    kind: Literal["circle"]
    radius_m: Stretch
    """Radius, m."""
    turns: Annotated[Positive, Field(le=100), Between("less is no curve", least=0.001)] = 1.0
    """How often around."""
    side: Side = "left"
    """To which side it turns."""

    @property
    def length_m(self) -> float:
        """Length of the course."""
        return math.tau * self.turns * self.radius_m

    @model_validator(mode="after")
    def _can_be_held(self) -> "Circle":
        _bounded(self.length_m, 24.0 * self.turns)
        return self


class Racetrack(Section):
    """Two straights joined by half circles, level. Curvature jumps where they join."""

    kind: Literal["racetrack"]
    straight_m: Stretch
    """Length of each straight, m."""
    radius_m: Stretch
    """Radius of the turns, m."""
    laps: Annotated[Whole, Field(ge=1, le=200)] = 1
    """How often around."""
    side: Side = "left"
    """To which side it turns."""

    @property
    def length_m(self) -> float:
        """Length of the course."""
        return 2.0 * self.laps * (self.straight_m + math.pi * self.radius_m)

    @model_validator(mode="after")
    def _can_be_held(self) -> "Racetrack":
        _bounded(self.length_m, 2.0 * self.laps * (12.0 + math.ceil(self.straight_m / (3.0 * self.radius_m))))
        return self


class Swerve(Section):
    """A level S-swerve: the heading goes to and fro as a cosine, so that the curvature is zero at either end."""

    kind: Literal["swerve"]
    heading_deg: Annotated[Positive, Field(le=60), Between("less is a straight line", least=0.001)] = 15.0
    """To either side of the mean direction, deg."""
    swing_m: Stretch = 150.0
    """Path length from one side to the other, m."""
    swings: Annotated[Whole, Field(ge=1, le=1000)] = 4
    """How many."""

    @property
    def length_m(self) -> float:
        """Length of the course."""
        return self.swings * self.swing_m

    @model_validator(mode="after")
    def _can_be_held(self) -> "Swerve":
        _bounded(self.length_m, 20.0 * math.pi * math.radians(self.heading_deg) * self.swings, LONGEST_SWERVE_M)
        return self


TightRadius = Annotated[Positive, Between("less is no bend to fly", least=1.0), Between("no computer holds a longer path", most=5000.0)]


class Random(Section):
    """A random path: half of them one PH quintic, half a chain of smooth bends. Drawn per seed and replicate, whoever flies it."""

    kind: Literal["random"]
    least_radius_m: tuple[TightRadius, TightRadius]
    """The radius of the tightest place is drawn evenly from this range, m."""
    climb_at_most_deg: Annotated[Number, Field(ge=0, le=60)]
    """Steepest climb and descent, deg."""

    @model_validator(mode="after")
    def _low_to_high(self) -> "Random":
        if self.least_radius_m[0] > self.least_radius_m[1]:
            raise ValueError("least_radius_m: the first is more than the second")
        return self


Shape = Annotated[Circle | Racetrack | Swerve | Random, Field(discriminator="kind")]


class Route(Section):
    """The original path: one canonical PH quintic between its ends, or a shape from its start on."""

    start_enu_m: Point
    """Where the path starts: [east, north, up], m."""
    start_direction_deg: Direction
    """Direction of the path at its start: [azimuth counter-clockwise from east, elevation up], deg."""
    goal_enu_m: Point | None = None
    """Where the path ends: [east, north, up], m."""
    goal_direction_deg: Direction | None = None
    """Direction of the path at its goal: [azimuth counter-clockwise from east, elevation up], deg."""
    magnitude_chords: Magnitude = 1.0
    """Length of both end tangents, in chord lengths (start to goal)."""
    shape: Shape | None = None
    """Instead of a goal: a course that begins at the start, in the azimuth of the start direction."""

    @model_validator(mode="after")
    def _goal_or_shape(self) -> "Route":
        goals = (self.goal_enu_m, self.goal_direction_deg)
        if self.shape is None and None in goals:
            raise ValueError("give goal_enu_m and goal_direction_deg, or a shape")
        if self.shape is not None and goals != (None, None):
            raise ValueError("a shape has its own end: leave out goal_enu_m and goal_direction_deg")
        if self.start_enu_m == self.goal_enu_m:
            raise ValueError("start_enu_m and goal_enu_m are the same point")
        if self.goal_enu_m is not None:
            chord_m = math.dist(self.start_enu_m, self.goal_enu_m)
            if not NEAREST_GOAL_M <= chord_m <= LONGEST_ROUTE_M:
                far = f"{chord_m / 1000.0:,.0f} km" if chord_m > LONGEST_ROUTE_M else f"{chord_m:.3g} m"
                raise ValueError(
                    f"start_enu_m and goal_enu_m are {far} apart; at least {NEAREST_GOAL_M:g} m, at most {LONGEST_ROUTE_M / 1000.0:g} km"
                )
        return self
