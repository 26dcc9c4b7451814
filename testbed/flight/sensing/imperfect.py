"""A sensor with a range, a field of view, a rate, a delay and errors: what a radar, a camera or a transponder leaves of the truth.

    truth -> in sight? -> measured, with noise -> lost for a while? -> some that are not there -> told after a delay

It measures at its own rate, never more often than the planner looks, and tells each measurement with the time at which it was made.
At every measurement the same count of numbers is drawn, whatever is in sight: methods, plants and aircraft meet the same noise.

Errors of the aircraft's own state are common to all that is seen. The planner goes on with its true state; what it sees is displaced
relative to it, which is all that a threat test or a cone knows of either. They change slowly (Gauss-Markov), so no tracker averages
them away.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field

from testbed.core.frames import Vec3, enu_from_body
from testbed.core.section import NonNegative, Number, Positive, Radius, Section, TrafficSpeed
from testbed.core.units import DEG
from testbed.flight.plants.base import State
from testbed.flight.sensing.base import NOTHING, Seen, SensorContext
from testbed.flight.sensing.lookout import Lookout
from testbed.flight.sensing.phantoms import DRAWN, Phantom, phantom
from testbed.flight.sensing.truth import RangeTo, Truth
from testbed.flight.traffic.track import Array, Covariance, Traffic
from vosc.vec import add, along, combine, cross, norm, sub, unit

EARLY = 1e-6  # of a measurement, in its own intervals: rounding must not put it off
ON_TIME_S = 1e-9
Angle = Annotated[NonNegative, Field(le=45)]
Noise = Annotated[NonNegative, Field(le=10_000)]
Lasts = Annotated[NonNegative, Field(le=3600)]
Often = Annotated[NonNegative, Field(le=100)]


class Options(Section):
    """What of the truth is left. As it stands: everything within range, without an error."""

    range_to: RangeTo = "centre"
    """What `sensor.range_m` counts to: the sphere's centre, or its surface."""
    azimuth_width_deg: Annotated[Number, Field(gt=0, le=360)] = 360.0
    """Field of view in body axes: so wide to the left and right of the nose together, deg."""
    elevation_width_deg: Annotated[Number, Field(gt=0, le=180)] = 180.0
    """The same above and below the nose together, deg."""
    update_hz: Annotated[Number, Field(gt=0, le=1000)] | None = None
    """Measurements a second; left out: one at each look of the planner."""
    latency_s: Annotated[NonNegative, Field(le=60)] = 0.0
    """From a measurement until the planner has it, s."""
    position_noise_m: Noise = 0.0
    """Standard deviation of each of the three parts of a measured position, m."""
    bearing_noise_deg: Angle = 0.0
    """Standard deviation of each of the two angles at which an obstacle is seen: off by so much across, times the distance, deg."""
    velocity_noise_mps: Noise | Literal["unmeasured"] = 0.0
    """Standard deviation of each part of a measured velocity, m/s. unmeasured: positions only, and a tracker finds the velocity."""
    dropouts_per_s: Often = 0.0
    """How often an obstacle in sight is lost, a second."""
    dropout_lasts_s: Lasts = 0.0
    """For how long it then is, s; 0: one measurement."""
    false_tracks_per_s: Often = 0.0
    """How often something is seen that is not there, a second: anywhere in sight, flying straight in any direction."""
    false_lasts_s: Lasts = 1.0
    """For how long, s."""
    false_radius_m: Radius = 25.0
    """How large, m."""
    false_speed_mps: TrafficSpeed = 40.0
    """How fast, m/s."""
    own_position_noise_m: Noise = 0.0
    """Standard deviation of each part of the error of the own position, which displaces all that is seen, m."""
    own_velocity_noise_mps: Noise = 0.0
    """The same of the own velocity, m/s."""
    own_attitude_noise_deg: Angle = 0.0
    """The same of the own attitude: turns all that is seen about the aircraft, deg."""
    own_correlation_s: Annotated[Positive, Field(le=3600)] = 10.0
    """How slowly these three change: after so long a share of 1/e is left of an error, s."""


class Memory(NamedTuple):
    """What was told, what is drawn, and what is on its way."""

    context: SensorContext
    hz: float
    measured: int = -1  # number of the last measurement
    own_error: Array | None = None  # (9,) in standard deviations: position, velocity, attitude
    lost_until_s: Mapping[str, float] = {}
    phantoms: tuple[Phantom, ...] = ()
    born: int = 0  # phantoms so far
    waiting: tuple[tuple[float, tuple[Seen, ...]], ...] = ()  # measurements that nobody has yet, and when they were made
    told: tuple[Seen, ...] = NOTHING
    lookout: Lookout | None = None


class Imperfect:
    """See the file. ``Options`` has what it can be given."""

    Options = Options

    def __init__(self, **options: Any) -> None:
        self._with = o = Options(**options)
        self._half_fields = (0.5 * o.azimuth_width_deg * DEG, 0.5 * o.elevation_width_deg * DEG)
        self._all_round = o.azimuth_width_deg >= 360.0 and o.elevation_width_deg >= 180.0
        self._velocity_mps = 0.0 if isinstance(o.velocity_noise_mps, str) else o.velocity_noise_mps
        own = (o.own_position_noise_m, o.own_velocity_noise_mps, o.own_attitude_noise_deg * DEG)
        self._own_sizes = np.repeat(own, 3)
        self._variances = (
            o.position_noise_m**2 + own[0] ** 2,
            (o.bearing_noise_deg * DEG) ** 2 + own[2] ** 2,
            math.inf if o.velocity_noise_mps == "unmeasured" else self._velocity_mps**2 + own[1] ** 2,
        )

    @staticmethod
    def reach_m(range_m: float, radius_m: float, range_to: RangeTo = "centre", **others: Any) -> float:  # noqa: ARG004
        """From how far, to the centre, a sphere of that radius is seen."""
        return Truth.reach_m(range_m, radius_m, range_to)

    @staticmethod
    def amiss(options: Mapping[str, Any], planner_hz: int, tracked: bool) -> Iterator[tuple[str, str]]:
        """Options (by name) that do not go with the rest of a plan, and why."""
        if (hz := options.get("update_hz") or 0.0) > planner_hz:
            yield "update_hz", f"{hz:g} measurements a second are more than the planner looks: rates.planner_hz is {planner_hz}"
        if options.get("velocity_noise_mps") == "unmeasured" and not tracked:
            yield "velocity_noise_mps", "is unmeasured, and without one no planner can do: a tracker.kind other than none finds it"

    def start(self, context: SensorContext) -> Memory:
        return Memory(context, self._with.update_hz or context.planner_hz)

    def sense(self, memory: Memory, time_s: float, own: State, traffic: Traffic) -> tuple[Memory, tuple[Seen, ...]]:
        """A new measurement where one is due, and the newest of those that have arrived."""
        number = math.floor(time_s * memory.hz + EARLY)
        if number > memory.measured:
            memory = self._measured(memory._replace(measured=number), time_s, own, traffic)
        waiting, told = memory.waiting, memory.told
        while waiting and waiting[0][0] <= time_s - self._with.latency_s + ON_TIME_S:
            (_, told), *rest = waiting
            waiting = tuple(rest)
        return memory._replace(waiting=waiting, told=told), told

    def _measured(self, memory: Memory, time_s: float, own: State, traffic: Traffic) -> Memory:
        """The memory with one measurement more on its way."""
        options, random, tracks = self._with, memory.context.random, traffic.tracks
        errors, common, even = random.normal(size=(len(tracks), 8)), random.normal(size=9), random.random(len(tracks) + DRAWN)
        own_error = self._own_error(memory, common)
        memory = memory._replace(own_error=own_error)
        lost_until, here, body = dict(memory.lost_until_s), own[:3], enu_from_body(own.bank, own.pitch, own.heading)
        lost_share = -math.expm1(-options.dropouts_per_s / memory.hz)
        lost = even[: len(tracks)] < lost_share
        for k in np.flatnonzero(lost).tolist():
            lost_until[tracks[k].name] = max(lost_until.get(tracks[k].name, 0.0), time_s + options.dropout_lasts_s)
        if memory.lookout is None or memory.lookout.traffic is not traffic:
            reach_m = [self.reach_m(memory.context.range_m, track.radius_m, options.range_to) for track in tracks]
            memory = memory._replace(lookout=Lookout(traffic, reach_m))
        assert memory.lookout is not None
        found: list[Seen] = []
        for k, track, moving in memory.lookout.look(time_s, here):
            if lost[k] or time_s < lost_until.get(track.name, 0.0):
                continue
            if self._in_sight(sub(moving[0], here), track.radius_m, body, memory.context.range_m):
                found.append(self._told(Seen(track.name, track.radius_m, *moving, time_s), here, errors[k].tolist(), own_error))
        memory = self._haunted(memory, time_s, here, body, even[len(tracks) :])
        for one in memory.phantoms:
            seen = one.at(time_s)
            if self._in_sight(sub(seen.pos, here), seen.radius_m, body, memory.context.range_m):
                found.append(seen._replace(covariance=self._covariance(sub(seen.pos, here))))
        return memory._replace(lost_until_s=lost_until, waiting=(*memory.waiting, (time_s, tuple(found))))

    def _own_error(self, memory: Memory, common: Array) -> Array:
        """The errors of the own state a measurement later."""
        if memory.own_error is None:
            return common
        kept = math.exp(-1.0 / (memory.hz * self._with.own_correlation_s))
        return kept * memory.own_error + math.sqrt(1.0 - kept * kept) * common

    def _haunted(self, memory: Memory, time_s: float, here: Vec3, body: Array, even: Array) -> Memory:
        """The memory with the phantoms of now."""
        options = self._with
        there = tuple(one for one in memory.phantoms if time_s < one.until_s)
        if even[0] < -math.expm1(-options.false_tracks_per_s / memory.hz):
            reach_m = self.reach_m(memory.context.range_m, options.false_radius_m, options.range_to)
            size, until_s = (options.false_radius_m, options.false_speed_mps, reach_m), time_s + options.false_lasts_s
            there += (phantom(memory.born + 1, time_s, until_s, size, (here, body), self._half_fields, even[1:]),)
            memory = memory._replace(born=memory.born + 1)
        return memory._replace(phantoms=there)

    def _in_sight(self, way: Vec3, radius_m: float, body: Array, range_m: float) -> bool:
        """``way`` leads to the centre; ``body`` turns body axes into ENU."""
        if norm(way) > self.reach_m(range_m, radius_m, self._with.range_to):
            return False
        if self._all_round:
            return True
        ahead, right, down = (np.asarray(way) @ body).tolist()
        azimuth, elevation = math.atan2(right, ahead), math.atan2(-down, math.hypot(ahead, right))
        return abs(azimuth) <= self._half_fields[0] and abs(elevation) <= self._half_fields[1]

    def _told(self, true: Seen, here: Vec3, error: Sequence[float], own_error: Array) -> Seen:
        """An obstacle as it is measured."""
        options, way = self._with, sub(true.pos, here)
        px, py, pz, vx, vy, vz, tx, ty, tz = (self._own_sizes * own_error).tolist()
        side, above = _across(way)
        bent = options.bearing_noise_deg * DEG * norm(way)
        turned = add(way, cross((tx, ty, tz), way))
        way = add(turned, combine(bent * error[6], side, bent * error[7], above))
        way = add(along(way, options.position_noise_m, (error[0], error[1], error[2])), (px, py, pz))
        velocity = add(along(true.vel, self._velocity_mps, (error[3], error[4], error[5])), (vx, vy, vz))
        if options.velocity_noise_mps == "unmeasured":
            velocity = (0.0, 0.0, 0.0)
        return true._replace(pos=add(here, way), vel=velocity, covariance=self._covariance(way))

    def _covariance(self, way: Vec3) -> Covariance:
        """Of a measurement in that direction, at that distance: along and across it the position's differ."""
        position, angle, velocity = self._variances
        square = sum(v * v for v in way)
        rows = [(*(position * (i == j) + angle * (square * (i == j) - way[i] * way[j]) for j in range(3)), 0.0, 0.0, 0.0) for i in range(3)]
        return (*rows, *((0.0, 0.0, 0.0, *(velocity if i == j else 0.0 for j in range(3))) for i in range(3)))


def _across(way: Vec3) -> tuple[Vec3, Vec3]:
    """Unit vectors across a direction: to the left and level, and above; for straight up or none, of the direction east."""
    x, y, _ = way
    flat = math.hypot(x, y)
    if flat <= 1e-9 * norm(way):
        return (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)
    side = (-y / flat, x / flat, 0.0)
    return side, cross(unit(way), side)
