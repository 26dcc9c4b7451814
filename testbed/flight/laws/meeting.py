"""What the laws share: the most imminent threat, the near tangent of its sphere, and the acceleration that turns the relative velocity.

With p from the aircraft to the sphere's centre, d = |p|, w the relative velocity, alpha the angle between them and sin alpha0 = R / d:
w is inside the collision cone while delta = alpha0 - alpha > 0. The near tangent lies delta away from w, in the plane of p and w, and
touches the sphere L = sqrt(d^2 - R^2) away. While w is not on it the tangent itself turns away, at |w| sin(delta) / L.
"""

import math
from collections.abc import Sequence
from typing import Annotated, NamedTuple

from pydantic import Field

from testbed.campaign.words.planning import Replan
from testbed.core.frames import Vec3
from testbed.flight.planning.context import STILL, Context
from testbed.flight.planning.decision import Sighting
from testbed.flight.plants.base import State
from testbed.flight.sensing.base import Seen
from vosc import Own
from vosc.encounter import cone_half_angle, relative_velocity
from vosc.vec import along, combine, dot, norm, perpendicular, right_of, scale, sub, unit

Spare = Annotated[float, Field(ge=0.0, le=1000.0)]
"""Added to the radius that a law keeps, m: an aircraft lags, and a law that tends to the tangent never quite reaches it."""
Most = Annotated[float, Field(gt=0.0, le=1000.0)]
"""The largest acceleration that a law asks for, m/s^2."""
SPARE_M, MOST_MPS2 = 2.0, 25.0
UP: Vec3 = (0.0, 0.0, 1.0)
LEAST_REACH = 1e-3  # cosine: an acceleration farther off the direction that it must act in does nothing there
NEAREST = 1e-6  # of the radius: as long as the tangent is at least, so that inside the sphere nothing is divided by zero


class Setting(NamedTuple):
    """What a law knows of its flight: the context, and the planner's settings with its own spare radius among them."""

    context: Context
    replan: Replan

    @classmethod
    def of(cls, context: Context, spare_m: float) -> "Setting":
        replan = context.replan
        return cls(context, replan.model_copy(update={"swell_m": replan.swell_m + spare_m}))

    def own(self, time_s: float, state: State) -> tuple[Own, Vec3]:
        """The aircraft in the frame that moves with the wind that the planner knows, and that wind."""
        pos = (state.x, state.y, state.z)
        wind = STILL if self.replan.vo_frame == "ground_naive" else self.context.wind_known(time_s, pos)
        return Own(pos, sub((state.vx, state.vy, state.vz), wind)), wind


class Meeting(NamedTuple):
    """The obstacle's name, the own velocity through the air, p, w, the radius to keep, and the time until they are closest."""

    name: str
    air_mps: Vec3
    sight_m: Vec3
    relative_mps: Vec3
    radius_m: float
    time_s: float

    def seen_along(self, axis: Vec3) -> "Meeting":
        """The same in the plane across a unit vector: the sphere's shadow is a circle, and who passes it passes the sphere."""
        p, w = self.sight_m, self.relative_mps
        return self._replace(sight_m=along(p, -dot(p, axis), axis), relative_mps=along(w, -dot(w, axis), axis))


def imminent(setting: Setting, time_s: float, state: State, seen: Sequence[Seen]) -> Meeting | None:
    """The threat whose closest approach comes first, both flying straight on; None where nothing threatens."""
    own, wind = setting.own(time_s, state)
    known = [Sighting.of(one, time_s, own, wind, setting.replan) for one in seen]
    threats = [sighting for sighting in known if sighting.obstacle.is_threat]
    if not threats:
        return None
    first = min(threats, key=lambda sighting: sighting.threat.time_to_cpa_s)
    obstacle = first.obstacle
    w, _ = relative_velocity(own.vel_mps, obstacle.vel_mps)
    return Meeting(first.seen.name, own.vel_mps, sub(obstacle.pos_m, own.pos_m), w, obstacle.radius_m, first.threat.time_to_cpa_s)


class Aim(NamedTuple):
    """The near tangent: delta (rad), |w|, unit vectors across the line of sight and across w, towards it, and along it; how fast it turns
    away (rad/s).
    """

    short_rad: float
    speed_mps: float
    side: Vec3
    across: Vec3
    line: Vec3
    runs_rad_s: float


def near_tangent(meeting: Meeting, *sides: Vec3) -> Aim | None:
    """``sides``: where it is where w points straight at the centre, the first that says. None without a line of sight or a relative
    motion.
    """
    p, w = meeting.sight_m, meeting.relative_mps
    distance, speed = norm(p), norm(w)
    if distance == 0.0 or speed == 0.0:
        return None
    axis, on = scale(1.0 / distance, p), scale(1.0 / speed, w)
    side = perpendicular(axis, w, *sides, right_of(axis))
    sine, cosine = dot(on, side), dot(on, axis)
    short = cone_half_angle(distance, meeting.radius_m) - math.atan2(sine, cosine)
    outside = (distance - meeting.radius_m) * (distance + meeting.radius_m)
    length = max(math.sqrt(max(outside, 0.0)), NEAREST * meeting.radius_m)
    across = unit(combine(-sine, axis, cosine, side))
    line = combine(math.cos(short), on, math.sin(short), across)
    return Aim(short, speed, side, across, line, speed * math.sin(short) / length)


def pull(air_mps: Vec3, aim: Aim, rate_rad_s: float, most_mps2: float, only: Vec3 | None = None) -> Vec3:
    """The least acceleration across the own velocity that turns the relative velocity towards the tangent at that rate, m/s^2.

    ``only``: a unit vector across the own velocity, to accelerate along that alone.
    """
    ahead = unit(air_mps)
    way = only or unit(along(aim.across, -dot(aim.across, ahead), ahead))
    reach = dot(aim.across, way)
    if reach < 0.0:
        way, reach = scale(-1.0, way), -reach
    amount = aim.speed_mps * rate_rad_s / max(reach, LEAST_REACH)
    return scale(max(-most_mps2, min(most_mps2, amount)), way)


def limited(acceleration_mps2: Vec3, most_mps2: float) -> Vec3:
    """In the same direction, no larger."""
    size = norm(acceleration_mps2)
    return acceleration_mps2 if size <= most_mps2 else scale(most_mps2 / size, acceleration_mps2)
