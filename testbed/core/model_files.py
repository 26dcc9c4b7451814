"""Where JSBSim finds an aircraft's model and what that is made of, without loading JSBSim: files, engines, what is missing."""

import math
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from testbed.core.units import FT

SECTIONS = "mass_balance ground_reactions external_reactions buoyant_forces propulsion system autopilot flight_control aerodynamics".split()
"""Those that may be in a file of their own."""

SPAN_UNITS_M = {"FT": FT, "IN": FT / 12.0, "M": 1.0}


class Missing(NamedTuple):
    """A file that a model names and that is nowhere where JSBSim looks. ``what``: engine, thruster, or the section."""

    what: str
    name: str


@cache
def wheel_root() -> Path:
    """The folder that JSBSim's wheel has its ``aircraft/``, ``engine/`` and ``systems/`` in."""
    found = find_spec("jsbsim")
    assert found is not None, "jsbsim is a dependency"
    assert found.submodule_search_locations, "it is a package"
    return Path(found.submodule_search_locations[0])


def wheel_models() -> list[str]:
    """Names of the models that the wheel ships, sorted."""
    return sorted(folder.name for folder in (wheel_root() / "aircraft").iterdir() if (folder / f"{folder.name}.xml").is_file())


def model_path(files: str, name: str, folder: Path) -> Path:
    """The JSBSim file of an aircraft whose ``aircraft.yaml`` is in ``folder``: there, or in the wheel."""
    return folder / f"{name}.xml" if files == "own" else wheel_root() / "aircraft" / name / f"{name}.xml"


def read_xml(file: Path) -> Element:
    """The root of a model file. Raises ``ElementTree.ParseError``."""
    return ElementTree.parse(file).getroot()


def engines(model: Element, file: Path) -> int:
    """How many engines it has, those of a propulsion file of its own included."""
    return sum(1 for section in _sections(model, file) for _ in section.iter("engine"))


def wing_span_m(model: Element) -> float:
    """From tip to tip, as the model's file has it; NaN where it does not say, or in no unit that JSBSim knows."""
    told = model.find("metrics/wingspan")
    try:
        return float(told.text or "") * SPAN_UNITS_M[told.get("unit", "FT")] if told is not None else math.nan
    except (ValueError, KeyError):
        return math.nan


def missing_files(model: Element, file: Path) -> list[Missing]:
    """Files that the model, or a section in a file of its own, names in vain."""
    lost: dict[Missing, None] = {}
    for part in [model, *_sections(model, file)]:
        for element in part.iter():
            name, what = element.get("file"), str(element.tag)
            if name and what in ("engine", "thruster", *SECTIONS) and _found(name, file) is None:
                lost[Missing(what, name)] = None
    return list(lost)


def unreadable(model: Element, file: Path) -> str:
    """The first file that the model, or a file of it, names and that is no XML: its name and why. Empty if all can be read."""
    todo, seen = [model], set()
    while todo:
        for element in todo.pop().iter():
            name = element.get("file")
            path = _found(name, file) if name and element.tag in ("engine", "thruster", *SECTIONS) else None
            if path is None or path in seen:
                continue
            seen.add(path)
            try:
                todo.append(read_xml(path))
            except ElementTree.ParseError as error:
                return f"{path.name} is no XML that can be read: {error}"
    return ""


def _sections(model: Element, file: Path) -> Iterator[Element]:
    """The propulsion of the model, wherever it is written."""
    for section in model.findall("propulsion"):
        named = section.get("file")
        path = _found(named, file) if named else None
        yield read_xml(path) if path else section


def _found(name: str, file: Path) -> Path | None:
    """A file by its name, with or without ``.xml``, in the places where JSBSim looks for parts of the model ``file``."""
    root = file.parents[2] if len(file.parents) > 2 else file.parent
    places = (file.parent, *(file.parent / folder for folder in ("Engines", "Systems")), root / "engine", root / "systems")
    names = (name,) if name.endswith(".xml") else (f"{name}.xml", name)
    return next((path for place in places for one in names if (path := place / one).is_file()), None)
