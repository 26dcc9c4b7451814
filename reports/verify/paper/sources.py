"""What the verdict rests on beside the run itself: files of the repository that this package is part of."""

from functools import cache
from pathlib import Path

from ..run import BadInputError

ROOT = Path(__file__).resolve().parents[3]
AUDIT = ROOT / "reports" / "paper" / "audit.csv"


@cache
def limits_of(aircraft: str) -> dict[str, float]:
    """The section ``limits`` of an aircraft's YAML."""
    path = ROOT / "aircraft" / aircraft / "aircraft.yaml"
    try:
        section = path.read_text().split("\nlimits:", 1)[1]
    except (OSError, IndexError):
        raise BadInputError(f"{path}: no limits of an aircraft here") from None
    found: dict[str, float] = {}
    for line in section.splitlines()[1:]:
        if not line.startswith(" "):
            break
        key, _, value = line.partition("#")[0].partition(":")
        found[key.strip()] = float(value)
    return found
