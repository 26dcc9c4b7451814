"""From a record to one row of ``results.csv``. Nothing is flown here."""

from typing import Any

from testbed.flight.record import FlightRecord
from testbed.results.columns import METRICS, FlightMetrics
from testbed.results.measured import Measured


def measure(record: FlightRecord) -> FlightMetrics:
    """The metrics of a flight, as ``FlightMetrics`` names them; NaN where a quantity does not exist."""
    of = Measured(record)
    values: dict[str, Any] = {column.name: column.function(of) for column in METRICS if column.function is not None}
    return FlightMetrics(**values)
