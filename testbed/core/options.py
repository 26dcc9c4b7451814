"""The options of a part, typed: read from its signature, or from the model ``Options`` that it carries.

    def avoid(own, obstacles, side: Literal["left", "right"] = "left", gain: float = 1.0): ...

has the options ``side`` and ``gain``. A whole number stays whole where ``int`` is asked for, true is no number, a list is a tuple.
Bounds are written as annotations (``Annotated[float, Field(gt=0)]``), in a model, or as a ``ValueError`` of the part itself: its
message begins with the option's name (``"gain: give a number above 0, got -1"``).
"""

import collections.abc
import inspect
import types
import typing
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, ValidationError, create_model
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError, core_schema

from testbed.core.section import Number, Whole

PYDANTICS_OWN = frozenset(get_args(core_schema.ErrorType))
STRICT: dict[Any, Any] = {
    float: Number,
    int: Whole,
    bool: Annotated[bool, Field(strict=True)],
    str: Annotated[str, Field(strict=True)],
}


class OptionsError(TypeError):
    """A part's parameters cannot be options of a YAML; str() says which and why."""


def model_of(part: Any, given: int) -> type[BaseModel]:
    """The options of a part as a model, which refuses unknown names. ``given``: its leading parameters that are none."""
    own = getattr(part, "Options", None)
    if isinstance(own, type) and issubclass(own, BaseModel):
        return own
    return _from_signature(part, given)


def checked(what: str, part: Any, given: int, options: Mapping[str, Any]) -> dict[str, Any]:
    """The options, each of its type; those that were left out stay out. Raises pydantic's ``ValidationError``, located by option.

    ``what`` names the part in messages: ``method 'scoam'``.
    """
    model = model_of(part, given)
    known = list(model.model_fields)
    try:
        found = model.model_validate(dict(options))
    except ValidationError as error:
        raise ValidationError.from_exception_data("options", [_told(what, item, known) for item in _whole(error.errors(), model)]) from None
    return {name: getattr(found, name) for name in known if name in found.model_fields_set}


def blamed(message: str, options: Mapping[str, Any]) -> ValidationError:
    """A part's own ``ValueError`` as pydantic's, located at the option that its message begins with, where it does."""
    names = [name.strip() for name in message.partition(":")[0].split(",")]
    name = next((name for name in names if name in options), None)
    text = message.partition(":")[2].strip() if name and names == [name] else message
    fault = PydanticCustomError("bad_option", "{text}", {"text": text})
    place = InitErrorDetails(type=fault, loc=(name,) if name else (), input=options.get(name) if name else None)
    return ValidationError.from_exception_data("options", [place])


def fixed_length(kind: Any, *way: int | str) -> int | None:
    """How many items a tuple has that has a fixed number of them, such as a point; None for anything else. ``way`` leads to it."""
    if get_origin(kind) is Annotated:
        return fixed_length(get_args(kind)[0], *way)
    if get_origin(kind) in (Union, types.UnionType):
        return next((found for part in get_args(kind) if (found := fixed_length(part, *way)) is not None), None)
    if way:
        return fixed_length(_inside(kind, way[0]), *way[1:])
    items = get_args(kind) if get_origin(kind) is tuple else ()
    return len(items) if items and items[-1] is not Ellipsis else None


def _inside(kind: Any, step: int | str) -> Any:
    """Type of what a key or an index leads to; None if that is not known."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return kind.model_fields[str(step)].annotation if step in kind.model_fields else None
    if get_origin(kind) is not tuple:
        return None
    if isinstance(step, str):  # pydantic's name for an alternative of a union
        return kind
    items = get_args(kind)
    return items[0] if items[-1] is Ellipsis else items[step] if step < len(items) else None


def _whole(errors: list[ErrorDetails], model: type[BaseModel]) -> list[ErrorDetails]:
    """The errors, where those of a tuple's missing items (pydantic has one for each, up to the last) are one of the tuple's length."""
    lengths: dict[tuple[int | str, ...], int] = {}
    for error in errors:
        *holder, item = error["loc"] or (None,)  # of the options as a whole: a name that is no text
        if error["type"] == "missing" and isinstance(item, int):
            lengths[tuple(holder)] = item + 1
    found: dict[Any, ErrorDetails] = {}
    for error in errors:
        loc = error["loc"]
        if error["type"] == "missing" and (wanted := lengths.get(loc[:-1])):
            loc, error = loc[:-1], _of_length(error, loc[:-1], wanted)  # noqa: PLW2901
        elif error["type"] == "too_long" and (wanted := fixed_length(model, *loc) or 0):
            error = _of_length(error, loc, wanted)  # noqa: PLW2901
        found[loc, error["type"]] = error
    return list(found.values())


def _of_length(error: ErrorDetails, loc: tuple[int | str, ...], wanted: int) -> ErrorDetails:
    """The error of a tuple that has to have so many items."""
    text, context = "must have {wanted} values, not {actual}", {"wanted": wanted, "actual": len(error["input"])}
    return {**error, "type": "wrong_length", "loc": loc, "msg": text, "ctx": context}


def _told(what: str, error: ErrorDetails, known: list[str]) -> InitErrorDetails:
    """An error of the model; a name that it does not have is told with those that it has."""
    kind: Any = error["type"]
    if kind == "extra_forbidden":
        text: Any = "unknown option '{option}' of the {what}" + ("; it has: {listing}" if known else ", which has none")
        kind = PydanticCustomError("unknown_option", text, {"what": what, "option": error["loc"][-1], "listing": ", ".join(known)})
    elif kind not in PYDANTICS_OWN:  # of a validator, which the library knows by its words alone
        kind = PydanticCustomError(kind, error["msg"], error.get("ctx"))
    return InitErrorDetails(type=kind, loc=error["loc"], input=error["input"], ctx=error.get("ctx", {}))


@lru_cache(maxsize=256)
def _from_signature(part: Any, given: int) -> type[BaseModel]:
    try:
        parameters = list(inspect.signature(part).parameters.values())
    except (TypeError, ValueError):  # the latter for some that are not written in Python
        raise OptionsError("it is nothing that can be called, with parameters that can be read") from None
    leading = [p for p in parameters if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    if len(leading) < given and not any(p.kind is p.VAR_POSITIONAL for p in parameters):
        raise OptionsError(f"takes {len(leading)} parameters, and is given {given}")
    if any(p.kind is p.VAR_KEYWORD for p in parameters):
        raise OptionsError("takes **options: name each one, so that a campaign can be checked against them")
    hints = _hints(part)
    fields: dict[str, Any] = {}
    for parameter in parameters:
        if parameter in leading[:given] or parameter.kind is parameter.VAR_POSITIONAL:
            continue
        default = ... if parameter.default is parameter.empty else parameter.default
        annotation = hints.get(parameter.name, Any if default in (..., None) else type(default))
        fields[parameter.name] = (_strict(annotation, parameter.name), default)
    return create_model("Options", __config__=ConfigDict(extra="forbid", arbitrary_types_allowed=False), **fields)


def _hints(part: Any) -> dict[str, Any]:
    function = part.__init__ if inspect.isclass(part) else part
    try:
        return typing.get_type_hints(function, include_extras=True)
    except NameError as bug:
        raise OptionsError(f"an annotation cannot be read: {bug}") from None


def _strict(annotation: Any, name: str) -> Any:
    """The annotation as YAML is held to it."""
    origin, inner = get_origin(annotation), get_args(annotation)
    if annotation in STRICT or annotation in (Any, None, type(None)) or origin is Literal:
        return STRICT.get(annotation, annotation)
    if origin is Annotated:
        return Annotated[_strict(inner[0], name), *inner[1:]]
    if origin in (Union, types.UnionType):
        return Union[tuple(_strict(part, name) for part in inner)]  # noqa: UP007 (made from a tuple)
    if origin is tuple:
        return tuple[tuple(part if part is Ellipsis else _strict(part, name) for part in inner)]  # type: ignore[misc]
    if origin in (list, Sequence, collections.abc.Sequence) and inner:
        return tuple[_strict(inner[0], name), ...]  # type: ignore[misc]
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    raise OptionsError(f"the type of '{name}' cannot be written in a YAML: {getattr(annotation, '__name__', annotation)}")
