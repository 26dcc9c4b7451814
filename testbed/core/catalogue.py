"""Where aircraft live on disk: every folder with an ``aircraft.yaml``. Adding an aircraft needs a folder and nothing else.

They are looked for in the project's ``aircraft/`` and in the folders of ``TESTBED_AIRCRAFT_PATH`` (separated as in PATH), which the
command's ``--aircraft-path`` sets, and a folder ``aircraft/`` beside the campaign, so that worker processes see the same. A name found
in several places is the later one's.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from importlib.resources import files
from pathlib import Path

DATA = Path(str(files("testbed"))).resolve() / "data"
"""What the package carries along that is not code. It is on disk: JSBSim opens the files of an aircraft by their names."""


def _shipped(name: str) -> Path:
    """A folder of the project: in a wheel below ``DATA``, in a checkout (and so in an editable installation) beside the packages."""
    packed = DATA / name
    return packed if packed.is_dir() else DATA.parents[1] / name


AIRCRAFT_ROOT = _shipped("aircraft")
CAMPAIGN_ROOT = _shipped("campaigns")
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


@contextmanager
def aircraft_beside(folder: Path) -> Iterator[None]:
    """Inside, look in ``folder/aircraft`` too, if aircraft are there; what ``--aircraft-path`` names goes before it."""
    root, before = folder / "aircraft", os.environ.get(PATH_VARIABLE)
    if not any(root.glob("*/aircraft.yaml")) or root.resolve() in aircraft_roots():
        yield
        return
    os.environ[PATH_VARIABLE] = os.pathsep.join(filter(None, [str(root.resolve()), before]))
    try:
        yield
    finally:
        if before is None:
            del os.environ[PATH_VARIABLE]
        else:
            os.environ[PATH_VARIABLE] = before


def is_installed(folder: Path) -> bool:
    """Whether an aircraft is part of an installed package, which a later installation replaces."""
    return DATA in folder.resolve().parents
