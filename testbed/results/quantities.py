"""The quantities behind the columns of ``results.csv``, each a function of a record. Nothing is flown here."""

import math
from typing import NamedTuple

import numpy as np

from testbed.core.units import DEG
from testbed.flight.air import make_wind
from testbed.flight.fly import GOAL_GATE_M
from testbed.flight.guidance.law import BANK_LIMITED, LIFT_LIMITED
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.record import FlightRecord, Outcome
from testbed.flight.record.columns import contenders
from testbed.flight.traffic.schedule import arc_lengths, planned_time
from testbed.flight.traffic.track import least_clearance
from testbed.results.avoidance import clearance_of

Array = np.ndarray
NAN = math.nan
NEAR_LIMIT = 0.95  # a roll rate counts as at its limit from here on
AT_GOAL_M = 1e-9  # a point that stops at the goal is on the plane up to rounding


class Closest(NamedTuple):
    """The least clearance of a flight, when it was and to which obstacle."""

    clearance_m: float = NAN
    time_s: float = NAN
    obstacle: str = ""


def extreme(pick: object, values: Array) -> float:
    """The largest or least finite value; NaN when there is none."""
    finite = values[np.isfinite(values)]
    return float(pick(finite)) if len(finite) else NAN  # type: ignore[operator]


def root_mean_square(values: Array) -> float:
    """NaN for none."""
    return float(np.sqrt(np.mean(values**2))) if len(values) else NAN


def limits_hit(record: FlightRecord, flown: slice) -> str:
    """Names of the aircraft's limits that were reached, separated by spaces; what a plant does not have it cannot reach."""
    limited, throttle, at_stop = (record.columns[name][flown] for name in ("guidance.limited", "own.throttle", "own.at_stop"))
    if not len(limited):
        return ""
    roll_limit = load_aircraft(record.plan.aircraft).limits.roll_rate_dps * DEG
    hit = {
        "bank": np.isin(limited, (BANK_LIMITED, BANK_LIMITED + LIFT_LIMITED)),
        "load_factor": limited >= LIFT_LIMITED,
        "roll_rate": np.abs(record.columns["own.rates_body_radps"][flown, 0]) >= NEAR_LIMIT * roll_limit,
        "surface": at_stop > 0.0,
        "thrust": (throttle >= 1.0) | (throttle <= 0.0),
    }
    return " ".join(name for name, rows in hit.items() if rows.any())


def wind_along_std(record: FlightRecord, flown: slice) -> float:
    """Standard deviation (m/s) of the air's velocity along the velocity over the ground."""
    vel, wind = record.columns["own.vel_enu_mps"][flown], record.columns["air.wind_enu_mps"][flown]
    speed = np.linalg.norm(vel, axis=1)
    moving = speed > 0.0
    along = np.einsum("ij,ij->i", vel[moving], wind[moving]) / speed[moving]
    return float(np.std(along)) if len(along) else NAN


def goal_crossing(record: FlightRecord) -> tuple[int, float]:
    """Last row on this side of the goal's plane, and the share of the next step until the plane (0 if it was not reached)."""
    pos = record.columns["own.pos_enu_m"]
    last = len(pos) - 1
    if record.outcome not in (Outcome.REACHED, Outcome.COLLIDED, Outcome.NO_PATH) or last < 1:
        return last, 0.0
    curve = record.paths[-1].curves[-1]
    goal, tangent, _ = curve.frame(curve.length_m)
    beyond = (pos - goal) @ np.asarray(tangent)
    # the last crossing, which may lie some time back: a flight that passes the goal aside ends when it comes within the gate
    before = np.flatnonzero(beyond <= -AT_GOAL_M)
    ended_here = beyond[-1] >= -AT_GOAL_M and math.dist(pos[-1], goal) <= GOAL_GATE_M
    if not ended_here or not len(before):
        return last, 0.0
    k = int(before[-1])
    return k, float(np.clip(-beyond[k] / (beyond[k + 1] - beyond[k]), 0.0, 1.0))


def flown_length(record: FlightRecord, end: int, share: float) -> float:
    """Ground arc flown, up to the goal's plane, m."""
    pos = record.columns["own.pos_enu_m"]
    if not len(pos):
        return NAN
    steps = np.linalg.norm(np.diff(pos[: end + 2], axis=0), axis=1)
    return float(np.sum(steps[:end]) + (share * steps[end] if share > 0.0 else 0.0))


def closest_approach(record: FlightRecord) -> Closest:
    """Over all obstacles; without any (or before the first tick) there is none."""
    columns = record.columns
    found = Closest()
    for obstacle in contenders(columns, columns["own.pos_enu_m"], record.plan.obstacles):
        centre = columns.get(f"obstacle.{obstacle.name}.pos_enu_m")
        if centre is None or not len(centre):
            continue
        approach = least_clearance(columns["time_s"], columns["own.pos_enu_m"], centre, obstacle.radius_m)
        if math.isnan(found.clearance_m) or approach.clearance_m < found.clearance_m:
            found = Closest(approach.clearance_m, approach.time_s, obstacle.name)
    return found


def schedule_error(record: FlightRecord, at_s: float, end_row: float) -> float:
    """Seconds late (positive) along the active path at closest approach, or at the end of a flight without obstacles."""
    columns = record.columns
    n = len(columns["time_s"])
    if not n or not record.paths:
        return NAN
    hz = record.plan.rates.plant_hz
    row = end_row if math.isnan(at_s) else at_s * hz
    k = min(int(row), n - 1)
    active = int(columns["path.index"][k])
    path = record.paths[active]
    first = round(path.from_time_s * hz)
    pos = columns["own.pos_enu_m"][k] + (row - k) * columns["own.vel_enu_mps"][k] / hz
    if not np.isfinite(pos).all():
        return NAN
    both, rows = np.array([columns["own.pos_enu_m"][first], pos]), [first, k]
    s_begin, s_m = path.chain.nearest(both, columns["guidance.s_m"][rows])[0].tolist()
    wind = make_wind(record.plan.air, record.plan.terrain_z_m)
    inside = min(s_m, path.length_m)
    scheduled = planned_time(path.chain, s_begin, inside, record.plan, wind) + (s_m - inside) / record.plan.speed_mps
    return float(row / hz - path.from_time_s - scheduled)


def planned_clearance(record: FlightRecord) -> float:
    """Least clearance (m) of a point that keeps to the active paths and to their schedule, each from where it began."""
    if not record.plan.obstacles or not record.paths or not len(record.columns["time_s"]):
        return NAN
    time_s, hz = record.columns["time_s"], record.plan.rates.plant_hz
    wind = make_wind(record.plan.air, record.plan.terrain_z_m)
    point = np.full((len(time_s), 3), NAN)
    for active, path in enumerate(record.paths):
        mine = np.flatnonzero(record.columns["path.index"] == active)
        if not len(mine):
            continue
        begin_s = float(record.columns["path.s_m"][mine[0]])
        s = arc_lengths(path.chain, begin_s, (mine - mine[0]) / hz, record.plan, wind)
        inside = s <= path.length_m
        point[mine[inside]] = path.chain.places(s[inside])
    return clearance_of(record, point)


def demanded_roll_rate(record: FlightRecord) -> Array:
    """Roll rate (rad/s) of the bank column, for a plant without body rates; NaN where the path or its piece changes: bank jumps."""
    bank, hz = np.unwrap(record.columns["own.bank_rad"]), record.plan.rates.plant_hz
    if len(bank) < 2:
        return np.full(len(bank), NAN)
    piece = record.columns["path.index"] * 1000.0 + record.columns["path.leg"]
    rate = np.append(np.diff(bank) * hz, NAN)
    held = hz // record.plan.rates.guidance_hz  # the piece is known at the guidance rate only
    for change in np.flatnonzero(np.diff(piece) != 0.0):
        rate[max(0, change - held) : change + held + 1] = NAN
    return rate
