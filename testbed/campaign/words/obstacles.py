"""The obstacles of a campaign: spheres, each on a track of some kind."""

from collections.abc import Callable
from typing import Any

from pydantic import Field, ValidationInfo, ValidatorFunctionWrapHandler, field_validator, model_validator
from pydantic_core import PydanticCustomError, PydanticKnownError

from testbed.campaign.words.pluggable import Pluggable
from testbed.core import datafiles, plugins, registry
from testbed.core.kept import Kept
from testbed.core.section import Direction, Instant, Name, Point, Radius, Section, TrafficSpeed
from testbed.core.utf8 import reason

MOST_OBSTACLES = 1000
MOTION = ("position_enu_m", "speed_mps", "direction_deg")
"""What a straight track is made of. Another kind says in ``uses`` what it is made of; where it says nothing it needs them all."""

_refused: Kept[str] = Kept(1000)
"""Why a part refuses an obstacle, empty where it does not: the thousands of cells of a campaign ask for few."""


def names_differ(obstacles: "tuple[ObstacleSpec, ...]") -> "tuple[ObstacleSpec, ...]":
    """The obstacles, if a flight can have them all."""
    if len(obstacles) > MOST_OBSTACLES:
        raise ValueError(f"{len(obstacles):,} obstacles; at most {MOST_OBSTACLES:,}, which a planner can look at in time")
    names = [obstacle.name for obstacle in obstacles]
    if len(set(names)) != len(names):
        raise ValueError(f"obstacle names must differ: {', '.join(names)}")
    return obstacles


class When(Section):
    """The instant at which an obstacle is at its ``position_enu_m``: a time, or when the plan has the aircraft at a point."""

    time_s: Instant | None = None
    """Time after the flight begins, s."""
    own_reaches_enu_m: Point | None = None
    """When the plan without obstacles has the aircraft nearest to this point: [east, north, up], m."""

    @model_validator(mode="after")
    def _one_of(self) -> "When":
        if (self.time_s is None) == (self.own_reaches_enu_m is None):
            raise ValueError("give exactly one of time_s and own_reaches_enu_m")
        return self


def _motion(kind: Any) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """(what an obstacle of that kind must say of its motion, what it may); all of it may be said of a kind that nobody knows."""
    try:
        part = registry.part("traffic", kind)
    except (registry.UnknownPartError, plugins.PluginError, TypeError):
        return (), MOTION
    return getattr(part, "uses", MOTION), getattr(part, "takes", getattr(part, "uses", MOTION))


class ObstacleSpec(Pluggable):
    """A sphere that moves along a track."""

    family = "traffic"
    role, needs = "a track", ("at", "sampled")

    kind: str = "straight"
    """straight: on a straight line at a constant speed. legs: turns, climbs and accelerates, leg by leg. waypoints: from place to place.
    file: as recorded. `file:name` is a track of a plug-in, which starts from what stands here."""
    name: Name
    """Short name: letters, digits, _ and -. A sweep addresses the obstacle by it."""
    radius_m: Radius
    """The sphere's radius, m."""
    position_enu_m: Point | None = Field(default=None, validate_default=True)
    """The centre at the instant `when`: [east, north, up], m. A file without one stays where it was recorded."""
    speed_mps: TrafficSpeed | None = Field(default=None, validate_default=True)
    """Speed over the ground, m/s; of legs and waypoints at the instant `when`. A file has its own."""
    direction_deg: Direction | None = Field(default=None, validate_default=True)
    """Direction of flight then: [azimuth counter-clockwise from east, elevation up], deg. Waypoints and files have their own."""
    when: When = When(time_s=0.0)
    """The instant at which the obstacle is at position_enu_m."""
    appears_at_s: Instant | None = None
    """Time of the flight before which there is no such obstacle, s."""
    leaves_at_s: Instant | None = None
    """Time of the flight after which there is none any more, s."""

    def __hash__(self) -> int:
        """Equal obstacles have equal numbers; their options, which a dict holds, have none."""
        return hash((self.name, self.kind, self.radius_m, self.position_enu_m, self.speed_mps, self.direction_deg))

    @field_validator(*MOTION, mode="wrap")
    @classmethod
    def _as_the_kind_has_it(cls, value: Any, handler: ValidatorFunctionWrapHandler, info: ValidationInfo) -> Any:
        needed, taken = _motion(info.data.get("kind"))
        if value is None:
            if info.field_name in needed:
                raise PydanticKnownError("missing")
            return None
        if info.field_name not in taken:
            text = "a track of the kind '{kind}' has its own: leave this out"
            raise PydanticCustomError("not_of_this_kind", text, {"kind": info.data["kind"]})
        return handler(value)

    @model_validator(mode="after")
    def _is_a_track(self) -> "ObstacleSpec":
        come, go = self.appears_at_s, self.leaves_at_s
        if come is not None and go is not None and come >= go:
            raise ValueError(f"leaves_at_s: {go:g} s is not later than appears_at_s, {come:g} s")
        part = registry.part(self.family, self.kind)
        refuse: Callable[..., None] | None = getattr(part, "refuse", None)
        hashes = tuple(datafiles.look_up(name).sha256 for name in self.files)
        if refuse is not None and not any(map(datafiles.is_of_a_run, self.files)):
            key = (part, hashes, repr(self.options), self.position_enu_m, self.speed_mps, self.direction_deg)
            if why := _refused.get(key, lambda: self._why_not(refuse)):
                raise ValueError(why)
        return self

    def _why_not(self, refuse: Callable[..., None]) -> str:
        """Why there is no such track; empty if there is."""
        try:
            refuse(self, **self.options)
        except ValueError as error:
            return reason(error).partition(": ")[2]
        return ""

    @property
    def files(self) -> tuple[str, ...]:
        """The data files that its track is made of, as the campaign calls them."""
        options = getattr(registry.part(self.family, self.kind), "files", ())
        return tuple(self.options[name] for name in options if name in self.options)
