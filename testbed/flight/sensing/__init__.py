"""What of the truth a planner sees. A sensor is a file here and a line in ``SENSORS``."""

SENSORS = {"truth": "testbed.flight.sensing.truth:detect"}
