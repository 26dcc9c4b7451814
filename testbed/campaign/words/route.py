"""The path that is planned before anything threatens: by its ends (the paper's way), or by a shape that tests a flight."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from testbed.core.section import Direction, Number, Point, Positive, Section, Whole

Side = Literal["left", "right"]


class Circle(Section):
    """A level circle, entered on its tangent."""

    kind: Literal["circle"]
    radius_m: Positive
    """Radius, m."""
    turns: Annotated[Positive, Field(le=100)] = 1.0
    """How often around."""
    side: Side = "left"
    """To which side it turns."""


class Racetrack(Section):
    """Two straights joined by half circles, level. Curvature jumps where they join."""

    kind: Literal["racetrack"]
    straight_m: Positive
    """Length of each straight, m."""
    radius_m: Positive
    """Radius of the turns, m."""
    laps: Annotated[Whole, Field(ge=1, le=200)] = 1
    """How often around."""
    side: Side = "left"
    """To which side it turns."""


class Swerve(Section):
    """A level S-swerve: the heading goes to and fro as a cosine, so that the curvature is zero at either end."""

    kind: Literal["swerve"]
    heading_deg: Annotated[Positive, Field(le=60)] = 15.0
    """To either side of the mean direction, deg."""
    swing_m: Positive = 150.0
    """Path length from one side to the other, m."""
    swings: Annotated[Whole, Field(ge=1, le=1000)] = 4
    """How many."""


class Random(Section):
    """A random path: half of them one PH quintic, half a chain of smooth bends. Drawn per seed and replicate, whoever flies it."""

    kind: Literal["random"]
    least_radius_m: tuple[Positive, Positive]
    """The radius of the tightest place is drawn evenly from this range, m."""
    climb_at_most_deg: Annotated[Number, Field(ge=0, le=60)]
    """Steepest climb and descent, deg."""


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
    magnitude_chords: Annotated[Positive, Field(le=3)] = 1.0
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
        return self
