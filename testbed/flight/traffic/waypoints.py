"""From place to place on straight lines, each at a speed."""

import math
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from pydantic import Field

from testbed.core.section import Point, Positive
from testbed.flight.traffic.pieces import Pieces, polygon
from testbed.flight.traffic.track import TrackSetting

if TYPE_CHECKING:
    from testbed.campaign.words.obstacles import ObstacleSpec

Points = Annotated[tuple[Point, ...], Field(min_length=1, max_length=10_000)]
Speeds = tuple[Positive, ...]


class Waypoints(Pieces):
    """From ``position_enu_m``, where it is at ``when``, to each of the points; before straight towards the first, then straight on.

    ``speeds_mps``: on the way to each of them; without them ``speed_mps`` all the way.
    """

    uses: ClassVar = ("position_enu_m", "speed_mps")

    def __init__(self, setting: TrackSetting, points_enu_m: Points, speeds_mps: Speeds = ()) -> None:
        pos = np.vstack([setting.pos, setting.frame.places(np.asarray(points_enu_m, dtype=float))])
        speed = np.asarray(speeds_mps) if speeds_mps else np.full(len(points_enu_m), setting.speed_mps)
        lasts = np.linalg.norm(np.diff(pos, axis=0), axis=1) / speed
        super().__init__(setting.name, setting.radius_m, polygon(setting.time_s + np.append(0.0, np.cumsum(lasts)), pos))

    @classmethod
    def refuse(cls, spec: "ObstacleSpec", points_enu_m: Points, speeds_mps: Speeds = ()) -> None:
        """Raise ``ValueError`` where there is no such way."""
        if speeds_mps and len(speeds_mps) != len(points_enu_m):
            raise ValueError(f"speeds_mps: has {len(speeds_mps)} speeds for {len(points_enu_m)} points")
        if not speeds_mps and not spec.speed_mps:
            raise ValueError("points_enu_m: at a speed_mps of 0 no point is ever reached")
        assert spec.position_enu_m is not None
        for k, (one, other) in enumerate(zip([spec.position_enu_m, *points_enu_m], points_enu_m, strict=False)):
            if math.dist(one, other) < 1e-6:
                raise ValueError(f"points_enu_m: item {k} is where the one before it is")
