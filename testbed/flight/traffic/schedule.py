"""What the plan without obstacles has the aircraft do: the point that keeps to its route and its speed in the mean wind.

Times of the plan come from it, and so do the obstacles of the *anchored* design, which keep the encounter of calm air in a wind.
"""

import numpy as np

from testbed.campaign.words.settings import FlightPlan
from testbed.core.chain import Chain
from testbed.core.frames import vec3
from testbed.flight.air import CALM, Wind
from testbed.flight.impossible import NoMeetingError
from testbed.flight.traffic.straight import shifted
from testbed.flight.traffic.track import Track

Array = np.ndarray
INTERVALS = 400  # of an integral over the route
FINE = 4000  # of the table that gives the place at a time


def planned_time(route: Chain, from_s_m: float, to_s_m: float, plan: FlightPlan, wind: Wind) -> float:
    """Seconds that the plan allows between two arc lengths, at the set speed in the wind (infinite where the wind is too strong)."""
    if keeps_speed(plan, wind):
        return (to_s_m - from_s_m) / plan.speed_mps
    s = np.linspace(from_s_m, to_s_m, INTERVALS + 1)
    return float(np.trapezoid(_slowness(ground_speeds(route, s, plan, wind)), s)) if to_s_m > from_s_m else 0.0


def _slowness(speed_mps: Array) -> Array:
    """Seconds per metre; infinite at a standstill."""
    return np.where(speed_mps > 0.0, 1.0 / np.where(speed_mps > 0.0, speed_mps, 1.0), np.inf)


def keeps_speed(plan: FlightPlan, wind: Wind) -> bool:
    """Is the speed over the ground the set speed everywhere?"""
    return plan.speed_hold == "groundspeed" or plan.air.wind.kind == "calm" or wind is CALM.mean


def ground_speeds(route: Chain, s_m: Array, plan: FlightPlan, wind: Wind) -> Array:
    """Speed over the ground (n,) at arc lengths (n,): the set airspeed in the mean wind of each place; 0 where the wind is too strong."""
    if keeps_speed(plan, wind):
        return np.full(len(s_m), plan.speed_mps)
    points, tangents, _ = route.sample(s_m)
    if plan.air.wind.kind == "steady":
        return _ground_speeds(tangents, plan.speed_mps, np.array(wind(0.0, vec3(points[0]))))
    return _ground_speeds(tangents, plan.speed_mps, np.array([wind(0.0, vec3(p)) for p in points]))


def _ground_speeds(tangents: Array, airspeed_mps: float, winds: Array) -> Array:
    """``ground_speed_along`` for tangents (n,3) and winds (n,3) or (3,)."""
    along = (tangents * winds).sum(axis=1)
    rest = airspeed_mps**2 - (winds * winds).sum(axis=-1) + along**2
    return np.where(rest > 0.0, np.maximum(along + np.sqrt(np.maximum(rest, 0.0)), 0.0), 0.0)


def arc_lengths(route: Chain, from_s_m: float, elapsed_s: Array, plan: FlightPlan, wind: Wind) -> Array:
    """Arc lengths (n,) after times (n,) from ``from_s_m`` on; past the end they grow at the set speed."""
    if keeps_speed(plan, wind):
        return from_s_m + plan.speed_mps * elapsed_s
    s = np.linspace(0.0, route.length_m, FINE + 1)
    slow = _slowness(ground_speeds(route, s, plan, wind))
    time_s = np.append(0.0, np.cumsum(0.5 * (slow[1:] + slow[:-1]) * np.diff(s)))
    due = np.interp(from_s_m, s, time_s) + elapsed_s
    return np.where(due <= time_s[-1], np.interp(due, time_s, s), s[-1] + plan.speed_mps * (due - time_s[-1]))


class Schedule:
    """Place and velocity of that point at any time of the plan. ``NoMeetingError`` when the wind holds it up."""

    def __init__(self, route: Chain, begin_s_m: float, plan: FlightPlan, wind: Wind) -> None:
        self._route, self._plan, self._wind = route, plan, wind
        self._s = np.linspace(begin_s_m, route.length_m, FINE + 1)
        slow = _slowness(ground_speeds(route, self._s, plan, wind))
        if not np.isfinite(slow).all():
            raise NoMeetingError("the wind is too strong for this route: no encounter can be anchored to it")
        self.time_s = np.concatenate([[0.0], np.cumsum(0.5 * (slow[1:] + slow[:-1]) * np.diff(self._s))])

    def points(self) -> Array:
        """Places (n,3) at ``time_s`` (n,)."""
        return self._route.points(self._s)

    def at(self, time_s: float) -> tuple[Array, Array]:
        """Position and velocity over the ground, ENU (3,) each."""
        s = np.array([np.interp(time_s, self.time_s, self._s)])
        points, tangents, _ = self._route.sample(s)
        return points[0], ground_speeds(self._route, s, self._plan, self._wind)[0] * tangents[0]

    def closest_time(self, track: Track) -> float:
        """When the point is nearest to an obstacle's centre: the vertex of the parabola through the three nearest samples.

        ``NoMeetingError`` when the obstacle is never there.
        """
        relative = track.sampled(self.time_s)[0] - self.points()
        square = np.einsum("ij,ij->i", relative, relative)
        if np.isnan(square).all():
            raise NoMeetingError(f"obstacle {track.name} is not there while the route is flown: it has no encounter to be anchored")
        k = int(np.nanargmin(square))
        if k in (0, FINE) or not np.isfinite(square[k - 1 : k + 2]).all():
            return float(self.time_s[k])
        a, b, c = np.polyfit(self.time_s[k - 1 : k + 2] - self.time_s[k], square[k - 1 : k + 2] - square[k], 2)
        return float(self.time_s[k] - b / (2.0 * a)) if a > 0.0 and np.isfinite(c) else float(self.time_s[k])


def anchored(track: Track, in_calm: Schedule, in_wind: Schedule) -> Track:
    """The obstacle that meets the plan in the wind as ``track`` meets it in calm air.

    At the calm closest approach of the flight without planner the obstacle is put where it has the same place relative to the
    aircraft (the miss vector) and is given the same velocity relative to it, both in ENU. Time, miss vector and closing speed of the
    closest approach are then the calm ones; the obstacle's own velocity is not as printed.
    """
    time = in_calm.closest_time(track)
    (own, own_vel), (there, vel_there) = in_calm.at(time), in_wind.at(time)
    if (met := track.at(time)) is None:
        raise NoMeetingError(f"obstacle {track.name} comes or goes at its closest approach: it has no encounter to be anchored")
    return shifted(track, time, np.asarray(met[0]) - own + there, np.asarray(met[1]) - own_vel + vel_there)
