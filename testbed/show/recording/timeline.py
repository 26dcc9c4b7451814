"""The one clock of a recording: flight time, in whole nanoseconds."""

import numpy as np
import rerun as rr

TIMELINE = "sim_time"


def index(time_s: np.ndarray) -> rr.TimeColumn:
    """Rows at those times. Rounded here, because floats are rounded in one call and cut off in another."""
    return rr.TimeColumn(TIMELINE, duration=np.round(np.asarray(time_s) * 1e9).astype("timedelta64[ns]"))


def thinned(rows: np.ndarray, rate_hz: float, plant_hz: float) -> np.ndarray:
    """About every ``plant_hz / rate_hz``-th of some rows, the last one always."""
    step = max(1, round(plant_hz / rate_hz))
    chosen = rows[::step]
    return chosen if len(rows) == 0 or chosen[-1] == rows[-1] else np.append(chosen, rows[-1])
