"""What a planner, and a method that steers, are told before a flight, and what they must do."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from testbed.campaign.words.planning import Replan
from testbed.campaign.words.settings import FlightPlan
from testbed.core import registry
from testbed.core.chain import Chain
from testbed.core.frames import Vec3
from testbed.core.seeds import stream
from testbed.flight.planning.prediction import AirKind, air_kind
from testbed.flight.plants.aircraft import Aircraft, Limits, idealised, load_aircraft
from testbed.flight.plants.base import State
from testbed.flight.record import ReplanEvent
from testbed.flight.route.path import Path
from testbed.flight.sensing.base import Seen
from vosc.vec import add

if TYPE_CHECKING:
    from testbed.flight.scene import Scene

STILL: Vec3 = (0.0, 0.0, 0.0)


class Method(NamedTuple):
    """The avoidance method of the plan: its name, the function or class, and its options."""

    kind: str
    part: Any
    options: dict[str, Any]


@dataclass(frozen=True)
class Context:
    """One flight, as far as a planner may know it. Metres, m/s and radians, ENU over the ground."""

    route: Chain
    begin_s_m: float  # arc length of the route at which the flight starts
    goal: Vec3
    goal_tangent: Vec3
    speed_mps: float  # the set speed ...
    airspeed_held: bool  # ... through the air, or over the ground
    limits: Limits
    planner_hz: int
    guidance_hz: int
    wind_known: Callable[[float, Vec3], Vec3]
    """From time (s) and place to the mean wind there as this planner has it: velocity of the air over the ground, m/s."""
    random: np.random.Generator
    """The planner's own stream, the same for every method, plant and aircraft."""
    method: Method
    replan: Replan
    aircraft: Aircraft
    """What its file says of it, without the limits that the plan turns off; what is drawn for the one that flies is not known."""
    air: AirKind
    """What a forecast would say: calm, wind, or turbulence (gusts too)."""


class Pending(NamedTuple):
    """The path for one step that is made of a command which is still to come, from outside of the flight (``outside.py``).

    The aircraft stands at ``s_m`` of it; it is ``ahead_m`` long. The loop stops there and asks.
    """

    s_m: float
    ahead_m: float


class Step(NamedTuple):
    """What a planner hands back at a look: its memory, the path from now on if there is a new one, what was decided if something was."""

    memory: Any
    path: Path | Pending | None = None
    event: ReplanEvent | None = None


Answer = tuple[Any, Path | Pending | None, ReplanEvent | None]
"""A ``Step``, or the plain tuple of the same."""


class Planner(Protocol):
    """The planner of one flight, made by ``factory(**options)``; its memory goes in and comes out.

    ``step(memory, time_s, state, seen)`` may do: ``(memory, path or None)`` is then its answer (``own.py``). One that asks for the
    active path as well, and for how far along it the flight is, answers with a ``Step``.
    """

    slowest_s: float
    """Processor seconds of the slowest answer, so that a busy computer counts no other work; not part of the result."""

    def start(self, context: Context) -> Any:
        """Fresh memory."""

    def step(self, memory: Any, time_s: float, state: State, seen: Sequence[Seen], path: Path, s_m: float) -> Answer:
        """One look of a flight that is at ``s_m`` of ``path``; while the path is one that does not last, at the guidance rate."""


def make_context(plan: FlightPlan, scene: "Scene", aircraft: Aircraft) -> Context:
    """What the planner of a plan is told."""
    return Context(
        route=scene.route,
        begin_s_m=scene.begin_s_m,
        goal=scene.goal,
        goal_tangent=scene.goal_tangent,
        speed_mps=plan.speed_mps,
        airspeed_held=plan.speed_hold == "airspeed",
        limits=aircraft.limits,
        planner_hz=plan.rates.planner_hz,
        guidance_hz=plan.rates.guidance_hz,
        wind_known=_wind_known(plan, scene),
        random=stream(plan.seed, plan.replicate, "planner"),
        method=Method(plan.method.kind, registry.part("method", plan.method.kind, plan.plugins), plan.method.options),
        replan=plan.replan,
        aircraft=idealised(load_aircraft(plan.aircraft), plan.plant.ideal),
        air=air_kind(plan),
    )


def _wind_known(plan: FlightPlan, scene: "Scene") -> Callable[[float, Vec3], Vec3]:
    """All of the mean wind, or with the error of an estimate: horizontal, one for the flight, for every method, plant and aircraft."""
    known, mean, error = plan.replan.wind_known, scene.air.mean, STILL
    if known == "none":
        return lambda time_s, pos: STILL  # noqa: ARG005
    if known == "estimated":
        east, north = plan.replan.wind_estimate_sigma_mps * stream(plan.seed, plan.replicate, "wind_estimate").normal(size=2)
        error = (float(east), float(north), 0.0)
    return lambda time_s, pos: add(mean(time_s, pos), error)
