"""What comes out of a flight: outcome, record, re-plans. Frozen values; arrays are never written to again."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from testbed.campaign.words.settings import FlightPlan
from testbed.core.chain import Chain
from testbed.core.frames import Vec3
from testbed.flight.record.outcome import Decision, Outcome
from testbed.flight.record.signals import flat, units_of
from vosc import ph

if TYPE_CHECKING:
    import pandas as pd

Array = np.ndarray


@dataclass(frozen=True)
class PlannedPath:
    """A path that guidance was told to follow, from ``from_time_s`` on: PH pieces joined end to end."""

    from_time_s: float
    chain: Chain

    @property
    def curves(self) -> tuple[ph.Curve, ...]:
        return self.chain.curves

    @property
    def length_m(self) -> float:
        return self.chain.length_m


@dataclass(frozen=True)
class ReplanEvent:
    """One decision of the planner, with its inputs and its result. Vectors are ENU; unknown quantities are NaN."""

    time_s: float
    obstacle: str
    decision: Decision
    method: str
    status: str  # of the method, a ``Status``, or the ``PathFault`` of its path; the decision where a law or somebody's planner made it
    own_pos_enu_m: Vec3
    own_vel_enu_mps: Vec3
    obstacle_pos_enu_m: Vec3
    obstacle_vel_enu_mps: Vec3
    radius_m: float  # as the planner takes it to be
    alpha_rad: float  # angle of the relative velocity from the line of sight (section 2, step 2)
    alpha0_rad: float  # half-angle of the collision cone (section 2, step 1)
    time_to_cpa_s: float
    miss_m: float  # least distance of the straight lines to the centre (the paper's threat test)
    route_miss_m: float  # least distance to a threat's centre along the path of that moment (rejoined: along the way back)
    cap_radius_mps: float  # G = (r, psi_r, theta_r, gamma), eq. 24-28
    cap_azimuth_rad: float
    cap_elevation_rad: float
    cap_half_angle_rad: float
    command_enu_mps: Vec3  # the avoidance velocity
    deflection_rad: float
    margin_rad: float
    insertion_enu_m: Vec3  # Q_avo, eq. 34-35; NaN where the direction is flown at once
    insertion_time_s: float  # after time_s
    max_curvature_to_insertion_1pm: float
    max_curvature_to_goal_1pm: float
    planned_length_m: float  # of the new path
    wind_known_enu_mps: Vec3 = (0.0, 0.0, 0.0)  # what the planner took for the wind; cap, command's size, deflection and insertion
    # rule are those of the velocities less this wind, while the velocities here are over the ground
    path_clearance_m: float = math.nan  # least clearance from all in sight along the new path, flown at the present ground speed
    reason: str = ""  # why there is no path, in words, where the planner says
    path_turns_rad: float = math.nan  # greatest angle of the new path, up to the insertion point, from the present velocity


@dataclass(frozen=True)
class FlightRecord:
    """Everything that happened. ``columns``: the signals that ``testbed.flight.record.signals`` declares, one row per plant tick."""

    plan: FlightPlan
    outcome: Outcome
    columns: Mapping[str, Array]
    events: tuple[ReplanEvent, ...]
    paths: tuple[PlannedPath, ...]
    message: str = ""  # one sentence about an outcome that is not REACHED
    longest_s: float = math.inf  # how long the flight was allowed to take
    timings: tuple[tuple[str, float], ...] = ()  # wall-clock seconds per stage; not part of the result

    def frame(self) -> "pd.DataFrame":
        """The signals as a table, a row a plant tick, vectors by their parts; ``frame.attrs["units"]`` has the unit of each column."""
        import pandas as pd

        frame = pd.DataFrame(flat(self.columns))
        frame.attrs |= {"flight_id": self.plan.flight_id, "units": units_of(self.columns)}
        return frame
