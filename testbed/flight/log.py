"""The log of a flight: rows are appended as packed doubles while it flies and become named columns once, at its end."""

import struct
from collections.abc import Callable
from time import perf_counter

import numpy as np

from testbed.campaign.words.settings import FlightPlan
from testbed.core.chain import Chain
from testbed.core.frames import quat_xyzw_from_euler
from testbed.flight.guidance.law import Telemetry
from testbed.flight.plants.base import Plant, State
from testbed.flight.record import ANSWERED, FlightRecord, Outcome, PlannedPath, ReplanEvent, inside
from testbed.flight.record.columns import Columns, column, contenders
from testbed.flight.route.path import ActivePath, Path
from testbed.flight.scene import Scene
from testbed.flight.traffic.track import least_clearance

Array = np.ndarray
_GUIDANCE_ROW = struct.Struct(f"{len(Telemetry._fields) + 1}d").pack
STATE_COLUMNS = {  # State field -> column
    "bank": "own.bank_rad",
    "pitch": "own.pitch_rad",
    "heading": "own.heading_rad",
    "load_factor": "own.load_factor",
    "airspeed": "own.airspeed_mps",
    "alpha": "own.alpha_rad",
    "beta": "own.beta_rad",
    "throttle": "own.throttle",
    "elevator": "own.elevator",
    "aileron": "own.aileron",
    "rudder": "own.rudder",
}
ROTATION = ("p_air", "q_air", "r_air")


class FlightLog:
    """What one flight writes down. Only the loop appends."""

    def __init__(self, plan: FlightPlan, begin_s_m: float, clock: Callable[[], float] = perf_counter) -> None:
        self.plan, self.begin_s_m, self.clock = plan, begin_s_m, clock
        self.samples: list[bytes] = []  # the plant's own rows, one a tick
        self.guidance: list[bytes] = []  # telemetry, and whether the aircraft was at a stop
        self.events: list[ReplanEvent] = []
        self.paths: list[tuple[float, ActivePath]] = []

    def guide(self, telemetry: Telemetry, at_stop: bool) -> None:
        """One guidance tick."""
        s_m, bank, load_factor, limited = telemetry
        self.guidance.append(_GUIDANCE_ROW(s_m, bank, load_factor, limited, at_stop))

    def change_path(self, time_s: float, path: Path) -> None:
        """Guidance follows ``path`` from ``time_s`` on. Where a law steers, the path that it left stays the one to compare with."""
        if isinstance(path, ActivePath):
            self.paths.append((time_s, path))


def finish(
    log: FlightLog, scene: Scene | None, outcome: Outcome, message: str, timings: dict[str, float], plant: Plant | None = None
) -> FlightRecord:
    """Columns, least clearance and the final outcome. Without a plant nothing was flown."""
    began = log.clock()
    # the route's chain is the same for all flights of it, and so is what was once worked out about it
    chains = [scene.route if scene is not None and path is scene.path else Chain(path.curves) for _, path in log.paths]
    columns, closest = _columns(log, scene, plant)
    if inside(closest) and outcome not in (Outcome.DIVERGED, Outcome.HIT_GROUND):
        outcome, message = Outcome.COLLIDED, f"came {-closest:.2f} m inside an obstacle"
    elif outcome is Outcome.REACHED and (refused := [e for e in log.events if e.decision not in ANSWERED]):
        outcome, message = (
            Outcome.NO_PATH,
            f"the planner had no path at {refused[0].time_s:.2f} s: {refused[0].reason or refused[0].decision}",
        )
    paths = tuple(PlannedPath(from_s, chain) for (from_s, _), chain in zip(log.paths, chains, strict=True))
    longest_s = scene.longest_s if scene else 0.0
    took = tuple({**timings, "log_s": log.clock() - began}.items())
    return FlightRecord(log.plan, outcome, columns, tuple(log.events), paths, message, longest_s, took)


def _states(log: FlightLog, plant: Plant | None) -> dict[str, Array]:
    """Every field of the state as an array (n,), and what only the log needs: the air's rotation."""
    if plant is None:
        return {name: np.empty(0) for name in (*State._fields, *ROTATION)}
    rows = np.frombuffer(b"".join(log.samples)).reshape(-1, len(plant.sample()))
    columns = list(rows.T)
    field = plant.state(columns)._asdict() | dict(zip(ROTATION, plant.air_rotation(columns), strict=True))
    return {name: column if np.ndim(column) else np.full(len(rows), column) for name, column in field.items()}


def _columns(log: FlightLog, scene: Scene | None, plant: Plant | None) -> tuple[Columns, float]:
    field = _states(log, plant)
    time_s = np.arange(len(field["x"])) / log.plan.rates.plant_hz
    columns = {
        "time_s": time_s,
        "own.pos_enu_m": np.column_stack([field[name] for name in ("x", "y", "z")]),
        "own.vel_enu_mps": np.column_stack([field[name] for name in ("vx", "vy", "vz")]),
        "air.wind_enu_mps": np.column_stack([field[name] for name in ("wx", "wy", "wz")]),
        "air.rotation_body_radps": np.column_stack([field[name] for name in ROTATION]),
        "own.rates_body_radps": np.column_stack([field[name] for name in ("p", "q", "r")]),
        "own.quat_enu_from_body_xyzw": quat_xyzw_from_euler(field["bank"], field["pitch"], field["heading"]),
        **{signal: np.array(field[name]) for name, signal in STATE_COLUMNS.items()},
    }
    columns |= _guidance_columns(log, len(time_s))
    columns |= _path_columns(log, columns["own.pos_enu_m"], time_s, columns["guidance.s_m"])
    flown, pos, closest = Columns(columns, scene.tracks if scene else ()), columns["own.pos_enu_m"], np.inf
    for track in contenders(flown, pos, scene.tracks) if scene else ():
        closest = min(closest, least_clearance(time_s, pos, flown[column(track.name, "pos_enu_m")], track.radius_m).clearance_m)
    return flown, closest


def _guidance_columns(log: FlightLog, n: int) -> dict[str, Array]:
    """Guidance rows held until the next one; a flight that ended before the first has where it began, and no command."""
    rows = np.frombuffer(b"".join(log.guidance) or _GUIDANCE_ROW(log.begin_s_m, np.nan, np.nan, 0.0, False))
    rows = rows.reshape(-1, len(Telemetry._fields) + 1)
    every = log.plan.rates.plant_hz // log.plan.rates.guidance_hz
    held = rows[np.minimum(np.arange(n) // every, len(rows) - 1)]
    s_m, bank, load_factor, limited, at_stop = held.T
    return {
        "guidance.s_m": s_m.copy(),
        "guidance.bank_cmd_rad": bank.copy(),
        "guidance.load_factor_cmd": load_factor.copy(),
        "guidance.saturated": np.where((limited > 0.0) | (at_stop > 0.0), 1.0, 0.0),
        "guidance.limited": limited.copy(),
        "own.at_stop": at_stop.copy(),
    }


def _path_columns(log: FlightLog, pos: Array, time_s: Array, s_m: Array) -> dict[str, Array]:
    """Which path and piece was active, and the exact distance from it."""
    leg, cross_track, nearest = np.zeros((3, len(pos)))
    index = np.searchsorted([t for t, _ in log.paths], time_s + 1e-9, side="right") - 1.0
    for k, (_, path) in enumerate(log.paths):
        mine = index == k
        if mine.any():
            nearest[mine], cross_track[mine] = path.nearest(pos[mine], s_m[mine])
            leg[mine] = np.searchsorted(path.starts_m, s_m[mine], side="right") - 1
    return {"path.index": index, "path.leg": np.maximum(leg, 0.0), "path.s_m": nearest, "path.cross_track_m": cross_track}
