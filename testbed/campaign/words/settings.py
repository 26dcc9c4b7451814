"""What a campaign may say: the vocabulary of the YAML, validated and frozen.

Every key carries its unit.  ``FlightSettings`` is what one flight needs; a ``Campaign`` is settings plus a sweep, or parts with a
sweep each (``grid.py``); a ``FlightPlan`` is one cell and replicate of it, fully resolved.
"""

from collections.abc import Iterable
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, ValidationInfo, field_validator, model_validator
from pydantic_core import PydanticCustomError

from testbed.campaign.words.air import Air
from testbed.campaign.words.check import Check
from testbed.campaign.words.daa import Daa, Stop
from testbed.campaign.words.grid import Grid, Part, Replicates, Stored
from testbed.campaign.words.limits import Limits
from testbed.campaign.words.obstacles import ObstacleSpec, names_differ
from testbed.campaign.words.planning import MethodSpec, PlannerSpec, Replan, Sensor, TrackerSpec
from testbed.campaign.words.pluggable import Pluggable
from testbed.campaign.words.route import Route
from testbed.campaign.words.study import StudySpec
from testbed.core.catalogue import aircraft_folders
from testbed.core.section import (
    Between,
    Distance,
    Height,
    Name,
    NonNegative,
    Number,
    Positive,
    Section,
    Whole,
)


def _known(what: str, name: str, known: Iterable[str]) -> str:
    """``name``, if it is one of ``known``; the error carries both, so that a message can suggest the nearest."""
    if name not in (names := list(known)):
        context = {"what": what, "name": name, "listing": ", ".join(names) or "none"}
        raise PydanticCustomError("unknown_name", "no {what} '{name}'; there are: {listing}", context)
    return name


Aircraft = Annotated[str, AfterValidator(lambda name: _known("aircraft", name, aircraft_folders()))]


class Begin(Section):
    """Where on the route the flight starts: an arc length, or the first place where the climb is at most a limit."""

    at_route_s_m: Distance | None = None
    """Arc length along the route, m."""
    climb_at_most_deg: Annotated[Number, Field(gt=-90, lt=90)] | None = None
    """The first place where the route's climb angle is at most this, deg."""

    @model_validator(mode="after")
    def _one_of(self) -> "Begin":
        if (self.at_route_s_m is None) == (self.climb_at_most_deg is None):
            raise ValueError("give exactly one of at_route_s_m and climb_at_most_deg")
        return self


class PlantSpec(Pluggable):
    """Which physics flies the plan."""

    family = "plant"

    kind: str = "jsbsim"
    """kinematic: a point on the planned curve. point_mass: a point with the aircraft's limits. jsbsim: six degrees of freedom."""
    ideal: tuple[Literal["roll", "load_factor", "speed", "gust"], ...] = ()
    """Limits of the point_mass that are off: roll (lag, rate, bank limit), load_factor (lag, limits, gust load), speed (thrust, drag).
    gust: the gust load alone, by which a gust changes the lift; without it a gust changes the velocity through the air only."""

    @model_validator(mode="after")
    def _ideal_is_for_the_point_mass(self) -> "PlantSpec":
        if self.ideal and self.kind != "point_mass":
            raise ValueError(f"ideal goes with kind: point_mass, not with {self.kind}")
        return self


class Rates(Section):
    """How often each block runs. The guidance's rate must divide the plant's, the planner's the guidance's."""

    plant_hz: Annotated[Whole, Field(ge=60, le=960)] = 120
    """Steps of the plant, Hz."""
    guidance_hz: Annotated[Whole, Field(ge=10, le=960)] = 60
    """Steps of the guidance, Hz; divides plant_hz."""
    planner_hz: Annotated[Whole, Field(ge=1, le=960)] = 60
    """Looks of the planner, Hz; divides guidance_hz."""

    @model_validator(mode="after")
    def _divide(self) -> "Rates":
        if self.plant_hz % self.guidance_hz:
            raise ValueError(f"guidance_hz must divide plant_hz = {self.plant_hz}")
        if self.guidance_hz % self.planner_hz:
            raise ValueError(f"planner_hz must divide guidance_hz = {self.guidance_hz}")
        return self


class GuidanceSpec(Pluggable):
    """The path-following law."""

    family = "guidance"
    role, needs = "a guidance law", ("start", "step")

    kind: str = "look_ahead"
    """look_ahead: error feedback with feed-forward of the curvature ahead. l1: Park, Deyst and How's law, which aims at a point ahead."""
    schedule: Literal["keep", "let_go"] = "let_go"
    """keep: fly faster or slower (by at most 6 %) to make up for time lost or won along the path. let_go: hold the set speed."""


class Traffic(Section):
    """How obstacles take part in the wind. In calm air all are the same."""

    in_wind: Literal["ground_fixed", "drifts", "anchored"] = "ground_fixed"
    """ground_fixed: as printed, over the ground. drifts: as printed, through the air, and carried by the mean wind of its place.
    anchored: so that the flight without planner has the miss vector, closest-approach time and closing speed that it has in calm air."""


Share = Annotated[NonNegative, Field(lt=1)]


class Vary(Section):
    """An aircraft other than the published one: factors drawn evenly from 1 less to 1 more a share, per replicate. 0: as published."""

    derivatives_share: Share = 0.0
    """Of the aerodynamic derivatives, each by itself; of the point_mass its two drags."""
    lags_share: Share = 0.0
    """Of the lags of actuators, engines (where the model has them as actuators) and the point_mass."""
    gains_share: Share = 0.0
    """Of the gains, leads and lags that guidance and autopilot work with; not of the limits."""


class FlightSettings(Section):
    """Everything one flight needs, apart from who it is."""

    speed_mps: Annotated[Positive, Field(le=1000), Between("nothing that flies is slower", least=1.0)] = 50.0
    """Set speed, m/s. Where the plant flies the aircraft, one that it can hold: `limits` of its aircraft.yaml."""
    speed_hold: Literal["airspeed", "groundspeed"] = "airspeed"
    """Which speed is held at speed_mps."""
    route: Route
    """The original path."""
    geometry: Literal["as_given", "level"] = "as_given"
    """level: the whole encounter turned about the route's start so that both end tangents are horizontal."""
    terrain_z_m: Height = -200.0
    """Height of the flat ground in the ENU frame, m."""
    begin: Begin = Begin(at_route_s_m=0.0)
    """Where on the route the flight starts."""
    obstacles: Annotated[tuple[ObstacleSpec, ...], AfterValidator(names_differ)] = ()
    """Moving spheres."""
    traffic: Traffic = Traffic()
    """How obstacles take part in the wind."""
    sensor: Sensor = Sensor()
    """What the planner sees."""
    tracker: TrackerSpec = TrackerSpec()
    """What makes tracks of what the sensor sees."""
    planner: PlannerSpec = PlannerSpec()
    """Who turns what is seen into a new path."""
    method: MethodSpec = MethodSpec()
    """The avoidance method."""
    replan: Replan = Replan()
    """How a threat becomes a new path."""
    guidance: GuidanceSpec = GuidanceSpec()
    """The path-following law."""
    plant: PlantSpec = PlantSpec()
    """Which physics flies the plan."""
    rates: Rates = Rates()
    """How often each block runs."""
    aircraft: Aircraft = "gtm_t2"
    """A folder of aircraft/; `testbed list aircraft` shows them."""
    air: Air = Air()
    """The air that every plant flies in."""
    vary: Vary = Vary()
    """How far the aircraft's data are off those that its gains were made for. A kinematic plant has none of them."""
    limits: Limits = Limits()
    """How long a flight may take, and how much of the computer; how many flights there may be."""
    study: StudySpec = StudySpec()
    """What judges the flights, and what it leads the page with."""

    @field_validator("study")
    @classmethod
    def _can_be_judged(cls, study: StudySpec, info: ValidationInfo) -> StudySpec:
        if why := study.unfit(info.data):
            raise ValueError(why)
        return study


class Campaign(Grid, FlightSettings):
    """One question, its settings, and the sweep that answers it; or several parts, each with settings and a sweep of its own.

    An axis of ``sweep`` is either ``dotted.path: [values]`` or ``axis_name: {label: {dotted.path: value, ...}, ...}``.
    Obstacles are addressed by name: ``obstacles.O.speed_mps``.
    """

    name: Name
    """Names the run directory: letters, digits, _ and -."""
    question: str
    """What this campaign asks, in a sentence."""
    seed: Annotated[Whole, Field(ge=0, le=2**63 - 1)] = 0
    """Root of every random stream. Method, plant and aircraft never change what is drawn."""
    replicates: Replicates = 1
    """Flights per cell of the sweep, each with its own random streams."""
    recordings: Stored = "selected"
    """Which flights leave a .rrd recording; selected: the first replicate of each cell."""
    columns: Stored = "none"
    """Which flights leave their raw columns, from which reports/verify computes the results again."""
    check: Check | None = None
    """For a campaign that checks the testbed: how it is judged."""
    daa: Daa | None = None
    """Metrics of detect and avoid, which are measured where this section is, `daa: {}` at the least."""
    stop: Stop | None = None
    """When fewer replicates than `replicates` are enough."""
    plugins: tuple[Annotated[str, Field(min_length=1)], ...] = ()
    """Python files with parts of one's own, relative to this file: [./tangent.py] gives the kinds "tangent:<name>"."""
    parts: dict[Name, Part] = {}  # noqa: RUF012 (pydantic copies it)
    """Instead of a sweep: named parts, flown one after the other. The name is the first label of a part's cells."""


class FlightPlan(FlightSettings):
    """One flight, fully resolved: settings, and who it is. Same plan, same record."""

    flight_id: str
    """First 12 hexadecimal digits of a hash of everything else but the campaign."""
    campaign: str
    """Name of the campaign."""
    cell: str
    """The labels joined by '/'."""
    labels: dict[str, str]
    """Axis of the sweep to the label of its value."""
    replicate: int
    seed: int
    weight: float = 1.0
    """What the flight's encounter counts where some are drawn more often than they occur."""
    plugins: dict[str, str] = {}  # noqa: RUF012 (pydantic copies it)
    """Where parts come from that are not built in: plug-in to the SHA-256 of its file, distribution to its version; and data files of
    tracks, each to its SHA-256."""

    @property
    def avoids_by(self) -> str:
        """What is to be named as that which avoids: the method, or a planner that needs none; ``none`` where nothing does."""
        without = self.method.kind == "none" and self.planner.kind != PlannerSpec.model_fields["kind"].default
        return self.planner.kind if without else self.method.kind

    @property
    def plugged(self) -> tuple[Pluggable, ...]:
        """Every section that names a part that the flight is made of: not a study that only judges it."""
        sections = (getattr(self, name) for name in FlightSettings.model_fields if name != "study" or self.study.part.flies)
        return (*(section for section in sections if isinstance(section, Pluggable)), *self.obstacles)

    @field_validator("air")
    @classmethod
    def _the_plant_has_that_turbulence(cls, air: Air, info: ValidationInfo) -> Air:
        plant = info.data.get("plant")
        if air.turbulence.kind == "jsbsim" and plant is not None and plant.kind != "jsbsim":
            raise ValueError(f"turbulence.kind: jsbsim goes with plant.kind: jsbsim, not with {plant.kind}; 'dryden' is for every plant")
        return air
