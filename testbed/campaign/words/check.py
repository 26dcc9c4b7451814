"""How a check campaign is judged: against what, and how closely. The judging is in ``testbed.results.checks``."""

from typing import Annotated, Literal

from pydantic import Field

from testbed.core import section
from testbed.core.section import Between, Section

MOST = 1e9
NoLarger = Between("no number that is judged is larger", most=MOST)
Number = Annotated[section.Number, Between("no number that is judged is larger", -MOST, MOST)]
NonNegative = Annotated[section.NonNegative, NoLarger]
Positive = Annotated[section.Positive, Between("rounding alone is more", least=1e-12), NoLarger]
"""A bound that a computed number can keep, and miss."""


class CheckSection(Section):
    """What every check says of itself; the page shows it beside the verdict."""

    verifies: str
    """What a pass proves, in a sentence."""
    truth: str
    """What the flights are held against, and why that does not come from the code under test."""
    tolerance: str
    """Why the bounds are what they are."""


class WindTriangle(CheckSection):
    """Straight flight in a steady wind: drift angle and ground speed of the last half of each flight against the wind triangle."""

    kind: Literal["wind_triangle"]
    speed_tolerance_mps: Positive
    """Largest error of the ground speed, m/s."""
    angle_tolerance_deg: Positive
    """Largest error of the drift angle, deg."""


class GustResponse(CheckSection):
    """Load factor in a one-minus-cosine gust against the superposition of responses to a step gust (linear theory).

    Where a point mass and six degrees of freedom met the same gust, the peak of the one against that of the other too.
    """

    kind: Literal["gust_response"]
    share_tolerance: Positive
    """Largest error of the load factor, as a share of its peak."""
    point_mass_share_tolerance: Positive = 0.12
    """Largest error of the point mass's peak, as a share of that of six degrees of freedom."""


class TurbulenceStatistics(CheckSection):
    """Standard deviation and spectrum of the air that was flown through against MIL-F-8785C."""

    kind: Literal["turbulence"]
    deviations: Positive
    """How many standard errors of the estimate itself a standard deviation may be off."""
    band_share_tolerance: Positive
    """Largest error of the power in a band of frequencies, as a share of the power specified there, beside the statistical error."""
    span_m: Positive | None = None
    """Wing span that the roll, pitch and yaw rates of the air are specified for, m; empty: they are not judged."""


class WindInvariance(CheckSection):
    """Traffic and goal that drift with a uniform wind: what the planner decides, seen from the air, is what it decides in calm air."""

    kind: Literal["invariance"]
    speed_tolerance_mps: Positive
    """Largest error of a velocity, m/s."""
    place_tolerance_m: Positive
    """Largest error of a position, m."""
    angle_tolerance_deg: Positive
    """Largest error of an angle, deg."""


class SteadyTurn(CheckSection):
    """The third quarter of a level circle in calm air: radius V^2 / (g tan phi) of the bank and airspeed flown, and no sideslip."""

    kind: Literal["steady_turn"]
    radius_share_tolerance: Positive
    """Largest error of the radius, as a share of it."""
    sideslip_tolerance_deg: Positive
    """Largest sideslip on average, deg."""


class PublishedTrim(Section):
    """Straight flight as somebody else computed it."""

    climb_deg: Number
    """Climb angle, deg."""
    alpha_deg: Number
    """Angle of attack, deg."""
    throttle: NonNegative
    """Throttle, 0 to 1."""


class Trims(CheckSection):
    """Angle of attack and throttle of straight flights against published trims of the same climb angle."""

    kind: Literal["trims"]
    published: tuple[PublishedTrim, ...]
    """One for each climb angle of the sweep."""
    alpha_tolerance_deg: Positive
    """Largest error of the angle of attack, deg."""
    throttle_tolerance: Positive
    """Largest error of the throttle."""


class ExcessPower(CheckSection):
    """Climb at full throttle: rate of change of the energy height h + V^2/2g at a speed against the specific excess power there."""

    kind: Literal["excess_power"]
    at_speed_mps: Positive
    """The true airspeed at which it is taken, while the aircraft slows down through it, m/s."""
    steepest_climb_deg: Positive
    """The climb at that speed and full throttle that is published for the aircraft, deg. The excess power is V sin of it."""
    power_tolerance_mps: Positive
    """Largest error of the specific excess power, m/s."""


class Energy(CheckSection):
    """Energy height gained over a flight against the work of thrust and drag that the aircraft's data sheet gives along it."""

    kind: Literal["energy"]
    height_tolerance_m: Positive
    """Largest error of the energy height at any time, m."""


class Modes(CheckSection):
    """Modes of motion, found in the record of a disturbed flight by regression, against published ones."""

    kind: Literal["modes"]
    roll_mode_s: Positive
    """Time constant of the roll mode, s."""
    dutch_roll_radps: Positive
    """Angular frequency of the Dutch roll, rad/s."""
    dutch_roll_damping: Positive
    """Damping ratio of the Dutch roll."""
    servo_lag_s: NonNegative
    """First-order lag from command to surface, s."""
    share_tolerance: Positive
    """Largest error of each, as a share of it."""


class Convergence(CheckSection):
    """The same flight at several rates of the plant, all else alike: clearance and path against those of the finest."""

    kind: Literal["convergence"]
    clearance_tolerance_m: Positive
    """Largest difference of the least clearance, m."""
    place_tolerance_m: Positive
    """Largest distance between the places at equal times, m."""
    least_order: Positive
    """The order of convergence at least: an error of h^p shrinks 2^p-fold from rate to doubled rate."""
    rounding_m: Positive
    """Differences of places below this are rounding, and have no order, m."""


class Clearance(CheckSection):
    """Straight flight past fast traffic whose closest approach lies between two samples: least clearance against two straight lines."""

    kind: Literal["clearance"]
    clearance_tolerance_m: Positive
    """Largest error of the least clearance, m."""
    time_tolerance_s: Positive
    """Largest error of its time, s."""


Check = Annotated[
    WindTriangle
    | GustResponse
    | TurbulenceStatistics
    | WindInvariance
    | SteadyTurn
    | Trims
    | ExcessPower
    | Energy
    | Modes
    | Convergence
    | Clearance,
    Field(discriminator="kind"),
]
