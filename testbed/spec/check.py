"""How a check campaign is judged: against what, and how closely. The judging is in ``testbed.results.checks``."""

from typing import Annotated, Literal

from pydantic import Field

from testbed.spec.base import Positive, Section


class WindTriangle(Section):
    """Straight flight in a steady wind: drift angle and ground speed of the last half of each flight against the wind triangle."""

    kind: Literal["wind_triangle"]
    speed_tolerance_mps: Positive
    """Largest error of the ground speed, m/s."""
    angle_tolerance_deg: Positive
    """Largest error of the drift angle, deg."""


class GustResponse(Section):
    """Load factor in a one-minus-cosine gust against the superposition of responses to a step gust (linear theory)."""

    kind: Literal["gust_response"]
    share_tolerance: Positive
    """Largest error of the load factor, as a share of its peak."""


class TurbulenceStatistics(Section):
    """Standard deviation and spectrum of the air that was flown through against MIL-F-8785C."""

    kind: Literal["turbulence"]
    deviations: Positive
    """How many standard errors of the estimate itself a standard deviation may be off."""
    band_share_tolerance: Positive
    """Largest error of the power in a band of frequencies, as a share of the power specified there, beside the statistical error."""


class WindInvariance(Section):
    """Traffic and goal that drift with a uniform wind: what the planner decides, seen from the air, is what it decides in calm air."""

    kind: Literal["invariance"]
    speed_tolerance_mps: Positive
    """Largest error of a velocity, m/s."""
    place_tolerance_m: Positive
    """Largest error of a position, m."""
    angle_tolerance_deg: Positive
    """Largest error of an angle, deg."""


Check = Annotated[WindTriangle | GustResponse | TurbulenceStatistics | WindInvariance, Field(discriminator="kind")]
