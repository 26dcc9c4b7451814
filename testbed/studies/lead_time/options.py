"""The options of a lead-time study: instead of one flight, each cell and replicate is a search for the least lead that suffices."""

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Any

from pydantic import Field, field_validator

from testbed.campaign.words.settings import FlightPlan
from testbed.core.frames import unit_from_direction
from testbed.core.section import Between, Number, Positive, Radius, Section, TrafficSpeed

CLEAR_BY_S = 8.0
"""So long after the closest approach the route must still go on, s."""
STRAIGHT = 1e-9

MOST_S = 600.0
EveryOneFlies = Between("every flight of the search lasts as long", most=MOST_S)
Lead = Annotated[Positive, Between("no planner looks so often", least=0.001), EveryOneFlies]
Tolerance = Annotated[Positive, Between("rounding decides about less", least=1e-6), EveryOneFlies]
RunUp = Annotated[Number, Field(ge=0), EveryOneFlies]


class LeadTime(Section):
    """What is searched for, and in which encounters (``docs/lead_time.md``).

    The obstacle is drawn, one for each replicate, the same for every method, plant and aircraft: its speed even in its range, its
    direction even on the sphere, its radius R even in its range, the miss vector of the two straight lines perpendicular to the relative
    velocity and even in area on the disc of radius R. What would begin inside of the sphere at the longest lead is drawn again.
    """

    leads_s: Annotated[tuple[Lead, ...], Field(min_length=2, max_length=200)]
    """The grid of times from the trigger to the closest approach, growing, s. Every one of them is flown."""
    tolerance_s: Tolerance = 0.02
    """The least lead is then bisected until it is known this closely, s."""
    run_up_s: RunUp = 0.0
    """The flight begins this long before the trigger, s."""
    obstacle_speed_mps: tuple[TrafficSpeed, TrafficSpeed]
    """Least and largest speed of the obstacle, m/s."""
    radius_m: tuple[Radius, Radius]
    """Least and largest radius of the sphere, m."""

    @field_validator("leads_s")
    @classmethod
    def _grow(cls, leads_s: tuple[float, ...]) -> tuple[float, ...]:
        if any(after <= before for before, after in pairwise(leads_s)):
            raise ValueError("each lead must be more than the one before it")
        return leads_s

    @field_validator("obstacle_speed_mps", "radius_m")
    @classmethod
    def _low_to_high(cls, ends: tuple[float, float]) -> tuple[float, float]:
        if ends[0] > ends[1]:
            raise ValueError("the first is more than the second")
        return ends

    @staticmethod
    def of(plan: FlightPlan) -> "LeadTime":
        """Those of a plan."""
        return LeadTime.model_validate(plan.study.options)

    def unfit(self, settings: Mapping[str, Any]) -> str | None:
        """Why flights with these settings cannot be searched; None if they can. Settings that are faulty themselves are absent."""
        if settings.get("obstacles"):
            return "draws the obstacle itself: leave out obstacles"
        rates = settings.get("rates")
        if rates and abs((ticks := self.run_up_s * rates.planner_hz) - round(ticks)) > 1e-9:
            return f"needs run_up_s to be a whole number of looks of the planner, 1/{rates.planner_hz} s each"
        if any(settings.get(key) is None for key in ("speed_mps", "route", "sensor", "air", "traffic")):
            return None
        wind, speed = settings["air"].wind, settings["speed_mps"]
        farthest = (speed + self.obstacle_speed_mps[1]) * (self.leads_s[-1] + 1.0) + self.radius_m[1]
        if settings["sensor"].range_m < farthest:
            return f"needs sensor.range_m of {farthest:.0f} m at least, so that the lead alone decides when the planner answers"
        drift = wind.speed_mps if wind.kind == "steady" else 0.0
        length = (speed + drift) * (self.run_up_s + self.leads_s[-1] + CLEAR_BY_S)
        return _unfit_wind(wind, settings["traffic"]) or _unfit_route(settings["route"], length)


def _unfit_wind(wind: Any, traffic: Any) -> str | None:
    if wind.kind not in ("calm", "steady"):
        return "goes with calm air or a steady wind: open-loop manoeuvres are flown once and moved to every encounter"
    if wind.kind == "steady" and traffic.in_wind != "anchored":
        return "needs traffic.in_wind: anchored in a wind, so that leads mean the same in every wind"
    return None


def _unfit_route(route: Any, length_m: float) -> str | None:
    """The route must be a level straight line of that length."""
    if route.goal_enu_m is None:
        return "needs a straight level route: give goal_enu_m and goal_direction_deg"
    chord = tuple(b - a for a, b in zip(route.start_enu_m, route.goal_enu_m, strict=True))
    size = math.hypot(*chord)
    along = unit_from_direction(*route.start_direction_deg)
    ends = (unit_from_direction(*route.goal_direction_deg), tuple(c / size for c in chord))
    if abs(along[2]) > STRAIGHT or any(math.dist(along, other) > STRAIGHT for other in ends):
        return "needs a straight level route: both end directions along the line from start to goal, elevation 0"
    if size < length_m:
        return f"needs a route of {length_m:.0f} m at least"
    return None
