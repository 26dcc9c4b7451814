"""Legs: one after the other, each with a rate of turn, a vertical speed and an acceleration that it keeps."""

import math
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from pydantic import Field

from testbed.core.arcs import Chained, Piece, along
from testbed.core.frames import Vec3
from testbed.core.section import Between, Duration, Number, Section
from testbed.core.units import DEG
from testbed.flight.traffic.bounds import Bounds
from testbed.flight.traffic.track import TrackSetting

if TYPE_CHECKING:
    from testbed.campaign.words.obstacles import ObstacleSpec

Array = np.ndarray


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


class Legs:
    """From its place at ``when``; before that it came straight, after the last leg it goes straight on."""

    uses: ClassVar = ("position_enu_m", "speed_mps", "direction_deg")

    def __init__(self, setting: TrackSetting, legs: LegList) -> None:
        self.name, self.radius_m = setting.name, setting.radius_m
        vx, vy, climb = setting.vel
        speed, azimuth, pos, time_s = math.hypot(vx, vy), math.atan2(vy, vx), setting.pos, setting.time_s
        pieces = [Piece(time_s, pos, speed, 0.0, azimuth, 0.0, climb)]
        for leg in legs:
            climb = climb if leg.climb_mps is None else leg.climb_mps
            pieces.append(Piece(time_s, pos, speed, leg.acceleration_mps2, azimuth, leg.turn_rate_dps * DEG, climb))
            pos = along(pieces[-1], leg.duration_s)[0]
            time_s += leg.duration_s
            speed = max(0.0, speed + leg.acceleration_mps2 * leg.duration_s)  # it may end at rest, give or take a rounding
            azimuth += leg.turn_rate_dps * DEG * leg.duration_s
        pieces.append(Piece(time_s, pos, speed, 0.0, azimuth, 0.0, climb))
        self._pieces = Chained(pieces)
        self._bounds = Bounds(self._pieces.top_speed(), -math.inf, math.inf)

    def at(self, time_s: float) -> tuple[Vec3, Vec3]:
        """Centre and velocity at a time."""
        return self._pieces.at(time_s)

    def sampled(self, time_s: Array) -> tuple[Array, Array]:
        """The same at times (n,), as arrays (n,3)."""
        return self._pieces.sampled(np.asarray(time_s, dtype=float))

    def bounds(self) -> Bounds:
        """See ``Bounds``."""
        return self._bounds

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
