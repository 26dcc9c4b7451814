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

    def __init__(self, why: str, least: float | None = None, most: float | None = None) -> None:
        self.why, self.least, self.most = why, least, most

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_after_validator_function(self._checked, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        told = {key: bound for key, bound in (("minimum", self.least), ("maximum", self.most)) if bound is not None}
        return handler(schema) | told

    def _checked(self, value: float) -> float:
        if self.least is not None and value < self.least:
            raise self._beyond("at least", self.least)
        if self.most is not None and value > self.most:
            raise self._beyond("at most", self.most)
        return value

    def _beyond(self, words: str, limit: float) -> PydanticCustomError:
        context = {"words": words, "limit": limit, "why": self.why}
        return PydanticCustomError("out_of_bounds", "must be {words} {limit}: {why}", context)


FARTHEST_M = 200_000.0
HIGHEST_M = 100_000.0
FASTEST_MPS = 3000.0
LONGEST_S = 86_400.0

Flat = Between("the ground is taken to be flat, which it is not farther away", -FARTHEST_M, FARTHEST_M)
NoAir = Between("there is no air to fly in beyond it", -HIGHEST_M, HIGHEST_M)
ADay = Between("that is a day, longer than any flight", -LONGEST_S, LONGEST_S)

Across = Annotated[Number, Flat]
Height = Annotated[Number, NoAir]
Point = tuple[Across, Across, Height]
Distance = Annotated[NonNegative, Flat]
Range = Annotated[Positive, Flat]
"""A distance that is not 0."""
Radius = Annotated[Positive, Between("less is a point, not a sphere", least=0.01), Flat]
Instant = Annotated[Number, ADay]
Duration = Annotated[Positive, ADay]
TrafficSpeed = Annotated[NonNegative, Between("nothing in the air is as fast", most=FASTEST_MPS)]
Azimuth = Annotated[Number, Between("that is ten turns", -3600.0, 3600.0)]
Elevation = Annotated[Number, Field(ge=-90, le=90)]
Direction = tuple[Azimuth, Elevation]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_\-]*$", max_length=60)]


class Section(BaseModel):
    """A frozen block of the YAML; an unknown key is an error. The text under a key is its description in the JSON Schema."""

    # Built when it is first used, and its texts are read by reading/json_schema.py alone: a worker starts sooner so.
    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)
