"""A section that names a part to plug in, and the part's own options."""

from typing import Any, ClassVar

from pydantic import ConfigDict, Field, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

from testbed.core import options as typed
from testbed.core import plugins, registry
from testbed.core.section import Section


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
        what, part = f"{cls.family} '{kind}'", registry.part(cls.family, kind)
        try:
            found = typed.checked(what, part, registry.given(cls.family, part), options)
        except typed.OptionsError as error:
            raise ValueError(f"the {what} cannot be used: {error}") from None
        try:
            cls._try(part, found)
        except ValueError as error:
            raise typed.blamed(str(error), found) from None
        except (Exception, SystemExit) as bug:  # a part that leaves must not take the reader along; Ctrl-C still does
            raise ValueError(f"the {what} fails when it is tried: {type(bug).__name__}: {bug}") from bug
        return found

    @classmethod
    def _try(cls, part: Any, options: dict[str, Any]) -> None:
        """Use the part once, so that it can refuse a value with a ``ValueError``."""
