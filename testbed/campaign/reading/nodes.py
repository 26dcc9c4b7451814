"""YAML text to plain data in which every key and value knows where it stands.

The reader is made for files that people get wrong: whatever the bytes are, the result is data or a ``SpecError``.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from testbed.campaign.reading.problems import NOWHERE, Problem, Source, SpecError, Spot
from testbed.campaign.reading.syntax import explain

MAX_BYTES = 300_000
MAX_VALUES = 100_000  # with every alias written out: an alias bomb is small on disk and endless in memory
MAX_MARKS = 40_000  # read in 3 s; a campaign with 1,000 obstacles has 25,000
MAX_DEPTH = 40
MAX_DIGITS = 300

_UNPRINTABLE = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_TAG = "tag:yaml.org,2002:"
_TEXT_TAGS = {"!", f"{_TAG}str", f"{_TAG}timestamp", f"{_TAG}value", f"{_TAG}merge"}


@dataclass(frozen=True, eq=False)
class Tree:
    """A value, its place, and the same for what is inside. ``broken``: its fault is reported already."""

    value: Any
    spot: Spot = NOWHERE
    inside: dict[str | int, "Tree"] = field(default_factory=dict)
    key_spots: dict[str | int, Spot] = field(default_factory=dict)
    broken: bool = False

    @staticmethod
    def plain(value: Any, spot: Spot = NOWHERE) -> "Tree":
        """A tree of data that was never text; ``spot`` is the place of all of it."""
        items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list | tuple) else ()
        return Tree(value, spot, {key: Tree.plain(item, spot) for key, item in items})

    def put(self, keys: Sequence[str], tree: "Tree", spot: Spot) -> "Tree":
        """A copy with another tree at ``keys``, sections opened on the way; ``spot`` is where the new keys are written."""
        key, rest = keys[0], keys[1:]
        inner = self.inside.get(key, Tree({}, spot)).put(rest, tree, spot) if rest else tree
        value = {**self.value, key: inner.value} if isinstance(self.value, dict) else {key: inner.value}
        key_spot = self.key_spots.get(key, spot) if rest else spot
        return Tree(value, self.spot, {**self.inside, key: inner}, {**self.key_spots, key: key_spot})

    def key_spot(self, key: str | int) -> Spot:
        return self.key_spots.get(key, self.inside[key].spot)


def read_text(path: Path) -> Source:
    """The text of a file, with line ends made ``\\n``."""
    empty = Source(str(path))

    def refuse(message: str) -> SpecError:
        return SpecError([Problem(Spot(empty), "", message)])

    try:
        if path.is_dir():
            raise refuse("this is a directory; give the YAML file of a campaign")
        if not path.exists():
            raise refuse("no such file")
        if not path.is_file():
            raise refuse("this is not a regular file")
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        raise refuse(f"cannot be read: {getattr(error, 'strerror', None) or error}") from error
    if len(data) > MAX_BYTES:
        raise refuse(f"larger than {MAX_BYTES // 1000} kB: this is no campaign")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8-sig", errors="replace")
        source = Source(str(path), _unix(before + data[error.start :].decode("latin-1")))
        message = f"byte 0x{data[error.start]:02x} is not UTF-8"
        raise SpecError([Problem(source.at(len(_unix(before))), "", message, "save the file as UTF-8")]) from error
    return Source(str(path), _unix(text))


def _unix(text: str) -> str:
    return text.replace("\r\n", "\n").replace("\r", "\n")


def parse(source: Source) -> tuple[Tree, list[Problem]]:
    """Data of one YAML document, and the problems that do not keep the rest from being read. An empty text is null."""
    if bad := _UNPRINTABLE.search(source.text):
        name = "a NUL byte" if bad[0] == "\0" else f"the control character U+{ord(bad[0]):04X}"
        raise SpecError([Problem(source.at(bad.start()), "", f"{name} does not belong in a text file")])
    if sum(map(source.text.count, "[]{},:\n")) > MAX_MARKS:
        raise SpecError([Problem(Spot(source), "", f"more than {MAX_MARKS:,} lines, commas, colons and brackets: this is no campaign")])
    yaml = YAML(typ="safe", pure=True)
    yaml.composer.warn_double_anchors = False  # an anchor may be given anew, YAML says
    try:
        root = yaml.compose(source.text)
    except MarkedYAMLError as error:
        raise SpecError([explain(error, source)]) from error
    except RecursionError as error:
        raise SpecError([Problem(Spot(source), "", "nested too deeply")]) from error
    except (YAMLError, ValueError, OverflowError) as error:
        wrong_escape = re.search(r"\\U[0-9A-Fa-f]{8}", source.text)
        spot = source.at(wrong_escape.start()) if wrong_escape else Spot(source)
        raise SpecError([Problem(spot, "", f"cannot be read as YAML: {error}")]) from error
    if root is None:
        return Tree(None, Spot(source)), []
    _refuse_endless(root, source)
    builder = _Builder(source)
    return builder.build(root), builder.problems


def _children(node: Node) -> list[Node]:
    if isinstance(node, MappingNode):
        return [part for pair in node.value for part in pair]
    return list(node.value) if isinstance(node, SequenceNode) else []


def _refuse_endless(root: Node, source: Source) -> None:
    """Walk the graph of nodes once, without recursion, and refuse cycles, depth, and aliases that multiply."""
    size: dict[int, int] = {}
    height: dict[int, int] = {}
    entered: set[int] = set()
    stack = [(root, False)]
    while stack:
        node, done = stack.pop()
        if id(node) in size:
            continue
        children = _children(node)
        if done:
            size[id(node)] = 1 + sum(size[id(child)] for child in children)
            height[id(node)] = 1 + max((height[id(child)] for child in children), default=0)
            if size[id(node)] > MAX_VALUES:
                raise SpecError([Problem(_spot(node, source), "", f"more than {MAX_VALUES:,} values, aliases written out")])
            if height[id(node)] > MAX_DEPTH:
                raise SpecError([Problem(_spot(node, source), "", "nested too deeply")])
        elif id(node) in entered:
            raise SpecError([Problem(_spot(node, source), "", f"this value contains itself through its alias *{node.anchor}")])
        else:
            entered.add(id(node))
            stack.append((node, True))
            stack.extend((child, False) for child in children)


def _spot(node: Node, source: Source) -> Spot:
    return source.at(node.start_mark.index)


class _Builder:
    """Turns composed nodes into a ``Tree``; what is wrong but local goes to ``problems``."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.problems: list[Problem] = []
        self.built: dict[int, Tree] = {}
        self.flattened: dict[int, list[tuple[str, Node, Node]]] = {}

    def build(self, node: Node) -> Tree:
        """The tree of a node, built once however many aliases lead to it."""
        if id(node) not in self.built:
            self.built[id(node)] = self._build(node)
        return self.built[id(node)]

    def _build(self, node: Node) -> Tree:
        spot = _spot(node, self.source)
        if isinstance(node, ScalarNode):
            return self._scalar(node, spot)
        expected = f"{_TAG}map" if isinstance(node, MappingNode) else f"{_TAG}seq"
        if str(node.tag) != expected:
            return self._broken(spot, f"the tag {_short(node)} is not supported")
        if not isinstance(node, MappingNode):
            items = [self.build(item) for item in node.value]
            return Tree([item.value for item in items], spot, dict(enumerate(items)))
        inside: dict[str | int, Tree] = {}
        key_spots: dict[str | int, Spot] = {}
        for name, key, value in self._pairs(node):
            inside[name] = self.build(value)
            key_spots[name] = _spot(key, self.source)
        return Tree({name: tree.value for name, tree in inside.items()}, spot, inside, key_spots)

    def _pairs(self, node: MappingNode) -> list[tuple[str, Node, Node]]:
        """Keys and values with ``<<`` merged in: the section's own keys win, then the first that is merged."""
        if id(node) in self.flattened:
            return self.flattened[id(node)]
        own: dict[str, tuple[str, Node, Node]] = {}
        merged: list[tuple[str, Node, Node]] = []
        for key, value in node.value:
            if not isinstance(key, ScalarNode):
                self.problems.append(Problem(_spot(key, self.source), "", "a key must be plain text"))
            elif key.value in own:
                first = _spot(own[key.value][1], self.source)
                before = f" (first in line {first.line})" if first.is_position else ""
                self.problems.append(Problem(_spot(key, self.source), "", f"the key '{key.value}' is there twice{before}"))
            elif str(key.tag) == f"{_TAG}merge":
                merged.extend(self._merged(value))
            else:
                own[key.value] = (key.value, key, value)
        for pair in merged:
            own.setdefault(pair[0], pair)
        self.flattened[id(node)] = list(own.values())
        return self.flattened[id(node)]

    def _merged(self, value: Node) -> Iterator[tuple[str, Node, Node]]:
        for part in value.value if isinstance(value, SequenceNode) else [value]:
            if isinstance(part, MappingNode):
                yield from self._pairs(part)
            else:
                self.problems.append(Problem(_spot(part, self.source), "", "'<<' takes a section, or a list of sections, by alias"))

    def _scalar(self, node: ScalarNode, spot: Spot) -> Tree:
        try:
            return Tree(_plain(str(node.value), str(node.tag)), spot)
        except ValueError as error:
            return self._broken(spot, str(error))

    def _broken(self, spot: Spot, message: str) -> Tree:
        self.problems.append(Problem(spot, "", message))
        return Tree(None, spot, broken=True)


def _short(node: Node) -> str:
    return str(node.tag).replace(_TAG, "!!")


def _plain(text: str, tag: str) -> object:
    """The value of a scalar; a ``ValueError`` is in words for users."""
    if any("\ud800" <= character <= "\udfff" for character in text):
        raise ValueError("half a character (a lone surrogate) in the text")
    if tag in _TEXT_TAGS:
        return text
    if tag == f"{_TAG}null":
        return None
    if tag == f"{_TAG}bool":
        if text.lower() not in ("true", "false"):
            raise ValueError("write true or false")
        return text.lower() == "true"
    if tag not in (f"{_TAG}int", f"{_TAG}float"):
        raise ValueError(f"the tag {tag.replace(_TAG, '!!')} is not supported")
    return _number(text, whole=tag == f"{_TAG}int")


def _number(text: str, whole: bool) -> int | float:
    if len(text) > MAX_DIGITS:
        raise ValueError(f"a number of {len(text)} characters")
    digits = text.replace("_", "").lower()
    sign, bare = -1 if digits.startswith("-") else 1, digits.lstrip("+-")
    base = {"0x": 16, "0o": 8, "0b": 2}.get(bare[:2], 10)
    try:
        if whole:
            return sign * int(bare[2:] if base != 10 else bare, base)
        return sign * float({".inf": "inf", ".nan": "nan"}.get(bare, bare))
    except ValueError:
        raise ValueError(f"'{text}' is not a number") from None
