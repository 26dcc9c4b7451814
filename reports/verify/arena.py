"""The shares and ranks of an arena (``arena.csv``), computed again from flights by the rules of ``docs/arena.md``.

Clearance, outcome, deflection and length are those computed from the raw columns, where a flight kept them. Not computed again are load
factor, bank and roll rate, which need more than the raw columns, and by what a flight was lost.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np
from scipy import special

from .approach import TOUCH_M
from .compare import Difference, apart, said_of, shown
from .paper.intervals import share_bounds
from .run import BadInputError, Run, figure_of, read_csv

SIX_DIGITS = 1e-5  # what rounding to six significant digits changes at most, of a figure
TOGETHER = ("flown", "")
Place = tuple[str, str]
Figures = dict[str, float]


@dataclass(frozen=True)
class Flight:
    """A flight, as far as shares and ranks hang on it."""

    method: str
    idle: bool
    place: Place
    much: int
    lead_s: float
    met: tuple[str, int]
    kept: bool
    reached: bool
    clearance_m: float
    deflection_deg: float
    length_m: float


def flights_of(run: Run, own: Mapping[str, Mapping[str, float | str]]) -> list[Flight]:
    """Every flight that has a row."""
    found = []
    for name, planned in run.flights.items():
        if name in run.rows:
            row: dict[str, Any] = {**run.rows[name], **own.get(name, {})}
            labels, clearance = planned["labels"], figure_of(row["least_clearance_m"])
            found.append(
                Flight(
                    labels["method"],
                    row["method"] == "none",
                    (labels["rung"], labels["flown_by"]),
                    ("kinematic", "point_mass").index(row["plant"]) if row["plant"] in ("kinematic", "point_mass") else 2,
                    float(labels["lead_s"]),
                    (labels.get("part", ""), int(planned["replicate"])),
                    clearance >= -TOUCH_M and row["outcome"] not in ("diverged", "hit_ground"),
                    row["outcome"] == "reached",
                    clearance,
                    figure_of(row["peak_deflection_deg"]),
                    figure_of(row["path_length_m"]),
                )
            )
    return found


def by(flights: Iterable[Flight], key: str) -> dict[Any, list[Flight]]:
    """Flights by a field, in order of appearance."""
    found: dict[Any, list[Flight]] = {}
    for one in flights:
        found.setdefault(getattr(one, key), []).append(one)
    return found


def counted(flights: Sequence[Flight]) -> Figures:
    """The share that keeps; its interval counts encounters, each with the share of its own flights."""
    per = [sum(one.kept for one in mine) / len(mine) for mine in by(flights, "met").values()]
    low, high = share_bounds(math.fsum(per), len(per))  # type: ignore[arg-type]
    kept = sum(one.kept for one in flights)
    told: Figures = {"encounters": len(per), "flights": len(flights), "kept": kept, "share": kept / len(flights)}
    return told | {"low": low, "high": high}


def chosen(flights: Sequence[Flight]) -> tuple[list[Flight], float, float]:
    """Flights at the lead that is the best of the other half; the leads of the even and of the odd encounters."""
    half = [[one for one in flights if one.met[1] % 2 == k] for k in (0, 1)]
    leads = []
    for mine, other in ((half[0], half[1]), (half[1], half[0])):
        judge = by(other or mine, "lead_s")
        shares = {lead: np.mean([one.kept for one in those]) for lead, those in judge.items()}
        leads.append(max(lead for lead, share in shares.items() if share == max(shares.values())))
    return [one for one in flights if one.lead_s == leads[one.met[1] % 2]], leads[0], leads[1]


def medians(flights: Sequence[Flight], idle_m: Mapping[Any, float]) -> Figures:
    """What raw columns tell of the cost."""
    longer = [one.length_m - idle_m.get((one.place, one.met), math.nan) for one in flights if one.reached]
    clearance = [one.clearance_m for one in flights]
    told = {"clearance_p05_m": (clearance, 5), "clearance_median_m": (clearance, 50), "clearance_p95_m": (clearance, 95)}
    told |= {"deflection_median_deg": ([one.deflection_deg for one in flights], 50), "extra_path_median_m": (longer, 50)}
    return {name: _percentile(values, q) for name, (values, q) in told.items()}


def _percentile(values: Sequence[float], q: float) -> float:
    there = [value for value in values if not math.isnan(value)]
    return float(np.percentile(there, q)) if there else math.nan


def rank(racing: dict[str, tuple[list[Flight], Figures]]) -> None:
    """Add ranks and the test of the pairs with the first to the figures of who competes."""
    if not racing:
        return
    score = {m: {met: np.mean([one.kept for one in mine]) for met, mine in by(of, "met").items()} for m, (of, _) in racing.items()}
    way = {method: figures["extra_path_median_m"] for method, (_, figures) in racing.items()}
    order = sorted(racing, key=lambda m: (-racing[m][1]["share"], math.inf if math.isnan(way[m]) else way[m]))
    first, tests = order[0], {}
    for method in order:
        figures = racing[method][1]
        both = score[first].keys() & score[method].keys()
        a = sum(bool(score[first][met] > score[method][met]) for met in both)
        b = sum(bool(score[first][met] < score[method][met]) for met in both)
        place = 1 + sum(other["share"] > figures["share"] for _, other in racing.values())
        figures |= {"rank": place, "only_first": a, "only_this": b, "p": math.nan, "p_holm": math.nan}
        if method != first:
            tests[method] = figures["p"] = min(1.0, 2.0 * float(special.bdtr(min(a, b), a + b, 0.5)))
    ascending = sorted(tests, key=tests.__getitem__)
    steps = [min(1.0, tests[method] * (len(ascending) - k)) for k, method in enumerate(ascending)]
    for method, p in zip(ascending, np.maximum.accumulate(steps), strict=True):
        racing[method][1]["p_holm"] = float(p)


def judged(flights: Sequence[Flight]) -> dict[tuple[str, ...], Figures]:
    """Every row of ``arena.csv`` by what it is of: table, rung, aircraft, population, method, and the lead of a share by lead."""
    found: dict[tuple[str, ...], Figures] = {}
    idle_m = {(one.place, one.met): one.length_m for one in flights if one.idle}
    most = max(one.much for one in flights)
    together: dict[str, list[list[Flight]]] = {}
    all_flown = [place for place, mine in by(flights, "place").items() if mine[0].much == most]
    for place, there in by(flights, "place").items():
        standing = {}
        for method, mine in by(there, "method").items():
            for lead, those in by(mine, "lead_s").items():
                found["lead", *place, "", method, f"{lead:g}"] = counted(those)
            best, even, odd = chosen(mine)
            standing[method] = (best, {**counted(best), **medians(best, idle_m), "lead_even_s": even, "lead_odd_s": odd})
            if place in all_flown:
                together.setdefault(method, []).append(best)
        rank({method: pair for method, pair in standing.items() if not pair[0][0].idle})
        found |= {("best", *place, "", method, ""): figures for method, (_, figures) in standing.items()}
    whole = {method: [one for best in bests for one in best] for method, bests in together.items() if len(bests) == len(all_flown)}
    over = {method: (mine, {**counted(mine), **medians(mine, idle_m)}) for method, mine in whole.items()}
    rank({method: pair for method, pair in over.items() if not pair[0][0].idle})
    found |= {("best", *TOGETHER, "", method, ""): figures for method, (_, figures) in over.items()}
    for method, mine in whole.items():
        ordered = sorted(mine, key=lambda one: one.met[0])
        for population, share in groupby(ordered, key=lambda one: one.met[0]):
            found["population", *TOGETHER, population, method, ""] = counted(list(share))
    return found


def compare_arena(run: Run, own: Mapping[str, Mapping[str, float | str]]) -> tuple[int, list[Difference]]:
    """Rows of ``arena.csv`` that agree, and what does not."""
    path = run.path / "arena.csv"
    lines = read_csv(path)
    try:
        found = judged(flights_of(run, own))
        said = {_key(line, run): line for line in lines}
    except (KeyError, ValueError, TypeError) as problem:
        raise BadInputError(f"{path}: cannot be judged ({type(problem).__name__}: {problem})") from None
    differences = [Difference(" ".join(filter(None, key)), "row", _there(key in said), _there(key in found), math.inf)
                   for key in said.keys() ^ found.keys()]  # fmt: skip
    agreed = 0
    for key in said.keys() & found.keys():
        where = " ".join(filter(None, key))
        unlike = []
        for name, value in found[key].items():
            text = said_of(path, where, name, said[key][name])
            if apart(text, value) > SIX_DIGITS * max(1.0, abs(value)):
                unlike.append(Difference(where, name, shown(text), shown(value), apart(text, value)))
        agreed += not unlike
        differences += unlike
    return agreed, differences


def _key(line: Mapping[str, str], run: Run) -> tuple[str, ...]:
    """Without parts the population has the campaign's name."""
    parts = bool(run.campaign.get("parts"))
    lead = line["lead_even_s"] if line["table"] == "lead" else ""
    return line["table"], line["rung"], line["flown_by"], line["population"] if parts else "", line["method"], lead


def _there(is_there: bool) -> str:
    return "there" if is_there else "nothing"
