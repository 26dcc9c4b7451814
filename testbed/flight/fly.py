"""One flight: the loop, written like the block diagram.

    traffic -> sensor -> tracker -> planner -> path -> guidance -> plant -> log

``fly`` is pure seen from outside: same plan, same record, in any order, process or worker count. The loop never asks which
plant, planner or sensor it has. Time is an integer tick.
"""

import math
import struct
from collections.abc import Callable, Generator
from time import perf_counter
from typing import Any, NamedTuple

from testbed.campaign.words.settings import FlightPlan
from testbed.core import registry
from testbed.core.seeds import stream
from testbed.flight.guidance.law import GuidanceSetting, Law, SpeedHold
from testbed.flight.impossible import ImpossibleError
from testbed.flight.log import FlightLog, finish
from testbed.flight.planning.context import Pending, Planner, make_context
from testbed.flight.planning.outside import Asked
from testbed.flight.planning.own import asked
from testbed.flight.planning.steering import Steer, arc
from testbed.flight.plants.aircraft import Aircraft, idealised, load_aircraft
from testbed.flight.plants.base import Plant, PlantSetting, Start, State, TrimFailedError
from testbed.flight.record import FlightRecord, Outcome
from testbed.flight.route.path import Path
from testbed.flight.scene import Scene, make_scene
from testbed.flight.sensing import SENSORS
from testbed.flight.sensing.base import NOTHING, Sensor, SensorContext
from testbed.flight.sensing.own import OwnSensor
from testbed.flight.tracking import TRACKERS
from testbed.flight.tracking.base import Tracked
from testbed.flight.variation import varied

GOAL_GATE_M = 20.0  # reached = crossing the goal's plane within this distance
NEAR_GOAL_M = 200.0  # the goal's plane counts only on the last of the path
HIGHEST_M = 1e5  # a state above this has diverged
LOW_M = 50.0  # nearer to the ground than this, a wing or a wheel may touch it

Until = Callable[[float, State, Path, float], bool]  # time (s), state, active path, arc length on it (m) -> enough?


def fly(plan: FlightPlan, until: Callable[[Scene], Until] | None = None, clock: Callable[[], float] = perf_counter) -> FlightRecord:
    """Fly one plan. What happens to the aircraft is an outcome in the record, never an exception.

    ``until`` may end the flight before its goal, with the outcome ``stopped``; it is asked at the guidance rate. ``clock`` times the
    stages of the work, in seconds.
    """
    try:
        next(flown(plan, until, clock))
    except StopIteration as end:
        record: FlightRecord = end.value
        return record
    raise ValueError("this flight takes commands from outside, which testbed.make_env asks for")


def flown(
    plan: FlightPlan,
    until: Callable[[Scene], Until] | None = None,
    clock: Callable[[], float] = perf_counter,
    planner: Planner | None = None,
) -> Generator[Asked, Steer, FlightRecord]:
    """The flight, which stops wherever it needs a command from outside: only where ``planner``, flown in place of the plan's, says so."""
    began = clock()
    try:
        scene = make_scene(plan)
    except ImpossibleError as error:
        return finish(FlightLog(plan, math.nan, clock), None, Outcome.NO_PATH, f"no route: {error}", {})
    path = scene.path
    log = FlightLog(plan, scene.begin_s_m, clock)
    log.change_path(0.0, path)
    if (start_z_m := scene.route.frame(scene.begin_s_m)[0][2]) <= plan.terrain_z_m:
        where = f"{plan.terrain_z_m - start_z_m:.1f} m under the ground" if start_z_m < plan.terrain_z_m else "on the ground"
        return finish(log, scene, Outcome.HIT_GROUND, f"the flight begins {where} (terrain_z_m: {plan.terrain_z_m:g})", {})
    aircraft = idealised(varied(load_aircraft(plan.aircraft), plan), plan.plant.ideal)
    try:
        plant = make_plant(plan, aircraft, start_of(plan, scene), scene)
    except TrimFailedError as error:
        return finish(log, scene, Outcome.TRIM_FAILED, str(error), {"set_up_s": clock() - began})
    blocks = _Blocks(make_sensor(plan), planner or make_planner(plan), make_law(plan, aircraft), plant)
    memories = (blocks.sensor.start(sensor_context(plan)), blocks.planner.start(make_context(plan, scene, aircraft)))
    ready = clock()
    outcome, message = yield from _loop(plan, scene, path, blocks, memories, log, until(scene) if until else None)
    landed = clock()
    return finish(
        log, scene, outcome, message, {"set_up_s": ready - began, "fly_s": landed - ready, "answer_s": blocks.planner.slowest_s}, plant
    )


class _Blocks(NamedTuple):
    """What the loop runs: the blocks of the diagram."""

    sensor: Sensor
    planner: Planner
    law: Law
    plant: Plant


def _loop(
    plan: FlightPlan, scene: Scene, path: Path, blocks: _Blocks, memories: tuple[Any, Any], log: FlightLog, until: Until | None
) -> Generator[Asked, Steer, tuple[Outcome, str]]:
    """The block diagram. ``memories``: of the sensor and of the planner. Nothing is yielded but questions for a command from outside."""
    hz, ticks_per_command = plan.rates.plant_hz, range(plan.rates.plant_hz // plan.rates.guidance_hz)
    planner_every = hz // plan.rates.planner_hz
    sensor, planner, law, plant = blocks
    (sensed, planned), memory, seen = memories, law.start(scene.begin_s_m), NOTHING
    plant.follow(path, scene.begin_s_m)
    ended = _Ending(plan, scene)
    traffic, sense, look = scene.traffic, sensor.sense, planner.step
    step, read, write = plant.step, plant.sample, log.samples.append  # looked up once: these run at the plant's rate
    sample = read()
    pack = struct.Struct(f"{len(sample)}d").pack
    write(pack(*sample))
    tick = 0
    while True:
        state = plant.state(sample)
        time_s, due = tick / hz, tick % planner_every == 0
        if ended.check(tick, state, path.length_m - memory.s_m, plant):
            return ended.outcome, ended.message
        if until is not None and until(time_s, state, path, memory.s_m):
            return Outcome.STOPPED, "stopped before the goal"
        if due:
            sensed, seen = sense(sensed, time_s, state, traffic)
        if due or not path.lasting:
            planned, new_path, event = look(planned, time_s, state, seen, path, memory.s_m)
            if event is not None:
                log.events.append(event)
            if new_path is not None:
                if isinstance(new_path, Pending):
                    new_path = arc((yield Asked(time_s, state, tuple(seen))), state, *new_path)
                path, memory = new_path, law.start(new_path.begin_s_m)
                plant.follow(path, path.begin_s_m)
                log.change_path(time_s, path)
        command, memory, telemetry = law.step(memory, state, path)
        log.guide(telemetry, plant.command(state, command))
        for _ in ticks_per_command:
            step()
            sample = read()
            write(pack(*sample))
            tick += 1


def make_sensor(plan: FlightPlan) -> Sensor:
    """The sensor that the plan asks for, with its tracker behind it; what is not built in is checked at every look."""
    sensor: Sensor = registry.part("sensor", plan.sensor.kind, plan.plugins)(**plan.sensor.options)
    sensor = sensor if plan.sensor.kind in SENSORS else OwnSensor(plan.sensor.kind, sensor)
    kind = plan.tracker.kind
    if kind == "none":
        return sensor
    return Tracked(sensor, kind, registry.part("tracker", kind, plan.plugins)(**plan.tracker.options), kind in TRACKERS)


def sensor_context(plan: FlightPlan) -> SensorContext:
    """What it is told."""
    return SensorContext(plan.sensor.range_m, plan.rates.planner_hz, stream(plan.seed, plan.replicate, "sensor"))


def make_planner(plan: FlightPlan) -> Planner:
    """The planner that the plan asks for."""
    return asked(plan.planner.kind, registry.part("planner", plan.planner.kind, plan.plugins)(**plan.planner.options))


def make_plant(plan: FlightPlan, aircraft: Aircraft, start: Start, scene: Scene) -> Plant:
    """The physics that the plan asks for, at its start. Raises ``TrimFailedError``."""
    make = registry.part("plant", plan.plant.kind, plan.plugins)
    rates, held = plan.rates, plan.speed_hold == "airspeed"
    setting = PlantSetting(aircraft, start, scene.air, rates.plant_hz, rates.guidance_hz, plan.terrain_z_m, held, plan.plant.ideal)
    plant: Plant = make(setting, **plan.plant.options)
    return plant


def make_law(plan: FlightPlan, aircraft: Aircraft) -> Law:
    """The path-following law that the plan asks for, with the aircraft's gains and limits."""
    make = registry.part("guidance", plan.guidance.kind, plan.plugins)
    hold = SpeedHold(plan.speed_mps, plan.speed_hold == "airspeed", plan.guidance.schedule == "keep")
    law: Law = make(GuidanceSetting(aircraft, hold, 1.0 / plan.rates.guidance_hz), **plan.guidance.options)
    return law


def start_of(plan: FlightPlan, scene: Scene) -> Start:
    """The state on the route at which the flight begins."""
    point, tangent, curvature = scene.route.frame(scene.begin_s_m)
    wind = scene.air.mean(0.0, point)
    held = plan.speed_mps
    airspeed = held if plan.speed_hold == "airspeed" else math.dist([held * t for t in tangent], wind)
    return Start(point, tangent, curvature, airspeed, wind)


class _Ending:
    """Has the flight ended, and how? Asked at the guidance rate."""

    def __init__(self, plan: FlightPlan, scene: Scene) -> None:
        limit = scene.longest_s
        self._last_tick = math.ceil(limit * plan.rates.plant_hz)
        self._ground, self._low = plan.terrain_z_m, plan.terrain_z_m + LOW_M
        self._goal, (self._tx, self._ty, self._tz) = scene.goal, scene.goal_tangent
        why = f"the longest flight that {scene.limit} allows" if scene.limit else "three times the planned time"
        self.outcome, self.message = Outcome.TIMED_OUT, f"not at the goal after {limit:.1f} s, {why}"

    def check(self, tick: int, state: State, remaining_m: float, plant: Plant) -> bool:
        """``remaining_m`` along the path keeps a closed course from ending where it starts."""
        x, y, z = state[:3]
        if not self._low < z < HIGHEST_M or math.isnan(state.airspeed):
            if math.isnan(state.airspeed) or not z < HIGHEST_M:
                self.outcome, self.message = Outcome.DIVERGED, "a state became non-finite or left the model's range"
                return True
            if z <= self._ground or plant.touches_ground():
                self.outcome, self.message = Outcome.HIT_GROUND, f"came down at {math.hypot(*state[3:6]):.0f} m/s"
                return True
        if remaining_m > NEAR_GOAL_M:
            return tick >= self._last_tick
        gx, gy, gz = self._goal
        along = (x - gx) * self._tx + (y - gy) * self._ty + (z - gz) * self._tz
        if -1e-9 <= along <= GOAL_GATE_M and math.dist((x, y, z), self._goal) <= GOAL_GATE_M:
            self.outcome, self.message = Outcome.REACHED, ""
            return True
        return tick >= self._last_tick
