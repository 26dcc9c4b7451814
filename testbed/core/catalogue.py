"""Where aircraft live on disk: every folder with an ``aircraft.yaml``. Adding an aircraft needs a folder and nothing else.

They are looked for in the project's ``aircraft/`` and in the folders of ``TESTBED_AIRCRAFT_PATH`` (separated as in PATH), which the
command's ``--aircraft-path`` sets, so that worker processes see the same. A name found in several places is the later one's.
"""

import os
from functools import lru_cache
from pathlib import Path

AIRCRAFT_ROOT = Path(__file__).resolve().parents[2] / "aircraft"
PATH_VARIABLE = "TESTBED_AIRCRAFT_PATH"


def aircraft_folders() -> dict[str, Path]:
    """Name to folder of every aircraft that can be flown, sorted by name."""
    return _found(os.environ.get(PATH_VARIABLE, ""))


def aircraft_roots() -> list[Path]:
    """Every folder in which aircraft are looked for."""
    return _roots(os.environ.get(PATH_VARIABLE, ""))


def _roots(extra: str) -> list[Path]:
    return [AIRCRAFT_ROOT, *(Path(root).resolve() for root in extra.split(os.pathsep) if root)]


@lru_cache(maxsize=8)
def _found(extra: str) -> dict[str, Path]:
    found = {file.parent.name: file.parent for root in _roots(extra) for file in sorted(root.glob("*/aircraft.yaml"))}
    return dict(sorted(found.items()))


def add_aircraft_path(root: Path) -> None:
    """Look for aircraft in ``root`` too, in this process and in those it starts. Raises ``FileNotFoundError`` when none is there."""
    if not any(root.glob("*/aircraft.yaml")):
        raise FileNotFoundError(f"{root}: no folder with an aircraft.yaml in it")
    before = [part for part in os.environ.get(PATH_VARIABLE, "").split(os.pathsep) if part]
    if (path := str(root.resolve())) not in before:
        os.environ[PATH_VARIABLE] = os.pathsep.join([*before, path])
