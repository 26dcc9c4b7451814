"""What the paper can be read as: one claim a reading in ``verdict.csv``, and the figures of ``readings.csv``."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from scipy import special

from ..approach import TOUCH_M
from ..compare import Difference, apart, said_of, shown
from ..run import read_csv
from .flights import AIR, Flight, Flights, cell_of, keeps_radius, label, number
from .intervals import median_bounds, share_bounds
from .promises import promise_word
from .words import Judged, settled

KEY = "readings."
JUDGED_IN = ("single_106", "multi_o2_up")
WHO = ("method", "part", "encounter", "aircraft", "rung")
SIX_DIGITS = 1e-5  # what rounding to six significant digits changes at most, of a figure


def judge_reading_of_method(flights: Flights, key: str) -> Judged:
    """Rails first, then calm air, then wind; without draws. The share is of the population, flown by gtm_t2."""
    method = key.removeprefix(KEY)
    calm = _at_threat(flights, part="readings", method=method, encounter=JUDGED_IN)
    rails = {cell_of(row): keeps_radius(row) for row in calm if label(row, "rung") == "kinematic"}
    passed = {cell for cell, good in rails.items() if good}
    still = [keeps_radius(row) for row in calm if label(row, "rung") == "jsbsim" and cell_of(row) in passed]
    windy = _at_threat(flights, part="readings_wind", method=method)
    rails_there = flights.pick(part="readings_wind", method=method, rung="kinematic")
    partners = {_place(row, on="any rung"): keeps_radius(row) for row in rails_there}
    flown = [row for row in windy if label(row, "rung") == "jsbsim"]
    air = [keeps_radius(row) for row in flown if cell_of(row) in passed and partners.get(_place(row, on="any rung"), True)]
    drawn = _at_threat(flights, part="readings_population", method=method, rung="jsbsim", flown_by="gtm_t2")
    kept = sum(map(keeps_radius, drawn))
    low, high = share_bounds(kept, len(drawn)) if drawn else (math.nan, math.nan)
    here = {"part": "readings", "method": method, "encounter": JUDGED_IN[0], "flown_by": "gtm_t2"}
    columns = {
        column: next((number(row, "least_clearance_m") for row in flights.pick(rung=rung, **here)), math.nan)
        for column, rung in (("kinematic", "kinematic"), ("point_mass", "point_mass"), ("flown_calm", "jsbsim"))
    }
    in_wind = [number(row, "least_clearance_m") for row in flown if cell_of(row) == (JUDGED_IN[0], "gtm_t2")]
    columns |= dict(zip(("flown_air_p05", "flown_air_median", "flown_air_p95"), _percentiles(in_wind), strict=True))
    columns |= {"flown_air_n": len(in_wind), "effect": kept / len(drawn) if drawn else math.nan, "effect_low": low, "effect_high": high}
    return Judged(settled(promise_word(list(rails.values()), still, air), {}).word, {**columns, "effect_n": len(drawn)})


def compare_readings(path: Path, flights: Flights) -> tuple[int, list[Difference]]:
    """The lines of ``readings.csv`` that agree, and what does not. A line that should not be there, or is lacking, is told too."""
    said = {tuple(line[name] for name in WHO): line for line in read_csv(path)}
    found = _figures(flights)
    differences = [Difference(" ".join(key), "line", "there", "not flown", math.inf) for key in said.keys() - found.keys()]
    differences += [Difference(" ".join(key), "line", "lacking", "flown", math.inf) for key in found.keys() - said.keys()]
    agreed = 0
    for key in said.keys() & found.keys():
        line, where = said[key], " ".join(key)
        figures, forbidden = found[key]
        unlike = [
            Difference(where, name, shown(told), shown(value), apart(told, value))
            for name, value in figures.items()
            if apart(told := said_of(path, where, name, line[name]), value) > SIX_DIGITS * max(1.0, abs(value))
        ]
        if line["forbidden_by"] != forbidden:
            unlike.append(Difference(where, "forbidden_by", line["forbidden_by"] or "nothing", forbidden or "nothing", math.inf))
        agreed += not unlike
        differences += unlike
    return agreed, differences


def _figures(flights: Flights) -> dict[tuple[str, ...], tuple[dict[str, float], str]]:
    """Of every reading, encounter, aircraft and rung: figures, and what forbade a path."""
    groups: dict[tuple[str, ...], list[Flight]] = {}
    own: dict[tuple[str, ...], Flight] = {}
    for row in flights.rows:
        if label(row, "part").startswith("readings") and label(row, "method") != "none":
            if label(row, "method") == "scoam":
                own[_place(row)] = row
            if flights.is_threat(row):
                groups.setdefault(tuple(label(row, {"aircraft": "flown_by"}.get(name, name)) for name in WHO), []).append(row)
    return {key: (_figures_of(rows, {} if key[0] == "scoam" else own), _forbidden(rows)) for key, rows in groups.items()}


def _figures_of(rows: Sequence[Flight], own: Mapping[tuple[str, ...], Flight]) -> dict[str, float]:
    kept = sum(map(keeps_radius, rows))
    low, high = share_bounds(kept, len(rows))
    p05, middle, p95 = _percentiles([number(row, "least_clearance_m") for row in rows])
    pairs = [(row, own[_place(row)]) for row in rows if _place(row) in own]
    gaps = [number(a, "least_clearance_m") - number(b, "least_clearance_m") for a, b in pairs]
    this = sum(keeps_radius(a) and not keeps_radius(b) for a, b in pairs)
    only_own = sum(keeps_radius(b) and not keeps_radius(a) for a, b in pairs)
    tail = float(special.bdtr(min(this, only_own), this + only_own, 0.5)) if pairs else math.nan
    value, least, most = median_bounds(gaps)
    return {
        "threats": len(rows),
        "kept": kept,
        "kept_low": low,
        "kept_high": high,
        "clearance_p05": p05,
        "clearance_median": middle,
        "clearance_p95": p95,
        "pairs": len(pairs),
        "other": sum(abs(gap) > TOUCH_M for gap in gaps),
        "only_this": this,
        "only_own": only_own,
        "mcnemar_p": min(1.0, 2.0 * tail) if pairs else math.nan,
        "difference": value,
        "difference_low": least,
        "difference_high": most,
        "no_path": sum(bool(row.get("no_path")) for row in rows),
    }


def _forbidden(rows: Sequence[Flight]) -> str:
    """``climb angle 3; roll rate 1``: what the planner named the first time that it found no path."""
    counts = Counter(_limit(str(row["no_path"])) for row in rows if row.get("no_path"))
    return "; ".join(f"{name} {counts[name]}" for name in sorted(counts, key=lambda name: (-counts[name], name)))


def _limit(said: str) -> str:
    before, found, after = said.partition("aircraft's limits: ")
    return after.split(",")[0] if found else before


def _percentiles(values: Sequence[float]) -> tuple[float, ...]:
    return tuple(float(x) for x in np.percentile(values, (5.0, 50.0, 95.0))) if values else (math.nan,) * 3


def _at_threat(flights: Flights, **labels: str | tuple[str, ...]) -> list[Flight]:
    return [row for row in flights.pick(**labels) if flights.is_threat(row)]


def _place(row: Flight, on: str = "") -> tuple[str, ...]:
    """Encounter, aircraft, air, replicate and rung; ``on`` in the place of the rung, for a partner on another one."""
    return (*(label(row, name) for name in ("part", "encounter", "flown_by", *AIR)), on or label(row, "rung"), str(row["replicate"]))
