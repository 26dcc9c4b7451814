"""A section that names a part to plug in, and the part's own options."""

import inspect
from typing import Any, ClassVar

from pydantic import ConfigDict, Field, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

from testbed.core import options as typed
from testbed.core import plugins, registry
from testbed.core.kept import Kept
from testbed.core.section import Section
from testbed.core.utf8 import reason

_tried: Kept[dict[str, Any]] = Kept(1000)
"""Options that a part has taken: the thousands of cells of a campaign ask for few."""


def _with_names(schema: dict[str, Any], model: "type[Pluggable]") -> None:
    """What an editor may complete: the built-in names, and that there are others. Methods come and go: `testbed list` shows them."""
    if model.__dict__.get("family") not in (None, "method"):
        kind = schema["properties"]["kind"]
        kind["anyOf"] = [{"enum": registry.names(model.family)}, {"type": kind.pop("type")}]


class Pluggable(Section):
    """``kind`` is the name of a part of the family, or ``"file:attribute"`` of a plug-in; ``options`` are checked against that part.

    A family with a setting that parts can be tried in says so by ``_try``: what a part itself refuses is then told with its place.
    """

    model_config = ConfigDict(json_schema_extra=_with_names)

    family: ClassVar[str]
    role: ClassVar[str] = ""
    """What a part makes, with its article: a planner."""
    needs: ClassVar[tuple[str, ...]] = ()
    """The methods that it must have."""

    kind: str
    options: dict[str, Any] = Field(default={}, validate_default=True)
    """The part's own options."""

    @field_validator("kind")
    @classmethod
    def _is_known(cls, kind: str) -> str:
        try:
            registry.part(cls.family, kind)
        except registry.UnknownPartError as error:
            context = {"what": cls.family, "name": kind, "listing": ", ".join(error.known)}
            raise PydanticCustomError("unknown_name", "no {what} '{name}'; there are: {listing}", context) from None
        except plugins.PluginError as error:
            raise ValueError(str(error)) from None
        return kind

    @field_validator("options")
    @classmethod
    def _are_the_part_s(cls, options: dict[str, Any], info: ValidationInfo) -> dict[str, Any]:
        kind = info.data.get("kind")
        if kind is None or (not options and kind == cls.model_fields["kind"].default):  # told already; what is flown unless asked otherwise
            return options
        part = registry.part(cls.family, kind)
        return dict(_tried.get((cls, kind, part, repr(options)), lambda: cls._used_once(kind, part, options)))

    @classmethod
    def _used_once(cls, kind: str, part: Any, options: dict[str, Any]) -> dict[str, Any]:
        """The options as the part takes them. Raises ``ValueError`` where it cannot be used with them."""
        what = f"{cls.family} '{kind}'"
        try:
            cls._fits(part, options)
        except ValueError as error:
            raise ValueError(f"the {what} cannot be used: {error}") from None
        try:
            found = typed.checked(what, part, registry.given(cls.family, part), options)
        except typed.OptionsError as error:
            raise ValueError(f"the {what} cannot be used: {error}") from None
        try:
            cls._try(part, found)
        except KeyboardInterrupt:
            raise
        except BaseException as bug:  # a part that leaves must not take the reader along
            if isinstance(bug, ValueError):
                raise typed.blamed(reason(bug).partition(": ")[2], found) from None
            raise ValueError(f"the {what} fails when it is tried: {reason(bug)}") from None
        return found

    @classmethod
    def _fits(cls, part: Any, options: dict[str, Any]) -> None:
        """Raise ``ValueError`` where the part is plainly one of another family: its options would be compared with the wrong parameters."""
        if inspect.isclass(part):
            cls._has_all(part, part)
        elif cls.needs and inspect.isfunction(part):
            parameters = list(inspect.signature(part).parameters.values())[registry.given(cls.family, part) :]
            wanted = [p.name for p in parameters if p.default is p.empty and p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
            if missing := [name for name in wanted if name not in options]:
                raise ValueError(
                    f"this is a function that wants {', '.join(missing)}; {cls.role} is a class with {' and '.join(cls.needs)}"
                )

    @classmethod
    def _has_all(cls, made: Any, of: type) -> None:
        """``made``, an ``of`` or the class itself, must have the methods of the family."""
        if missing := [name for name in cls.needs if not callable(getattr(made, name, None))]:
            raise ValueError(f"{cls.role} needs {' and '.join(cls.needs)}; {of.__name__} has no {' and no '.join(missing)}")

    @classmethod
    def _try(cls, part: Any, options: dict[str, Any]) -> None:
        """Use the part once, so that it can refuse a value with a ``ValueError``."""
