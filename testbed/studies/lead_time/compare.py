"""Lines of a study side by side: groups of the same circumstances, and what one circumstance costs, encounter by encounter."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from testbed.results.statistics import share_at_least
from testbed.studies.lead_time.lead_distributions import Cost, Estimate, bootstrap, cost, logistic, quantile, shown_from
from testbed.studies.lead_time.line import Line

RAILS = {"direct": "vo_instant", "insertion_point": "kinematic", "flyable": "kinematic"}
COMPARED_RUNGS = (  # what is compared, the rung with it, the rung without it
    ("guidance: no rails", "point_ideal", "rails"),
    ("roll, alone", "point_roll", "point_ideal"),
    ("load factor, alone", "point_load", "point_ideal"),
    ("speed, alone", "point_speed", "point_ideal"),
    ("roll, last", "point_mass", "point_no_roll"),
    ("load factor, last", "point_mass", "point_no_load"),
    ("speed, last", "point_mass", "point_no_speed"),
    ("all three", "point_mass", "point_ideal"),
    ("six degrees of freedom", "jsbsim", "point_mass"),
    ("all of flight", "jsbsim", "rails"),
)


class Who(NamedTuple):
    """The circumstances of a search, its encounter apart."""

    rung: str
    answer: str
    aircraft: str
    method: str
    swell_m: float
    wind_mps: float
    wind_from_deg: float | None
    turbulence: str


def who(line: Line) -> Who:
    """Of a line."""
    wind = None if math.isnan(line.wind_from_deg) else line.wind_from_deg
    return Who(line.rung, line.answer, line.aircraft, line.method, line.swell_m, line.wind_mps, wind, line.turbulence)


def groups(lines: Sequence[Line]) -> dict[Who, list[Line]]:
    """Lines by their circumstances, in order of appearance."""
    found: dict[Who, list[Line]] = {}
    for line in lines:
        found.setdefault(who(line), []).append(line)
    return found


class Summary(NamedTuple):
    """A group in numbers. Leads in s, ranges in m."""

    n: int
    never: int  # no lead of the grid suffices
    longest_s: float
    lead: Estimate
    lead_95: Estimate
    best: Estimate
    best_95: Estimate
    waste: Estimate
    again: int  # fails at a longer lead than one that sufficed
    range_m: Estimate
    range_95_m: Estimate


def summary(lines: Sequence[Line]) -> Summary:
    """Of a group that is not empty."""
    leads, best, ranges = ([getattr(line.found, name) for line in lines] for name in ("lead_s", "best_s", "range_m"))
    waste = [line.waste_s for line in lines if not math.isnan(line.waste_s)]
    return Summary(
        n=len(lines),
        never=sum(math.isinf(lead) for lead in leads),
        longest_s=lines[0].leads_s[-1],
        lead=quantile(leads, 0.5),
        lead_95=quantile(leads, 0.95),
        best=quantile(best, 0.5),
        best_95=quantile(best, 0.95),
        waste=quantile(waste, 0.5),
        again=sum(line.found.fails_again for line in lines),
        range_m=quantile(ranges, 0.5),
        range_95_m=quantile(ranges, 0.95),
    )


class Priced(NamedTuple):
    """What one thing costs the method, and the best manoeuvre."""

    what: str
    aircraft: str
    answer: str
    method: Cost
    best: Cost


def priced(what: str, with_it: Sequence[Line], without: Sequence[Line]) -> Priced:
    """By the encounters that both have (of one seed: the same number with another radius is another encounter)."""
    other = {(line.encounter, line.found.radius_m): line.found for line in without}
    pairs = [(line.found, other[key]) for line in with_it if (key := (line.encounter, line.found.radius_m)) in other]
    return Priced(
        what,
        with_it[0].aircraft,
        with_it[0].answer,
        cost([a.lead_s for a, _ in pairs], [b.lead_s for _, b in pairs]),
        cost([a.best_s for a, _ in pairs], [b.best_s for _, b in pairs]),
    )


def limits(by_who: dict[Who, list[Line]]) -> list[Priced]:
    """What rails, each limit (alone, and as the last one) and six degrees of freedom cost, wherever a point mass was flown."""
    bases = list(dict.fromkeys(key._replace(rung="") for key in by_who if key.rung.startswith("point_")))
    found = []
    for base in bases:
        rails = base._replace(rung=RAILS[base.answer], aircraft="")
        for what, with_it, without in COMPARED_RUNGS:
            keys = [rails if rung == "rails" else base._replace(rung=rung) for rung in (with_it, without)]
            if all(key in by_who for key in keys):
                found.append(priced(what, by_who[keys[0]], by_who[keys[1]]))
    return found


def insertion(by_who: dict[Who, list[Line]]) -> list[tuple[Who, Priced]]:
    """What flying through the insertion point costs beside flying the direction at once."""
    found = []
    for key, lines in by_who.items():
        at_once = key._replace(answer="direct", rung="vo_instant" if key.rung == "kinematic" else key.rung)
        if key.answer == "insertion_point" and not key.rung.startswith("point_") and key.wind_mps == 0.0 and at_once in by_who:
            found.append((key, priced("insertion point", lines, by_who[at_once])))
    return found


def flyable(by_who: dict[Who, list[Line]]) -> list[tuple[Who, Priced]]:
    """What a path within the aircraft's limits costs beside the one to the insertion point that asks nobody."""
    others = {key: key._replace(answer="insertion_point") for key in by_who if key.answer == "flyable"}
    return [(key, priced("flyable path", by_who[key], by_who[other])) for key, other in others.items() if other in by_who]


def winds(by_who: dict[Who, list[Line]]) -> list[tuple[Who, Priced]]:
    """What each wind costs beside calm air."""
    calm = {key: key._replace(wind_mps=0.0, wind_from_deg=None) for key in by_who if key.wind_mps > 0.0}
    return [(key, priced("wind", by_who[key], by_who[other])) for key, other in calm.items() if other in by_who]


class Shares(NamedTuple):
    """Flights in turbulence that kept the radius, by lead; leads of the logistic curve."""

    leads_s: tuple[float, ...]
    kept: list[int]
    n: int
    bounds: list[float]
    shown_from_s: float
    curve: list[float]
    half: Estimate
    most: Estimate
    curve_99: Estimate


def shares(lines: Sequence[Line], seed: int, at_s: np.ndarray) -> Shares:
    """Of a group flown in turbulence; the logistic curve at times ``at_s``."""
    leads = lines[0].leads_s
    kept = np.array([line.kept for line in lines], dtype=float)

    def reaches(share: float) -> Estimate:
        return bootstrap(kept, seed, lambda table: logistic(np.tile(leads, len(table)), table).lead_s(share))

    counts = [int(column.sum()) for column in kept.T]
    return Shares(
        leads,
        counts,
        len(lines),
        [share_at_least(count, len(lines)) for count in counts],
        shown_from(leads, kept),
        logistic(np.tile(leads, len(lines)), kept).at(at_s).tolist(),
        reaches(0.5),
        reaches(0.95),
        reaches(0.99),
    )
