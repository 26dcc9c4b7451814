"""How large an aircraft is, by its model's file."""

import math
from functools import cache
from pathlib import Path

from testbed.core.model_files import model_path, read_xml
from testbed.core.model_files import wing_span_m as span_in_file
from testbed.flight.plants.aircraft import load_aircraft

UNKNOWN_M = 2.0  # of an aircraft whose model does not say


def wing_span_m(name: str) -> float:
    """From tip to tip."""
    aircraft = load_aircraft(name)
    return _span(model_path(aircraft.model.files, aircraft.model.name, aircraft.folder))


@cache
def _span(file: Path) -> float:
    found = span_in_file(read_xml(file))
    return found if math.isfinite(found) and found > 0.0 else UNKNOWN_M
