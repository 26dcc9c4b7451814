"""One encounter of two straight lines, as a study draws it, and the flight that meets it with a given lead."""

import math
from dataclasses import dataclass

import numpy as np

from testbed.campaign.words.obstacles import ObstacleSpec, When
from testbed.campaign.words.population import MOST_DRAWS, OBSTACLE_NAME, draws, perpendicular
from testbed.campaign.words.settings import FlightPlan
from testbed.campaign.words.study import StudySpec
from testbed.core.frames import direction_deg, unit_from_direction, vec3
from testbed.studies.lead_time.options import LeadTime

Array = np.ndarray


@dataclass(frozen=True)
class Encounter:
    """Both fly straight on. ENU; ``miss_m`` (3,) from the obstacle's centre to the own aircraft at the closest approach, perpendicular
    to ``closing_mps`` (3,), the own velocity less the obstacle's. In a wind these are those over the ground (anchored).
    """

    miss_m: Array
    closing_mps: Array
    obstacle_vel_mps: Array
    radius_m: float

    @property
    def closing_speed_mps(self) -> float:
        return float(np.linalg.norm(self.closing_mps))

    @property
    def entry_s(self) -> float:
        """Time before the closest approach at which straight flight enters the sphere: no lead below it can do."""
        square = self.radius_m**2 - float(self.miss_m @ self.miss_m)
        return math.sqrt(max(0.0, square)) / self.closing_speed_mps

    def range_m(self, lead_s: float) -> float:
        """How far the obstacle's centre must be seen for that lead, at most: closing speed times lead, and the radius."""
        return self.closing_speed_mps * lead_s + self.radius_m


def drawn(plan: FlightPlan) -> Encounter:
    """The encounter of a plan's seed and replicate: nothing that is compared has a part in it. Raises ``ValueError`` if there is none."""
    study = LeadTime.of(plan)
    own = plan.speed_mps * np.array(unit_from_direction(*plan.route.start_direction_deg))
    for one in draws(plan.seed, plan.replicate, study.obstacle_speed_mps, study.radius_m):
        velocity = one.speed_mps * one.direction
        closing = own - velocity
        if np.linalg.norm(closing) > 0.0:
            encounter = Encounter(one.miss_m * perpendicular(closing, one.around_rad), closing, velocity, float(one.radius_m))
            if encounter.entry_s < study.leads_s[-1]:
                return encounter
    raise ValueError(f"none of {MOST_DRAWS:,} draws begins outside of the sphere at the longest lead")


def at_lead(plan: FlightPlan, encounter: Encounter, lead_s: float) -> FlightPlan:
    """The flight in which the planner meets the encounter that long before the closest approach.

    The horizon is half a look of the planner more than the lead, and a look falls on the lead exactly: in straight flight the look
    before it is too early by half a look, so the trigger hangs on no rounding.
    """
    at_s = LeadTime.of(plan).run_up_s + lead_s
    along = np.array(unit_from_direction(*plan.route.start_direction_deg))
    own = np.array(plan.route.start_enu_m) + ((plan.begin.at_route_s_m or 0.0) + plan.speed_mps * at_s) * along
    obstacle = ObstacleSpec(
        name=OBSTACLE_NAME,
        radius_m=encounter.radius_m,
        position_enu_m=vec3(own - encounter.miss_m),
        speed_mps=float(np.linalg.norm(encounter.obstacle_vel_mps)),
        direction_deg=direction_deg(vec3(encounter.obstacle_vel_mps)),
        when=When(time_s=at_s),
    )
    replan = plan.replan.model_copy(update={"horizon_s": lead_s + 0.5 / plan.rates.planner_hz})
    return plan.model_copy(update={"obstacles": (obstacle,), "replan": replan, "study": StudySpec()})
