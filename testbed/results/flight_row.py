"""What a row says of its flight. A row is what ``rows.jsonl`` holds: identity, metrics, labels, decisions."""

import math
from collections.abc import Mapping
from typing import Any

from testbed.flight.record import inside, kept_and_flew_on

Row = Mapping[str, Any]


def value(row: Row | None, name: str) -> float:
    """A number of a row; NaN if it is missing, whichever way that is written."""
    found = None if row is None else row.get(name)
    return math.nan if found is None else float(found)


def collided(row: Row) -> bool:
    """Did the flight come inside of an obstacle?"""
    return bool(inside(value(row, "least_clearance_m")))


def met_obstacle(row: Row) -> bool:
    """Was there an obstacle to come close to?"""
    return math.isfinite(value(row, "least_clearance_m"))


def keeps(row: Row) -> bool:
    """Did the flight keep every radius to its end? One that hit the ground or left its model's envelope did not."""
    return kept_and_flew_on(str(row.get("outcome")), value(row, "least_clearance_m"))
