"""How much a campaign may take: of time, of memory, of flights. Checked before anything is allocated or flown."""

from typing import Annotated

from pydantic import Field

from testbed.core.section import ADay, Between, Duration, Number, Section, Whole

ROW_BYTES = 1400
OBSTACLE_BYTES = 60
"""Of the log of a flight for each tick of its plant, and for each obstacle then: measured, while it is flown and measured."""


class Limits(Section):
    """What one flight, and the campaign as a whole, may take. A flight that takes longer is ended, and its row says which limit it was."""

    flight_s: Duration = 3600.0
    """Longest flight, s of its own time: it is `timed_out` then, as it is after three times its planned time."""
    log_mb: Annotated[Number, Between("that holds no flight", least=10.0), Between("that is no limit", most=100_000.0)] = 350.0
    """Memory for one flight, MB: a row a tick, longer with each obstacle. A flight with a row too many for it is `timed_out`."""
    wall_limit_s: Annotated[Number, Field(gt=0), Between("no flight is that quick", least=0.1), ADay] = 300.0
    """Longest that one flight may keep its worker, s of the clock on the wall: one that hangs is ended, and is a `crashed` row."""
    flights: Annotated[Whole, Field(ge=1, le=10_000_000)] = 1_000_000
    """Most flights of the campaign: cells times replicates. A campaign with more is refused before any of them is made."""

    def of_a_flight(self) -> tuple[float, float]:
        """Those that a flight depends on; the others change nothing that is flown."""
        return self.flight_s, self.log_mb


def most_ticks(limits: Limits, obstacles: int) -> int:
    """How many rows of a flight with so many obstacles fit into its memory."""
    return int(limits.log_mb * 1e6 / (ROW_BYTES + OBSTACLE_BYTES * obstacles))


def longest_flight(limits: Limits, obstacles: int, plant_hz: int) -> tuple[float, str]:
    """Seconds that a flight may take whatever its plan, and the name of the limit that says so."""
    by_memory = most_ticks(limits, obstacles) / plant_hz
    return (limits.flight_s, "limits.flight_s") if limits.flight_s <= by_memory else (by_memory, "limits.log_mb")
