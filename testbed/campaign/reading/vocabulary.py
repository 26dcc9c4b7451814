"""Questions about the model's types: which keys a section has, what a dotted path leads to, in which unit a key speaks."""

from collections.abc import Sequence
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel

from testbed.campaign.reading.problems import did_you_mean
from testbed.campaign.words.settings import Campaign, FlightSettings
from testbed.campaign.words.study import formerly

Loc = tuple[str | int, ...]
"""Where a value stands in the data: keys and indices from the top."""

OF_THE_CAMPAIGN = ("study", "study.kind", "limits", "limits.flights", "limits.wall_limit_s")
"""Settings that all flights of a campaign have alike: no axis, part or draw changes them."""

UNITS = {"_per_s": "1/s", "_mps": "m/s", "_deg": "deg", "_hz": "Hz", "_m": "m", "_s": "s"}


def unit_of(loc: Loc) -> str:
    """Unit in which the user writes the value at ``loc`` (read from its key); empty if it has none."""
    key = next((part for part in reversed(loc) if isinstance(part, str)), "")
    if key.endswith("_deg_m"):  # latitude, longitude and height
        return {0: "deg", 1: "deg", 2: "m"}.get(loc[-1], "") if isinstance(loc[-1], int) else ""
    return next((unit for suffix, unit in UNITS.items() if key.endswith(suffix)), "")


def members(kind: Any) -> list[Any]:
    """The alternatives of a union; a list of one for anything else."""
    if get_origin(kind) is Annotated:
        return members(get_args(kind)[0])
    if get_origin(kind) in (Union, UnionType):
        return [member for part in get_args(kind) for member in members(part)]
    return [kind]


def sections(kind: Any) -> list[type[BaseModel]]:
    """The models among the alternatives."""
    return [member for member in members(kind) if isinstance(member, type) and issubclass(member, BaseModel)]


def keys(kind: Any) -> dict[str, Any]:
    """Key to type, of every section that ``kind`` can be."""
    return {name: info.annotation for section in sections(kind) for name, info in section.model_fields.items()}


def below(kind: Any, key: str | int) -> Any:
    """Type of what ``key`` leads to inside ``kind``; None where nothing is known."""
    if sections(kind):
        return keys(kind).get(str(key))
    arguments = get_args(members(kind)[0])
    origin = get_origin(members(kind)[0])
    if origin is dict:
        return arguments[1]
    if origin is tuple:
        return arguments[0] if arguments[-1] is Ellipsis else arguments[int(key)] if isinstance(key, int) and key < len(arguments) else None
    return None


def _tagged(kind: Any, tag: str | int) -> Any:
    """The section of a tagged union whose ``kind`` is ``tag``."""
    for section in sections(kind):
        annotation = section.model_fields["kind"].annotation
        if get_origin(annotation) is Literal and tag in get_args(annotation):
            return section
    return kind


def untagged(loc: Loc, root: type[BaseModel] = Campaign) -> tuple[Loc, Any]:
    """Pydantic's location without the tags that it inserts for tagged unions, and the type of what holds the last key."""
    kind: Any = root
    holder: Any = None
    known: list[str | int] = []
    for part in loc:
        if len(sections(kind)) > 1:
            kind = _tagged(kind, part)
            continue
        holder, kind = kind, below(kind, part)
        known.append(part)
    return tuple(known), holder


def path_fault(path: str, root: type[FlightSettings]) -> tuple[str, str] | None:
    """(message, hint) about a dotted path that leads nowhere in ``root``; None for a good one. Obstacle names are not checked."""
    parts: Sequence[str] = path.split(".")
    kind: Any = root
    if root is FlightSettings and path in OF_THE_CAMPAIGN:
        differs = "study.options.<name>" if parts[0] == "study" else "limits.flight_s and limits.log_mb"
        return f"'{path}' belongs to the campaign as a whole, not to a flight", f"{differs} can differ"
    for i, part in enumerate(parts):
        known = keys(kind)
        prefix = "".join(f"{before}." for before in parts[:i])
        if known and part not in known:
            if i == 0 and part in Campaign.model_fields:
                return f"'{part}' belongs to the campaign as a whole, not to a flight", ""
            if i == 0 and (instead := formerly(part)):
                return f"unknown setting '{path}'", f"write {instead}"
            hint = did_you_mean(part, known, prefix, "".join(f".{after}" for after in parts[i + 1 :]))
            return f"unknown setting '{path}'", hint or f"known{f' in {prefix[:-1]}' if prefix else ''}: {', '.join(known)}"
        origin = get_origin(members(kind)[0])
        is_list = origin is tuple and get_args(members(kind)[0])[-1] is Ellipsis
        if not known and origin is not dict and not is_list:
            return f"unknown setting '{path}'", f"'{prefix[:-1]}' is a single value"
        kind = below(kind, part)
    return None
