"""An ``aircraft.yaml`` and the model that it names, read with the place of every word; or all that is wrong with them, at once."""

import os
from functools import lru_cache
from pathlib import Path
from xml.etree.ElementTree import ParseError

from pydantic import ValidationError

from testbed.campaign.reading.document import Document, Fault, faults_of
from testbed.campaign.reading.nodes import Tree, parse, read_text
from testbed.campaign.reading.problems import Problem, SpecError, did_you_mean
from testbed.campaign.words.aircraft import Aircraft, Model
from testbed.core.model_files import engines, missing_files, model_path, read_xml, unreadable, wheel_models

FILE = "aircraft.yaml"


def read_aircraft(folder: Path) -> Aircraft:
    """The aircraft of a folder, read once in a process as long as its file does not change. Raises ``SpecError``."""
    file = folder / FILE
    return _read(file, file.stat().st_mtime_ns if file.exists() else 0)


@lru_cache(maxsize=64)
def _read(file: Path, _changed_ns: int) -> Aircraft:
    here = os.path.relpath(file)
    tree, problems = parse(read_text(file if here.startswith(os.pardir) else Path(here)))
    if not isinstance(tree.value, dict):
        raise SpecError(problems or [Problem(tree.spot, "", "must be a section: 'key: value' lines at the top, not a list or a text")])
    document = Document({**tree.value, "folder": file.parent}, tree)
    faults = [Fault(("folder",), "unknown key 'folder'", at_key=True)] if "folder" in tree.inside else []
    aircraft = None
    try:
        aircraft = Aircraft.model_validate(document.data)
    except ValidationError as error:
        faults += faults_of(error, Aircraft)
    else:
        if aircraft.limits.speed_min_mps >= aircraft.limits.speed_max_mps:
            faults.append(Fault(("limits", "speed_max_mps"), f"must be more than speed_min_mps, {aircraft.limits.speed_min_mps:g} m/s"))
    faults += model_faults(tree, file.parent)
    problems += [found for fault in faults if (found := document.problem(fault))]
    if problems or aircraft is None:
        raise SpecError(problems)
    return aircraft


def model_faults(tree: Tree, folder: Path) -> list[Fault]:
    """What is wrong with the model's files; nothing where the section that names it is wrong itself."""
    try:
        model = Model.model_validate(tree.value.get("model"))
    except ValidationError:
        return []
    at = ("model", "name")
    file = model_path(model.files, model.name, folder)
    if not file.is_file():
        if model.files == "own":
            return [Fault(at, f"there is no {file.name} beside {FILE}", "model.name is the name of the JSBSim file without .xml")]
        return [Fault(at, f"JSBSim's wheel has no aircraft '{model.name}'", did_you_mean(model.name, wheel_models()))]
    try:
        xml = read_xml(file)
    except ParseError as error:
        return [Fault(at, f"{file.name} is no XML that can be read: {error}")]
    told = [f"the {part.what} file '{part.name}' that {file.name} names is not there" for part in missing_files(xml, file)]
    bad = unreadable(xml, file)
    lost = [Fault(at, why) for why in ([bad] if bad else told)]
    if not lost and not engines(xml, file):
        return [Fault(at, f"'{model.name}' has no engine: gliders are not supported, since a campaign holds speed and height")]
    return lost
