"""The JSON Schema of a campaign, which gives an editor completion, descriptions and red underlines."""

import ast
import inspect
import json
import textwrap
from collections.abc import Callable
from itertools import pairwise
from typing import Any

from pydantic import BaseModel

from testbed.campaign.reading.vocabulary import OF_THE_CAMPAIGN, keys
from testbed.campaign.words.settings import Campaign, FlightSettings
from testbed.core.section import Section

Json = dict[str, Any]

_SWEEP = (
    "Axes of the grid, in order; the last one varies fastest. An axis is either `dotted.path: [values]`, for example "
    "`method.kind: [none, scoam]`, or a name with labels, each of which sets several paths: "
    "`reading: {as_printed: {obstacles.O.direction_deg: [135, 12.4]}, ...}`. A path to a section replaces the whole section. "
    "Obstacles are addressed by name: obstacles.O.speed_mps. The labels joined by '/' name the cell."
)
_OBSTACLE_PATH = r"^obstacles\.[A-Za-z0-9][A-Za-z0-9_\-]*(\.|$)"


def schema() -> str:
    """The text of ``campaigns/campaign.schema.json``: JSON Schema draft 7, which every editor understands.

    Names of methods and aircraft are not in it: a new one would change it, and `testbed list` shows them.
    """
    document = Campaign.model_json_schema()
    _describe(document)
    paths = dict(_paths(document))
    document["$defs"]["Settings"] = {"description": "Dotted paths and the values they get.", **_by_path(paths, dict)}
    document["$defs"]["NamedAxis"] = {
        "description": "Labels, each with the settings it stands for.",
        "type": "object",
        "minProperties": 1,
        "additionalProperties": {"$ref": "#/$defs/Settings"},
    }
    named = {"$ref": "#/$defs/NamedAxis"}
    axes = _by_path(paths, lambda kind: {"anyOf": [_values(kind), named], "description": kind.get("description", "")})
    own, of_part = document["properties"], document["$defs"]["Part"]["properties"]
    own["sweep"] = {"description": _SWEEP, **axes, "additionalProperties": named, "default": {}}
    own["draw"] = {"description": own["draw"]["description"], **_by_path(paths, lambda _: {"$ref": "#/$defs/Draw"}), "default": {}}
    of_part["sweep"] = {"description": "The part's grid; see sweep of the campaign.", "$ref": "#/properties/sweep"}
    of_part["draw"] = {"description": of_part["draw"]["description"], "$ref": "#/properties/draw"}
    of_part["set"] = {"description": of_part["set"]["description"], "$ref": "#/$defs/Settings"}
    kind = document["$defs"]["StudySpec"]["properties"]["kind"]["anyOf"]
    own["study"] = {key: part for key, part in own["study"].items() if key != "$ref"} | {"anyOf": [{"$ref": own["study"]["$ref"]}, *kind]}
    return json.dumps({"$schema": "http://json-schema.org/draft-07/schema#", **_draft7(document)}, indent=2) + "\n"


def _describe(document: Json) -> None:
    """Give each setting the text that stands under its field in the code."""
    for section in _sections(Section):
        there = document if section is Campaign else document["$defs"].get(section.__name__, {})
        texts = {
            name: text
            for base in reversed(section.__mro__)
            if issubclass(base, Section)
            for name, text in _texts_under_fields(base).items()
        }
        for name, told in there.get("properties", {}).items():
            if name in texts and "description" not in told:
                there["properties"][name] = dict(sorted({**told, "description": texts[name]}.items()))


def _sections(of: type[BaseModel]) -> list[type[BaseModel]]:
    return [each for child in of.__subclasses__() for each in (child, *_sections(child))]


def _texts_under_fields(section: type[BaseModel]) -> dict[str, str]:
    (described,) = ast.parse(textwrap.dedent(inspect.getsource(section))).body
    assert isinstance(described, ast.ClassDef)
    texts = {}
    for field, text in pairwise(described.body):
        match field, text:
            case ast.AnnAssign(target=ast.Name(id=name)), ast.Expr(value=ast.Constant(value=str(said))):
                texts[name] = inspect.cleandoc(said)
    return texts


def _by_path(paths: Json, told: Callable[[Json], Json]) -> Json:
    """A section whose keys are dotted paths. ``told``: from the schema of a setting to that of what stands there."""
    properties = {path: told(kind) for path, kind in paths.items()}
    return {"type": "object", "properties": properties, "patternProperties": {_OBSTACLE_PATH: told({})}, "additionalProperties": False}


def _values(kind: Json) -> Json:
    return {"type": "array", "minItems": 1, "items": kind}


def _paths(document: Json) -> list[tuple[str, Json]]:
    """Every dotted path that a sweep may use (those below obstacles apart), with the schema of its value."""
    found: list[tuple[str, Json]] = []

    def visit(kind: Any, properties: Json, prefix: str) -> None:
        for name, annotation in keys(kind).items():
            value = {key: part for key, part in properties[name].items() if key not in ("default", "title")}
            if f"{prefix}{name}" not in OF_THE_CAMPAIGN:
                found.append((f"{prefix}{name}", value))
            visit(annotation, _properties(value, document), f"{prefix}{name}.")

    visit(FlightSettings, document["properties"], "")
    return found


def _properties(value: Json, document: Json) -> Json:
    """Properties of a section, or of all sections of a union together."""
    if "$ref" in value:
        return document["$defs"][value["$ref"].rpartition("/")[2]].get("properties", {})
    merged: dict[str, list[Json]] = {}
    for option in value.get("oneOf", []) + value.get("anyOf", []):  # a union, and one that may be left out
        for name, part in _properties(option, document).items():
            if part not in merged.setdefault(name, []):
                merged[name].append(part)
    return {name: parts[0] if len(parts) == 1 else {"anyOf": parts} for name, parts in merged.items()}


def _draft7(node: Any, is_names: bool = False) -> Any:
    """The same schema in draft 7: lists of fixed length spelt the old way, and nothing beside a ``$ref``."""
    if isinstance(node, list):
        return [_draft7(item) for item in node]
    if not isinstance(node, dict):
        return node
    if is_names:
        return {name: _draft7(part) for name, part in node.items()}
    result = {}
    for name, part in node.items():
        if name == "prefixItems":
            result["items"] = _draft7(part)
        elif name == "$ref" and len(node) > 1:
            result["allOf"] = [{"$ref": part}]
        elif name not in ("discriminator", "title") or (name == "title" and "properties" in node):
            result[name] = (
                part if name in ("default", "required", "enum") else _draft7(part, name in ("properties", "$defs", "patternProperties"))
            )
    return result
