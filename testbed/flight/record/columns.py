"""The signals of a record by name. Those of an obstacle are worked out when the first of them is asked for."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, Protocol, TypeVar

import numpy as np

from testbed.flight.record.signals import OBSTACLE_PREFIX
from testbed.flight.traffic.bounds import bounds_of
from testbed.flight.traffic.nearest import Nearest
from testbed.flight.traffic.track import Track

Array = np.ndarray


class Sphere(Protocol):
    """An obstacle of a plan, or its track."""

    @property
    def name(self) -> str: ...

    @property
    def radius_m(self) -> float: ...


AnySphere = TypeVar("AnySphere", bound=Sphere)
PARTS = ("pos_enu_m", "vel_enu_mps", "clearance_m")


class Columns(Mapping[str, Array]):
    """What a dictionary would be that has all of them: same names, order and numbers, never to be written to.

    Of a hundred obstacles that stay far away nobody asks for the columns. A track of somebody's own is asked at once, since what it
    answers may depend on when it is asked.
    """

    def __init__(self, own: Mapping[str, Array], tracks: Sequence[Track]) -> None:
        self._known, self._tracks = dict(own), tuple(tracks)
        self._of = {column(track.name, part): track for track in tracks for part in PARTS}
        self._names = (*self._known, *self._of)
        for values in self._known.values():
            values.flags.writeable = False
        for track in tracks:
            if bounds_of(track) is None:
                self._work_out(track)

    def __getitem__(self, name: str) -> Array:
        if name not in self._known:
            self._work_out(self._of[name])
        return self._known[name]

    def __contains__(self, name: object) -> bool:
        return name in self._known or name in self._of

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __or__(self, other: Mapping[str, Array]) -> dict[str, Array]:
        """A dictionary of all of them, some replaced."""
        return dict(self) | dict(other)

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        """A copy, or what another process gets, is a dictionary of all of them."""
        return dict, (dict(self),)

    def _work_out(self, track: Track) -> None:
        pos, vel = track.sampled(self._known["time_s"])
        clearance = np.linalg.norm(self._known["own.pos_enu_m"] - pos, axis=1) - track.radius_m
        for part, values in zip(PARTS, (pos, vel, clearance), strict=True):
            values.flags.writeable = False
            self._known[column(track.name, part)] = values

    @cached_property
    def _nearest(self) -> Nearest:
        return Nearest(self._known["time_s"], self._tracks)

    def contenders(self, point: Array, obstacles: Sequence[AnySphere]) -> list[AnySphere]:
        """See the function."""
        radius = {spec.name: spec.radius_m for spec in obstacles}
        radii = np.array([radius.get(track.name, np.nan) for track in self._tracks])
        may = {track.name for track, is_one in zip(self._tracks, self._nearest.contenders(point, radii), strict=True) if is_one}
        known = {track.name for track in self._tracks}
        return [spec for spec in obstacles if spec.name in may or spec.name not in known]


def column(obstacle: str, part: str) -> str:
    """What one of an obstacle's columns is called."""
    return f"{OBSTACLE_PREFIX.replace('<name>', obstacle)}{part}"


def contenders(columns: Mapping[str, Array], point: Array, obstacles: Sequence[AnySphere]) -> Sequence[AnySphere]:
    """Those obstacles, in their order, one of which has the least clearance from a point at places (n,3), one a row.

    All of them where the columns are not as they were flown.
    """
    return columns.contenders(point, obstacles) if isinstance(columns, Columns) else obstacles
