"""Time series, modes, events, and the whole log in double precision."""

import numpy as np
import rerun as rr

from testbed.core.units import DEG
from testbed.flight.record import NEW_PATH, FlightRecord, Outcome, inside
from testbed.flight.record.signals import flat
from testbed.show import palette, words
from testbed.show.flight_summary import changes, event_sentence, leg_names, who
from testbed.show.palette import rgba
from testbed.show.recording import timeline
from testbed.show.velocity_space import Sight

# Entity below "signals", column of the record, factor to the unit shown, name in the legend, colour.
HEADLINES = (
    ("cross_track", "path.cross_track_m", 1.0, "cross-track, m", palette.OWN),
    ("bank/command", "guidance.bank_cmd_rad", 1.0 / DEG, "command, deg", palette.COMMAND),
    ("bank/flown", "own.bank_rad", 1.0 / DEG, "flown, deg", palette.OWN),
    ("load_factor/command", "guidance.load_factor_cmd", 1.0, "command", palette.COMMAND),
    ("load_factor/flown", "own.load_factor", 1.0, "flown", palette.OWN),
    ("airspeed", "own.airspeed_mps", 1.0, "airspeed, m/s", palette.OWN),
    ("throttle", "own.throttle", 100.0, "throttle, %", palette.GREEN),
    ("alpha", "own.alpha_rad", 1.0 / DEG, "angle of attack, deg", palette.ORANGE),
)
CURVES_HZ = 60.0  # the telemetry has every row


def log(stream: rr.RecordingStream, record: FlightRecord, rows: np.ndarray, seen: np.ndarray, sights: list[Sight]) -> None:
    """Headline curves, modes and events, telemetry. ``sights`` belong to the rows ``seen``."""
    columns, every = record.columns, rows
    rows = timeline.thinned(rows, CURVES_HZ, record.plan.rates.plant_hz)
    time_s = columns["time_s"][rows]
    for entity, column, factor, name, colour in HEADLINES:
        _log_curve(stream, f"signals/{entity}", name, colour, time_s, columns[column][rows] * factor)
    shades = (palette.OBSTACLE, palette.YELLOW, palette.PURPLE, palette.GREEN, palette.BLUE)
    for k, spec in enumerate(record.plan.obstacles):
        clearance = columns[f"obstacle.{spec.name}.clearance_m"][rows]
        _log_curve(stream, f"signals/clearance/{spec.name}", f"to {spec.name}, m", shades[k % len(shades)], time_s, clearance)
    if record.plan.obstacles:
        _log_curve(stream, "signals/clearance/zero", "collision", palette.WHITE, time_s[[0, -1]], np.zeros(2))
    _log_modes(stream, record, every, seen, sights)
    _log_events(stream, record)
    stream.send_columns(
        "telemetry", [timeline.index(columns["time_s"][every])], rr.DynamicArchetype.columns("telemetry", components=_flat(record, every))
    )


def _log_curve(stream: rr.RecordingStream, entity: str, name: str, colour: str, time_s: np.ndarray, values: np.ndarray) -> None:
    known = np.isfinite(values)
    if known.any():  # a point has no throttle: no curve rather than an empty one
        stream.log(entity, rr.SeriesLines(names=name, colors=rgba(colour), widths=1.5), static=True)
        stream.send_columns(entity, [timeline.index(time_s[known])], [*rr.Scalars.columns(scalars=values[known])])


def _flat(record: FlightRecord, rows: np.ndarray) -> dict[str, np.ndarray]:
    """Every column of the record as scalars: vectors become ``name.x``; what is unknown throughout is left out."""
    told = {name: values[rows].astype(np.float64) for name, values in flat(record.columns).items() if name != "time_s"}
    return {name: values for name, values in told.items() if not np.isnan(values).all()}


def _log_modes(stream: rr.RecordingStream, record: FlightRecord, rows: np.ndarray, seen: np.ndarray, sights: list[Sight]) -> None:
    time_s, legs = record.columns["time_s"], leg_names(record)
    legs = [legs[k] for k in rows]
    _log_states(stream, "modes/leg", time_s[rows], legs, {leg: rgba(colour) for leg, colour in palette.LEG.items()})
    colours = {
        "inside": rgba(palette.PURPLE),
        "threat": rgba(palette.OBSTACLE),
        "in range": rgba(palette.ORANGE),
        "out of range": rgba(palette.NIGHT_LINES),
    }
    for sight in sights:
        _log_states(stream, f"modes/threat_{sight.name}", time_s[seen], sight.states(), colours)


def _log_states(
    stream: rr.RecordingStream, entity: str, time_s: np.ndarray, states: list[str], colours: dict[str, tuple[int, int, int, int]]
) -> None:
    at = changes(states)
    stream.log(entity, rr.StateConfiguration(values=list(colours), colors=list(colours.values())), static=True)
    stream.send_columns(entity, [timeline.index(time_s[at])], [*rr.StateChange.columns(state=[states[k] for k in at])])


def _log_events(stream: rr.RecordingStream, record: FlightRecord) -> None:
    time_s = record.columns["time_s"]
    outcome = record.outcome
    ending = record.message or words.outcome_told(outcome)
    lines = [(float(time_s[0]), "INFO", f"start: {who(record)}, {words.method(record.plan.method.kind)}")]
    lines += [(event.time_s, "INFO" if event.decision in NEW_PATH else "WARN", event_sentence(event)) for event in record.events]
    for spec in record.plan.obstacles:
        hit = inside(record.columns[f"obstacle.{spec.name}.clearance_m"])
        if hit.any():
            lines.append((float(time_s[int(np.argmax(hit))]), "ERROR", f"collision with {spec.name}"))
    lines.append((float(time_s[-1]), "INFO" if outcome == Outcome.REACHED else "ERROR", f"end: {ending}"))
    lines.sort(key=lambda line: line[0])
    texts, levels = [line[2] for line in lines], [line[1] for line in lines]
    stream.send_columns("events", [timeline.index(np.array([line[0] for line in lines]))], [*rr.TextLog.columns(text=texts, level=levels)])
