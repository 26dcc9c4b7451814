"""Compute the results of a run again from its raw columns, and say where they differ: ``python reports/verify.py RUN_DIR``.

It shares no code with the testbed: it reads ``plan.json``, ``results.csv`` and ``columns/*.parquet`` of a run that kept its raw columns
(``--set columns=all``), computes what they determine from its definition alone, and compares. What needs more than the raw columns
(bank, load factor, cross-track, the planned curves) is taken from ``results.csv`` as it is. Where the run has a ``verdict.csv``, the
rules of ``docs/verdict.md`` are applied to these figures: words, effects of promises and numbers, counts. Not judged are
``words.online`` (wall clock), the poses of ``words.single.flyable``, the effects of comparisons, what decides, and the sentences.

Exit code 0: everything agrees. 1: something differs; a table says what. 2: the directory cannot be verified.
"""

import argparse
import csv
import json
import math
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from scipy import stats

Array = np.ndarray
NAN = math.nan

AGREE = 1e-6  # in the unit of a figure
TOUCH_M = 1e-6  # a sphere that is touched is not entered
GATE_M = 20.0  # a flight that crosses the goal's plane this near to it has reached the goal
ON_PLANE_M = 1e-9
HIGHEST_M = 1e5  # a state above this has diverged
REACH_M = 50.0  # no wing is longer
SHOWN = 12  # differences that are listed

NO_LOSS = ("replanned", "rejoined", "none", "clear")  # decisions that leave a flight with a path
TAKEN = ("crashed", "trim_failed")  # outcomes without a flight: there is nothing to compute them from

NUMBERS = (
    "least_clearance_m time_at_least_clearance_s replans trigger_time_s path_length_m flight_time_s deflection_deg deflection_ground_deg "
    "flown_deflection_deg flown_deflection_air_deg peak_deflection_deg peak_deflection_air_deg avoidance_time_s insertion_miss_m "
    "clear_time_s wind_along_std_mps route_miss_m"
).split()
WORDS = ("outcome", "nearest_obstacle")
DRAWN = ("robustness", "robustness_single", "robustness_multi")  # parts with draws


class BadInputError(Exception):
    """The directory cannot be verified; str() says why."""


@dataclass(frozen=True)
class Difference:
    """Something that the run says and that was computed otherwise. ``size`` orders differences of the same kind."""

    where: str
    quantity: str
    said: str
    found: str
    size: float


# ---------------------------------------------------------------------------------------------------------------- reading


@dataclass(frozen=True)
class Raw:
    """One flight as it was kept: ``time_s`` (n,), places, velocities and wind (n,3) in ENU, and what the file says about it."""

    time_s: Array
    pos: Array
    vel: Array
    wind: Array
    about: Mapping[str, Any]

    def centre(self, obstacle: Mapping[str, Any]) -> Array:
        """Places (n,3) of an obstacle's centre: a straight line."""
        return np.array(obstacle["pos_enu_m"]) + self.time_s[:, None] * np.array(obstacle["vel_enu_mps"])


def read_raw(path: Path) -> Raw:
    """The raw columns of a flight."""
    try:
        table = pq.read_table(path)
        pos, vel, wind = (
            np.column_stack([table[f"{name}.{axis}"].to_numpy() for axis in "xyz"])
            for name in ("own.pos_enu_m", "own.vel_enu_mps", "air.wind_enu_mps")
        )
        raw = Raw(table["time_s"].to_numpy(), pos, vel, wind, json.loads((table.schema.metadata or {})[b"flight"]))
        _ = [raw.about[key] for key in ("flight_id", "plant_hz", "terrain_z_m", "goal_enu_m", "goal_direction", "obstacles", "decisions")]
    except (OSError, pa.ArrowException, KeyError, ValueError, TypeError) as problem:
        raise BadInputError(f"{path}: not the raw columns of a flight ({problem})") from None
    return raw


def read_json(path: Path) -> Any:
    """A JSON file of the run."""
    try:
        return json.loads(path.read_bytes())
    except OSError:
        raise BadInputError(f"{path.parent}: no {path.name} here; is it a run directory?") from None
    except ValueError as problem:
        raise BadInputError(f"{path}: damaged ({problem})") from None


def read_csv(path: Path) -> list[dict[str, str]]:
    """The rows of a table, every field as its text."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    except OSError:
        raise BadInputError(f"{path.parent}: no {path.name} here; is it a run directory?") from None
    except (csv.Error, UnicodeDecodeError) as problem:
        raise BadInputError(f"{path}: damaged ({problem})") from None
    if any(None in row or None in row.values() for row in rows):
        raise BadInputError(f"{path}: damaged (a row has more or fewer fields than the heading)")
    return rows


def keeps(campaign: Mapping[str, Any], flight: Mapping[str, Any]) -> bool:
    """Should this flight of the plan have left its raw columns?"""
    part = (campaign.get("parts") or {}).get(flight["labels"].get("part")) or {}
    kept = part.get("columns") or campaign.get("columns") or "none"
    return bool(kept == "all" or (kept == "selected" and flight["replicate"] == 0))


# ------------------------------------------------------------------------------------------------------------- one flight


def nearest_between(relative: Array) -> tuple[Array, Array]:
    """Least distance (n-1,) of each step of a relative place (n,3) from the origin, and where on the step, 0 to 1.

    The step is straight. Where the foot of the perpendicular lies on it, the distance is |r x d| / |d|; else it is that of an end.
    """
    a, b = relative[:-1], relative[1:]
    d = b - a
    length = np.sqrt((d**2).sum(axis=1))
    ends = np.sqrt((a**2).sum(axis=1)), np.sqrt((b**2).sum(axis=1))
    with np.errstate(divide="ignore", invalid="ignore"):
        share = -(a * d).sum(axis=1) / length**2
        perpendicular = np.sqrt((np.cross(a, d) ** 2).sum(axis=1)) / length
    on_it = (share > 0.0) & (share < 1.0)
    least = np.where(on_it, perpendicular, np.minimum(*ends))
    return least, np.where(on_it, share, np.where(ends[0] <= ends[1], 0.0, 1.0))


def closest(raw: Raw) -> tuple[float, float, str]:
    """Least distance to any surface (m, negative inside), when (s), and whose."""
    best = (NAN, NAN, "")
    for obstacle in raw.about["obstacles"]:
        relative = raw.pos - raw.centre(obstacle)
        finite = np.isfinite(relative).all(axis=1)
        relative, time_s = relative[finite], raw.time_s[finite]
        if not len(relative):
            continue
        if len(relative) == 1:
            clearance, at = float(np.linalg.norm(relative[0])) - obstacle["radius_m"], float(time_s[0])
        else:
            least, share = nearest_between(relative)
            k = int(least.argmin())
            clearance, at = float(least[k]) - obstacle["radius_m"], float(time_s[k] + share[k] * (time_s[k + 1] - time_s[k]))
        if not best[0] <= clearance:
            best = (clearance, at, obstacle["name"])
    return best


@dataclass(frozen=True)
class End:
    """Where a flight counts until: the last row before the goal's plane, and the part of the next step up to it."""

    row: int
    share: float
    at_goal: bool


def end_of(raw: Raw) -> End:
    """A flight that stopped at the goal's gate counts until the plane, any other until its last row."""
    last = len(raw.pos) - 1
    if raw.about["goal_enu_m"] is None or last < 1:
        return End(last, 0.0, False)
    offset = raw.pos - np.array(raw.about["goal_enu_m"])
    beyond = offset @ np.array(raw.about["goal_direction"])
    at_goal = bool(-ON_PLANE_M <= beyond[-1] <= GATE_M and math.hypot(*offset[-1]) <= GATE_M)
    before = np.nonzero(beyond <= -ON_PLANE_M)[0]
    if not at_goal or not len(before):
        return End(last, 0.0, at_goal)
    k = int(before[-1])
    return End(k, min(1.0, -float(beyond[k]) / float(beyond[k + 1] - beyond[k])), True)


def outcome_of(raw: Raw, clearance: float, end: End) -> str:
    """How the flight ended, by the order of precedence: diverged, ground, collision, no path, time, goal."""
    if not len(raw.pos):
        return "no_path"
    z, limit_s = raw.pos[-1, 2], raw.about["longest_s"]
    height = z - raw.about["terrain_z_m"]
    if not z < HIGHEST_M or not np.isfinite(raw.vel[-1]).all():
        return "diverged"
    # a wing or a wheel touches before the centre of gravity does, and nothing else ends a flight before its time and its goal
    early = not end.at_goal and limit_s is not None and raw.time_s[-1] < limit_s
    if height <= 0.0 or (height < REACH_M and early):
        return "hit_ground"
    if clearance < -TOUCH_M:
        return "collided"
    if not end.at_goal:
        return "timed_out"
    return "reached" if all(decision["decision"] in NO_LOSS for decision in raw.about["decisions"]) else "no_path"


def between_deg(a: Array, b: Array) -> Array:
    """Angle (n,) in degrees between vectors (n,3) and one (3,), by Kahan's half-angle formula, good at every angle."""
    a, b = np.atleast_2d(a), np.asarray(b, dtype=float)
    a, b = a / np.linalg.norm(a, axis=1, keepdims=True), b / np.linalg.norm(b)
    return np.degrees(2.0 * np.arctan2(np.linalg.norm(a - b, axis=1), np.linalg.norm(a + b, axis=1)))


def clear_at(raw: Raw, first: int, last: int) -> int | None:
    """The first row from ``first`` on from which every obstacle opens, and is not entered any more until ``last``."""
    good = np.ones(last + 1 - first, dtype=bool)
    for obstacle in raw.about["obstacles"]:
        relative = (raw.centre(obstacle) - raw.pos)[first : last + 1]
        opens = (relative * (np.array(obstacle["vel_enu_mps"]) - raw.vel[first : last + 1])).sum(axis=1) > 0.0
        inside = np.nonzero(np.linalg.norm(relative, axis=1) < obstacle["radius_m"] - TOUCH_M)[0]
        good &= opens
        good[: inside[-1] + 1 if len(inside) else 0] = False
    return first + int(good.argmax()) if good.any() else None


def avoidance(raw: Raw, end: End) -> dict[str, float]:
    """What the first avoidance did, in degrees, seconds and metres; nothing where there was none."""
    event = next((decision for decision in raw.about["decisions"] if decision["decision"] == "replanned"), None)
    hz = raw.about["plant_hz"]
    if event is None:
        return {}
    first, last = round(event["time_s"] * hz), end.row
    known, command = np.array(event["wind_known_enu_mps"]), np.array(event["command_enu_mps"])
    found = {"deflection_deg": float(between_deg(np.array(event["own_vel_enu_mps"]) - known, command - known)[0])}
    if first >= last:
        return found
    ground = between_deg(raw.vel, raw.vel[first])
    air = between_deg(raw.vel - raw.wind, raw.vel[first] - raw.wind[first])
    clear = clear_at(raw, first, last)
    until = (last if clear is None else clear) + 1
    found |= {
        "deflection_ground_deg": float(between_deg(raw.vel[first], command)[0]),
        "peak_deflection_deg": float(ground[first:until].max()),
        "peak_deflection_air_deg": float(air[first:until].max()),
        "clear_time_s": NAN if clear is None else float(raw.time_s[clear] - raw.time_s[first]),
    }
    if None not in event["insertion_enu_m"]:
        away = np.linalg.norm(raw.pos[first : last + 1] - np.array(event["insertion_enu_m"]), axis=1)
        there = first + int(away.argmin())
        found |= {
            "flown_deflection_deg": float(ground[there]),
            "flown_deflection_air_deg": float(air[there]),
            "avoidance_time_s": float(raw.time_s[there] - raw.time_s[first]),
            "insertion_miss_m": float(away[there - first]),
        }
    return found


def metrics_of(raw: Raw) -> dict[str, float | str]:
    """Every quantity of ``NUMBERS`` and ``WORDS``; NaN where it does not exist for this flight."""
    clearance, at, who = closest(raw)
    end = end_of(raw)
    decisions = raw.about["decisions"]
    found: dict[str, float | str] = dict.fromkeys(NUMBERS, NAN)
    found |= {
        "outcome": outcome_of(raw, clearance, end),
        "nearest_obstacle": who,
        "least_clearance_m": clearance,
        "time_at_least_clearance_s": at,
        "replans": float(sum(decision["decision"] == "replanned" for decision in decisions)),
    }
    if decisions:
        found |= {"trigger_time_s": float(decisions[0]["time_s"]), "route_miss_m": _number(decisions[0]["route_miss_m"])}
    if len(raw.pos):
        steps = np.sqrt((np.diff(raw.pos, axis=0) ** 2).sum(axis=1))
        beyond = end.share * steps[end.row] if end.share else 0.0
        found["path_length_m"] = float(math.fsum(steps[: end.row]) + beyond)
        found["flight_time_s"] = (end.row + end.share) / raw.about["plant_hz"]
        found["wind_along_std_mps"] = _along(raw, end.row)
    return found | avoidance(raw, end)


def _along(raw: Raw, last: int) -> float:
    """Standard deviation (m/s) of the wind along the flight."""
    vel, wind = raw.vel[: last + 1], raw.wind[: last + 1]
    speed = np.sqrt((vel**2).sum(axis=1))
    moves = speed > 0.0
    along = ((vel * wind).sum(axis=1)[moves]) / speed[moves]
    return math.sqrt(((along - along.mean()) ** 2).mean()) if len(along) else NAN


def _number(text: str | float | None) -> float:
    return NAN if text is None or text == "" else float(text)


# ------------------------------------------------------------------------------------------------------------ all flights


@dataclass(frozen=True)
class Run:
    """A run directory: its plan, its rows by flight, and the raw columns of those that kept them."""

    path: Path
    campaign: Mapping[str, Any]
    flights: Mapping[str, Mapping[str, Any]]
    rows: Mapping[str, Mapping[str, str]]

    def kept(self) -> Iterator[tuple[str, Path]]:
        """Flights that have a row and should have raw columns, in plan order."""
        for flight_id, flight in self.flights.items():
            row = self.rows.get(flight_id)
            if row is not None and row["outcome"] not in TAKEN[:1] and keeps(self.campaign, flight):
                yield flight_id, self.path / "columns" / f"{flight_id}.parquet"


def open_run(path: Path) -> Run:
    """A run that has rows and raw columns, all of them."""
    if not path.is_dir():
        raise BadInputError(f"{path}: no such directory")
    plan, rows = read_json(path / "plan.json"), read_csv(path / "results.csv")
    try:
        flights = {flight["flight_id"]: flight for flight in plan["flights"]}
        _ = [(flight["labels"], flight["replicate"], flight["cell"]) for flight in flights.values()]
        run = Run(path, plan["campaign"], flights, {row["flight_id"]: row for row in rows})
        lacking = [name for name in (*NUMBERS, *WORDS, "cell") if rows and name not in rows[0]]
        kept = list(run.kept())
    except (KeyError, TypeError, AttributeError) as problem:
        raise BadInputError(f"{path}: not a run of this version of testbed ({type(problem).__name__}: {problem})") from None
    if lacking:
        raise BadInputError(f"{path / 'results.csv'}: has no column {', '.join(lacking)}")
    if not kept:
        raise BadInputError(f"{path}: no flight of this run kept its raw columns; fly it with --set columns=all")
    missing = [file for _, file in kept if not file.is_file()]
    if missing:
        more = f" and {len(missing) - 3} more" if len(missing) > 3 else ""
        names = ", ".join(f"columns/{file.name}" for file in missing[:3])
        raise BadInputError(f"{path}: raw columns are missing: {names}{more} (of {len(kept)} flights that kept them)")
    return run


@dataclass
class Comparison:
    """Differences of one quantity over many flights: how many were compared, and the worst."""

    compared: int = 0
    worst: float = 0.0
    worst_flight: str = ""

    def take(self, flight_id: str, said: float, found: float) -> float:
        """One flight more; how far apart its figures are."""
        size = apart(said, found)
        self.compared += not (math.isnan(said) and math.isnan(found))
        if size > self.worst:
            self.worst, self.worst_flight = size, flight_id
        return size


def compare_flights(run: Run) -> tuple[dict[str, dict[str, float | str]], dict[str, Comparison], list[Difference]]:
    """The metrics of every flight with raw columns, the worst difference of each quantity, and what does not agree."""
    own: dict[str, dict[str, float | str]] = {}
    worst = {name: Comparison() for name in NUMBERS}
    differences = [Difference("results.csv", "flight", name, "not in the plan", math.inf) for name in run.rows if name not in run.flights]
    for flight_id, file in run.kept():
        row, raw = run.rows[flight_id], read_raw(file)
        where = f"{flight_id} {row['cell']}"
        if raw.about["flight_id"] != flight_id or row["cell"] != run.flights[flight_id]["cell"]:
            raise BadInputError(f"{file}: of flight {raw.about['flight_id']} in another run, or the tables are of another plan")
        try:
            found = metrics_of(raw)
        except (KeyError, TypeError, ValueError, IndexError) as problem:
            raise BadInputError(f"{file}: cannot be computed from ({type(problem).__name__}: {problem})") from None
        if row["outcome"] in TAKEN:
            found["outcome"] = row["outcome"]
        own[flight_id] = found
        for name in NUMBERS:
            said = _said(run.path / "results.csv", flight_id, name, row[name])
            size = worst[name].take(flight_id, said, float(found[name]))
            if size > AGREE:
                differences.append(Difference(where, name, _text(said), _text(float(found[name])), size))
        differences += [
            Difference(where, name, row[name] or "nothing", str(found[name]) or "nothing", math.inf)
            for name in WORDS
            if row[name] != found[name]
        ]
    return own, worst, differences


def _said(path: Path, flight_id: str, name: str, text: str) -> float:
    try:
        return _number(text)
    except ValueError:
        raise BadInputError(f"{path}: flight {flight_id}: {name} is not a number: '{text}'") from None


def apart(a: float, b: float) -> float:
    """Difference of two figures; none of two that do not exist, infinite of one that does not."""
    if math.isnan(a) or math.isnan(b):
        return 0.0 if math.isnan(a) and math.isnan(b) else math.inf
    return 0.0 if a == b else abs(a - b)


def compare_counts(run: Run, own: Mapping[str, Mapping[str, float | str]]) -> tuple[int, list[Difference]]:
    """Outcomes counted in each cell, of flights with raw columns: how many cells, and what does not agree."""
    said: dict[str, Counter[str]] = {}
    found: dict[str, Counter[str]] = {}
    for flight_id, metrics in own.items():
        cell = str(run.flights[flight_id]["cell"])
        said.setdefault(cell, Counter())[run.rows[flight_id]["outcome"]] += 1
        found.setdefault(cell, Counter())[str(metrics["outcome"])] += 1
    unlike = [cell for cell in said if said[cell] != found[cell]]
    return len(said), [Difference(cell, "outcomes", _counted(said[cell]), _counted(found[cell]), math.inf) for cell in unlike]


def _counted(counts: Counter[str]) -> str:
    return ", ".join(f"{counts[name]} {name}" for name in sorted(counts))


# ------------------------------------------------------------------------------------------------- the verdict: docs/verdict.md

HOLDS, ONLY_IF, ON_RAILS, FLOWN, OPEN = "holds", "holds only if", "fails kinematically", "fails when flown", "not determined"
KINDEST = (HOLDS, ONLY_IF, FLOWN, OPEN, ON_RAILS)  # of the readings of a number
SIX_DIGITS = 1e-5  # what rounding to six significant digits changes at most, of a figure
ROOT = Path(__file__).resolve().parents[1]
SINGLE, MULTI = ("single_106", "single_106_10"), ("multi_o2_up",)
SIDES = {"droam_hp": ("droam_hp_left", "droam_hp_right"), "droam_vp": ("droam_vp_up", "droam_vp_down")}
DROAM = ("droam_hp", "droam_vp", *SIDES["droam_hp"], *SIDES["droam_vp"])
AIR = ("design", "wind_mps", "wind_from", "severity")
LEAST_PAIRS, ENOUGH = 6, 0.95

Flight = Mapping[str, Any]
Test = Callable[[Flight], bool]
Figure = Callable[[Flight], float]
Draws = dict[int, dict[str, list[Flight]]]  # replicate -> rung -> flights


@dataclass(frozen=True)
class Judged:
    """A word, and columns of ``verdict.csv`` that follow with it."""

    word: str
    columns: Mapping[str, float]


def number(row: Flight, name: str) -> float:
    """A metric; NaN where it does not exist."""
    return _number(row.get(name))


def route_length(row: Flight) -> float:
    """Length of the whole way, m: flights begin late on the route."""
    return number(row, "path_length_m") + number(row, "begin_s_m")


def replanned(row: Flight, value: float) -> float:
    """A figure of an avoidance; a flight that did not re-plan has none."""
    return value if number(row, "replans") > 0.0 else NAN


def keeps_radius(row: Flight) -> bool:
    """Every radius is kept, a touch included."""
    return number(row, "least_clearance_m") >= -TOUCH_M and row["outcome"] not in ("diverged", "hit_ground")


class Flights:
    """Flights that say something, found by their labels: figures computed again, and those of ``results.csv`` where they were not."""

    def __init__(self, rows: Sequence[Flight]) -> None:
        self.rows = [row for row in rows if row["outcome"] not in TAKEN and not math.isnan(number(row, "least_clearance_m"))]
        self._unplanned = {self._place(row): row for row in self.rows if label(row, "method") == "none"}
        self._rails = {self._partner(row): row for row in self.pick(rung="kinematic", part=("calm", "wind"))}

    @staticmethod
    def _place(row: Flight) -> tuple[str, ...]:
        return (*(label(row, name) for name in ("part", "encounter", "class", "flown_by", "rung", *AIR)), str(row["replicate"]))

    @staticmethod
    def _partner(row: Flight) -> tuple[str, ...]:
        who = tuple(label(row, name) for name in ("encounter", "method", "flown_by"))
        if label(row, "part") != "wind":  # in turbulence the calm one
            return ("calm", *who)
        return ("wind", *who, *(label(row, name) for name in AIR), str(row["replicate"]))

    def partner_fails(self, row: Flight) -> bool:
        """Is there a flight on rails of the same in the same wind, and does it fail?"""
        partner = self._rails.get(self._partner(row))
        return partner is not None and not keeps_radius(partner)

    def is_threat(self, row: Flight) -> bool:
        """Without planner a radius is not kept here, or that was not flown."""
        alone = self._unplanned.get(self._place(row))
        return alone is None or not keeps_radius(alone)

    def pick(self, **labels: str | tuple[str, ...]) -> list[Flight]:
        """Those with these labels; of several labels any."""
        wanted = {axis: (among,) if isinstance(among, str) else among for axis, among in labels.items()}
        return [row for row in self.rows if all(label(row, axis) in among for axis, among in wanted.items())]

    def draws(self, encounter: str, method: str | tuple[str, ...] = "scoam") -> Draws:
        """Flights of the robustness part by replicate and rung."""
        found: Draws = {}
        for row in self.pick(
            part=DRAWN,
            encounter=encounter,
            method=method,
            flown_by="gtm_t2",
            rung=("kinematic", "jsbsim"),
        ):
            found.setdefault(int(row["replicate"]), {}).setdefault(label(row, "rung"), []).append(row)
        return found


def label(row: Flight, axis: str) -> str:
    """A label of a flight, empty where it has none."""
    return str(row.get(f"label.{axis}") or "")


def share_bounds(count: int, n: int) -> tuple[float, float]:
    """Two-sided 95 % interval of a share after Clopper and Pearson, from quantiles of the beta distribution."""
    low = float(stats.beta.ppf(0.025, count, n - count + 1)) if count else 0.0
    return low, float(stats.beta.ppf(0.975, count + 1, n - count)) if count < n else 1.0


def median_bounds(values: Sequence[float]) -> tuple[float, float, float]:
    """Median, and its distribution-free 95 % interval; NaN below six values."""
    ordered = np.sort(np.array(values, dtype=float))
    n = len(ordered)
    if n < LEAST_PAIRS:
        return float(np.median(ordered)) if n else NAN, NAN, NAN
    r = int(np.argmax(stats.binom.cdf(np.arange(n + 1), n, 0.5) >= 0.025))
    return float(np.median(ordered)), float(ordered[r - 1]), float(ordered[n - r])


# promises


@cache
def limits_of(aircraft: str) -> dict[str, float]:
    """The section ``limits`` of an aircraft's YAML."""
    path = ROOT / "aircraft" / aircraft / "aircraft.yaml"
    try:
        section = path.read_text().split("\nlimits:", 1)[1]
    except (OSError, IndexError):
        raise BadInputError(f"{path}: no limits of an aircraft here") from None
    found: dict[str, float] = {}
    for line in section.splitlines()[1:]:
        if not line.startswith(" "):
            break
        key, _, value = line.partition("#")[0].partition(":")
        found[key.strip()] = float(value)
    return found


def lift_within(row: Flight) -> bool:
    """The load factor stays within the aircraft's limits, both ways."""
    limits = limits_of(str(row["aircraft"]))
    return number(row, "max_load_factor") <= limits["load_factor_max"] and number(row, "min_load_factor") >= limits["load_factor_min"]


def demand_within(row: Flight) -> bool:
    """Bank, load factor and roll rate that a path demands are within the limits."""
    limits = limits_of(str(row["aircraft"]))
    turns = number(row, "max_bank_deg") <= limits["bank_deg"] and number(row, "max_roll_rate_dps") <= limits["roll_rate_dps"]
    return turns and lift_within(row)


PROMISES: dict[str, tuple[tuple[str, ...], Test, Test]] = {
    "words.single.safe": (SINGLE, keeps_radius, keeps_radius),
    "words.single.flyable": (SINGLE, demand_within, lambda row: number(row, "cross_track_max_m") <= 5.0),
    "words.multi.safe": (MULTI, keeps_radius, keeps_radius),
    "words.overload": (("multi_as_printed", "multi_o2_up"), lift_within, lift_within),
}


def judge_promise(flights: Flights, key: str) -> Judged:
    """Rails first, then calm air, then air."""
    encounters, on_rails, flown = PROMISES[key]
    calm = flights.pick(part="calm", method="scoam", encounter=encounters, rung=("kinematic", "jsbsim"))
    calm = [row for row in calm if flights.is_threat(row)]
    rails = {cell_of(row): on_rails(row) for row in calm if label(row, "rung") == "kinematic"}
    passed = {cell for cell, good in rails.items() if good}
    still = [flown(row) for row in calm if label(row, "rung") == "jsbsim" and cell_of(row) in passed]
    windy = flights.pick(part="wind", design="anchored", method="scoam", encounter=encounters, rung="jsbsim")
    windy += flights.pick(part="turbulence", method="scoam", encounter=encounters, rung="jsbsim")
    air = [flown(row) for row in windy if cell_of(row) in passed and flights.is_threat(row) and not flights.partner_fails(row)]
    word = _promise_word(list(rails.values()), still, air)
    told = list(rails.values()) if word == ON_RAILS else [*still, *air]
    share = {"effect": sum(told) / len(told), "effect_n": len(told)} if told else {}
    share |= dict(zip(("effect_low", "effect_high"), share_bounds(sum(told), len(told)), strict=True)) if told else {}
    if on_rails is keeps_radius:
        where = {"encounter": encounters[0], "flown_by": "gtm_t2", "method": "scoam"}
        share |= _rungs(flights, lambda row: number(row, "least_clearance_m"), **where)
    judged = settled(word, draw_words(flights.draws(encounters[-1] if key == "words.overload" else encounters[0]), on_rails, flown))
    return Judged(judged.word, {**share, **judged.columns})


def _rungs(flights: Flights, figure: Figure, **where: str) -> dict[str, float]:
    """A figure on the rungs in calm air, and its spread in anchored wind and turbulence."""
    calm = {
        column: next(map(figure, flights.pick(part="calm", rung=rung, **where)), NAN)
        for column, rung in (("kinematic", "kinematic"), ("point_mass", "point_mass"), ("flown_calm", "jsbsim"))
    }
    return calm | _in_air(flights, figure, **where)


def _in_air(flights: Flights, figure: Figure, **where: str) -> dict[str, float]:
    air = [*flights.pick(part="wind", design="anchored", rung="jsbsim", **where), *flights.pick(part="turbulence", rung="jsbsim", **where)]
    found = [value for value in map(figure, air) if not math.isnan(value)]
    low, middle, high = np.percentile(found, (5.0, 50.0, 95.0)) if found else (NAN, NAN, NAN)
    return {"flown_air_p05": float(low), "flown_air_median": float(middle), "flown_air_p95": float(high), "flown_air_n": len(found)}


def cell_of(row: Flight) -> tuple[str, str]:
    """Encounter and aircraft."""
    return label(row, "encounter"), label(row, "flown_by")


def _promise_word(rails: Sequence[bool], still: Sequence[bool], air: Sequence[bool]) -> str:
    for flown, failure in ((rails, ON_RAILS), (still, FLOWN)):
        if not flown:
            return OPEN
        if not any(flown):
            return failure
    if not all(rails) or not all(still) or not air:
        return ONLY_IF
    together = [*still, *air]
    if share_bounds(sum(together), len(together))[0] >= ENOUGH:
        return HOLDS
    return OPEN if all(air) else ONLY_IF


# robustness


def draw_words(draws: Draws, on_rails: Test, flown: Test) -> dict[int, str]:
    """The word of each draw that has both flights."""
    both = {n: (pair["kinematic"][0], pair["jsbsim"][0]) for n, pair in draws.items() if len(pair) == 2}
    return {n: ON_RAILS if not on_rails(rails) else HOLDS if flown(air) else FLOWN for n, (rails, air) in both.items()}


def agreeing(word: str, said: Mapping[int, str]) -> tuple[float, int]:
    """Share of the draws that say the same as a word (or as the nominal pair, for a word that no pair can say), and how many there are."""
    drawn = [one for n, one in said.items() if n]
    meant = said.get(0) if word in (ONLY_IF, OPEN) else word
    return (drawn.count(meant) / len(drawn) if drawn and meant else NAN), len(drawn)


def settled(word: str, said: Mapping[int, str]) -> Judged:
    """A word after the rules on robustness."""
    share, n = agreeing(word, said)
    after = word
    if word == HOLDS:
        after = OPEN if not n else ONLY_IF if share < ENOUGH else HOLDS
    elif word in (ON_RAILS, FLOWN) and n and share < 0.5:
        after = OPEN
    return Judged(after, {"robustness_share": share, "robustness_n": n})


# comparisons

COMPARED: dict[str, tuple[Figure, Figure, float]] = {  # figure on rails, figure flown, margin
    "words.deflection_least": (lambda row: number(row, "deflection_deg"), lambda row: number(row, "flown_deflection_deg"), 0.05),
    "words.path_shortest": (route_length, route_length, 0.05),
    "words.time_least": (lambda row: number(row, "avoidance_time_s"), lambda row: number(row, "avoidance_time_s"), 0.01),
}


def gains(flights: Flights, rivals: Sequence[str], figure: Figure, **where: str | tuple[str, ...]) -> list[float]:
    """Best rival's figure minus SCOAM's for each encounter at a threat that has both."""
    best: dict[tuple[str, ...], dict[bool, float]] = {}
    for row in flights.pick(method=("scoam", *rivals), **where):
        value = figure(row)
        if not math.isnan(value) and flights.is_threat(row):
            ours = best.setdefault(Flights._place(row), {})
            mine = label(row, "method") == "scoam"
            ours[mine] = min(value, ours.get(mine, math.inf))
    return [pair[False] - pair[True] for pair in best.values() if len(pair) == 2]


def stand(differences: Sequence[float], margin: float) -> str:
    """Worse, open, better or typical."""
    _, low, high = median_bounds(differences)
    if len(differences) < LEAST_PAIRS:
        return "open"
    if high < -margin:
        return "worse"
    if low < -margin:
        return "open"
    kept = sum(d >= -margin for d in differences)
    return "better" if share_bounds(kept, len(differences))[0] >= ENOUGH else "typical"


def judge_comparison(flights: Flights, key: str) -> Judged:
    """Against the paper's rivals, and then against the wider field."""
    on_rails, flown, margin = COMPARED[key]
    narrow, wide = (_field_word(flights, key, rivals) for rivals in (DROAM, (*DROAM, "least_deflection")))
    word = ONLY_IF if narrow in (HOLDS, ONLY_IF) and wide != narrow else narrow
    here = {"part": "calm", "encounter": "single_106", "flown_by": "gtm_t2"}
    calm = {
        column: next(iter(gains(flights, DROAM, figure, rung=rung, **here)), NAN)
        for column, rung, figure in (("kinematic", "kinematic", on_rails), ("flown_calm", "jsbsim", flown))
    }
    said = {}
    for n, pair in _comparison_draws(flights, on_rails, flown).items():
        said[n] = ON_RAILS if pair[0] < -margin else HOLDS if pair[1] >= -margin else FLOWN
    judged = settled(word, said)
    return Judged(judged.word, {**calm, **judged.columns})


def _comparison_draws(flights: Flights, on_rails: Figure, flown: Figure, encounter: str = "single_106") -> dict[int, tuple[float, float]]:
    by_draw: dict[int, list[Flight]] = {}
    for row in flights.pick(part=DRAWN, encounter=encounter, flown_by="gtm_t2"):
        by_draw.setdefault(int(row["replicate"]), []).append(row)
    found = {}
    for n, rows in by_draw.items():
        only = Flights(rows)
        pair = [gains(only, DROAM, figure, rung=rung) for rung, figure in (("kinematic", on_rails), ("jsbsim", flown))]
        if all(pair):
            found[n] = (pair[0][0], pair[1][0])
    return found


def _field_word(flights: Flights, key: str, rivals: Sequence[str]) -> str:
    on_rails, flown, margin = COMPARED[key]
    rails, air = (
        gains(flights, rivals, figure, part="population", rung=rung) for rung, figure in (("kinematic", on_rails), ("jsbsim", flown))
    )
    if len(rails) < LEAST_PAIRS:
        two = gains(flights, rivals, on_rails, part="calm", encounter=SINGLE, rung="kinematic", flown_by="gtm_t2")
        refuted = len(two) == 2 and max(two) < -margin and _comparison_draws(flights, on_rails, flown)
        return ON_RAILS if refuted else OPEN
    first, second = stand(rails, margin), stand(air, margin)
    for found, failure in ((first, ON_RAILS), (second, FLOWN)):
        if found in ("worse", "open"):
            return failure if found == "worse" else OPEN
    return ONLY_IF if "typical" in (first, second) else HOLDS


# superior

LESS_CLEAR: Figure = lambda row: -number(row, "least_clearance_m")  # noqa: E731
CRITERIA: tuple[tuple[Figure, Figure, float], ...] = (  # on rails, flown: larger is worse; margin
    (LESS_CLEAR, LESS_CLEAR, 0.15),
    (lambda row: number(row, "deflection_deg"), lambda row: number(row, "flown_deflection_deg"), 0.05),
    (route_length, route_length, 0.05),
    (lambda row: number(row, "max_load_factor"), lambda row: number(row, "max_load_factor"), 0.05),
)


def judge_superior(flights: Flights) -> Judged:
    """SCOAM against both planes of DROAM on the population, then the draws: its clearance against the better plane."""
    margin = CRITERIA[0][2]
    draws = _comparison_draws(flights, LESS_CLEAR, LESS_CLEAR, "multi_o2_up")
    said = {n: ON_RAILS if rails < -margin else HOLDS if air >= -margin else FLOWN for n, (rails, air) in draws.items()}
    return settled(_superior_word(flights), said)


def _superior_word(flights: Flights) -> str:
    rails, air = (_standing(flights, rung) for rung in ("kinematic", "jsbsim"))
    if not flights.pick(part="population", method="scoam"):
        return OPEN
    better = [k for k, one in enumerate(rails) if one == "better"]
    if not better:
        return ON_RAILS if "worse" in rails else OPEN
    if not any(air[k] == "better" for k in better):
        return FLOWN
    return ONLY_IF if {"worse", "open"} & {*rails, *air} else HOLDS


def _standing(flights: Flights, rung: str) -> list[str]:
    """Of each criterion on a rung: better, equal, worse or open against both planes together."""
    each = [[_safer(flights, rung, plane), *(_median_stand(flights, rung, plane, *one) for one in CRITERIA)] for plane in SIDES]
    return [_of_both(pair) for pair in zip(*each, strict=True)]


def _of_both(pair: Sequence[str]) -> str:
    if "worse" in pair:
        return "worse"
    if all(one == "better" for one in pair):
        return "better"
    return "equal" if all(one in ("better", "equal") for one in pair) else "open"


def _safer(flights: Flights, rung: str, plane: str) -> str:
    ours: dict[tuple[str, ...], dict[str, bool]] = {}
    for row in flights.pick(part="population", rung=rung, method=("scoam", plane)):
        if flights.is_threat(row):
            ours.setdefault(Flights._place(row), {})[label(row, "method")] = keeps_radius(row)
    pairs = [(one["scoam"], one[plane]) for one in ours.values() if len(one) == 2]
    only_us, only_them = sum(a and not b for a, b in pairs), sum(b and not a for a, b in pairs)
    n = only_us + only_them
    if not n:
        return "equal"
    p = min(1.0, 2.0 * float(stats.binom.cdf(min(only_us, only_them), n, 0.5)))
    return "open" if p >= 0.05 else "better" if only_us > only_them else "worse"


def _median_stand(flights: Flights, rung: str, plane: str, on_rails: Figure, flown: Figure, margin: float) -> str:
    figure = on_rails if rung == "kinematic" else flown
    _, low, high = median_bounds(gains(flights, (plane,), figure, part="population", rung=rung))
    if low > margin:
        return "better"
    if high < -margin:
        return "worse"
    return "equal" if -margin <= low and high <= margin else "open"


# numbers

READINGS = {  # table -> encounter -> column of the audit
    "table2": {"single_as_printed": "as_printed", "single_106": "azimuth_106", "single_106_10": "direction_106_10"},
    "table4": {"multi_as_printed": "as_printed", "multi_o2_up": "o2_elevation_plus"},
}
DRAWN_FOR = {"table2": "single_106", "table4": "multi_o2_up"}
METHODS = {"scoam": "SCOAM", "droam_hp": "DROAM/HP", "droam_vp": "DROAM/VP"}
QUANTITIES: dict[str, tuple[str, Figure]] = {
    "deflection": ("deflection", lambda row: replanned(row, number(row, "deflection_deg"))),
    "path_length": ("path length", lambda row: replanned(row, route_length(row))),
    "time": ("avoidance time", lambda row: replanned(row, number(row, "avoidance_time_s"))),
}
PH_BOUNDARIES, DROAM_OPEN = {"ph_magnitudes", "route_tangents"}, {"droam", "common_q"}


@dataclass(frozen=True)
class Print:
    """A printed number under one reading: what is printed, half a unit of it, and what rounding of the inputs adds."""

    table: str
    method: str
    encounter: str
    figure: Figure
    value: float
    half_unit: float
    tolerance: float
    assumes: frozenset[str]

    def meets(self, value: float) -> bool:
        """Within the tolerance, and that there is a figure."""
        return abs(value - self.value) <= self.tolerance


def printed(key: str, encounter: str) -> Print:
    """What the audit says of a number."""
    which, method, quantity = key.split(".")
    name, figure = QUANTITIES[quantity]
    rows = read_csv(ROOT / "reports" / "paper" / "audit.csv")
    row = next(one for one in rows if one["where"] == f"Table {which[-1]}" and one["quantity"] == f"{METHODS[method]} {name}")
    half_unit, more = float(row["tolerance"]), _number(row[f"{READINGS[which][encounter]}_pm"])
    tolerance = half_unit + (0.0 if math.isnan(more) else more)
    assumes = frozenset(row["assumptions"].split("; "))
    return Print(which, method, encounter, figure, float(row["printed"]), half_unit, tolerance, assumes)


def judge_reading(flights: Flights, one: Print) -> Judged:
    """One number under one reading."""
    sides = SIDES.get(one.method, (one.method,))
    where = {"encounter": one.encounter, "flown_by": "gtm_t2"}
    rails = [row for row in flights.pick(part="calm", rung="kinematic", method=sides, **where) if not math.isnan(one.figure(row))]
    if not rails:
        return Judged(OPEN, {"kinematic": NAN})
    rails.sort(key=lambda row: number(row, "deflection_deg"))
    row = next((side for side in rails if one.meets(one.figure(side))), rails[0])
    calm = _rungs(flights, one.figure, method=label(row, "method"), **where)
    if row is rails[0]:  # in moving air the lesser side alone is flown, under the method's own name
        calm |= _in_air(flights, one.figure, method=one.method, **where)
    gap = calm["kinematic"] - one.value
    columns = {**calm, "effect": gap, "effect_low": gap - one.tolerance, "effect_high": gap + one.tolerance}
    # draws are of one encounter of each table and of the lesser side; the other readings and sides have none
    drawn = one.encounter == DRAWN_FOR[one.table] and row is rails[0]
    draws = flights.draws(one.encounter, one.method) if drawn else {}
    said = draw_words(draws, lambda flight: one.meets(one.figure(flight)), lambda flight: one.meets(one.figure(flight)))
    word = _number_word(one, calm, draws, said, row is not rails[0])
    share, n = agreeing(HOLDS if word == ONLY_IF else word, said)  # a number that is met
    return Judged(word, {**columns, "robustness_share": share, "robustness_n": n})


def _number_word(one: Print, calm: Mapping[str, float], draws: Draws, said: Mapping[int, str], other_side: bool) -> str:
    if not one.meets(calm["kinematic"]):
        on_rails = [one.figure(pair["kinematic"][0]) for n, pair in draws.items() if n and "kinematic" in pair]
        range_of = [value for value in on_rails if not math.isnan(value)]
        reached = bool(range_of) and min(range_of) - one.half_unit <= one.value <= max(range_of) + one.half_unit
        unprinted = not range_of and PH_BOUNDARIES & one.assumes
        return OPEN if DROAM_OPEN & one.assumes or reached or unprinted else ON_RAILS
    if math.isnan(calm["flown_calm"]):
        return OPEN
    if not one.meets(calm["flown_calm"]) and not calm["flown_air_p05"] <= one.value <= calm["flown_air_p95"]:
        return FLOWN
    share, n = agreeing(HOLDS, said)
    conditions = not one.encounter.endswith("as_printed") or other_side or PH_BOUNDARIES & one.assumes or (n and share < ENOUGH)
    return ONLY_IF if conditions else HOLDS


def judge_number(flights: Flights, key: str) -> Judged:
    """A number under a reading (``@encounter``), or the kindest word of all its readings."""
    name, _, encounter = key.partition("@")
    if encounter:
        return judge_reading(flights, printed(name, encounter))
    each = [judge_reading(flights, printed(name, one)) for one in READINGS[name.split(".")[0]]]
    figured = [one for one in each if not math.isnan(one.columns["kinematic"])]
    return min(figured, key=lambda one: KINDEST.index(one.word)) if figured else each[0]


def judge(flights: Flights, key: str) -> Judged | None:
    """The word of a claim and what follows with it; None for a claim that is not judged here."""
    if key in PROMISES:
        return judge_promise(flights, key)
    if key in COMPARED:
        return judge_comparison(flights, key)
    if key == "words.superior":
        return judge_superior(flights)
    if key.startswith(tuple(READINGS)):
        return judge_number(flights, key)
    return None


def compare_claims(run: Run, own: Mapping[str, Mapping[str, float | str]]) -> tuple[int, list[str], list[Difference]]:
    """Claims that agree, those that were not judged, and what does not agree."""
    path = run.path / "verdict.csv"
    claims = read_csv(path)
    flights = Flights([{**run.rows[name], **own.get(name, {})} for name in run.flights if name in run.rows])
    agreed, skipped, differences = 0, [], []
    for claim in claims:
        try:
            judged = judge(flights, claim["key"])
            found = [] if judged is None else _claim_differences(path, claim, judged)
        except (KeyError, ValueError, TypeError, StopIteration) as problem:
            raise BadInputError(f"{path}: cannot be judged ({type(problem).__name__}: {problem})") from None
        if judged is None:
            skipped.append(claim["key"])
        differences += found
        agreed += judged is not None and not found
    return agreed, skipped, differences


def _claim_differences(path: Path, claim: Mapping[str, str], judged: Judged) -> list[Difference]:
    found = [] if claim["word"] == judged.word else [Difference(claim["key"], "word", claim["word"], judged.word, math.inf)]
    for name, value in judged.columns.items():
        said = _said(path, claim["key"], name, claim[name])
        if apart(said, value) > SIX_DIGITS * max(1.0, abs(value)):
            found.append(Difference(claim["key"], name, _text(said), _text(value), apart(said, value)))
    return found


# ----------------------------------------------------------------------------------------------------------------- report


def _text(value: float) -> str:
    return "nothing" if math.isnan(value) else repr(value)


def table(rows: Sequence[tuple[str, ...]]) -> str:
    """Lines of a table, its columns as wide as they need to be."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return "\n".join("  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows)


def _unchecked(run: Run) -> str:
    """What was not checked and why, if anything."""
    told = {
        "not flown yet": sum(name not in run.rows for name in run.flights),
        "crashed": sum(row["outcome"] == "crashed" for row in run.rows.values()),
        "kept no raw columns": sum(not keeps(run.campaign, flight) for flight in run.flights.values()),
    }
    return "".join(f"; {count} {why}" for why, count in told.items() if count)


def verify(path: Path, say: Callable[[str], None]) -> bool:
    """Compare, and say what came out. Does everything agree?"""
    run = open_run(path)
    own, worst, differences = compare_flights(run)
    cells, unlike = compare_counts(run, own)
    differences += unlike
    say(f"{len(own)} flights checked of {len(run.flights)} planned, in {cells} cells{_unchecked(run)}")
    lines = [("quantity", "flights", "worst difference", "in flight")]
    lines += [(name, str(one.compared), f"{one.worst:.1e}" if one.worst else "0", one.worst_flight) for name, one in worst.items()]
    say(table(lines))
    if (path / "verdict.csv").is_file():
        agreed, skipped, unlike = compare_claims(run, own)
        differences += unlike
        say(f"{agreed} claims of the verdict agree" + (f"; not judged here: {', '.join(skipped)}" if skipped else ""))
    if differences:
        differences.sort(key=lambda one: -one.size)
        say(f"{len(differences)} differences above {AGREE:g}" + (f", the first {SHOWN}:" if len(differences) > SHOWN else ":"))
        say(
            table(
                [("where", "quantity", "the run says", "computed again")]
                + [(d.where, d.quantity, d.said, d.found) for d in differences[:SHOWN]]
            )
        )
    else:
        say("everything agrees")
    return not differences


def main() -> int:
    """Verify the run that the command line names."""
    parser = argparse.ArgumentParser(description="Compute the results of a run again from its raw columns.")
    parser.add_argument("run_dir", metavar="RUN_DIR", type=Path, help="a run directory that kept raw columns (--set columns=all)")
    try:
        return 0 if verify(parser.parse_args().run_dir, print) else 1
    except BadInputError as problem:
        print(problem, file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
