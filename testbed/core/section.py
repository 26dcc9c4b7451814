"""What the vocabulary is made of: numbers, points, directions, names, and the frozen section."""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

# Strict: neither true nor "30" is a number. An int is a float, a list is a tuple.
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Whole = Annotated[int, Field(strict=True)]
Positive = Annotated[Number, Field(gt=0)]
NonNegative = Annotated[Number, Field(ge=0)]


class Between:
    """A bound of a number that says why it is there: what lies beyond would be no flight, or more than a computer holds."""

    def __init__(self, least: float | None, most: float | None, why: str) -> None:
        self.least, self.most, self.why = least, most, why

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_after_validator_function(self._checked, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        told = {key: bound for key, bound in (("minimum", self.least), ("maximum", self.most)) if bound is not None}
        return handler(schema) | told

    def _checked(self, value: float) -> float:
        if self.least is not None and value < self.least:
            raise PydanticCustomError("out_of_bounds", "must be at least {limit}", {"limit": self.least, "words": "at least", "why": self.why})
        if self.most is not None and value > self.most:
            raise PydanticCustomError("out_of_bounds", "must be at most {limit}", {"limit": self.most, "words": "at most", "why": self.why})
        return value


FARTHEST_M = 200_000.0
HIGHEST_M = 100_000.0
LONGEST_S = 86_400.0
_FLAT = "the ground is taken to be flat, which it is not farther away"
_A_DAY = "that is a day, longer than any flight"

Across = Annotated[Number, Between(-FARTHEST_M, FARTHEST_M, _FLAT)]
Height = Annotated[Number, Between(-HIGHEST_M, HIGHEST_M, "there is no air to fly in beyond it")]
Point = tuple[Across, Across, Height]
Distance = Annotated[NonNegative, Between(None, FARTHEST_M, _FLAT)]
Range = Annotated[Positive, Between(None, FARTHEST_M, _FLAT)]
"""A distance that is not 0."""
Radius = Annotated[Positive, Between(0.01, FARTHEST_M, "a centimetre is a point, and 200 km reach farther than the ground is flat")]
Instant = Annotated[Number, Between(-LONGEST_S, LONGEST_S, _A_DAY)]
Duration = Annotated[Positive, Between(None, LONGEST_S, _A_DAY)]
TrafficSpeed = Annotated[NonNegative, Between(None, 3000.0, "nothing in the air is as fast")]
Azimuth = Annotated[Number, Between(-3600.0, 3600.0, "that is ten turns")]
Elevation = Annotated[Number, Field(ge=-90, le=90)]
Direction = tuple[Azimuth, Elevation]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_\-]*$", max_length=60)]


class Section(BaseModel):
    """A frozen block of the YAML; an unknown key is an error. The text under a key is its description in the JSON Schema."""

    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)
