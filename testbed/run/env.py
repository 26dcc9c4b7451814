"""The flight loop as a gymnasium environment: a step is a command, and what is flown until the next one is asked for.

It is made by ``testbed.make_env`` (``stepping.py``); gymnasium is imported here and in nothing that others need.
"""

from collections.abc import Callable, Generator
from dataclasses import replace
from typing import Any, Final, Literal

import gymnasium
import numpy as np
from gymnasium import spaces

from testbed.campaign.words.planning import PlannerSpec
from testbed.campaign.words.settings import FlightPlan
from testbed.core.frames import Vec3
from testbed.core.utf8 import shortened
from testbed.flight.fly import flown
from testbed.flight.planning.context import STILL
from testbed.flight.planning.outside import OUTSIDE, Always, Asked, AskingPlanner, WhenThreatened
from testbed.flight.planning.steering import Steer
from testbed.flight.record import LOST, FlightRecord, Outcome
from testbed.flight.sensing.base import NOTHING
from testbed.results.metrics import measure
from testbed.results.tables import table
from testbed.run.job import row_of
from testbed.run.observation import MOST_OF_A_ROW, SHOWN, Array, Observation, Observer, nothing_to_see
from vosc.vec import LARGEST, unit

CommandKind = Literal["acceleration", "velocity"]
Asks = Literal["when_threatened", "always"]
Reward = Callable[[Observation, Vec3, Observation, FlightRecord | None], float]
"""What a step is worth, from the observation before it, the command, the observation after it and, at the end, the flight."""
CUT_SHORT: Final = frozenset({Outcome.TIMED_OUT, Outcome.STOPPED})
"""Outcomes of a flight that nothing but its time ended."""


def by_outcome(before: Observation, command: Vec3, after: Observation, record: FlightRecord | None) -> float:  # noqa: ARG001
    """Nothing on the way; at the end 1 where the goal was reached and every radius kept, -1 for a collision or a lost aircraft, else 0."""
    if record is None:
        return 0.0
    if record.outcome in LOST or record.outcome is Outcome.COLLIDED:
        return -1.0
    return 1.0 if record.outcome is Outcome.REACHED else 0.0


class FlightEnv(gymnasium.Env[Observation, Array]):
    """Flights of one cell of a campaign, a replicate an episode. ``plan`` is what is flown, ``record`` the last flight that ended."""

    metadata = {"render_modes": []}  # noqa: RUF012 (as gymnasium has it)

    def __init__(
        self, plan_of: Callable[[int], FlightPlan], first: int, command: CommandKind, asks: Asks, most: float, reward: Reward
    ) -> None:
        self._plan_of, self._next, self._kind, self._asks, self._reward = plan_of, first, command, asks, reward
        self.plan, self.record = plan_of(first), None
        self._rows = max(1, len(self.plan.obstacles))
        self.action_space = spaces.Box(-most, most, (3,), np.float64)
        self.observation_space = _space(self._rows)
        self._flying: Generator[Asked, Steer, FlightRecord] | None = None
        self._flown = False  # the flight that is on has ended, and no step has said so yet

    plan: FlightPlan
    record: FlightRecord | None

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, dict[str, Any]]:
        """Begin the flight of replicate ``seed`` of the campaign, or of the next one, up to where the first command is asked for."""
        if options:
            raise ValueError("reset() takes no options: what is flown is the campaign's, and the seed is the number of the replicate")
        super().reset(seed=seed)
        self.close()
        number = self._next if seed is None else seed
        self.plan, self._next = self._plan_of(number), number + 1
        self._planner: AskingPlanner = Always() if self._asks == "always" else WhenThreatened()
        self._observer: Observer | None = None
        self._seen, self._flown = NOTHING, False
        self._flying = flown(self.plan, planner=self._planner)
        self._fly_on(None)
        return _copied(self._shown), {"flight_id": self.plan.flight_id, "cell": self.plan.cell, "replicate": number}

    def step(self, action: Any) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Answer with a command, ENU, and fly on until the next one is asked for, or to the end."""
        if self._flying is None:
            why = "no flight has begun" if self.record is None else "the flight is over"
            raise gymnasium.error.ResetNeeded(f"{why}: reset() begins the next one")
        command, before = self._checked(action), self._shown
        if not self._flown:
            self._fly_on(Steer(command) if self._kind == "acceleration" else Steer(velocity_enu_mps=command))
        record = self.record if self._flown else None
        reward = float(self._reward(before, command, self._shown, record))
        if record is None:
            return _copied(self._shown), reward, False, False, {}
        self.close()
        row = table([row_of(record, measure(record))]).to_pylist()[0]
        cut_short = record.outcome in CUT_SHORT
        return _copied(self._shown), reward, not cut_short, cut_short, {"row": row, "message": record.message}

    def close(self) -> None:
        """Leave the flight that is on where it is."""
        if self._flying is not None:
            self._flying.close()
        self._flying = None

    def _fly_on(self, steer: Steer | None) -> None:
        """To the next question, or to the end."""
        assert self._flying is not None
        try:
            asked = self._flying.send(steer)  # type: ignore[arg-type]  # nothing is what a generator begins with
        except StopIteration as end:
            self._flown, self.record = True, _as_flown(end.value)
            observer = self._observing()
            self._shown = observer.end(end.value, self._seen, self._planner.left_s_m) if observer else nothing_to_see(self._rows)
        except BaseException:
            self._flying = None
            raise
        else:
            observer, self._seen = self._observing(), asked.seen
            assert observer is not None, "who asks has been told a context"
            self._shown = observer.look(*asked, self._planner.left_s_m)

    def _observing(self) -> Observer | None:
        """Who looks for this flight; nobody where it could not begin."""
        if self._observer is None and self._planner.context is not None:
            self._observer = Observer(self._planner.context, self._rows)
        return self._observer

    def _checked(self, action: Any) -> Vec3:
        """The action as three finite numbers. Raises ``ValueError`` in a sentence; what is beyond the space's bounds is flown as well."""
        measure_of = "m/s^2" if self._kind == "acceleration" else "of any length above 0"
        try:
            numbers = np.asarray(action, dtype=np.float64)
        except (TypeError, ValueError):
            numbers = np.empty(0)
        if numbers.shape != (3,) or not (np.abs(numbers) <= LARGEST).all():  # which a NaN is not either
            given = shortened(" ".join(repr(action).split()))
            raise ValueError(
                f"a command is an array of 3 finite numbers below {LARGEST:g} in size ({self._kind}, ENU, {measure_of}), not {given}"
            )
        x, y, z = numbers.tolist()
        if self._kind == "velocity" and unit((x, y, z)) == STILL:
            raise ValueError("a velocity of zero has no direction to fly in")
        return x, y, z


def _as_flown(record: FlightRecord) -> FlightRecord:
    """It says who avoided: not what the campaign names, and so it is not the flight of that id."""
    method = record.plan.method.model_copy(update={"kind": OUTSIDE, "options": {}})
    return replace(record, plan=record.plan.model_copy(update={"method": method, "planner": PlannerSpec(), "flight_id": ""}))


def _space(rows: int) -> Any:
    most = np.tile(MOST_OF_A_ROW, (rows, 1))
    boxes: dict[str, Any] = {one.name: spaces.Box(-one.most, one.most, (one.size,), np.float64) for one in SHOWN}
    return spaces.Dict(boxes | {"obstacles": spaces.Box(-most, most, dtype=np.float64)})


def _copied(shown: Observation) -> Observation:
    """Whoever is shown it may change it."""
    return {name: values.copy() for name, values in shown.items()}
