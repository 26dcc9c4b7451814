"""Settings that are right one by one and impossible together: told before anything is flown, at the setting that has to give way.

Only what is certain is told here, from the route's ends, its closed form and a steady wind. What needs the flight's own geometry (a
sheared wind, a route that is turned level) is found when its scene is made, and is an outcome then.
"""

import math
from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from testbed.campaign.reading.aircraft import read_aircraft
from testbed.campaign.reading.document import Fault
from testbed.campaign.words.air import SteadyWind
from testbed.campaign.words.limits import longest_flight
from testbed.campaign.words.planning import PlannerSpec
from testbed.campaign.words.route import LONGEST_ROUTE_M, Random, Route
from testbed.campaign.words.settings import FlightPlan
from testbed.core import registry
from testbed.core.catalogue import aircraft_folders
from testbed.core.frames import ground_speed_along, unit_from_direction, wind_enu_from_compass
from testbed.core.units import DEG, G0_MPS2
from vosc import Degenerate, ph
from vosc.vec import norm

SAMPLES = 401
"""Places of a route at which a wind is held against its direction."""


def impossible(plan: FlightPlan) -> list[Fault]:
    """What keeps a plan from being flown whoever flies it, or its planner from ever doing anything."""
    curve = _curve(plan.route)
    if isinstance(curve, str):
        return [Fault(("route",), curve)]
    return [
        *_unseen(plan),
        *_unfit_sensor(plan),
        *_decides_itself(plan),
        *_begins(plan, curve),
        *_too_slow(plan, curve),
        *_behind(plan, curve),
    ]


@lru_cache(maxsize=512)
def _curve(route: Route) -> ph.Curve | str | None:
    """The curve between the route's ends; what is wrong with it; None for a shape."""
    if route.goal_enu_m is None or route.goal_direction_deg is None:
        return None
    size = route.magnitude_chords * math.dist(route.start_enu_m, route.goal_enu_m)
    ends = (route.start_direction_deg, route.goal_direction_deg)
    first, last = ([size * part for part in unit_from_direction(*direction)] for direction in ends)
    try:
        curve = ph.hermite(route.start_enu_m, first, route.goal_enu_m, last)
    except Degenerate as error:
        return f"no curve joins its ends: {error}"
    if not curve.length_m <= LONGEST_ROUTE_M:
        return f"it is {curve.length_m / 1000.0:,.0f} km long; at most {LONGEST_ROUTE_M / 1000.0:g} km"
    return curve


def unseen(plan: FlightPlan, radius_m: float) -> str:
    """Why the planner can never see a sphere before it is entered; empty if it can."""
    reach_m = plan.sensor.reach_m(radius_m) if plan.avoids_by != "none" else None
    if reach_m is None or radius_m < reach_m:
        return ""
    range_m = f"sensor.range_m {plan.sensor.range_m:g}, which is to the centre"
    return f"can never be seen before it is entered: radius_m {radius_m:g}, {range_m}"


def _unseen(plan: FlightPlan) -> Iterator[Fault]:
    for i, obstacle in enumerate(plan.obstacles):
        if why := unseen(plan, obstacle.radius_m):
            yield Fault(("obstacles", i, "radius_m"), f"'{obstacle.name}' {why}")


def _unfit_sensor(plan: FlightPlan) -> Iterator[Fault]:
    """Options of the sensor that do not go with the rates, or without a tracker."""
    amiss = getattr(registry.part("sensor", plan.sensor.kind), "amiss", None)
    for option, why in amiss(plan.sensor.options, plan.rates.planner_hz, plan.tracker.kind != "none") if amiss else ():
        yield Fault(("sensor", "options", option), why)


def _decides_itself(plan: FlightPlan) -> Iterator[Fault]:
    """Only one planner is told by the campaign when it is to decide anew; another would not listen."""
    if plan.replan.policy != "once" and plan.planner.kind != PlannerSpec().kind:
        yield Fault(
            ("replan", "policy"),
            f"{plan.replan.policy} is of planner.kind: {PlannerSpec().kind}; {plan.planner.kind} has its own rule when it decides anew",
        )


def _begins(plan: FlightPlan, curve: ph.Curve | None) -> Iterator[Fault]:
    """Where the flight begins: on the route, and above the ground."""
    at_m, shape = plan.begin.at_route_s_m, plan.route.shape
    length_m = curve.length_m if curve else None if shape is None or isinstance(shape, Random) else shape.length_m * 1.001
    if at_m is not None and length_m is not None and at_m >= length_m:
        yield Fault(("begin", "at_route_s_m"), f"{at_m:g} m is past the end of the route, which is {length_m:.1f} m long")
    elif at_m == 0.0 and (z_m := plan.route.start_enu_m[2]) <= plan.terrain_z_m:
        where = f"{plan.terrain_z_m - z_m:g} m under the ground" if z_m < plan.terrain_z_m else "on the ground"
        yield Fault(("route", "start_enu_m"), f"the flight begins {where}: terrain_z_m is {plan.terrain_z_m:g}")


def _too_slow(plan: FlightPlan, curve: ph.Curve | None) -> Iterator[Fault]:
    """A wind that holds the flight up, and a flight that takes longer than flights may take."""
    wind = plan.air.wind if plan.speed_hold == "airspeed" and isinstance(plan.air.wind, SteadyWind) else None
    fastest = plan.speed_mps + (wind.speed_mps if wind else 40.0 if plan.air.wind.kind != "calm" else 0.0)
    begin_m = plan.begin.at_route_s_m or 0.0
    length_m = curve.length_m if curve else 0.0 if plan.route.shape is None else getattr(plan.route.shape, "length_m", 0.0)
    planned_s = max(0.0, length_m - begin_m) / fastest
    longest_s, limit = longest_flight(plan.limits, len(plan.obstacles), plan.rates.plant_hz)
    if wind and wind.speed_mps < plan.speed_mps and length_m - begin_m <= longest_s * (plan.speed_mps - wind.speed_mps):
        return  # even against it all the way: most campaigns, and there is no need to look at the route
    if wind and curve and plan.geometry == "as_given" and plan.begin.at_route_s_m is not None:
        planned_s = _time_in_wind(plan.route, begin_m, plan.speed_mps, wind.speed_mps, wind.from_deg)
        if not math.isfinite(planned_s):
            what = f"the wind of {wind.speed_mps:g} m/s is too strong for an airspeed of {plan.speed_mps:g} m/s"
            yield Fault(("air", "wind", "speed_mps"), f"{what}: somewhere on the route the flight would stand still or go backwards")
            return
    if planned_s > longest_s:
        words = f"the route takes {planned_s:,.0f} s at {plan.speed_mps:g} m/s" + (" in this wind" if wind else "")
        most = f"{longest_s:,.0f}" if longest_s >= 10.0 else f"{longest_s:g}"
        yield Fault(("route",), f"{words}; a flight may take {most} s", f"{limit} sets that")


@lru_cache(maxsize=512)
def _time_in_wind(route: Route, begin_m: float, airspeed_mps: float, wind_mps: float, from_deg: float) -> float:
    """From a place of the route to its end, s; infinite if the wind is too strong somewhere. Most cells of a sweep share it."""
    curve, air = _curve(route), wind_enu_from_compass(wind_mps, from_deg)
    assert isinstance(curve, ph.Curve)
    s = np.linspace(begin_m, curve.length_m, SAMPLES)
    speeds = [ground_speed_along((x, y, z), airspeed_mps, air) for x, y, z in curve.sample(s)[1].tolist()]
    return float(np.trapezoid(1.0 / np.array(speeds), s)) if min(speeds) > 0.0 else math.inf


def _behind(plan: FlightPlan, curve: ph.Curve | None) -> Iterator[Fault]:
    """A goal behind the start, which an aircraft would have to turn to more tightly than it can. A point on rails turns on the spot."""
    if curve is None or plan.plant.kind == "kinematic" or plan.begin.at_route_s_m != 0.0:
        return
    tangent, (start, goal) = unit_from_direction(*plan.route.start_direction_deg), (plan.route.start_enu_m, plan.route.goal_enu_m)
    assert goal is not None
    if sum(t * (b - a) for t, a, b in zip(tangent, start, goal, strict=True)) >= 0.0:
        return
    limits, ideal = read_aircraft(aircraft_folders()[plan.aircraft]).limits, plan.plant.ideal
    by_bank = math.inf if "roll" in ideal else math.tan(min(limits.bank_deg, 89.0) * DEG)
    by_lift = math.inf if "load_factor" in ideal else math.sqrt(max(limits.load_factor_max**2 - 1.0, 1e-6))
    tightest_m = plan.speed_mps**2 / (G0_MPS2 * min(by_bank, by_lift))
    if curve.min_radius_m < tightest_m:
        bend = f"lies behind the start: the path to it has a bend of {curve.min_radius_m:.0f} m radius"
        turns = f"{plan.aircraft} turns no tighter than {tightest_m:.0f} m at {plan.speed_mps:g} m/s"
        yield Fault(("route", "goal_enu_m"), f"{bend}, and {turns}")


def start_airspeed(plan: FlightPlan) -> float | None:
    """Airspeed at the start of a flight that holds its speed over the ground in a steady wind; None where that is not known here."""
    wind = plan.air.wind
    known = (
        plan.speed_hold == "groundspeed" and isinstance(wind, SteadyWind) and plan.geometry == "as_given" and plan.begin.at_route_s_m == 0.0
    )
    if not known or not isinstance(wind, SteadyWind):
        return None
    tangent, (wx, wy, wz) = unit_from_direction(*plan.route.start_direction_deg), wind_enu_from_compass(wind.speed_mps, wind.from_deg)
    return norm((plan.speed_mps * tangent[0] - wx, plan.speed_mps * tangent[1] - wy, plan.speed_mps * tangent[2] - wz))
