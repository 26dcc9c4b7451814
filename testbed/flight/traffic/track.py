"""The obstacles as they truly are: spheres on tracks of any kind, and how close a flight came to them."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple, Protocol

import numpy as np

from testbed.core.frames import Vec3, vec3
from testbed.flight.impossible import NoMeetingError
from testbed.flight.traffic.bounds import Bounds, bounds_of

Array = np.ndarray
Covariance = tuple[tuple[float, ...], ...]
"""Rows of a symmetrical matrix."""


class Body(NamedTuple):
    """A sphere at an instant: where its centre is (ENU m) and how it moves (m/s over the ground), or where somebody takes it to be."""

    name: str
    radius_m: float
    pos: Vec3
    vel: Vec3
    time_s: float
    covariance: Covariance | None = None
    """Of the error of ``pos`` and ``vel`` (6x6, in m and m/s), where who says this knows it; infinite where nothing is known."""

    def at(self, time_s: float) -> Vec3:
        """Where the centre is at another time if it goes straight on."""
        (x, y, z), (vx, vy, vz), elapsed = self.pos, self.vel, time_s - self.time_s
        return x + vx * elapsed, y + vy * elapsed, z + vz * elapsed


class Track(Protocol):
    """An obstacle's motion: the same for every flight of a plan, whatever the aircraft does."""

    @property
    def name(self) -> str: ...

    @property
    def radius_m(self) -> float: ...

    def at(self, time_s: float) -> tuple[Vec3, Vec3] | None:
        """Centre (ENU m) and velocity over the ground (m/s) at a time; None while the obstacle is not there."""

    def sampled(self, time_s: Array) -> tuple[Array, Array]:
        """The same at times (n,), as arrays (n,3); rows of NaN while it is not there."""


class Frame(NamedTuple):
    """From the frame that a campaign is written in to the one that is flown, which ``geometry: level`` turns about the route's start."""

    start: Array
    turn: Array

    def place(self, point: Vec3 | Array) -> Array:
        """A point (3,) there."""
        return np.asarray(self.start + self.turn @ (np.asarray(point) - self.start))

    def places(self, points: Array) -> Array:
        """Points (n,3) there."""
        return np.asarray(self.start + (points - self.start) @ self.turn.T)


AS_WRITTEN = Frame(np.zeros(3), np.eye(3))
NOWHERE: Vec3 = (np.nan, np.nan, np.nan)
NO_FILES: Mapping[str, str] = MappingProxyType({})


class TrackSetting(NamedTuple):
    """What a track is made with: the obstacle of the campaign in numbers, in the frame that is flown.

    A kind that does without a place, a speed or a direction gets NaN where the campaign gives none.
    """

    name: str
    radius_m: float
    pos: Vec3  # where the centre is at ``time_s``, ENU m
    vel: Vec3  # its velocity over the ground then, m/s
    time_s: float
    random: np.random.Generator  # a stream of this obstacle's own, the same for every method, plant and aircraft
    speed_mps: float = 0.0
    frame: Frame = AS_WRITTEN  # for places that are among a kind's options
    until_s: float = math.inf  # nobody asks for a time before 0 and ``time_s``, or after this and ``time_s``
    files: Mapping[str, str] = NO_FILES  # the plan's: name of a data file to the SHA-256 that it must have


class Traffic(NamedTuple):
    """All obstacles of a flight."""

    tracks: tuple[Track, ...]

    def at(self, time_s: float) -> tuple[Body, ...]:
        """The truth at a time: every obstacle that is there."""
        found = ((track, track.at(time_s)) for track in self.tracks)
        return tuple(Body(track.name, track.radius_m, *moving, time_s) for track, moving in found if moving is not None)


class Sampled(ABC):
    """The array form of a track that only knows where it is at one time: a base class for tracks of one's own."""

    @abstractmethod
    def at(self, time_s: float) -> tuple[Vec3, Vec3] | None:
        """See ``Track``."""

    def sampled(self, time_s: Array) -> tuple[Array, Array]:
        """See ``Track``: ``at``, time by time."""
        rows = np.full((len(time_s), 6), np.nan)
        for row, time in zip(rows, time_s, strict=True):
            if (moving := self.at(float(time))) is not None:
                row[:3], row[3:] = moving
        return rows[:, :3], rows[:, 3:]


class Shifted(Sampled):
    """A track moved as a whole, and carried on by a frame: at ``time_s`` it is at ``pos`` with the velocity ``vel``.

    Raises ``NoMeetingError`` when there is no obstacle at that time.
    """

    def __init__(self, track: Track, time_s: float, pos: Array, vel: Array) -> None:
        there = track.at(time_s)
        if there is None:
            raise NoMeetingError(f"obstacle {track.name} is not there at {time_s:.2f} s, when the wind is to take hold of it")
        self.name, self.radius_m = track.name, track.radius_m
        self._track, self._time_s = track, time_s
        self._offset, self._carried = pos - there[0], vel - there[1]

    def at(self, time_s: float) -> tuple[Vec3, Vec3] | None:
        moving = self._track.at(time_s)
        if moving is None:
            return None
        return vec3(moving[0] + self._offset + (time_s - self._time_s) * self._carried), vec3(moving[1] + self._carried)

    def sampled(self, time_s: Array) -> tuple[Array, Array]:
        pos, vel = self._track.sampled(time_s)
        return pos + self._offset + np.outer(time_s - self._time_s, self._carried), vel + self._carried

    def bounds(self) -> Bounds | None:
        """See ``Bounds``."""
        own = bounds_of(self._track)
        return own and own._replace(top_mps=own.top_mps + math.hypot(*self._carried))


class Present:
    """A track of an obstacle that appears and leaves; where it would be meanwhile it does not say."""

    def __init__(self, track: Track, from_s: float | None, to_s: float | None) -> None:
        self.name, self.radius_m = track.name, track.radius_m
        self._track, self._at, self._sampled = track, track.at, track.sampled
        self._from_s, self._to_s = -math.inf if from_s is None else from_s, math.inf if to_s is None else to_s

    def at(self, time_s: float) -> tuple[Vec3, Vec3] | None:
        """See ``Track``."""
        return self._at(time_s) if self._from_s <= time_s <= self._to_s else None

    def sampled(self, time_s: Array) -> tuple[Array, Array]:
        """See ``Track``."""
        away = (time_s < self._from_s) | (time_s > self._to_s)
        pos, vel = self._sampled(time_s)
        return np.where(away[:, None], np.nan, pos), np.where(away[:, None], np.nan, vel)

    def bounds(self) -> Bounds | None:
        """See ``Bounds``."""
        own = bounds_of(self._track)
        return own and own._replace(from_s=max(own.from_s, self._from_s), to_s=min(own.to_s, self._to_s))


class Approach(NamedTuple):
    """The closest approach of a flight to one obstacle."""

    clearance_m: float
    time_s: float


def least_clearance(time_s: Array, own_pos: Array, obstacle_pos: Array, radius_m: float) -> Approach:
    """Least distance to the surface over a sampled flight, between samples too.

    ``time_s`` (n,), positions (n,3). Both bodies are taken to move straight between samples, which makes the minimum on each
    segment a closed form. NaN for an empty flight; samples that are not finite are passed over, and so are the segments at them.
    """
    relative = own_pos - obstacle_pos
    good = np.isfinite(relative).all(axis=1)
    if not good.all():
        if not good.any():
            return Approach(np.nan, np.nan)
        joined = good[:-1] & good[1:]
        first, step, from_s, lasts = relative[:-1][joined], np.diff(relative, axis=0)[joined], time_s[:-1][joined], np.diff(time_s)[joined]
        relative, time_s = relative[good], time_s[good]
    elif len(time_s) == 0:
        return Approach(np.nan, np.nan)
    else:
        first, step, from_s, lasts = relative[:-1], relative[1:] - relative[:-1], time_s[:-1], time_s[1:] - time_s[:-1]
    square = np.einsum("ij,ij->i", step, step)
    share = np.clip(-np.einsum("ij,ij->i", first, step) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    at_samples, between = np.linalg.norm(relative, axis=1), np.linalg.norm(first + share[:, None] * step, axis=1)
    k = int(np.argmin(at_samples))
    if len(between) and between[j := int(np.argmin(between))] < at_samples[k]:
        return Approach(float(between[j]) - radius_m, float(from_s[j] + share[j] * lasts[j]))
    return Approach(float(at_samples[k]) - radius_m, float(time_s[k]))
