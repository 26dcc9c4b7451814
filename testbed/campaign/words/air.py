"""The air of a campaign: mean wind, one discrete gust, turbulence."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from testbed.core.section import Between, Direction, Distance, Flat, Instant, NoAir, NonNegative, Number, Positive, Section

WindSpeed = Annotated[NonNegative, Field(le=40)]
Above = Annotated[Positive, Between("that is no height above the ground", least=0.001), NoAir]
From = Annotated[Number, Field(ge=-360, le=360)]
Severity = Literal["light", "moderate", "severe"]


class Calm(Section):
    """Still air."""

    kind: Literal["calm"] = "calm"


class SteadyWind(Section):
    """The same wind everywhere and always."""

    kind: Literal["steady"]
    speed_mps: WindSpeed
    """Speed of the air over the ground, m/s."""
    from_deg: From
    """Compass direction the wind comes FROM, deg."""


class PowerLawWind(Section):
    """A wind that grows with height above the ground: W = speed (h / reference)^exponent."""

    kind: Literal["power_law"]
    speed_mps: WindSpeed
    """Speed of the air over the ground at the reference height, m/s."""
    from_deg: From
    """Compass direction the wind comes FROM, deg."""
    reference_height_m: Above = 10.0
    """Height above the ground of speed_mps, m."""
    exponent: Annotated[NonNegative, Field(le=1)] = 1.0 / 7.0
    """1/7 over open ground by day."""


class LogarithmicWind(Section):
    """The wind of a neutral surface layer: W = speed ln(h / roughness) / ln(reference / roughness), 0 below the roughness length."""

    kind: Literal["logarithmic"]
    speed_mps: WindSpeed
    """Speed of the air over the ground at the reference height, m/s."""
    from_deg: From
    """Compass direction the wind comes FROM, deg."""
    reference_height_m: Above = 10.0
    """Height above the ground of speed_mps, m."""
    roughness_m: Annotated[Positive, Between("no ground is smoother", least=1e-6), NoAir] = 0.05
    """Roughness length of the ground, m. Grass: 0.05. MIL-F-8785C: 0.046 (0.15 ft) for landing, 0.61 (2 ft) for the rest."""

    @model_validator(mode="after")
    def _reference_is_above_the_grass(self) -> "LogarithmicWind":
        if self.roughness_m >= self.reference_height_m:
            raise ValueError("reference_height_m must be more than roughness_m")
        return self


class NoGust(Section):
    """No discrete gust."""

    kind: Literal["none"] = "none"


class _DiscreteGust(Section):
    """What every discrete gust has."""

    amplitude_mps: Annotated[NonNegative, Field(le=40)]
    """Speed of the gust at its full strength, m/s."""
    direction_deg: Direction = (0.0, 90.0)
    """Direction towards which the gust blows, in its frame: [azimuth counter-clockwise, elevation up], deg. [0, 90] is an updraught."""
    frame: Literal["track", "enu"] = "track"
    """Where azimuth 0 points. track: along the route, seen from above, where the gust begins (90 is to the left). enu: east."""
    at_time_s: Annotated[Instant, Field(ge=0)] | None = None
    """The gust begins at this time after the flight begins, everywhere at once, s."""
    at_route_s_m: Distance | None = None
    """The gust begins at the plane across the route at this arc length, and stands there, m."""

    @model_validator(mode="after")
    def _one_of(self) -> "_DiscreteGust":
        if (self.at_time_s is None) == (self.at_route_s_m is None):
            raise ValueError("give exactly one of at_time_s and at_route_s_m")
        return self


class StepGust(_DiscreteGust):
    """Full strength at once, and for ever."""

    kind: Literal["step"]


class OneMinusCosineGust(_DiscreteGust):
    """Rises as (1 - cos)/2 over a length, holds, and falls as it rose (MIL-F-8785C 3.7.1.3 rises and holds)."""

    kind: Literal["one_minus_cosine"]
    rise_m: Annotated[Positive, Between("that is a step gust", least=0.01), Flat]
    """Length from nothing to full strength (the gust length d_m of MIL-F-8785C), m. A gust in time passes at the set speed."""
    hold_m: Distance | None = 0.0
    """Length at full strength, m; empty: it never falls, as in MIL-F-8785C."""


class NoTurbulence(Section):
    """Smooth air."""

    kind: Literal["none"] = "none"


class DrydenTurbulence(Section):
    """One frozen MIL-F-8785C Dryden series per seed, the same for every plant, method and aircraft; a wing also feels it turn."""

    kind: Literal["dryden"]
    severity: Severity
    """light, moderate or severe (MIL-F-8785C 3.7.2, 3.7.3)."""
    height_m: Above | None = None
    """Height above the ground that sets strength and scale, m; empty: that of the route's start."""


class JsbsimTurbulence(Section):
    """JSBSim's own turbulence, with filters of its own. It depends on what is flown: equal seeds mean equal noise, not equal air."""

    kind: Literal["jsbsim"]
    severity: Severity
    """light, moderate or severe (MIL-F-8785C 3.7.2, 3.7.3)."""


Turbulence = NoTurbulence | DrydenTurbulence | JsbsimTurbulence


class Air(Section):
    """The air that every plant flies in."""

    wind: Annotated[Calm | SteadyWind | PowerLawWind | LogarithmicWind, Field(discriminator="kind")] = Calm()
    """Mean wind: what the planner may know and what traffic may drift with."""
    gust: Annotated[NoGust | StepGust | OneMinusCosineGust, Field(discriminator="kind")] = NoGust()
    """One discrete gust on top of the wind."""
    turbulence: Annotated[Turbulence, Field(discriminator="kind")] = NoTurbulence()
    """Turbulence on top of the wind."""
