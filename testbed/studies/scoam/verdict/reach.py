"""What an aircraft has, and whether it can reach the pose that a re-plan asks for: the seam to the bound on the insertion pose."""

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Any, Protocol

from testbed.flight.plants.aircraft import Limits, load_aircraft
from testbed.flight.record import Decision, ReplanEvent
from testbed.studies.scoam.verdict.flights import Row, number


class Pose(Protocol):
    """What is used of a bound: metres; ``reachable`` within the limits by the widest curve."""

    @property
    def radius_m(self) -> float: ...
    @property
    def level_turn_radius_m(self) -> float: ...
    @property
    def steepest_radius_m(self) -> float: ...
    @property
    def reachable(self) -> bool: ...


Reach = Callable[[ReplanEvent, Limits], Pose | None]


@lru_cache(maxsize=32)
def limits_of(aircraft: str) -> Limits | None:
    """The limits of an aircraft of the catalogue; nothing for a name that it does not have."""
    try:
        return load_aircraft(aircraft).limits
    except KeyError:
        return None


@dataclass(frozen=True)
class Demand:
    """What a flight used against what its aircraft has; ratios to the limits, the three of them and the greatest."""

    bank: float
    load_factor: float
    roll_rate: float
    unloads: bool  # below the least load factor

    @property
    def most(self) -> float:
        return max(self.bank, self.load_factor, self.roll_rate)

    @property
    def within(self) -> bool:
        return self.most <= 1.0 and not self.unloads

    @property
    def worst(self) -> str:
        """The limit that is exceeded most."""
        named = {"roll": self.roll_rate, "bank": self.bank, "load factor": self.load_factor}
        return max(named, key=lambda name: named[name])


def demand(row: Row | None) -> Demand | None:
    """What the flight of the row used; nothing where a figure or the aircraft's limits are missing."""
    limits = None if row is None else limits_of(str(row.get("aircraft")))
    if limits is None:
        return None
    found = Demand(
        number(row, "max_bank_deg") / limits.bank_deg,
        number(row, "max_load_factor") / limits.load_factor_max,
        number(row, "max_roll_rate_dps") / limits.roll_rate_dps,
        number(row, "min_load_factor") < limits.load_factor_min,
    )
    return None if any(map(math.isnan, (found.bank, found.load_factor, found.roll_rate))) else found


def pose(row: Row | None, reach: Reach | None) -> Pose | None:
    """The bound for the first re-plan of the flight; nothing without a bound or a re-plan."""
    limits = None if row is None else limits_of(str(row.get("aircraft")))
    if row is None or reach is None or limits is None:
        return None
    event: dict[str, Any] | None = next((e for e in row.get("events", ()) if e["decision"] == Decision.REPLANNED), None)
    if event is None:
        return None
    known = {field.name for field in fields(ReplanEvent)}
    values: dict[str, Any] = {name: tuple(v) if isinstance(v, list) else v for name, v in event.items() if name in known}
    return reach(ReplanEvent(**values), limits)
