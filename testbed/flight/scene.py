"""The stage of a flight: route, where it begins, and every obstacle's track, in the frame that is flown."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from testbed.campaign.words.limits import longest_flight
from testbed.campaign.words.obstacles import ObstacleSpec
from testbed.campaign.words.route import LONGEST_ROUTE_M
from testbed.campaign.words.settings import FlightPlan
from testbed.core import registry
from testbed.core.chain import Chain
from testbed.core.frames import Vec3, unit_from_direction, vec3
from testbed.core.kept import Kept
from testbed.core.seeds import stream
from testbed.core.units import DEG
from testbed.flight.air import CALM, AirModel, Wind, make_air, make_wind
from testbed.flight.impossible import NoMeetingError, NoRouteError
from testbed.flight.route.courses import Ends, draws, route_pieces
from testbed.flight.route.path import ActivePath
from testbed.flight.traffic import TRACKS
from testbed.flight.traffic.schedule import Schedule, anchored, planned_time, wind_key
from testbed.flight.traffic.straight import shifted
from testbed.flight.traffic.track import NOWHERE, Frame, Present, Track, TrackSetting, Traffic
from vosc import Degenerate, ph
from vosc.ph_curve import CUSP

Array = np.ndarray
TIME_OUT = 3.0  # times the planned time


@dataclass(frozen=True)
class Scene:
    """What the plan describes, in numbers: ``begin_s_m`` is the arc length of the route at which the flight starts."""

    route: Chain
    path: ActivePath  # the same, for guidance
    begin_s_m: float
    planned_time_s: float  # from the start to the goal
    traffic: Traffic
    goal: Vec3
    goal_tangent: Vec3
    air: AirModel
    longest_s: float  # a flight that takes longer has timed out
    limit: str = ""  # the setting that makes it so short; empty: it is ``TIME_OUT`` times the planned time

    @property
    def tracks(self) -> tuple[Track, ...]:
        """Of the obstacles, in the plan's order."""
        return self.traffic.tracks


class _Laid(NamedTuple):
    """A route in the frame that is flown, and what brought it there."""

    route: Chain
    path: ActivePath
    frame: Frame


class _Stage(NamedTuple):
    """A scene without its air, which is another for every seed."""

    laid: _Laid
    begin_s_m: float
    planned_time_s: float
    traffic: Traffic


MOST_M = 1e5  # so long are all routes together that are kept; guidance's table takes some 0.4 kB a metre
_laid: Kept[_Laid] = Kept(MOST_M, lambda laid: laid.route.length_m)
_stages: Kept[_Stage] = Kept(MOST_M, lambda stage: stage.laid.route.length_m)
_schedules: Kept[Schedule] = Kept(16)


def make_scene(plan: FlightPlan) -> Scene:
    """Route, start and traffic of a plan. Raises ``ImpossibleError`` when its route or its encounter cannot be."""
    (route, path, _), begin_s, planned, traffic = _stage(plan)
    goal, goal_tangent, _ = route.frame(route.length_m)
    longest, limit = longest_flight(plan.limits, len(plan.obstacles), plan.rates.plant_hz)
    if TIME_OUT * planned <= longest:
        longest, limit = TIME_OUT * planned, ""
    frame = lambda s_m: route.frame(s_m)[:2]  # noqa: E731
    return Scene(route, path, begin_s, planned, traffic, goal, goal_tangent, make_air(plan, frame, begin_s, longest), longest, limit)


def _stage(plan: FlightPlan) -> _Stage:
    """What many flights of a sweep share is made once; not with tracks of somebody's own, which may remember what they were asked."""

    def make() -> _Stage:
        laid = _laid.get(_key(plan, "route", "geometry"), lambda: _lay(plan))
        begin_s = _begin(plan, laid.route)
        wind = make_wind(plan.air, plan.terrain_z_m)
        planned = planned_time(laid.route, begin_s, laid.route.length_m, plan, wind)
        if not math.isfinite(planned):
            raise NoRouteError(f"the wind is too strong for it: somewhere it is no slower than the {plan.speed_mps:g} m/s that are held")
        return _Stage(laid, begin_s, planned, Traffic(_tracks(plan, laid, begin_s, planned, wind)))

    if any(spec.kind not in TRACKS for spec in plan.obstacles):
        return make()
    return _stages.get(_key(plan, "route", "geometry", "begin", "obstacles", "plugins", "traffic", *FLOWN), make)


FLOWN = ("speed_mps", "speed_hold", "terrain_z_m")  # with the mean wind: how fast the plan moves along its route


def _key(plan: FlightPlan, *names: str) -> tuple[object, ...]:
    """Those settings of a plan, and what its route is drawn with; as text, in which 0 and -0 differ."""
    include: dict[str, object] = dict.fromkeys(names, True)
    if "speed_mps" in names:
        include["air"] = {"wind"}
    drawn = (plan.seed, plan.replicate) if draws(plan.route) else ()
    return (plan.model_dump_json(include=include), *drawn)  # type: ignore[arg-type]


def _lay(plan: FlightPlan) -> _Laid:
    pieces = route_pieces(plan)
    start, first, last = pieces[0][0], pieces[0][1], pieces[-1][3]
    turn = level_rotation(first, last) if plan.geometry == "level" else np.eye(3)
    frame = Frame(np.asarray(start), turn)
    route = _chain([(frame.place(p0), turn @ d0, frame.place(p1), turn @ d1) for p0, d0, p1, d1 in pieces])
    return _Laid(route, ActivePath(route.curves), frame)


def _chain(pieces: Sequence[Ends]) -> Chain:
    """The route of these pieces. Raises ``NoRouteError`` where there is no such curve, or none that can be flown along."""
    try:
        route = Chain([ph.hermite(*ends) for ends in pieces])
    except Degenerate as error:
        raise NoRouteError(str(error)) from error
    if not route.length_m <= LONGEST_ROUTE_M:
        raise NoRouteError(f"it is {route.length_m / 1000.0:,.0f} km long; at most {LONGEST_ROUTE_M / 1000.0:g} km")
    if not min(curve.min_speed for curve in route.curves) >= CUSP:
        raise NoRouteError("it has a cusp, where it turns on the spot: its ends lie against their directions")
    return route


def _tracks(plan: FlightPlan, laid: _Laid, begin_s: float, planned_s: float, wind: Wind) -> tuple[Track, ...]:
    """The obstacles, in the wind as ``traffic.in_wind`` says. An anchored one is where it is printed in calm air only."""
    anchor = plan.traffic.in_wind == "anchored"
    in_wind, in_calm = (_schedule(plan, laid.route, begin_s, air) if anchor else None for air in (wind, CALM.mean))
    tracks = []
    for spec in plan.obstacles:
        setting = _setting(plan, spec, laid, begin_s, CALM.mean if anchor else wind)._replace(until_s=TIME_OUT * planned_s)
        track: Track = registry.part("traffic", spec.kind, plan.plugins)(setting, **spec.options)
        if plan.traffic.in_wind == "drifts":
            track = _drifting(track, setting, wind)
        track = anchored(track, in_calm, in_wind) if in_calm and in_wind else track
        if spec.appears_at_s is not None or spec.leaves_at_s is not None:
            track = Present(track, spec.appears_at_s, spec.leaves_at_s)
        tracks.append(track)
    return tuple(tracks)


def _setting(plan: FlightPlan, spec: ObstacleSpec, laid: _Laid, begin_s: float, timing_wind: Wind) -> TrackSetting:
    """What an obstacle's track is made with."""
    route, frame = laid.route, laid.frame
    if spec.when.own_reaches_enu_m is None:
        when = spec.when.time_s or 0.0
    else:
        reached = float(route.nearest(frame.place(spec.when.own_reaches_enu_m)[None])[0][0])
        when = planned_time(route, begin_s, reached, plan, timing_wind)
        if not math.isfinite(when):
            raise NoMeetingError(f"obstacles.{spec.name}.when: the wind is too strong to get there")
    position = NOWHERE if spec.position_enu_m is None else vec3(frame.place(spec.position_enu_m))
    velocity = NOWHERE
    if spec.speed_mps is not None and spec.direction_deg is not None:
        velocity = vec3(spec.speed_mps * frame.turn @ np.array(unit_from_direction(*spec.direction_deg)))
    random = stream(plan.seed, plan.replicate, f"traffic.{spec.name}")
    return TrackSetting(spec.name, spec.radius_m, position, velocity, when, random, spec.speed_mps or 0.0, frame, files=plan.plugins)


def _drifting(track: Track, setting: TrackSetting, wind: Wind) -> Track:
    """The track carried by the wind from its place at ``when`` on: the one that the campaign says, else the track's own."""
    position, velocity, when = setting.pos, setting.vel, setting.time_s
    if math.isnan(position[0]) or math.isnan(velocity[0]):
        if (there := track.at(when)) is None:
            raise NoMeetingError(f"obstacle {track.name} is not there at {when:.2f} s, when the wind is to take hold of it")
        position, velocity = there
    return shifted(track, when, np.array(position), np.array(velocity) + wind(when, position))


def _schedule(plan: FlightPlan, route: Chain, begin_s: float, wind: Wind) -> Schedule:
    """Of the plan in that wind, or in calm air."""
    key = (route, begin_s, wind is CALM.mean, wind_key(plan))
    return _schedules.get(key, lambda: Schedule(route, begin_s, plan, wind))


def level_rotation(first: Array, last: Array) -> Array:
    """The least rotation (3,3) that makes two directions horizontal: the normal of their plane is turned upright.

    For parallel directions the plane is the one that holds them and the horizontal across them.
    """
    first, last = (v / np.linalg.norm(v) for v in (first, last))
    normal = np.cross(first, last)
    if np.linalg.norm(normal) < 1e-9:
        across = np.array([-first[1], first[0], 0.0])
        normal = np.cross(first, across if np.linalg.norm(across) > 1e-9 else np.array([1.0, 0.0, 0.0]))
    normal = normal / np.linalg.norm(normal) * (1.0 if normal[2] >= 0.0 else -1.0)
    axis, cos = np.cross(normal, [0.0, 0.0, 1.0]), normal[2]
    skew = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    return np.eye(3) + skew + skew @ skew / (1.0 + cos)


def _begin(plan: FlightPlan, route: Chain) -> float:
    if plan.begin.at_route_s_m is not None:
        if plan.begin.at_route_s_m >= route.length_m:
            raise NoRouteError(f"begin.at_route_s_m {plan.begin.at_route_s_m:g} is past the end of the route ({route.length_m:.1f} m)")
        return plan.begin.at_route_s_m
    limit = np.sin((plan.begin.climb_at_most_deg or 0.0) * DEG)
    s = np.linspace(0.0, route.length_m, 4001)
    climb = route.sample(s)[1][:, 2]
    below = np.flatnonzero(climb <= limit)
    if not len(below):
        raise NoRouteError(f"begin.climb_at_most_deg {plan.begin.climb_at_most_deg:g}: the route climbs more everywhere")
    k = int(below[0])
    if k == 0:
        return 0.0
    share = (climb[k - 1] - limit) / (climb[k - 1] - climb[k])
    return float(s[k - 1] + share * (s[k] - s[k - 1]))
