"""The clocks of a recording, in whole nanoseconds: the time of the flight, and for the encounter alone the time since the decision.

The viewer begins to play where its timeline begins, and cannot be told another place. So the encounter has a timeline of its own, which
begins at the decision; the whole flight is on ``sim_time``, one click away in the time panel.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

Array = np.ndarray
Build = Callable[[Array], Any]
"""Of some rows, by their numbers, the columns of components."""

TIMELINE = "sim_time"
ENCOUNTER = "encounter"
TICK_S = 1e-6  # times that differ by less are the same instant


@dataclass(frozen=True)
class Clock:
    """Writes to a stream at times of the flight, each also as a time of the encounter where it is within ``begin_s`` and ``end_s``."""

    stream: rr.RecordingStream
    begin_s: float
    end_s: float
    whole: bool = True
    """Whether the flight outside of its encounter is written, too; without that, the times of several flights may be written to one."""

    def send(self, entity: str, time_s: Array, build: Build) -> None:
        """Rows at those times. Those before the encounter, in it and after it are columns of their own."""
        inside = (time_s > self.begin_s - TICK_S) & (time_s < self.end_s + TICK_S)
        edges = np.flatnonzero(np.diff(inside)) + 1
        for rows in np.split(np.arange(len(time_s)), edges):
            if not len(rows):
                continue
            clocks = [index(TIMELINE, time_s[rows])] if self.whole else []
            if inside[rows[0]]:
                clocks.append(index(ENCOUNTER, time_s[rows] - self.begin_s))
            if clocks:
                self.stream.send_columns(entity, clocks, [*build(rows)])

    def log(self, entity: str, time_s: float, thing: rr.AsComponents) -> None:
        """From that time on; what was there when the encounter began is there from its beginning."""
        if self.whole:
            self.stream.set_time(TIMELINE, duration=np.timedelta64(_nanoseconds(time_s), "ns"))
        if time_s < self.end_s + TICK_S:
            self.stream.set_time(ENCOUNTER, duration=np.timedelta64(_nanoseconds(max(time_s - self.begin_s, 0.0)), "ns"))
        self.stream.log(entity, thing)
        self.stream.reset_time()

    def static(self, entity: str, *things: rr.AsComponents) -> None:
        """At all times."""
        for thing in things:
            self.stream.log(entity, thing, static=True)


def _nanoseconds(time_s: float) -> int:
    return round(time_s * 1e9)


def index(name: str, time_s: Array) -> rr.TimeColumn:
    """Rows at those times. Rounded here, because floats are rounded in one call and cut off in another."""
    return rr.TimeColumn(name, duration=np.round(np.asarray(time_s) * 1e9).astype("timedelta64[ns]"))


def thinned(rows: Array, rate_hz: float, plant_hz: float) -> Array:
    """About every ``plant_hz / rate_hz``-th of some rows, the last one always."""
    step = max(1, round(plant_hz / rate_hz))
    chosen = rows[::step]
    return chosen if len(rows) == 0 or chosen[-1] == rows[-1] else np.append(chosen, rows[-1])


def ragged(columns: Callable[..., Any], name: str, items: Sequence[Array] | Array) -> Build:
    """Columns of one component of which each row has as many as it likes; ``items`` by row, (m, 3) each."""

    def build(rows: Array) -> Any:
        chosen = [np.asarray(items[row], dtype=np.float32).reshape(-1, 3) for row in rows]
        return columns(**{name: np.concatenate(chosen)}).partition([len(item) for item in chosen])

    return build


def trail_ranges() -> rrb.VisibleTimeRanges:
    """What makes a view show a trail up to now, and not only its newest piece."""
    return rrb.VisibleTimeRanges(
        [
            rrb.VisibleTimeRange(name, start=rrb.TimeRangeBoundary.infinite(), end=rrb.TimeRangeBoundary.cursor_relative(seconds=0.0))
            for name in (TIMELINE, ENCOUNTER)
        ]
    )
