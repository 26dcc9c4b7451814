"""What of the truth a planner sees. A sensor is a file here and a line in ``SENSORS``."""

from testbed.flight.sensing.base import Seen, Sensor, SensorContext

__all__ = ["SENSORS", "Seen", "Sensor", "SensorContext"]

SENSORS = {
    "truth": "testbed.flight.sensing.truth:Truth",
    "imperfect": "testbed.flight.sensing.imperfect:Imperfect",
}
