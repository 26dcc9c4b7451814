"""Legs: one after the other, each with a rate of turn, a vertical speed and an acceleration that it keeps."""

import bisect
import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, NamedTuple

import numpy as np
from pydantic import Field

from testbed.core.frames import Vec3
from testbed.core.section import Between, Duration, Number, Section
from testbed.core.units import DEG
from testbed.flight.traffic.track import TrackSetting

if TYPE_CHECKING:
    from testbed.campaign.words.obstacles import ObstacleSpec

Array = np.ndarray
SMALL_RAD = 1e-2
"""Below this angle the integrals of a turn are series: their closed forms would lose digits."""


class Leg(Section):
    """What an obstacle does for a while. Each leg begins with the speed and the direction that the one before ended with."""

    duration_s: Duration
    turn_rate_dps: Annotated[Number, Between("that is three turns a second", -1080.0, 1080.0)] = 0.0
    """Positive to the left, as azimuths are counted, deg/s."""
    climb_mps: Annotated[Number, Between("nothing climbs or falls as fast", -1000.0, 1000.0)] | None = None
    """Vertical speed from its beginning on, m/s; none: as before it."""
    acceleration_mps2: Annotated[Number, Between("nothing with wings stands it", -1000.0, 1000.0)] = 0.0
    """Of the speed over the ground along its track, m/s^2."""


LegList = Annotated[tuple[Leg, ...], Field(min_length=1, max_length=10_000)]


class _Piece(NamedTuple):
    """From ``pos`` at ``time_s``: level speed, its rate, azimuth, its rate, vertical speed."""

    time_s: float
    pos: Vec3
    speed: float
    rate: float
    azimuth: float
    turn: float
    climb: float


def _integrals(theta: Any, m: Any) -> tuple[Any, Any, Any, Any]:
    """Of exp(i theta s) and of s exp(i theta s) over s from 0 to 1, real and imaginary parts; ``m``: ``math`` or ``numpy``."""
    half = m.sin(0.5 * theta)
    sine, versine = m.sin(theta), 2.0 * half * half
    return sine / theta, versine / theta, (theta * sine - versine) / theta**2, (sine - theta * (1.0 - versine)) / theta**2


def _series(theta: Any) -> tuple[Any, Any, Any, Any]:
    """The same for a small angle."""
    square = theta * theta
    return (
        1.0 - square / 6.0 + square * square / 120.0,
        theta * (0.5 - square / 24.0),
        0.5 - square / 8.0 + square * square / 144.0,
        theta * (1.0 / 3.0 - square / 30.0),
    )


def _along(piece: _Piece, t: float) -> tuple[Vec3, Vec3]:
    """Place and velocity after that long on a piece."""
    theta = piece.turn * t
    c0, s0, c1, s1 = _series(theta) if abs(theta) < SMALL_RAD else _integrals(theta, math)
    ahead, aside = t * (piece.speed * c0 + piece.rate * t * c1), t * (piece.speed * s0 + piece.rate * t * s1)
    cos, sin = math.cos(piece.azimuth), math.sin(piece.azimuth)
    (x, y, z), speed, azimuth = piece.pos, piece.speed + piece.rate * t, piece.azimuth + theta
    return (
        (x + cos * ahead - sin * aside, y + sin * ahead + cos * aside, z + piece.climb * t),
        (speed * math.cos(azimuth), speed * math.sin(azimuth), piece.climb),
    )


def _along_all(piece: _Piece, t: Array) -> tuple[Array, Array]:
    """The same after times (n,): arrays (n,3)."""
    theta = piece.turn * t
    small = np.abs(theta) < SMALL_RAD
    exact = _integrals(np.where(small, 1.0, theta), np)
    c0, s0, c1, s1 = (np.where(small, a, b) for a, b in zip(_series(theta), exact, strict=True))
    ahead, aside = t * (piece.speed * c0 + piece.rate * t * c1), t * (piece.speed * s0 + piece.rate * t * s1)
    cos, sin = math.cos(piece.azimuth), math.sin(piece.azimuth)
    (x, y, z), speed, azimuth = piece.pos, piece.speed + piece.rate * t, piece.azimuth + theta
    pos = np.column_stack([x + cos * ahead - sin * aside, y + sin * ahead + cos * aside, z + piece.climb * t])
    return pos, np.column_stack([speed * np.cos(azimuth), speed * np.sin(azimuth), np.full(len(t), piece.climb)])


class Legs:
    """From its place at ``when``; before that it came straight, after the last leg it goes straight on."""

    uses: ClassVar = ("position_enu_m", "speed_mps", "direction_deg")

    def __init__(self, setting: TrackSetting, legs: LegList) -> None:
        self.name, self.radius_m = setting.name, setting.radius_m
        vx, vy, climb = setting.vel
        speed, azimuth, pos, time_s = math.hypot(vx, vy), math.atan2(vy, vx), setting.pos, setting.time_s
        self._pieces = [_Piece(time_s, pos, speed, 0.0, azimuth, 0.0, climb)]
        for leg in legs:
            climb = climb if leg.climb_mps is None else leg.climb_mps
            self._pieces.append(_Piece(time_s, pos, speed, leg.acceleration_mps2, azimuth, leg.turn_rate_dps * DEG, climb))
            pos = _along(self._pieces[-1], leg.duration_s)[0]
            time_s += leg.duration_s
            speed = max(0.0, speed + leg.acceleration_mps2 * leg.duration_s)  # it may end at rest, give or take a rounding
            azimuth += leg.turn_rate_dps * DEG * leg.duration_s
        self._pieces.append(_Piece(time_s, pos, speed, 0.0, azimuth, 0.0, climb))
        self._starts = [piece.time_s for piece in self._pieces[1:]]

    def at(self, time_s: float) -> tuple[Vec3, Vec3]:
        """Centre and velocity at a time."""
        piece = self._pieces[bisect.bisect_right(self._starts, time_s)]
        return _along(piece, time_s - piece.time_s)

    def sampled(self, time_s: Array) -> tuple[Array, Array]:
        """The same at times (n,), as arrays (n,3)."""
        times = np.asarray(time_s, dtype=float)
        which, pos, vel = np.searchsorted(self._starts, times, side="right"), np.empty((len(times), 3)), np.empty((len(times), 3))
        for k in np.unique(which).tolist():
            mine = which == k
            pos[mine], vel[mine] = _along_all(self._pieces[k], times[mine] - self._pieces[k].time_s)
        return pos, vel

    @classmethod
    def refuse(cls, spec: "ObstacleSpec", legs: LegList) -> None:
        """Raise ``ValueError`` where a leg would brake below a standstill."""
        assert spec.speed_mps is not None
        assert spec.direction_deg is not None
        speed = spec.speed_mps * math.cos(spec.direction_deg[1] * DEG)
        for k, leg in enumerate(legs):
            end = speed + leg.acceleration_mps2 * leg.duration_s
            if end < -1e-9:
                stops_s = -speed / leg.acceleration_mps2
                raise ValueError(f"legs: item {k} brakes {speed:g} m/s to a standstill after {stops_s:g} s, and goes on braking")
            speed = max(0.0, end)
