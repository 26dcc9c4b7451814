"""A population of encounters: an obstacle or several for each replicate, drawn about a straight stretch of the own path."""

import math
from collections.abc import Iterator
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field, model_validator

from testbed.core.frames import direction_deg, unit_from_direction, vec3
from testbed.core.section import (
    Between,
    Direction,
    Duration,
    NonNegative,
    Number,
    Point,
    Positive,
    Radius,
    Range,
    Section,
    TrafficSpeed,
    Whole,
)
from testbed.core.seeds import stream

OBSTACLE_NAME = "O"
"""Of the obstacle that is drawn; of several the others are O2, O3 and so on."""
MOST_DRAWN = 50
MOST_DRAWS = 20_000


HalfTurn = Annotated[Number, Field(ge=0, le=180)]
QuarterTurn = Annotated[Number, Field(ge=-90, le=90)]


class Draw(NamedTuple):
    """What is random in an encounter: the obstacle's speed, direction (unit vector (3,)) and radius, the miss, and the angle of the miss
    vector about the relative velocity.
    """

    speed_mps: float
    direction: np.ndarray
    radius_m: float
    miss_m: float
    around_rad: float


def draws(seed: int, replicate: int, speed_mps: tuple[float, float], radius_m: tuple[float, float]) -> Iterator[Draw]:
    """Encounters of a replicate, in order, for as long as anybody will look: speed and radius even in their ranges, direction even on
    the sphere, the miss even in area on the disc of the radius.
    """
    rng = stream(seed, replicate, "encounter")
    for _ in range(MOST_DRAWS):
        speed, sine, azimuth, radius, share, around = rng.uniform(size=6)
        speed = speed_mps[0] + speed * (speed_mps[1] - speed_mps[0])
        radius = radius_m[0] + radius * (radius_m[1] - radius_m[0])
        sine, azimuth = 2.0 * sine - 1.0, math.tau * azimuth  # even on the sphere: Archimedes
        flat = math.sqrt(1.0 - sine * sine)
        direction = np.array([flat * math.cos(azimuth), flat * math.sin(azimuth), sine])
        yield Draw(speed, direction, radius, radius * math.sqrt(share), math.tau * around)


class Met(NamedTuple):
    """What one replicate meets: obstacles as a YAML would say them, what the encounter counts, and settings of the flight that go with
    it, dotted path to value.
    """

    obstacles: tuple[dict[str, Any], ...]
    weight: float = 1.0
    settings: tuple[tuple[str, Any], ...] = ()
    files: tuple[tuple[str, str], ...] = ()  # data files that it comes from, each with its SHA-256


def named(k: int | None) -> str:
    """What the drawn obstacle of that number is called, of several."""
    return OBSTACLE_NAME if k is None else f"{OBSTACLE_NAME}{k}"


def obstacle(name: str, radius_m: float, position: Point, speed_mps: float, direction: Direction, own_at_enu_m: Point) -> dict[str, Any]:
    """One on a straight line, there when the plan has the aircraft at a point."""
    return {
        "name": name,
        "radius_m": float(radius_m),
        "position_enu_m": position,
        "speed_mps": float(speed_mps),
        "direction_deg": direction,
        "when": {"own_reaches_enu_m": own_at_enu_m},
    }


class NoEncounterError(Exception):
    """What is asked for does not occur, or hardly ever."""

    def __init__(self, why: str = "") -> None:
        super().__init__(
            why or f"none of {MOST_DRAWS:,} draws is an encounter that begins outside of the sphere and comes closest within longest_s"
        )


class Trigger(Section):
    """Where an encounter begins: how far before the closest approach."""

    range_m: Range | None = None
    """Distance from the own aircraft to the obstacle's centre, m."""
    time_to_cpa_s: Duration | None = None
    """Time to the closest approach, s."""

    @model_validator(mode="after")
    def _one_of(self) -> "Trigger":
        if (self.range_m is None) == (self.time_to_cpa_s is None):
            raise ValueError("give exactly one of range_m and time_to_cpa_s")
        return self


class Encounters(Section):
    """Encounters of straight lines, one for each replicate, the same for every method, plant and aircraft.

    ``crossing_deg`` and ``climb_deg`` keep a class of directions: another direction is drawn again. Of a ``count`` of obstacles each is
    drawn like the first, and comes closest ``apart_s`` after the one before it.

    Own velocity: ``speed_mps`` of the flight (before draws) along ``own_direction_deg``. The obstacle's speed is even in its range and
    its direction even on the sphere, so that all crossing and climb angles occur; its radius R is even in its range. The miss vector of
    the two straight lines is perpendicular to the relative velocity, even in area on the disc of radius R: both flying straight on, they
    collide. The time to the closest approach follows from the trigger: sqrt(range^2 - miss^2) / relative speed, or it is given. An
    encounter that comes closest after ``longest_s``, or that begins inside of the sphere, is drawn again, all of it: slow closing is
    rarer than directions even on the sphere would have it.
    """

    kind: Literal["drawn"] = "drawn"
    own_at_enu_m: Point
    """Where the plan has the aircraft when the encounter begins, on the route: [east, north, up], m."""
    own_direction_deg: Direction
    """Direction of the route there: [azimuth counter-clockwise from east, elevation up], deg."""
    trigger: Trigger
    """How far before the closest approach that is."""
    obstacle_speed_mps: tuple[TrafficSpeed, TrafficSpeed]
    """Least and largest speed of the obstacle, m/s."""
    radius_m: tuple[Radius, Radius]
    """Least and largest radius of the sphere, m."""
    longest_s: Annotated[Positive, Field(le=3600)] = 10.0
    """Longest time from its begin to the closest approach, s; of several obstacles to that of the first."""
    crossing_deg: tuple[HalfTurn, HalfTurn] = (0.0, 180.0)
    """Least and largest angle between the obstacle's direction and the own one (0 overtaking or overtaken, 180 head on), deg."""
    climb_deg: tuple[QuarterTurn, QuarterTurn] = (-90.0, 90.0)
    """Least and largest elevation of the obstacle's direction (negative ones sink), deg."""
    count: Annotated[Whole, Field(ge=1, le=MOST_DRAWN)] = 1
    """Obstacles of one encounter; both flying straight on, every one of them is hit."""
    apart_s: Annotated[NonNegative, Between("the encounter would be several", most=600.0)] = 0.0
    """Time from one closest approach to the next, s."""

    @model_validator(mode="after")
    def _possible(self) -> "Encounters":
        ranges = {name: getattr(self, name) for name in ("obstacle_speed_mps", "radius_m", "crossing_deg", "climb_deg")}
        for name, (low, high) in ranges.items():
            if low > high:
                raise ValueError(f"{name}: the first is more than the second")
        if self.trigger.range_m is not None and self.trigger.range_m <= self.radius_m[1]:
            raise ValueError(f"trigger.range_m must be more than the largest radius, {self.radius_m[1]:g} m")
        if self.trigger.time_to_cpa_s is not None and self.trigger.time_to_cpa_s > self.longest_s:
            raise ValueError(f"trigger.time_to_cpa_s must be at most longest_s = {self.longest_s:g} s")
        return self

    @property
    def weighted(self) -> bool:
        """Whether some encounters stand for more than others."""
        return False

    @property
    def largest_m(self) -> float:
        """Radius of the largest sphere."""
        return self.radius_m[1]

    def placeholders(self) -> list[dict[str, Any]]:
        """Obstacles of the population's kind, for checks that need some and not which."""
        one = (self.radius_m[0], self.own_at_enu_m, self.obstacle_speed_mps[0], self.own_direction_deg)
        return [self._obstacle(k, *one) for k in range(self.count)]

    def met(self, own_speed_mps: float, seed: int, replicate: int) -> Met:
        """The encounter of one replicate. Raises ``NoEncounterError``."""
        return Met(self.drawn(own_speed_mps, seed, replicate))

    def drawn(self, own_speed_mps: float, seed: int, replicate: int) -> tuple[dict[str, Any], ...]:
        """The obstacles of one replicate, as a YAML would say them. Raises ``NoEncounterError``."""
        own_vel = own_speed_mps * np.array(unit_from_direction(*self.own_direction_deg))
        tried = draws(seed, replicate, self.obstacle_speed_mps, self.radius_m)
        return tuple(self._next(tried, own_vel, k) for k in range(self.count))

    def _next(self, tried: Iterator[Draw], own_vel: np.ndarray, k: int) -> dict[str, Any]:
        """The next of the draws that is an encounter, as obstacle number ``k`` from 0."""
        for one in tried:
            if not self._of_the_class(one.direction, own_vel):
                continue
            relative_vel = one.speed_mps * one.direction - own_vel
            time_s = self._time_to_cpa(one.miss_m, float(np.linalg.norm(relative_vel)))
            if time_s <= self.longest_s:
                offset = one.miss_m * perpendicular(relative_vel, one.around_rad) - (time_s + k * self.apart_s) * relative_vel
                if np.linalg.norm(offset) > one.radius_m:
                    position = vec3(np.array(self.own_at_enu_m) + offset)
                    return self._obstacle(k, one.radius_m, position, one.speed_mps, direction_deg(vec3(one.direction)))
        raise NoEncounterError

    def _of_the_class(self, direction: np.ndarray, own_vel: np.ndarray) -> bool:
        """Does an obstacle with this direction (unit vector) cross and climb as was asked for?"""
        crossing = math.degrees(math.atan2(float(np.linalg.norm(np.cross(own_vel, direction))), float(own_vel @ direction)))
        climb = direction_deg(vec3(direction))[1]
        return self.crossing_deg[0] <= crossing <= self.crossing_deg[1] and self.climb_deg[0] <= climb <= self.climb_deg[1]

    def _time_to_cpa(self, miss_m: float, closing_mps: float) -> float:
        if self.trigger.time_to_cpa_s is not None:
            return self.trigger.time_to_cpa_s
        return math.sqrt((self.trigger.range_m or 0.0) ** 2 - miss_m**2) / closing_mps if closing_mps > 0.0 else math.inf

    def _obstacle(self, k: int, radius_m: float, position: Point, speed_mps: float, direction: Direction) -> dict[str, Any]:
        return obstacle(named(k + 1 if k else None), radius_m, position, speed_mps, direction, self.own_at_enu_m)


def perpendicular(vector: np.ndarray, angle: float) -> np.ndarray:
    """Unit vector (3,) perpendicular to ``vector`` (3,), at that angle (rad) about it; zero for a vector of length 0."""
    along = vector / (np.linalg.norm(vector) or 1.0)
    across = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
    across /= np.linalg.norm(across) or 1.0
    return math.cos(angle) * across + math.sin(angle) * np.cross(along, across)
