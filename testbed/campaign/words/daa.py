"""What a campaign says of detect and avoid: which volumes are to be kept, by what limits, and when it has flown enough.

Nothing of it changes a flight: the same flights are measured and judged by it.
"""

from typing import Annotated, Final, Literal

from pydantic import Field, model_validator

from testbed.core.section import NonNegative, Number, Positive, Radius, Section, Whole
from testbed.core.units import FT

SPHERE: Final = "sphere"
"""What the obstacle's own sphere is called among the volumes."""

VolumeName = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=40)]


class Volume(Section):
    """A volume about the obstacle's centre that the own aircraft is to keep out of: an upright cylinder, or a sphere."""

    shape: Literal["cylinder", "sphere"] = "cylinder"
    """cylinder: upright, about the obstacle. sphere: without a half height."""
    radius_m: Radius
    """Radius of the cylinder (for a well-clear volume its DMOD and HMD) or of the sphere, m."""
    half_height_m: Radius | None = None
    """From the middle of the cylinder to its lid, m."""
    tau_s: Annotated[Number, Field(ge=0, le=3600)] = 0.0
    """Of a cylinder: it reaches out to where the modified tau is this long, if the two would pass within its radius, s. 0: it does not."""
    edge: Literal["in", "out"] = "out"
    """Whether a place exactly on the limit is inside."""

    @model_validator(mode="after")
    def _fits_its_shape(self) -> "Volume":
        if self.shape == "cylinder" and self.half_height_m is None:
            raise ValueError("a cylinder needs half_height_m")
        if self.shape == "sphere" and (self.half_height_m is not None or self.tau_s):
            raise ValueError("a sphere has no half_height_m and no tau_s")
        return self


def _cylinder(radius_ft: float, half_height_ft: float, edge: Literal["in", "out"], tau_s: float = 0.0) -> Volume:
    return Volume(radius_m=radius_ft * FT, half_height_m=half_height_ft * FT, tau_s=tau_s, edge=edge)


def standards() -> dict[str, Volume]:
    """The volumes of the standards, by their names here. A campaign's own volume of one of these names takes its place."""
    return {
        "nmac": _cylinder(500.0, 100.0, "out"),
        "do365_phase_1": _cylinder(4000.0, 450.0, "in", 35.0),
        "do365_non_cooperative": _cylinder(2200.0, 450.0, "in"),
        "do365_terminal": _cylinder(1500.0, 450.0, "in"),
        "astm_f3442": _cylinder(2000.0, 250.0, "out"),
    }


Standard = Literal["nmac", "do365_phase_1", "do365_non_cooperative", "do365_terminal", "astm_f3442"]


class Power(Section):
    """What `testbed validate` is to say: how many encounters it takes until the interval of a ratio of risk is so wide."""

    width: Positive
    """Of the 95 % interval of the ratio, from end to end."""
    ratio: Annotated[Number, Field(gt=0, le=1000)] = 0.3
    """The ratio that is expected."""
    share: Annotated[Number, Field(gt=0, le=1)] = 0.5
    """Share of the encounters that are expected to come into the volume without avoidance."""
    induced: NonNegative = 0.0
    """The part of the ratio that is expected of encounters that came into it with avoidance alone."""

    @model_validator(mode="after")
    def _can_be(self) -> "Power":
        if self.induced > self.ratio:
            raise ValueError("induced is a part of ratio, and cannot be more")
        if self.ratio - self.induced > 1.0:
            raise ValueError("ratio less induced, the unresolved part, cannot be more than 1")
        if self.share * (1.0 + self.induced) > 1.0:
            raise ValueError("share * (1 + induced) are the encounters with an event: cannot be more than 1")
        return self


class Daa(Section):
    """Metrics of detect and avoid: columns of each flight and, where there are flights without avoidance, ratios of risk."""

    standards: tuple[Standard, ...] = ("nmac", "do365_phase_1", "do365_non_cooperative", "do365_terminal", "astm_f3442")
    """Which volumes of the standards are looked at, with the limits that `docs/daa.md` lists."""
    volumes: dict[VolumeName, Volume] = {}  # noqa: RUF012 (pydantic copies it)
    """Volumes of one's own by name, cylinders or spheres; one with the name of a standard's takes its place."""
    dmod_m: Radius = 4000.0 * FT
    """DMOD of the column least_tau_mod_s, m."""
    needed_by: str = SPHERE
    """Into which volume the route has to lead for a manoeuvre to be needed: sphere (the obstacle's own), or the name of one."""
    weight: str = ""
    """Column of results.csv with the weight of an encounter (an axis of the sweep as `label.<axis>`); empty: the column `weight` of
    encounters that have one (`drawn`), else all weigh the same."""
    accepted_ratio: Annotated[Number, Field(gt=0, le=1000)] = 0.3
    """Ratio of risk that is good enough where the upper end of its interval is no more; the page says where on the axes that is."""
    power: Power | None = None
    """What is expected and how narrow an interval is wanted: `testbed validate` then says how many encounters that takes."""

    @model_validator(mode="after")
    def _named_volumes_are_there(self) -> "Daa":
        if SPHERE in self.volumes:
            raise ValueError(f"volumes: '{SPHERE}' is the obstacle's own sphere; choose another name")
        if self.needed_by not in (SPHERE, *self.all_volumes):
            raise ValueError(f"needed_by: no volume '{self.needed_by}'; there are: {', '.join((SPHERE, *self.all_volumes))}")
        return self

    @property
    def all_volumes(self) -> dict[str, Volume]:
        """By name: those of the standards, then one's own."""
        known = standards()
        return {name: known[name] for name in self.standards} | self.volumes


class Stop(Section):
    """When a campaign has flown enough: its replicates are flown in batches, all cells alike, until an interval is narrow enough.

    It is decided after whole batches alone, by their rows in the order of the plan, so that it stops at the same flight whatever the
    number of workers.
    """

    column: str
    """What the interval is of: `risk_ratio.<volume>`, or a column of results.csv (true or false: its share; a number: its median)."""
    width: Positive
    """The 95 % interval of every cell is to be at most this wide (of a ratio: that of every method), in the unit of the column."""
    every: Annotated[Whole, Field(ge=10, le=100_000)] = 100
    """Replicates in a batch; after ten batches each is a tenth of what has been flown."""
