"""The planner ``survivor``: it predicts the aircraft instead of drawing a cone, and takes what keeps the margin when flown.

A velocity obstacle asks which velocity would be free if it could be had at once. This planner asks where the aircraft would be: for some
two hundred manoeuvres from its present state it predicts the flight of a point with the aircraft's lags and limits, all at once
(``foresight.py``), and it asks again several times a second. A flight that follows its path is looked at as often; it leaves the path
when the path comes nearer to anything in sight than the margin, and comes back as every planner does (``rejoin.py``).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from time import thread_time
from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field

from testbed.campaign.words.planning import Replan
from testbed.core.frames import Vec3
from testbed.core.units import G0_MPS2
from testbed.flight.impossible import NoWayError
from testbed.flight.planning.context import Context, Step
from testbed.flight.planning.decision import Sighting, make_event
from testbed.flight.planning.foresight import Choice, Held, MarginAt, Outlook, Situation
from testbed.flight.planning.prediction import UNIDENTIFIED_M, aeroplane_of, read_prediction
from testbed.flight.planning.rejoin import Rejoin, miss_along
from testbed.flight.planning.steering import Steer, arc
from testbed.flight.plants.base import State
from testbed.flight.record import Decision, ReplanEvent
from testbed.flight.route.path import ActivePath, Path
from testbed.flight.sensing.base import Seen
from vosc import Own
from vosc.vec import norm, scale, sub, unit

NAME = "survivor"
DEPARTED_M = 1.0  # an aircraft that is so far from where it was expected is predicted anew at once
AGAIN_S = 0.5  # a way back that cannot be flown is looked for again after this
EARLY_S = 1e-6  # rounding of a time that is due
NO_ONE: Mapping[str, Seen] = {}


class Memory(NamedTuple):
    """The planner's memory."""

    looked_s: float = -math.inf  # when it last looked or decided ...
    looked_at: frozenset[str] = frozenset()  # ... and at whom
    choice: Choice | None = None  # what flies, and what is expected of it; None on a path
    base: Vec3 = (0.0, 0.0, 0.0)  # unit vector: where the flight was going when it left the path
    known: Mapping[str, Seen] = NO_ONE  # everybody who was seen since
    left_s_m: float = 0.0  # arc length at which the flight left the route
    ahead_m: float = 0.0  # what the arc length of the route is more than that of the active path; NaN while it is elsewhere
    asked_m: float = 0.0  # margin of the first decision
    said: bool = False  # that no manoeuvre keeps the margin
    not_before_s: float = -math.inf  # no way back is looked for before


class Survivor:
    """Predicts the aircraft and takes what keeps the margin.

    ``shape``: directions that are held, or programmes (bank x load factor x duration, then straight on). ``margin_m``: what a prediction
    has to spare; identified: by time to go, as ``testbed identify`` found it for this aircraft. ``trial`` is for that command: the first
    decision stays, and every later look only says what is now expected of it, by a model without or with the lags that were identified.
    """

    def __init__(
        self,
        shape: Literal["directions", "programmes"] = "directions",
        margin_m: Literal["identified"] | Annotated[float, Field(ge=0, le=100)] = "identified",
        every_s: Annotated[float, Field(ge=0.02, le=2)] = 0.15,
        trial: Literal["no", "first_order", "identified"] = "no",
    ) -> None:
        self._shape, self._margin_m, self._every_s = shape, margin_m, every_s
        self._trial, self._first_order = trial != "no", trial == "first_order"
        self.slowest_s = 0.0

    def start(self, context: Context) -> Memory:
        """Fresh memory."""
        found = None if self._first_order else read_prediction(context.aircraft.folder)
        identified = found.margins.get(context.air) if found else None
        self._margin: MarginAt = identified.at if identified and self._margin_m == "identified" else self._fixed
        aeroplane = aeroplane_of(context.aircraft, found.lags if found else None)
        self._outlook = Outlook(aeroplane, self._margin, context.speed_mps, context.airspeed_held, self._shape == "programmes")
        self._context, self._rejoin = context, Rejoin(context)
        self._settings: Replan = context.replan
        return Memory()

    def _fixed(self, time_s: np.ndarray) -> np.ndarray:
        return np.full(np.shape(time_s), UNIDENTIFIED_M if self._margin_m == "identified" else self._margin_m)

    def step(self, memory: Memory, time_s: float, state: State, seen: Sequence[Seen], path: Path, s_m: float) -> Step:
        """One look of a flight that is at ``s_m`` of ``path``."""
        if norm(state[3:6]) == 0.0:
            return Step(memory)
        if memory.choice is not None:
            return self._flown_on(memory, time_s, state, seen, s_m)
        if not seen or not self._due(memory, time_s, seen):
            return Step(memory)
        memory = memory._replace(looked_s=time_s, looked_at=frozenset(one.name for one in seen))
        began = thread_time()
        if not any(self._threatens(one, time_s, state, path, s_m) for one in seen):
            self.slowest_s = max(self.slowest_s, thread_time() - began)
            return Step(memory)
        left_s_m = memory.left_s_m if math.isnan(memory.ahead_m) else max(memory.left_s_m, s_m + memory.ahead_m)
        left_s_m = min(left_s_m, self._context.route.length_m)
        known = {one.name: one for one in seen}
        memory = memory._replace(base=unit(state[3:6]), left_s_m=left_s_m, ahead_m=math.nan, known=known, asked_m=0.0, said=False)
        passing = miss_along(path, s_m, norm(state[3:6]), time_s, seen)
        return self._decided(memory, time_s, state, s_m, began, passing)

    def _due(self, memory: Memory, time_s: float, seen: Sequence[Seen]) -> bool:
        """Is it time to look, or is somebody new in sight?"""
        return time_s - memory.looked_s >= self._every_s - EARLY_S or any(one.name not in memory.looked_at for one in seen)

    def _threatens(self, one: Seen, time_s: float, state: State, path: Path, s_m: float) -> bool:
        """Does the path, flown on at the present speed, come nearer than the margin?"""
        apart, relative = sub(one.at(time_s), state[:3]), sub(one.vel, state[3:6])
        square = sum(v * v for v in relative)
        closest_s = max(-sum(p * v for p, v in zip(apart, relative, strict=True)) / square, 0.0) if square > 0.0 else 0.0
        margin = float(self._margin(np.array([closest_s]))[0])
        missed = miss_along(path, s_m, norm(state[3:6]), time_s, [one])
        return closest_s <= self._settings.horizon_s and missed < one.radius_m + self._settings.swell_m + margin

    def _flown_on(self, memory: Memory, time_s: float, state: State, seen: Sequence[Seen], s_m: float) -> Step:
        """Off the path: the way back once the flight is clear, until then what was decided, decided anew when that is due."""
        choice = memory.choice
        assert choice is not None
        memory = memory._replace(known={**memory.known, **{one.name: one for one in seen}})
        memory, back = self._back(memory, time_s, state)
        if back is not None:
            return back
        gone = math.dist(choice.expected(time_s)[0], state[:3]) > DEPARTED_M and not self._trial
        if gone or self._due(memory, time_s, seen):
            return self._decided(memory, time_s, state, s_m, thread_time(), math.nan)
        return Step(memory, self._arc(choice.held, time_s, state, s_m))

    def _decided(self, memory: Memory, time_s: float, state: State, s_m: float, began: float, passing_m: float) -> Step:
        """Decide, and fly it. It is an event at first, and when no manoeuvre keeps the margin any more."""
        before = memory.choice
        wind, load_rate = self._context.wind_known(time_s, state[:3]), before.expected(time_s)[1] if before else 0.0
        known = [one._replace(radius_m=one.radius_m + self._settings.swell_m) for one in memory.known.values()]
        now = Situation(time_s, state, load_rate, wind, memory.base, known, before.held if before else None, memory.asked_m)
        choice = self._outlook.expect(now) if before and self._trial else self._outlook.decide(now)
        self.slowest_s = max(self.slowest_s, thread_time() - began)
        event = None
        if before is None or self._trial or (before.keeps and not choice.keeps and not memory.said):
            event = self._event(memory, time_s, state, wind, choice, passing_m)
        looked_at = frozenset(memory.known)
        if before is None:
            memory = memory._replace(asked_m=choice.margin_m)
        memory = memory._replace(choice=choice, said=memory.said or not choice.keeps, looked_s=time_s, looked_at=looked_at)
        return Step(memory, self._arc(choice.held, time_s, state, s_m), event)

    def _arc(self, held: Held, time_s: float, state: State, s_m: float) -> Path:
        """The path for one step."""
        if held.direction is not None:
            return arc(Steer(velocity_enu_mps=held.direction), state, s_m)
        on = time_s < held.until_s - EARLY_S
        return arc(Steer(acceleration_enu_mps2=lift(held, state[3:6]) if on else (0.0, 0.0, 0.0)), state, s_m)

    def _back(self, memory: Memory, time_s: float, state: State) -> tuple[Memory, Step | None]:
        """The way back, once the flight is clear of everybody who was seen."""
        if time_s < memory.not_before_s:
            return memory, None
        known = list(memory.known.values())
        try:
            way = self._rejoin.when_clear(time_s, state, known, memory.left_s_m, now=False)
        except NoWayError:
            return memory._replace(not_before_s=time_s + AGAIN_S), None
        if way is None:
            return memory, None
        path, wind = ActivePath(way.curves), self._context.wind_known(time_s, state[:3])
        passing = miss_along(path, 0.0, norm(state[3:6]), time_s, known)
        own, sighting = self._sighted(memory, time_s, state, wind)
        event = make_event(time_s, Decision.REJOINED, NAME, own, sighting, None, None, path, wind, passing)
        memory = memory._replace(choice=None, known=NO_ONE, ahead_m=way.ahead_m, looked_s=time_s)
        return memory, Step(memory, path, event)

    def _sighted(self, memory: Memory, time_s: float, state: State, wind: Vec3) -> tuple[Own, Sighting]:
        """The aircraft in the air, and the nearest of all."""
        own = Own(state[:3], sub(state[3:6], wind))
        nearest = min(memory.known.values(), key=lambda one: math.dist(own.pos_m, one.at(time_s)) - one.radius_m)
        return own, Sighting.of(nearest, time_s, own, wind, self._settings)

    def _event(self, memory: Memory, time_s: float, state: State, wind: Vec3, choice: Choice, passing_m: float) -> ReplanEvent:
        own, sighting = self._sighted(memory, time_s, state, wind)
        reason = "" if choice.keeps else _words(choice)
        event = make_event(
            time_s, Decision.STEERED, NAME, own, sighting, None, None, None, wind, passing_m, status=Decision.STEERED, reason=reason
        )
        direction = choice.held.direction
        command = scale(norm(state[3:6]), direction) if direction is not None else event.command_enu_mps
        to_go_s = choice.to_go_s if self._trial else event.time_to_cpa_s
        return replace(
            event,
            command_enu_mps=command,
            deflection_rad=choice.deviation_rad,
            path_clearance_m=choice.clearance_m,
            time_to_cpa_s=to_go_s,
        )


def lift(held: Held, velocity: Sequence[float]) -> Vec3:
    """The acceleration (ENU, m/s^2) across a velocity that a bank and a load factor mean there, gravity counted."""
    vx, vy, vz = velocity
    flat = math.hypot(vx, vy)
    speed = math.hypot(flat, vz)
    lx, ly = (-vy / flat, vx / flat) if flat > 1e-9 * speed else (0.0, 1.0)
    sin, cos = vz / speed, flat / speed
    left = -G0_MPS2 * held.load * math.sin(held.bank)
    up = G0_MPS2 * (held.load * math.cos(held.bank) - cos)
    return (left * lx - up * sin * ly, left * ly + up * sin * lx, up * cos)


def _words(choice: Choice) -> str:
    """Why the margin is not kept, and what is expected instead."""
    return (
        f"no manoeuvre keeps the margin of {choice.margin_m:.1f} m: the one with the most clearance,"
        f" {choice.clearance_m:.1f} m in {choice.to_go_s:.1f} s as predicted"
    )
