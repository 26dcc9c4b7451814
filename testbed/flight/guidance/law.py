"""The guidance's side of the loop: what a law is told once (``GuidanceSetting``), what it must do (``Law``), what it leaves in the log."""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

from testbed.flight.plants.aircraft import Aircraft
from testbed.flight.plants.base import Command, State
from testbed.flight.route.path import Path

CATCH_UP_1PS = 0.5  # airspeed added per metre behind the schedule ...
CATCH_UP_SHARE = 0.06  # ... up to this share of the set speed

BANK_LIMITED, LIFT_LIMITED = 1.0, 2.0
STANDSTILL_MPS = 1e-9  # a point that the wind holds up has no direction
VERTICAL = 1e-9  # a velocity with a smaller share over the ground points straight up or down


class Memory(NamedTuple):
    """Arc length of the last projection, where the schedule has the aircraft, and the integral of the error, left and up (m/s^2)."""

    s_m: float
    scheduled_s_m: float
    left: float = 0.0
    up: float = 0.0


class Telemetry(NamedTuple):
    """One row of the guidance log."""

    s_m: float
    bank_cmd: float
    load_factor_cmd: float
    limited: float  # which limits of the aircraft cut the command: BANK_LIMITED + LIFT_LIMITED, 0 for none


class Law(Protocol):
    """A guidance law. It sees the aircraft's state and the path by arc length, never the plant.

    Its memory may hold anything besides ``s_m``, the arc length of the path at which the aircraft is due at the next step.
    """

    def start(self, s_m: float) -> Memory:
        """Fresh memory for a path on which the aircraft stands at ``s_m``."""

    def step(self, memory: Memory, state: State, path: Path) -> tuple[Command, Memory, Telemetry]: ...


@dataclass(frozen=True, slots=True)
class SpeedHold:
    """Which speed is held, and whether time lost along the path is made up for."""

    speed_mps: float
    airspeed: bool  # true: the airspeed is held; false: the speed over the ground
    keep_schedule: bool

    def solve(self, airspeed_now: float, ground_speed: float, behind_m: float) -> tuple[float, float]:
        """The airspeed to fly, and the speed along the path that the schedule moves on with, m/s.

        In wind the schedule of an airspeed hold moves with the ground speed that the set airspeed would give just now.
        """
        drift = ground_speed - airspeed_now
        airspeed, scheduled = (self.speed_mps, self.speed_mps + drift) if self.airspeed else (self.speed_mps - drift, self.speed_mps)
        if self.keep_schedule:
            most = CATCH_UP_SHARE * self.speed_mps
            airspeed += max(-most, min(most, CATCH_UP_1PS * behind_m))
        return airspeed, scheduled


class GuidanceSetting(NamedTuple):
    """What a law is made with: the aircraft with its gains and limits, the speed to hold, and the time between two steps, s."""

    aircraft: Aircraft
    hold: SpeedHold
    dt_s: float
