"""Differences between SCOAM and its rivals in one and the same encounter, aircraft and air."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from testbed.results.statistics import NAN, Effect, finite, median, share
from testbed.studies.scoam.labels import DROAM, SIDES, Axis, Method, Rung
from testbed.studies.scoam.verdict.flights import Flights, Row, air_of, label, number

EVERY: Final = (*DROAM, Method.LEAST_DEFLECTION)


@dataclass(frozen=True)
class Measure:
    """A quantity that is compared. ``margin``: a difference that counts as none (what the paper's tables or the flight loop resolve)."""

    name: str  # as a sentence says it
    unit: str
    rails: str  # metric on rails
    flown: str
    margin: float
    larger_is_better: bool = False

    def metric(self, rung: str) -> str:
        return self.rails if rung in (Rung.KINEMATIC, Rung.VO_INSTANT) else self.flown


DEFLECTION: Final = Measure("deflection", "deg", "deflection_deg", "flown_deflection_deg", 0.05)
LENGTH: Final = Measure("path length", "m", "path_length_m", "path_length_m", 0.05)
TIME: Final = Measure("avoidance time", "s", "avoidance_time_s", "avoidance_time_s", 0.01)
CLEAR: Final = Measure("time to clear", "s", "clear_time_s", "clear_time_s", 0.01)
LOAD: Final = Measure("load factor", "g", "max_load_factor", "max_load_factor", 0.05)
CLEARANCE: Final = Measure("clearance", "m", "least_clearance_m", "least_clearance_m", 0.15, larger_is_better=True)


@dataclass(frozen=True)
class Pairs:
    """Paired differences, rival minus SCOAM (turned round where more is better): positive favours SCOAM."""

    differences: tuple[float, ...]
    measure: Measure

    @property
    def effect(self) -> Effect:
        return median(f"median of the best rival's {self.measure.name} minus SCOAM's", self.measure.unit, self.differences)

    @property
    def least(self) -> Effect:
        """Share of pairs in which SCOAM is the best, ties included."""
        return share("pairs in which SCOAM is best", sum(d >= -self.measure.margin for d in self.differences), len(self.differences))


def gain(measure: Measure, rung: str, scoam: Row, rivals: Sequence[Row]) -> float:
    """How much the best rival that has a figure is behind SCOAM; NaN where either has none."""
    sign = -1.0 if measure.larger_is_better else 1.0
    metric = measure.metric(rung)
    figures = finite(sign * number(rival, metric) for rival in rivals)
    return min(figures) - sign * number(scoam, metric) if figures else NAN


def paired(
    flights: Flights,
    measure: Measure,
    part: str,
    rung: str,
    rivals: Sequence[str],
    only: Callable[[Row], bool] | None = None,
    **labels: str,
) -> Pairs:
    """All pairs of a part at threats. A plane of DROAM whose sides were flown apart stands for both of them.

    A flight in which SCOAM gave no answer has no figure and no pair; ``only`` chooses among SCOAM's flights.
    """
    names = [side for rival in rivals for side in (rival, *SIDES.get(rival, ()))]
    found: dict[tuple[str, ...], list[Row]] = {}
    for name in names:
        for row in flights.pick(part, name, rung, **labels):
            found.setdefault(_key(row), []).append(row)
    out = []
    for row in flights.pick(part, Method.SCOAM, rung, **labels):
        if flights.is_threat(row) and (only is None or only(row)):
            out.append(gain(measure, rung, row, found.get(_key(row), [])))
    return Pairs(tuple(finite(out)), measure)


def _key(row: Row) -> tuple[str, ...]:
    return (label(row, Axis.ENCOUNTER), label(row, Axis.FLOWN_BY), str(row.get("replicate")), *air_of(row))
