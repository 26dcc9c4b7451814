"""What the vocabulary is made of: numbers, points, directions, names, and the frozen section."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

# Strict: neither true nor "30" is a number. An int is a float, a list is a tuple.
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Whole = Annotated[int, Field(strict=True)]
Positive = Annotated[Number, Field(gt=0)]
NonNegative = Annotated[Number, Field(ge=0)]
Point = tuple[Number, Number, Number]
Elevation = Annotated[Number, Field(ge=-90, le=90)]
Direction = tuple[Number, Elevation]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_\-]*$", max_length=60)]


class Section(BaseModel):
    """A frozen block of the YAML; an unknown key is an error. The text under a key is its description in the JSON Schema."""

    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)
