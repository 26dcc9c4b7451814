"""What ``tune`` puts into an aircraft.yaml, everything else in it kept."""

from collections.abc import Mapping
from io import StringIO
from typing import Any

from ruamel.yaml import YAML

from testbed.campaign.reading.aircraft import FILE
from testbed.flight.plants.aircraft import Aircraft

PLACEHOLDER, BY_TUNE = "# chosen: a placeholder until tune measures it", "# measured: by tune"  # marks of numbers in a new file


def changes(name: str, after: Aircraft) -> dict[str, Any]:
    """What the file is to say, by section."""
    sections = ("guidance", "autopilot", "point_mass")
    found: dict[str, Any] = {section: getattr(after, section).model_dump() for section in sections}
    found["limits"] = {
        key: getattr(after.limits, key) for key in ("speed_min_mps", "speed_max_mps", "roll_rate_dps", "alpha_max_1g_mps", "stall_mps")
    }
    return found | {"gains_found_by": f"testbed tune {name}"}


def write_gains(aircraft: Aircraft, changes: Mapping[str, Any]) -> None:
    """Put values into the aircraft's file; everything else in it, comments too, stays."""
    yaml = YAML()
    yaml.width = 200
    yaml.preserve_quotes = True
    file = aircraft.folder / FILE
    document = yaml.load(file.read_text(encoding="utf-8"))
    for key, value in changes.items():
        if isinstance(value, Mapping):
            document[key].update({name: _plain(number) for name, number in value.items()})
        elif value is None:
            document.pop(key, None)
        else:
            document[key] = value
    text = StringIO()
    yaml.dump(document, text)
    file.write_text(text.getvalue().replace(PLACEHOLDER, BY_TUNE), encoding="utf-8")


def _plain(number: float) -> float | int:
    """50 rather than 50.0."""
    return int(number) if float(number).is_integer() and abs(number) >= 10 else number
