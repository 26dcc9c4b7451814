"""One flight as one ``.rrd`` for the Rerun viewer, its layout included. All of Rerun's API stays inside this package.

Importing it costs a third of a second, so callers import it where they need it.
"""

import os
from pathlib import Path

import numpy as np
import rerun as rr
import rerun_bindings

from testbed.flight.record import FlightRecord
from testbed.results.columns import FlightMetrics
from testbed.show.flight_summary import summary_markdown, who
from testbed.show.recording import layout, scene, signals, timeline, velocity
from testbed.show.velocity_space import look

APPLICATION = "vosc_testbed"
SIGHT_HZ = 30.0  # how often velocity space is pictured


def write_recording(record: FlightRecord, metrics: FlightMetrics, path: Path) -> None:
    """Write the recording of one flight; a file of that name is replaced only when the new one is complete."""
    rr.set_strict_mode(True)  # otherwise data of a wrong shape is dropped with a warning
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    skin = path.with_name(f"{path.name}.{os.getpid()}.rbl")
    try:
        layout.blueprint(record).save(APPLICATION, skin)
        stream = rr.RecordingStream(APPLICATION, recording_id=record.plan.flight_id, send_properties=False)
        stream.set_log_time_enabled(False)
        stream.set_log_tick_enabled(False)
        stream.save(part)
        stream.log_file_from_path(skin)
        _log_flight(stream, record, metrics)
        stream.flush()
        stream.disconnect()
        del stream
        # A stream leaves two threads and their memory behind until this is called; a thousand flights would not fit.
        rerun_bindings.flush_and_cleanup_orphaned_recordings()
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)
        skin.unlink(missing_ok=True)


def _log_flight(stream: rr.RecordingStream, record: FlightRecord, metrics: FlightMetrics) -> None:
    plan = record.plan
    stream.send_recording_name(f"{plan.campaign}: {plan.cell or who(record)} [{metrics.outcome}]")
    stream.send_property(
        "flight", rr.AnyValues(flight_id=plan.flight_id, campaign=plan.campaign, cell=plan.cell, seed=plan.seed, outcome=metrics.outcome)
    )
    stream.log("summary", rr.TextDocument(summary_markdown(record, metrics), media_type="text/markdown"), static=True)
    scene.log_route(stream, record)
    finite = np.isfinite(record.columns["own.pos_enu_m"]).all(axis=1)
    if finite.any():  # a flight that failed before its first step has a summary and nothing else
        rows = np.flatnonzero(finite)
        scene.log_motion(stream, record, metrics, rows)
        seen = timeline.thinned(rows, min(SIGHT_HZ, plan.rates.planner_hz), plan.rates.plant_hz)
        sights = look(record, seen)
        velocity.log(stream, record, seen, sights)
        signals.log(stream, record, rows, seen, sights)
