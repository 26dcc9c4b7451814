"""Flights as ``.rrd`` files for the Rerun viewer, their layout included. All of Rerun's API stays inside this package.

Importing it costs a third of a second, so callers import it where they need it.
"""

from pathlib import Path

import numpy as np
import rerun as rr

from testbed.flight.record import FlightRecord
from testbed.results.columns import FlightMetrics
from testbed.show.encounter import Window, window_of
from testbed.show.flight_summary import summary_markdown, who
from testbed.show.recording import film, layout, scene, signals, velocity
from testbed.show.recording.file import APPLICATION, readable, written
from testbed.show.recording.timeline import Clock, thinned
from testbed.show.true_size import wing_span_m
from testbed.show.velocity_space import look

__all__ = ["APPLICATION", "SIGHT_HZ", "write_recording"]

SIGHT_HZ = 30.0  # how often velocity space is pictured


def write_recording(record: FlightRecord, metrics: FlightMetrics, path: Path) -> None:
    """Write the recording of one flight; a file of that name is replaced only when the new one is complete."""
    plan, window, span_m = record.plan, window_of(record, metrics), wing_span_m(record.plan.aircraft)
    skin = layout.blueprint(record, metrics, window, scene.symbol_scale(record, span_m))
    name = f"{plan.campaign}: {plan.cell or who(record)} [{metrics.outcome}]"
    with written(path, name, plan.flight_id, skin) as stream:
        stream.send_property(
            "flight",
            rr.AnyValues(flight_id=plan.flight_id, campaign=plan.campaign, cell=plan.cell, seed=plan.seed, outcome=metrics.outcome),
        )
        clock = Clock(stream, window.begin_s, window.end_s)
        clock.static("summary", rr.TextDocument(readable(summary_markdown(record, metrics)), media_type="text/markdown"))
        _log_flight(clock, record, metrics, window, span_m)


def _log_flight(clock: Clock, record: FlightRecord, metrics: FlightMetrics, window: Window, span_m: float) -> None:
    scene.log_route(clock, record)
    rows = np.flatnonzero(np.isfinite(record.columns["own.pos_enu_m"]).all(axis=1))
    if len(rows):  # a flight that failed before its first step has a summary and nothing else
        scene.log_motion(clock, record, metrics, rows, span_m)
        if window.obstacle and (shown := film.filmed(record, window, rows, span_m)):
            film.log(clock, record, shown, window.obstacle, span_m)
        rates = record.plan.rates
        sight_hz = min(SIGHT_HZ, rates.planner_hz)
        seen = thinned(rows, sight_hz, rates.plant_hz)
        sights = look(record, seen)
        velocity.log(clock, record, seen, sights, sight_hz)
        signals.log(clock, record, metrics, rows, seen, sights)
