"""What is measured of one flight, each thing once and only when a column asks for it."""

import math
from functools import cached_property
from typing import NamedTuple

import numpy as np

from testbed.core.units import DEG
from testbed.flight.record import AVOIDING, FlightRecord, ReplanEvent, kept_clear
from testbed.results import quantities
from testbed.results.avoidance import Avoidance, avoidance, followed_clearance
from testbed.results.quantities import Closest, extreme, root_mean_square
from vosc import Obstacle, Own, threat

Array = np.ndarray
NAN = math.nan


class Encounter(NamedTuple):
    """Two straight lines at an instant; NaN without an obstacle."""

    radius_m: float = NAN
    speed_mps: float = NAN  # of the obstacle, over the ground
    closing_mps: float = NAN
    miss_m: float = NAN
    crossing_deg: float = NAN


class Measured:
    """A record and what follows from it. Rows past the goal's plane do not count."""

    def __init__(self, record: FlightRecord) -> None:
        self.record = record
        self.end, self.share = quantities.goal_crossing(record)
        self.flown = slice(0, self.end + 1)
        self.n = len(record.columns["time_s"][self.flown])

    def of(self, signal: str) -> Array:
        """A signal on this side of the goal's plane."""
        return self.record.columns[signal][self.flown]

    def most(self, signal: str) -> float:
        """Its largest finite value."""
        return extreme(np.max, self.of(signal))

    def least(self, signal: str) -> float:
        """Its least finite value."""
        return extreme(np.min, self.of(signal))

    def rms(self, signal: str) -> float:
        """Its root mean square."""
        return root_mean_square(self.of(signal))

    @cached_property
    def approach(self) -> Closest:
        return quantities.closest_approach(self.record)

    @property
    def kept_clear(self) -> bool | None:
        return kept_clear(self.approach.clearance_m)

    @cached_property
    def avoidance(self) -> Avoidance:
        return avoidance(self.record, self.end)

    @property
    def replans(self) -> int:
        return sum(event.decision in AVOIDING for event in self.record.events)

    @property
    def first_decision(self) -> ReplanEvent | None:
        return self.record.events[0] if self.record.events else None

    @property
    def trigger_s(self) -> float:
        return self.first_decision.time_s if self.first_decision else NAN

    @property
    def route_miss_m(self) -> float:
        return self.first_decision.route_miss_m if self.first_decision else NAN

    @property
    def deflection_deg(self) -> float:
        first = next((event for event in self.record.events if event.decision in AVOIDING), None)
        return first.deflection_rad / DEG if first else NAN

    @property
    def length_m(self) -> float:
        return quantities.flown_length(self.record, self.end, self.share)

    @property
    def time_s(self) -> float:
        return (self.end + self.share) / self.record.plan.rates.plant_hz if self.n else NAN

    @property
    def begin_s_m(self) -> float:
        return float(self.record.columns["guidance.s_m"][0]) if self.n else NAN

    @property
    def schedule_error_s(self) -> float:
        return quantities.schedule_error(self.record, self.approach.time_s, self.end + self.share)

    @property
    def bank_deg(self) -> float:
        return extreme(np.max, np.abs(self.of("own.bank_rad"))) / DEG

    @property
    def alpha_deg(self) -> float:
        return self.most("own.alpha_rad") / DEG

    @property
    def roll_rate_dps(self) -> float:
        """Of the body; of a point, what its path demands."""
        rate = self.of("own.rates_body_radps")[:, 0]
        if np.isnan(rate).all():
            rate = quantities.demanded_roll_rate(self.record)[self.flown]
        return extreme(np.max, np.abs(rate)) / DEG

    @property
    def airspeed_error_mps(self) -> float:
        return root_mean_square(self.of("own.airspeed_mps") - self.record.plan.speed_mps)

    @property
    def saturated_share(self) -> float:
        return float(np.mean(self.of("guidance.saturated"))) if self.n else NAN

    @property
    def limits_hit(self) -> str:
        return quantities.limits_hit(self.record, self.flown)

    @property
    def wind_along_std_mps(self) -> float:
        return quantities.wind_along_std(self.record, self.flown)

    @property
    def planned_length_m(self) -> float:
        return self.record.paths[-1].length_m if self.record.paths else NAN

    @property
    def planned_radius_m(self) -> float:
        curvature = self.record.paths[-1].chain.max_curvature() if self.record.paths else 0.0
        return 1.0 / curvature if curvature > 0.0 else NAN

    @cached_property
    def planned_clearance_m(self) -> float:
        return quantities.planned_clearance(self.record)

    @cached_property
    def followed_clearance_m(self) -> float:
        return followed_clearance(self.record)

    @cached_property
    def encounter(self) -> Encounter:
        """With the obstacle of the first decision, then; where nothing was decided with the nearest one, at the start of the flight."""
        record, first = self.record, self.first_decision
        radii = {spec.name: spec.radius_m for spec in record.plan.obstacles}
        met, row = self.approach.obstacle, 0
        if first is not None and first.obstacle in radii:
            met, row = first.obstacle, round(first.time_s * record.plan.rates.plant_hz)
        if met not in radii or not row < len(record.columns["time_s"]):
            return Encounter()
        signals = ("own.pos_enu_m", "own.vel_enu_mps", f"obstacle.{met}.pos_enu_m", f"obstacle.{met}.vel_enu_mps")
        own_pos, own_vel, pos, vel = (record.columns[signal][row] for signal in signals)
        return encounter(own_pos, own_vel, pos, vel, radii[met])


def encounter(own_pos: Array, own_vel: Array, pos: Array, vel: Array, radius_m: float) -> Encounter:
    """Of two straight lines, ENU (3,). Closing and crossing are NaN where a direction does not exist."""
    if not all(np.isfinite(vector).all() for vector in (own_pos, own_vel, pos, vel)):
        return Encounter()
    met = threat(Own(tuple(own_pos), tuple(own_vel)), Obstacle(tuple(pos), tuple(vel), radius_m))
    speed = float(np.linalg.norm(vel))
    across = float(np.linalg.norm(np.cross(own_vel, vel)))
    return Encounter(
        radius_m=radius_m,
        speed_mps=speed,
        closing_mps=float((pos - own_pos) @ (own_vel - vel)) / met.distance_m if met.distance_m > 0.0 else NAN,
        miss_m=met.miss_m,
        crossing_deg=math.atan2(across, float(own_vel @ vel)) / DEG if speed > 0.0 and own_vel.any() else NAN,
    )
