"""How flights are varied: the grid of a sweep, what is drawn for each replicate, and the parts of a campaign."""

import math
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from testbed.campaign.words.encounters import Meetings
from testbed.core.section import Number, Section, Whole

PART = "part"
"""The first label of each flight of a campaign with parts."""

Settings = dict[str, object]
"""Dotted path to YAML value, e.g. ``{"method.kind": "none"}``."""

Sweep = dict[str, list[object] | dict[str, Settings]]
"""``dotted.path: [values]`` or ``axis_name: {label: {dotted.path: value, ...}, ...}`` for each axis."""

Label = str | Number | bool
Skip = dict[str, Label | tuple[Label, ...]]
"""Axis to a label of it, or to several."""

Replicates = Annotated[Whole, Field(ge=1, le=100_000)]
Stored = Literal["all", "none", "selected"]


def _amount(value: object) -> object:
    """Checked before the union is tried, which would report one bad value twice."""
    items = value if isinstance(value, list | tuple) and value else [value]
    if any(isinstance(item, bool) or not isinstance(item, int | float) or not math.isfinite(item) for item in items):
        raise ValueError("must be a finite number, or a list of them")
    return tuple(map(float, items)) if isinstance(value, list | tuple) else float(items[0])  # type: ignore[arg-type]


Amount = Annotated[float | tuple[float, ...], BeforeValidator(_amount)]


class Draw(Section):
    """How a setting differs between replicates. Replicate 0 keeps it as written; the others draw it, each from its own stream.

    What is drawn depends on the seed, the replicate and the path alone, so every cell, method, plant and aircraft gets the same.
    """

    within: Amount | None = None
    """Evenly, at most so far to either side of the value that is set; a list goes element by element, and one number does for all of
    them. For a number that was printed rounded: half a unit in its last place, 0.05 for 12.4."""
    between: tuple[Amount, Amount] | None = None
    """Evenly, between two numbers or, element by element, two lists of them."""
    among: tuple[object, ...] | None = None
    """One of these values, each as likely."""

    @model_validator(mode="after")
    def _one_of(self) -> "Draw":
        if [self.within, self.between, self.among].count(None) != 2:
            raise ValueError("give exactly one of within, between and among")
        if self.among == ():
            raise ValueError("among needs at least one value")
        if self.within is not None and min(_items(self.within)) < 0.0:
            raise ValueError("within is a distance to either side: at least 0")
        if self.between is not None:
            low, high = self.between
            if isinstance(low, tuple) != isinstance(high, tuple) or len(_items(low)) != len(_items(high)):
                raise ValueError("between takes two numbers, or two lists of as many numbers")
            if any(a > b for a, b in zip(_items(low), _items(high), strict=True)):
                raise ValueError("between: the first is more than the second")
        return self


def _items(amount: float | tuple[float, ...]) -> tuple[float, ...]:
    return amount if isinstance(amount, tuple) else (amount,)


class Grid(Section):
    """Cells, and what is drawn for each replicate in them."""

    draw: dict[str, Draw] = {}  # noqa: RUF012 (pydantic copies it)
    """Settings that are drawn for each replicate but the first, which has them as written: dotted path to how."""
    encounters: Meetings | None = None
    """One encounter for each replicate: the obstacle O, or O1, O2, ..., beside those that are named."""
    skip: tuple[Skip, ...] = ()
    """Cells that are not flown: those that have, for every axis of an entry, the label given there or one of them."""
    sweep: Sweep = {}  # noqa: RUF012 (pydantic copies it)


class Part(Grid):
    """A part of a campaign: settings of its own on top of the campaign's, a sweep of its own.

    What it draws comes on top of what the campaign draws; its encounters take the place of the campaign's.
    """

    set: Settings = {}  # noqa: RUF012 (pydantic copies it)
    """Settings of this part: dotted paths and their values."""
    replicates: Replicates | None = None
    """Flights per cell; empty: as the campaign says."""
    recordings: Stored | None = None
    """Which flights leave a .rrd recording; empty: as the campaign says."""
    columns: Stored | None = None
    """Which flights leave their raw columns; empty: as the campaign says."""
