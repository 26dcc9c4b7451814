"""Time series, modes, events, and the whole log in double precision."""

import math

import numpy as np
import rerun as rr

from testbed.campaign.words.aircraft import Limits
from testbed.core.units import DEG
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.record import FlightRecord
from testbed.flight.record.signals import flat
from testbed.results.columns import FlightMetrics
from testbed.show import palette
from testbed.show.flight_summary import changes, leg_names
from testbed.show.palette import rgba
from testbed.show.pilot_log import pilot_log
from testbed.show.recording.file import readable
from testbed.show.recording.timeline import Clock, thinned
from testbed.show.velocity_space import Sight
from testbed.show.words import number

# Entity below "signals", column of the record, factor to the unit shown, name in the legend, colour.
HEADLINES = (
    ("cross_track", "path.cross_track_m", 1.0, "cross-track, m", palette.OWN),
    ("bank/command", "guidance.bank_cmd_rad", 1.0 / DEG, "command", palette.COMMAND),
    ("bank/flown", "own.bank_rad", 1.0 / DEG, "flown", palette.OWN),
    ("load_factor/command", "guidance.load_factor_cmd", 1.0, "command", palette.COMMAND),
    ("load_factor/flown", "own.load_factor", 1.0, "flown", palette.OWN),
    ("airspeed/flown", "own.airspeed_mps", 1.0, "flown", palette.OWN),
    ("throttle", "own.throttle", 100.0, "throttle, %", palette.GREEN),
    ("alpha", "own.alpha_rad", 1.0 / DEG, "angle of attack, deg", palette.ORANGE),
)
CURVES_HZ = 60.0  # the telemetry has every row
SHADES = (palette.OBSTACLE, palette.YELLOW, palette.PURPLE, palette.GREEN, palette.BLUE)


def limit_lines(record: FlightRecord) -> dict[str, tuple[str, float]]:
    """Entity below "signals" to the name and value of a limit of the aircraft, as it is in force in the plant."""
    plan, limits = record.plan, load_aircraft(record.plan.aircraft).limits
    lines = {} if "roll" in plan.plant.ideal else _both("bank", -limits.bank_deg, limits.bank_deg, "limit", 0)
    if "load_factor" not in plan.plant.ideal:
        lines |= _both("load_factor", limits.load_factor_min, limits.load_factor_max, "limit", 1)
        lines["airspeed/slowest"] = _airspeed(limits)
    return lines | {"airspeed/set": (f"set speed {number(plan.speed_mps, 0)} m/s", plan.speed_mps)}


def _airspeed(limits: Limits) -> tuple[str, float]:
    return f"slowest {number(limits.speed_min_mps, 0)} m/s", limits.speed_min_mps


def _both(entity: str, low: float, high: float, name: str, digits: int) -> dict[str, tuple[str, float]]:
    return {
        f"{entity}/{side}": (f"{name} {number(value, digits)}", value)
        for side, value in (("least", low), ("most", high))
        if math.isfinite(value)
    }


def log(clock: Clock, record: FlightRecord, metrics: FlightMetrics, rows: np.ndarray, seen: np.ndarray, sights: list[Sight]) -> None:
    """Headline curves with their limits, modes and events, telemetry. ``sights`` belong to the rows ``seen``."""
    columns, every = record.columns, rows
    rows = thinned(rows, CURVES_HZ, record.plan.rates.plant_hz)
    time_s = columns["time_s"][rows]
    for entity, column, factor, name, colour in HEADLINES:
        log_curve(clock, f"signals/{entity}", name, colour, time_s, columns[column][rows] * factor)
    if record.plan.plant.kind != "kinematic":  # a point on rails has no limits
        for entity, (name, value) in limit_lines(record).items():
            log_level(clock, f"signals/{entity}", name, palette.GREY if entity.endswith("/set") else palette.ALARM, time_s, value)
    for k, spec in enumerate(record.plan.obstacles):
        clearance = columns[f"obstacle.{spec.name}.clearance_m"][rows]
        log_curve(clock, f"signals/clearance/{spec.name}", f"to {spec.name}", SHADES[k % len(SHADES)], time_s, clearance)
    if record.plan.obstacles:
        radii = sorted({spec.radius_m for spec in record.plan.obstacles})
        surface = f"surface (radius {' and '.join(number(radius, 0) for radius in radii)} m)"
        log_level(clock, "signals/clearance/surface", surface, palette.ALARM, time_s, 0.0)
    _log_modes(clock, record, every, seen, sights)
    lines = pilot_log(record, metrics)
    clock.send(
        "events",
        np.array([line.time_s for line in lines]),
        lambda k: rr.TextLog.columns(text=[readable(lines[row].text) for row in k], level=[lines[row].level for row in k]),
    )
    told = _flat(record, every)
    clock.send(
        "telemetry",
        columns["time_s"][every],
        lambda k: rr.DynamicArchetype.columns("telemetry", components={name: values[k] for name, values in told.items()}),
    )


def log_curve(clock: Clock, entity: str, name: str, colour: str, time_s: np.ndarray, values: np.ndarray) -> None:
    """A curve where it is known."""
    known = np.isfinite(values)
    if known.any():  # a point has no throttle: no curve rather than an empty one
        clock.static(entity, rr.SeriesLines(names=name, colors=rgba(colour), widths=1.8))
        there = values[known]
        clock.send(entity, time_s[known], lambda k: rr.Scalars.columns(scalars=there[k]))


def log_level(clock: Clock, entity: str, name: str, colour: str, time_s: np.ndarray, value: float) -> None:
    """A level line over all times."""
    clock.static(entity, rr.SeriesLines(names=name, colors=rgba(colour), widths=1.0))
    ends = [time_s[0], clock.begin_s, clock.end_s, time_s[-1]]
    clock.send(entity, np.unique(np.clip(ends, time_s[0], time_s[-1])), lambda k: rr.Scalars.columns(scalars=np.full(len(k), value)))


def _flat(record: FlightRecord, rows: np.ndarray) -> dict[str, np.ndarray]:
    """Every column of the record as scalars: vectors become ``name.x``; what is unknown throughout is left out."""
    told = {name: values[rows].astype(np.float64) for name, values in flat(record.columns).items() if name != "time_s"}
    return {name: values for name, values in told.items() if not np.isnan(values).all()}


def _log_modes(clock: Clock, record: FlightRecord, rows: np.ndarray, seen: np.ndarray, sights: list[Sight]) -> None:
    time_s, legs = record.columns["time_s"], leg_names(record)
    legs = [legs[k] for k in rows]
    _log_states(clock, "modes/leg", time_s[rows], legs, {leg: rgba(colour) for leg, colour in palette.LEG.items()})
    colours = {
        "inside": rgba(palette.PURPLE),
        "threat": rgba(palette.OBSTACLE),
        "in range": rgba(palette.ORANGE),
        "out of range": rgba(palette.NIGHT_LINES),
    }
    for sight in sights:
        _log_states(clock, f"modes/threat_{sight.name}", time_s[seen], sight.states(), colours)


def _log_states(clock: Clock, entity: str, time_s: np.ndarray, states: list[str], colours: dict[str, tuple[int, int, int, int]]) -> None:
    at = changes(states)
    clock.static(entity, rr.StateConfiguration(values=list(colours), colors=list(colours.values())))
    clock.send(entity, time_s[at], lambda k: rr.StateChange.columns(state=[states[at[row]] for row in k]))
