"""``arena_timings.csv``: what a decision took. The only file of an arena that is another one each time it is flown."""

import csv
import io

from testbed.results.statistics import spread
from testbed.studies.arena.flights import CONTROL, Flight, Place


def timings_text(flights: list[Flight]) -> str:
    """Processor time of the slowest decision of a flight, ms, by method and place, at all leads."""
    found: dict[tuple[str, str, Place], list[float]] = {}
    for one in flights:
        if one.shape != CONTROL:
            found.setdefault((one.method, one.shape, one.place), []).append(one.answer_ms)
    sink = io.StringIO(newline="")
    writer = csv.writer(sink, lineterminator="\n")
    writer.writerow(["method", "shape", "rung", "flown_by", "flights", "slowest_decision_median_ms", "slowest_decision_p95_ms"])
    for (method, shape, place), times in found.items():
        of = spread(times)
        writer.writerow([method, shape, *place, of.n, f"{of.median:.3f}", f"{of.p95:.3f}"])
    return sink.getvalue()
