"""What comes out of a flight."""

from testbed.flight.record.outcome import (
    ANSWERED,
    AVOIDING,
    LOST,
    NEW_PATH,
    TOUCH_M,
    Decision,
    Outcome,
    PathFault,
    inside,
    kept_and_flew_on,
    kept_clear,
)
from testbed.flight.record.record import FlightRecord, PlannedPath, ReplanEvent
from testbed.flight.record.reversals import reversals

__all__ = [
    "ANSWERED",
    "AVOIDING",
    "LOST",
    "NEW_PATH",
    "TOUCH_M",
    "Decision",
    "FlightRecord",
    "Outcome",
    "PathFault",
    "PlannedPath",
    "ReplanEvent",
    "inside",
    "kept_and_flew_on",
    "kept_clear",
    "reversals",
]
