"""Encounters of several obstacles, one set for each replicate: by their closest approach, the classic ones, or out of a published set."""

import math
from abc import abstractmethod
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Discriminator, Field, Tag, model_validator

from testbed.campaign.words.population import OBSTACLE_NAME, Encounters, Met, NoEncounterError, named, obstacle, perpendicular
from testbed.campaign.words.spread import Spread, Spreading, within
from testbed.core import datafiles
from testbed.core.encounter_file import Control, Flown, encounters
from testbed.core.frames import direction_deg, unit_from_direction, vec3
from testbed.core.section import Direction, Duration, Point, Positive, Radius, Section, TrafficSpeed, Whole
from testbed.core.seeds import stream

Array = np.ndarray
MOST_AT_ONCE = 6
MOST_TRIED = 1000
FASTEST_TOGETHER = 0.1
"""Relative speed below which two aircraft fly side by side and have no closest approach, m/s."""


class _Meeting(Section):
    """Where the own aircraft is when an encounter begins, and which way it flies: on straight lines from there it is what it says."""

    own_at_enu_m: Point
    """Where the plan has the aircraft when the encounter begins, on the route: [east, north, up], m."""
    own_direction_deg: Direction
    """Direction of the route there: [azimuth counter-clockwise from east, elevation up], deg."""

    def _own_vel(self, speed_mps: float) -> Array:
        return speed_mps * np.array(unit_from_direction(*self.own_direction_deg))

    def _met(self, k: int | None, radius_m: float, offset: Array, vel: Array) -> dict[str, Any]:
        """Obstacle ``k``, at ``offset`` from the own aircraft when the encounter begins."""
        position, speed = vec3(np.array(self.own_at_enu_m) + offset), float(np.linalg.norm(vel))
        direction = direction_deg(vec3(vel)) if speed > 0.0 else self.own_direction_deg
        return obstacle(named(k), radius_m, position, speed, direction, self.own_at_enu_m)


class Approaches(_Meeting):
    """Encounters by their closest approach, of 1 to 6 obstacles, each drawn by itself: flying straight on from where it begins, the own
    aircraft and the obstacle are nearest after ``time_to_cpa_s``, ``miss_m`` apart, in a direction that is even about their relative
    velocity. Left and right are as likely. What begins inside of a sphere, or side by side, is drawn again.
    """

    kind: Literal["approaches"]
    obstacles: Annotated[Whole, Field(ge=1, le=MOST_AT_ONCE)] | tuple[Whole, Whole] = 1
    """How many obstacles; or the fewest and the most, each number as likely. They are called O1, O2, ..."""
    miss_m: Spreading
    """Least distance of the centres, m: less than the radius is a collision, more is none."""
    crossing_deg: Spreading
    """Angle between the two courses, deg: 0 the same way, 180 head on."""
    speed_mps: Spreading
    """Speed of the obstacle over the ground, m/s."""
    vertical_rate_mps: Spreading = Spread(between=(0.0, 0.0))
    """Its vertical speed, m/s."""
    time_to_cpa_s: Spreading
    """From the begin of the encounter to the closest approach, s."""
    radius_m: Spreading
    """Radius of the sphere, m."""

    @model_validator(mode="after")
    def _possible(self) -> "Approaches":
        fewest, most = self._numbers
        if not 1 <= fewest <= most <= MOST_AT_ONCE:
            raise ValueError(f"obstacles: must be 1 to {MOST_AT_ONCE}, and the fewest first")
        within("miss_m", self.miss_m, 0.0, 10_000.0, "m")
        within("crossing_deg", self.crossing_deg, 0.0, 180.0, "deg")
        within("speed_mps", self.speed_mps, 0.0, 3000.0, "m/s")
        within("time_to_cpa_s", self.time_to_cpa_s, 0.1, 3600.0, "s")
        within("radius_m", self.radius_m, 0.01, 10_000.0, "m")
        if max(map(abs, self.vertical_rate_mps.ends)) > self.speed_mps.ends[0]:
            raise ValueError("vertical_rate_mps: is more than the least speed_mps, of which it is a part")
        return self

    @property
    def _numbers(self) -> tuple[int, int]:
        return self.obstacles if isinstance(self.obstacles, tuple) else (self.obstacles, self.obstacles)

    @property
    def weighted(self) -> bool:
        """Whether some encounters stand for more than others."""
        return any(getattr(self, name).drawn for name in type(self).model_fields if isinstance(getattr(self, name), Spread))

    @property
    def largest_m(self) -> float:
        """Radius of the largest sphere."""
        return self.radius_m.ends[1]

    def placeholders(self) -> list[dict[str, Any]]:
        """Obstacles of the kind, as many as there may be, for checks that need some and not which."""
        ahead = self._own_vel(1.0)
        return [self._met(k, self.radius_m.ends[0], (k + 10.0) * self.largest_m * ahead, -ahead) for k in range(1, self._numbers[1] + 1)]

    def met(self, own_speed_mps: float, seed: int, replicate: int) -> Met:
        """Those of one replicate. Raises ``NoEncounterError``."""
        random = stream(seed, replicate, "encounter")
        fewest, most = self._numbers
        count = fewest + min(int(random.uniform() * (most - fewest + 1)), most - fewest)
        own, found, weight = self._own_vel(own_speed_mps), [], 1.0
        for k in range(1, count + 1):
            one, share = self._one(own, random, k)
            found.append(one)
            weight *= share
        return Met(tuple(found), weight)

    def _one(self, own: Array, random: np.random.Generator, k: int) -> tuple[dict[str, Any], float]:
        for _ in range(MOST_TRIED):
            shares = random.uniform(size=8)
            spreads = (self.miss_m, self.crossing_deg, self.speed_mps, self.vertical_rate_mps, self.time_to_cpa_s, self.radius_m)
            values, weights = zip(*(spread.at(share) for spread, share in zip(spreads, shares, strict=False)), strict=True)
            miss, crossing, speed, climb, time_s, radius = values
            course = math.radians(self.own_direction_deg[0] + (crossing if shares[6] < 0.5 else -crossing))
            level = math.sqrt(max(speed**2 - climb**2, 0.0))
            vel = np.array([level * math.cos(course), level * math.sin(course), climb])
            offset = miss * perpendicular(vel - own, math.tau * shares[7]) - time_s * (vel - own)
            if np.linalg.norm(vel - own) >= FASTEST_TOGETHER and np.linalg.norm(offset) > radius:
                return self._met(k, radius, offset, vel), math.prod(weights)
        raise NoEncounterError(f"none of {MOST_TRIED:,} draws begins outside of the sphere and with a relative speed")


class _Classic(_Meeting):
    """A set that everybody tries, the same in every replicate: on straight lines all meet the own aircraft after ``time_to_cpa_s``."""

    speed_mps: TrafficSpeed | None = None
    """Speed of the obstacles over the ground, m/s; none: the own speed, half of it for overtaking."""
    radius_m: Radius = 25.0
    """Radius of the spheres, m."""
    time_to_cpa_s: Duration = 8.0
    """From the begin of the encounter to where all meet, s."""

    @property
    def weighted(self) -> bool:
        """Whether some encounters stand for more than others."""
        return False

    @property
    def largest_m(self) -> float:
        """Radius of the largest sphere."""
        return self.radius_m

    def placeholders(self) -> list[dict[str, Any]]:
        """As many as there are, for checks that need some and not which."""
        return list(self._all(50.0).obstacles)

    def met(self, own_speed_mps: float, seed: int, replicate: int) -> Met:  # noqa: ARG002 (nothing is drawn)
        """All of it. Raises ``NoEncounterError``."""
        found = self._all(own_speed_mps)
        begin_m = [math.dist(one["position_enu_m"], self.own_at_enu_m) for one in found.obstacles]
        if min(begin_m) < FASTEST_TOGETHER * min(self.time_to_cpa_s, self.radius_m / FASTEST_TOGETHER):
            raise NoEncounterError("an obstacle has the own velocity and flies where the own aircraft does: give another speed_mps")
        if min(begin_m) <= self.radius_m:
            raise NoEncounterError("an obstacle begins around the own aircraft: give a longer time_to_cpa_s")
        return found

    def _all(self, own_speed_mps: float) -> Met:
        own, made = self._own_vel(own_speed_mps), []
        for k, (share, turned, climb, aside) in enumerate(self._lines(), start=1):
            speed = self.speed_mps if self.speed_mps is not None else share * own_speed_mps
            vel = speed * np.array(unit_from_direction(self.own_direction_deg[0] + turned, climb))
            beside = aside * np.array(unit_from_direction(self.own_direction_deg[0] + 90.0, 0.0))
            made.append(self._met(k, self.radius_m, beside - self.time_to_cpa_s * (vel - own), vel))
        return Met(tuple(made))

    @abstractmethod
    def _lines(self) -> list[tuple[float, float, float, float]]:
        """Of each obstacle its share of the own speed, its course from the own one to the left and its climb (deg), and how far to the
        left of the own aircraft it comes by (m).
        """

    @property
    def _climb(self) -> float:
        return self.own_direction_deg[1]


class Ring(_Classic):
    """``n`` aircraft, the own one among them, evenly round a circle, all to its middle."""

    kind: Literal["circle"]
    n: Annotated[Whole, Field(ge=2, le=100)] = 6
    """How many aircraft."""

    def _lines(self) -> list[tuple[float, float, float, float]]:
        turns = [math.tau * k / self.n for k in range(1, self.n)]
        return [(1.0, math.degrees(turn), self._climb * math.cos(turn), 0.0) for turn in turns]


class Wall(_Classic):
    """``n`` obstacles abreast, head on."""

    kind: Literal["wall"]
    n: Annotated[Whole, Field(ge=1, le=100)] = 5
    """How many obstacles."""
    spacing_m: Positive = 60.0
    """From one centre to the next, m."""

    def _lines(self) -> list[tuple[float, float, float, float]]:
        return [(1.0, 180.0, -self._climb, (k - 0.5 * (self.n - 1)) * self.spacing_m) for k in range(self.n)]


class HeadOn(_Classic):
    """One, the other way."""

    kind: Literal["head_on"]

    def _lines(self) -> list[tuple[float, float, float, float]]:
        return [(1.0, 180.0, -self._climb, 0.0)]


class Overtaking(_Classic):
    """One ahead, the same way and half as fast."""

    kind: Literal["overtaking"]

    def _lines(self) -> list[tuple[float, float, float, float]]:
        return [(0.5, 0.0, self._climb, 0.0)]


class VerticalCrossing(_Classic):
    """One from the right that climbs through the own height at 45 deg."""

    kind: Literal["vertical_crossing"]

    def _lines(self) -> list[tuple[float, float, float, float]]:
        return [(1.0, 90.0, 45.0, 0.0)]


class EncounterSet(Section):
    """Encounters out of a file, replicate k the k-th of them: MIT Lincoln Laboratory's, of two aircraft (docs/traffic.md).

    One of the two is the obstacle O and does what the file says. The other one is flown: its speed, and a route from where it begins to
    where the file takes it, with its directions at both ends, are those of the flight; what the campaign says of them is not used.
    """

    kind: Literal["file"]
    path: Annotated[str, Field(min_length=1)]
    """The file, relative to the campaign: a MATLAB file with a struct array `samples`."""
    own: Literal[1, 2] = 1
    """Which of the two aircraft is flown."""
    own_at_enu_m: Point = (0.0, 0.0, 0.0)
    """Where it begins: [east, north, up], m. Heights in the file count from there, too."""
    radius_m: Radius = 25.0
    """Radius of the sphere, m."""

    @model_validator(mode="after")
    def _can_be_read(self) -> "EncounterSet":
        found = datafiles.look_up(self.path)
        if not datafiles.is_of_a_run(self.path):
            for k, one in enumerate(encounters(self.path, found.sha256), start=1):
                own = one.aircraft[self.own - 1]
                if not math.hypot(own.speed, own.climb) > 0.0:
                    raise ValueError(f"{self.path}: encounter {k}: aircraft {self.own}, which is flown, begins with a speed of 0")
        return self

    @property
    def weighted(self) -> bool:
        """Whether some encounters stand for more than others."""
        return any(one.weight != 1.0 for one in encounters(self.path))

    @property
    def largest_m(self) -> float:
        """Radius of the largest sphere."""
        return self.radius_m

    def placeholders(self) -> list[dict[str, Any]]:
        """The first encounter's, for checks that need one and not which."""
        return list(self._scripted(0).obstacles)

    def met(self, own_speed_mps: float, seed: int, replicate: int) -> Met:  # noqa: ARG002 (the file has it all)
        """That of one replicate. Raises ``NoEncounterError``."""
        if replicate >= (there := len(encounters(self.path))):
            raise NoEncounterError(f"{self.path} has {there:,} encounters: replicates must be at most that")
        return self._scripted(replicate)

    def _scripted(self, k: int) -> Met:
        file = datafiles.look_up(self.path)
        scripted = encounters(self.path, file.sha256)[k]
        own, other = scripted.aircraft[self.own - 1], scripted.aircraft[2 - self.own]
        moved = np.array(self.own_at_enu_m) - own.pos
        goal, last = own.end()
        route = {
            "start_enu_m": self.own_at_enu_m,
            "goal_enu_m": vec3(goal + moved),
            "start_direction_deg": _direction(own),
            "goal_direction_deg": direction_deg(last),
        }
        legs = [_leg(control) for control in other.controls]
        speed, place = math.hypot(other.speed, other.climb), vec3(other.pos + moved)
        one = {
            **obstacle(OBSTACLE_NAME, self.radius_m, place, speed, _direction(other), self.own_at_enu_m),
            "when": {"time_s": 0.0},
            "kind": "legs",
            "options": {"legs": legs},
        }
        settings = (("route", route), ("speed_mps", math.hypot(own.speed, own.climb)), ("begin", {"at_route_s_m": 0.0}))
        return Met((one,), scripted.weight, settings, ((file.name, file.sha256),))


def _direction(flown: Flown) -> Direction:
    return math.degrees(flown.azimuth), math.degrees(math.atan2(flown.climb, flown.speed))


def _leg(control: Control) -> dict[str, Any]:
    leg = {"duration_s": control.lasts_s, "turn_rate_dps": math.degrees(control.turn), "acceleration_mps2": control.rate}
    return leg if control.climb is None else {**leg, "climb_mps": control.climb}


def _kind(written: Any) -> str:
    """Which of them is meant: without a ``kind`` the drawn one, which was there before there were others."""
    kind = written.get("kind", "drawn") if isinstance(written, dict) else getattr(written, "kind", "drawn")
    return kind if isinstance(kind, str) else "drawn"


Meetings = Annotated[
    Annotated[Encounters, Tag("drawn")]
    | Annotated[Approaches, Tag("approaches")]
    | Annotated[Ring, Tag("circle")]
    | Annotated[Wall, Tag("wall")]
    | Annotated[HeadOn, Tag("head_on")]
    | Annotated[Overtaking, Tag("overtaking")]
    | Annotated[VerticalCrossing, Tag("vertical_crossing")]
    | Annotated[EncounterSet, Tag("file")],
    Discriminator(_kind),
]
