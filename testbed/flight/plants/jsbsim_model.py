"""What is changed in an aircraft's JSBSim file as it is loaded: derivatives and lags by factors, and the air that its wing turns in.

A derivative is what JSBSim adds up along an axis: one ``<function>`` of one ``<axis>``, under the function's name. Where such a
function is no more than a product of properties, one of which is a polynomial (a function outside the axes whose body is a
``<sum>``), the polynomial is taken apart: its terms that vary with the same quantities are one derivative, whatever their powers
and however they vary with the angle of attack, ``aero/gtm/Cl(velocities/p-aero-rad_sec)``. The terms of a fit cancel one another;
a factor for each would be no spread of any derivative. The constant is a derivative of its own, ``aero/gtm/Cm()``.

A lag is an ``<actuator>`` with a number for its ``<lag>``, under the actuator's name; JSBSim's number is 1/s, so it is divided.
An ``<aerodynamics file=>`` or ``<flight_control file=>`` is read in; lags in ``<system file=>`` stay as they are.

JSBSim takes no rotary gust from outside: its p, q, r gusts are read-only. For air that turns, the aerodynamics get a property to write
each of them to, a function that takes it off the aircraft's rate, and that function wherever they use the rate.
"""

import re
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

PROPERTIES = ("property", "p", "independentVar")
BESIDE_BODY = ("description", "documentation")  # what may stand in a function beside its body
ALPHA = "aero/alpha-rad"
SCALES = ("aero/bi2vel", "aero/ci2vel")  # make a rate dimensionless
AERO_RATES = tuple(f"velocities/{axis}-aero-rad_sec" for axis in "pqr")
"""The aircraft's rates through the air, rad/s: what turns in JSBSim's own turbulence is taken off already."""
ROTARY_GUST = tuple(f"atmosphere/rotary-gust/{axis}-rad_sec" for axis in "pqr")
"""Angular velocity of the air in body axes, rad/s, to be written to; in a file for air that turns."""
IN_ROTATING_AIR = tuple(f"aero/in-rotating-air/{axis}-rad_sec" for axis in "pqr")
"""What such a file's aerodynamics use for ``AERO_RATES``. Other rates (``velocities/p-rad_sec``) stay, and do not feel the air turn."""
MARK = "\ue000"  # of a private-use area: in no file


class Place(NamedTuple):
    """Where a number stands that a factor changes: ``value`` times, or for a lag's rate divided by, the factor of that name."""

    name: str
    value: float
    divided: bool

    def text(self, factor: float) -> str:
        return repr(self.value / factor if self.divided else self.value * factor)


class ModelFile(NamedTuple):
    """An aircraft file cut at its places: text, place, text, ..., text."""

    texts: tuple[str, ...]
    places: tuple[Place, ...]

    @property
    def derivatives(self) -> list[str]:
        """Sorted."""
        return sorted({place.name for place in self.places if not place.divided})

    @property
    def lags(self) -> list[str]:
        """Sorted."""
        return sorted({place.name for place in self.places if place.divided})

    def changed(self, factors: Mapping[str, float]) -> str:
        """The file with those factors; a name that is not among them keeps its value. Raises ``KeyError`` for an unknown name."""
        if unknown := sorted(factors.keys() - {place.name for place in self.places}):
            raise KeyError(f"this aircraft has no derivative or lag '{unknown[0]}'")
        numbers = [place.text(factors.get(place.name, 1.0)) for place in self.places]
        return self.texts[0] + "".join(number + text for number, text in zip(numbers, self.texts[1:], strict=True))


def read_model(file: Path, air_turns: bool = False) -> ModelFile:
    """The aircraft file, for air that turns if told so, read once in a process as long as it does not change."""
    return _read(file, file.stat().st_mtime_ns, air_turns)


@contextmanager
def changed_root(file: Path, factors: Mapping[str, float], air_turns: bool = False) -> Iterator[Path]:
    """A folder of aircraft in which JSBSim finds ``<root>/<name>/<name>.xml`` with those factors, until the end of the block.

    Everything else of the aircraft's folder (engines, systems, what is included) is there by links, or as copies where links are not
    allowed. Without factors, and in air that does not turn, it is the folder where the file is, if that has the model's name.
    """
    rewritten = bool(factors) or air_turns
    if not rewritten and file.parent.name == file.stem:
        yield file.parent.parent
        return
    with TemporaryDirectory(prefix="aircraft-") as root:
        folder = Path(root) / file.stem  # JSBSim wants <name>/<name>.xml, whatever the folder of the aircraft is called
        folder.mkdir()
        for beside in file.parent.resolve().iterdir():
            if not rewritten or beside.name != file.name:
                _put_beside(folder / beside.name, beside)
        if rewritten:
            (folder / file.name).write_text(read_model(file, air_turns).changed(factors), encoding="utf-8")
        yield Path(root)


def _put_beside(place: Path, original: Path) -> None:
    try:
        place.symlink_to(original)
    except OSError:  # Windows lets few users make links
        copy = shutil.copytree if original.is_dir() else shutil.copyfile
        copy(original, place)


@lru_cache(maxsize=32)
def _read(file: Path, _changed_ns: int, air_turns: bool) -> ModelFile:
    root = ElementTree.parse(file).getroot()
    places: list[Place] = []

    def put(place: Place) -> str:
        places.append(place)
        return f"{MARK}{len(places) - 1}{MARK}"

    for tag in ("aerodynamics", "flight_control"):
        for section in root.findall(tag):
            _include(section, file.parent)
    for aerodynamics in root.findall("aerodynamics"):
        for name, owner, term in _derivatives(aerodynamics):
            product = Element("product")
            ElementTree.SubElement(product, "value").text = put(Place(name, 1.0, False))
            product.append(term)
            owner[list(owner).index(term)] = product
        if air_turns:
            _turn(aerodynamics)
    for actuator in root.iter("actuator"):
        lag = actuator.find("lag")
        if lag is not None and (value := _number(lag.text)) is not None:
            lag.text = put(Place(actuator.get("name", ""), value, True))
    # cut at the marks, which stand in the order of the document: text, index, text, ...
    cut = re.split(f"{MARK}(\\d+){MARK}", ElementTree.tostring(root, encoding="unicode"))
    return ModelFile(tuple(cut[::2]), tuple(places[int(index)] for index in cut[1::2]))


def _include(section: Element, folder: Path) -> None:
    """Put the content of the file that a section names in its place."""
    if name := section.attrib.pop("file", ""):
        path = folder / name
        section[:] = list(ElementTree.parse(path if path.suffix == ".xml" else path.with_name(f"{path.name}.xml")).getroot())


def _turn(aerodynamics: Element) -> None:
    """Take the rotary gusts off the rates that the aerodynamics use: JSBSim evaluates the functions of a section in their order."""
    felt = dict(zip(AERO_RATES, IN_ROTATING_AIR, strict=True))
    for part in aerodynamics.iter():
        if part.tag in PROPERTIES and (name := _name(part)) in felt:
            part.text = (part.text or "").replace(name, felt[name])
    for rate, gust, in_air in reversed(tuple(zip(AERO_RATES, ROTARY_GUST, IN_ROTATING_AIR, strict=True))):
        function = Element("function", name=in_air)
        difference = ElementTree.SubElement(function, "difference")
        ElementTree.SubElement(difference, "property").text = rate
        ElementTree.SubElement(difference, "property").text = gust
        declared = Element("property", value="0")
        declared.text = gust
        aerodynamics[:0] = [declared, function]


def _derivatives(aerodynamics: Element) -> list[tuple[str, Element, Element]]:
    """(name, parent, element) of everything that is to be multiplied by the derivative's factor."""
    outside = {function.get("name", ""): function for function in aerodynamics.findall("function")}
    polynomials = {name: body for name, function in outside.items() if (body := _body(function)) is not None and body.tag == "sum"}
    found: list[tuple[str, Element, Element]] = []
    taken: set[str] = set()
    for function in (function for axis in aerodynamics.findall("axis") for function in axis.iter("function")):
        body = _body(function)
        if body is None:
            continue
        inside = [_name(child) for child in body if child.tag in PROPERTIES]
        named = [name for name in inside if name in polynomials]
        if body.tag != "product" or len(inside) < len(body) or len(named) != 1:
            found.append((function.get("name", ""), function, body))
        elif named[0] not in taken:
            taken.add(named[0])
            terms = polynomials[named[0]]
            found += [(f"{named[0]}({', '.join(_varies_with(term, outside))})", terms, term) for term in terms]
    return found


def _varies_with(term: Element, functions: Mapping[str, Element]) -> list[str]:
    """The quantities that a term depends on, sorted; the angle of attack only when there is no other."""
    found = _quantities(term, functions) - set(SCALES)
    return sorted(found - {ALPHA} or found)


def _quantities(element: Element, functions: Mapping[str, Element]) -> set[str]:
    names = {_name(part) for part in element.iter() if part.tag in PROPERTIES}
    return {deep for name in names for deep in (_quantities(functions[name], functions) if name in functions else {name})}


def _body(function: Element) -> Element | None:
    return next((child for child in function if child.tag not in BESIDE_BODY), None)


def _name(element: Element) -> str:
    return (element.text or "").strip().removeprefix("-")


def _number(text: str | None) -> float | None:
    try:
        return float(text or "")
    except ValueError:
        return None  # the lag is a property
