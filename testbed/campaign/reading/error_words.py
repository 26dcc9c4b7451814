"""Pydantic's errors in plain words, in the unit that the user wrote."""

import math
import re
from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel
from pydantic_core import ErrorDetails

from testbed.campaign.reading.problems import did_you_mean
from testbed.campaign.reading.vocabulary import Loc, below, keys, unit_of, untagged
from testbed.campaign.words.settings import Campaign
from testbed.campaign.words.study import formerly
from testbed.core.options import fixed_length
from testbed.core.utf8 import clipped

_BOUNDS = {
    "greater_than": ("gt", "more than"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "less than"),
    "less_than_equal": ("le", "at most"),
}
_WANTED = {
    "float_type": "a number",
    "int_type": "a whole number",
    "float_parsing": "a number",  # these two of text, as a command line has it
    "int_parsing": "a whole number",
    "string_type": "a text",
    "bool_type": "true or false",
    "tuple_type": "a list",
    "list_type": "a list",
    "dict_type": "a section (keys and values)",
    "model_type": "a section (keys and values)",
    "model_attributes_type": "a section (keys and values)",
}
_NUMBERS = ("float_type", "int_type")
_ALTERNATIVE = re.compile(r"constrained-\w+|[\w-]+\[.*\]")
_PLAIN = ("float", "int", "str", "bool")
MAX_SHOWN = 40
"""Characters of a value that a message repeats."""


def shown(value: Any) -> str:
    """A value as a user would name it."""
    if isinstance(value, str):
        return f"the text '{clipped(value, MAX_SHOWN)}'" if value else "an empty text"
    if isinstance(value, list | tuple | dict):
        return "a section" if isinstance(value, dict) else "a list"
    if isinstance(value, float) and not math.isfinite(value):
        return f"{value}".replace("nan", ".nan").replace("inf", ".inf")
    return (
        {None: "empty", True: "true", False: "false"}[value] if value is None or isinstance(value, bool) else clipped(str(value), MAX_SHOWN)
    )


def _quoted(names: Sequence[Any]) -> str:
    return ", ".join(f"'{name}'" for name in names)


def _choice(expected: str, value: Any) -> tuple[str, str]:
    """(message, hint) for a name that is none of pydantic's ``'a', 'b' or 'c'``."""
    if "'" not in expected:  # numbers: "1 or 2"
        return f"must be {expected}, not {shown(value)}", ""
    names = expected.split("'")[1::2]
    allowed = f"must be {'one of ' if len(names) > 1 else ''}{_quoted(names)}, not "
    return allowed + (f"'{clipped(value, MAX_SHOWN)}'" if isinstance(value, str) else shown(value)), did_you_mean(str(value), names)


def worded(error: ErrorDetails, root: type[BaseModel] = Campaign) -> tuple[Loc, str, str]:
    """(location in the data, message, hint) of one error; ``root`` is what was validated."""
    kind, value, context = error["type"], error["input"], error.get("ctx", {})
    loc, holder = untagged(error["loc"][:-1] if error["loc"][-1:] == ("[key]",) else error["loc"], root)
    if kind == "extra_forbidden":
        known = list(keys(holder))
        if len(loc) == 1 and (instead := formerly(str(loc[0]))):
            return loc, f"unknown key '{loc[0]}'", f"write {instead}"
        return loc, f"unknown key '{loc[-1]}'", did_you_mean(str(loc[-1]), known) or f"known here: {', '.join(known)}"
    if kind in ("missing", "too_long", "too_short"):
        return _incomplete(loc, holder, kind, value, context)
    if kind == "union_tag_not_found":
        return (*loc, "kind"), "this key is missing", ""
    if kind == "union_tag_invalid":
        return (*loc, "kind"), *_choice(context["expected_tags"], value["kind"])
    return loc, *unfit(error, unit_of(loc))


def unfit(error: ErrorDetails, unit: str) -> tuple[str, str]:
    """(message, hint) about a value that is where it should be, but not what it should be."""
    kind, value, context = error["type"], error["input"], error.get("ctx", {})
    hint = ""
    if kind in _BOUNDS:
        name, words = _BOUNDS[kind]
        message = f"must be {words} {f'{context[name]:g} {unit}'.strip()}, not {f'{shown(value)} {unit}'.strip()}"
    elif kind == "out_of_bounds":
        limit, words, why = (context[key] for key in ("limit", "words", "why"))
        message = f"must be {words} {f'{limit:g} {unit}'.strip()}, not {f'{shown(value)} {unit}'.strip()}: {why}"
    elif kind in _WANTED or kind == "alternatives":
        wanted = _WANTED.get(kind) or context["wanted"]
        message, hint = f"must be {wanted}, not {shown(value)}", _unit_advice(value, unit) if kind in _NUMBERS else ""
    elif kind == "literal_error":
        message, hint = _choice(context["expected"], value)
    elif kind == "unknown_name":
        elsewhere = "`testbed --aircraft-path DIR` looks elsewhere too" if context["what"] == "aircraft" else ""
        message, hint = error["msg"], did_you_mean(str(value), context["listing"].split(", ")) or elsewhere
    elif kind == "unknown_option":
        message, hint = error["msg"], did_you_mean(context["option"], context["listing"].split(", "))
    elif kind == "bad_option":
        message = error["msg"]
    elif kind == "string_pattern_mismatch":
        message = f"must be letters, digits, '_' and '-' only, not {shown(value)}"
    elif kind == "string_too_long":
        message = f"must have at most {context['max_length']} characters, not {len(value)}"
    elif kind == "finite_number":
        message = f"must be a finite number, not {shown(value)}"
    elif kind == "value_error":
        message = str(context["error"])
    else:
        message = error["msg"].replace("Input should be", "must be")
    return message, hint


def of_unions(errors: Sequence[ErrorDetails]) -> list[ErrorDetails]:
    """The errors without pydantic's names of a union's alternatives in their places, and one for each value that is none of them.

    A value that is of an alternative's type is told what that one wants of it; any other what all of them are.
    """
    found: dict[Loc, list[tuple[int, ErrorDetails]]] = {}
    for error in errors:
        loc = error["loc"]
        cut = next((k for k, part in enumerate(loc) if k and _names_alternative(part, k == len(loc) - 1)), None)
        bare: ErrorDetails = error if cut is None else {**error, "loc": (*loc[:cut], *loc[cut + 1 :])}
        found.setdefault(("", len(found)) if cut is None else loc[:cut], []).append((len(loc) if cut is None else cut, bare))
    return [one for group in found.values() for one in _of_one_value(group)]


def _names_alternative(part: int | str, last: bool) -> bool:
    return isinstance(part, str) and (bool(_ALTERNATIVE.fullmatch(part)) or (last and part in _PLAIN))


def _of_one_value(group: list[tuple[int, ErrorDetails]]) -> list[ErrorDetails]:
    if len(group) == 1:
        return [group[0][1]]
    if inside := [error for cut, error in group if len(error["loc"]) > cut]:
        return inside
    fits = [error for _, error in group if error["type"] not in (*_WANTED, "literal_error")]
    wanted = [_WANTED.get(error["type"]) or error["ctx"]["expected"] for _, error in group if error not in fits]
    first = group[0][1]
    return fits[:1] or [{**first, "type": "alternatives", "ctx": {"wanted": " or ".join(dict.fromkeys(wanted))}}]


def follows(error: ErrorDetails) -> bool:
    """Whether pydantic says only that a list is short of what it has itself refused: the refused items have errors of their own."""
    return error["type"] == "too_short" and len(error["input"]) >= error["ctx"]["min_length"]


def _incomplete(loc: Loc, holder: Any, kind: str, value: Any, context: dict[str, Any]) -> tuple[Loc, str, str]:
    """A missing key, or a list of the wrong length. ``holder``: what the last step of ``loc`` is a part of."""
    if kind == "missing" and isinstance(loc[-1], str):
        return loc, "this key is missing", ""
    if kind == "missing":  # an item of a list of fixed length; pydantic says so once for each
        loc, wanted = loc[:-1], fixed_length(holder)
    else:
        wanted = fixed_length(below(holder, loc[-1])) if loc else None
    words = ""
    if wanted is None:
        wanted, words = (context["min_length"], "at least ") if kind == "too_short" else (context["max_length"], "at most ")
    return loc, f"must have {words}{wanted} value{'' if wanted == 1 else 's'}, not {len(value)}", ""


def _unit_advice(value: Any, unit: str) -> str:
    """``30 m`` was written where the key says metres already."""
    if not (isinstance(value, str) and unit):
        return ""
    number = value.strip().split(" ")[0]
    try:
        float(number)
    except ValueError:
        return ""
    return f"write {number}, without quotes or unit: the key says {unit}"
