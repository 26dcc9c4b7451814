"""A flight's encounter closely: what the page needs to move it. Dense samples on ticks counted from the decision, so that the flights of
an encounter lie on one grid of instants, and the clearance of each is the logged one at every instant of it.
"""

import math
from typing import Any, Final, NamedTuple

import numpy as np

from testbed.core.units import DEG
from testbed.flight.record import FlightRecord, ReplanEvent

Array = np.ndarray

MOST_CLEARANCES = 960  # samples of the clearance; a longer stretch is sampled more coarsely, by a power of two
EVERY = 4  # so many samples of the clearance make one of all else: 30 Hz of the usual 120
BEFORE_S, AFTER_S = 1.0, 1.5  # shown before the decision, and after the closest approach
SEEN_S = 4.0  # a detection so long before the decision is still shown
LONGEST_S = 20.0
MOST_OBSTACLES, MOST_DECISIONS = 12, 8
FAR = 1e9  # beyond this no number of a flight is one

DECISION: Final = "decision"
DETECTION: Final = "detection"
CLOSEST: Final = "closest approach"
ZEROS: Final = (DECISION, DETECTION, CLOSEST)
"""What instant 0 is: the first of these that the flight has."""

# Curve, column of the record, factor to the unit shown, decimals kept.
CURVES: Final = (
    ("bank_deg", "own.bank_rad", 1.0 / DEG, 1),
    ("pitch_deg", "own.pitch_rad", 1.0 / DEG, 1),
    ("heading_deg", "own.heading_rad", 1.0 / DEG, 1),
    ("load_factor", "own.load_factor", 1.0, 2),
)


class Instants(NamedTuple):
    """Rows of a record that matter. ``zero``: where time is counted from, and ``zero_is`` what that is."""

    zero: int
    zero_is: str
    detected: int | None
    nearest: int
    first: int
    last: int


def rounded(values: Array, digits: int) -> list[float | None]:
    """Plain floats, without negative zeros; ``None`` for what is not finite."""
    return [round(float(value), digits) + 0.0 if math.isfinite(value) else None for value in values]


def axes_of(points: Array, digits: int = 2) -> dict[str, list[float | None]]:
    """Points (n, 3) by their parts."""
    return {axis: rounded(points[:, k], digits) for k, axis in enumerate("xyz")}


def close_up(record: FlightRecord, clearance: Array, roll_rate: Array) -> dict[str, Any] | None:
    """The encounter of a flight, as JSON-able values; None for one without an obstacle. ``clearance``: to the nearest one in each row,
    ``roll_rate`` in rad/s. Sample k of the clearance is ``first + k`` steps of 1/``hz`` s after zero, sample k of all else ``EVERY * k``.
    """
    if not record.plan.obstacles or not np.isfinite(clearance).any():
        return None
    at, columns = instants(record, clearance), record.columns
    stride = 1
    while (at.last - at.first) / stride > MOST_CLEARANCES:
        stride *= 2
    step = stride * EVERY
    begin = at.zero - (at.zero - at.first) // step * step
    rows, coarse = np.arange(begin, at.last + 1, stride), np.arange(begin, at.last + 1, step)
    hz = record.plan.rates.plant_hz
    if not np.isfinite(columns["own.pos_enu_m"][coarse]).all(axis=1).any():
        return None
    return {
        "zero_s": round(float(columns["time_s"][at.zero]), 6),
        "zero_is": at.zero_is,
        "hz": hz / stride,
        "first": (begin - at.zero) // stride,
        "detected_s": None if at.detected is None else round((at.detected - at.zero) / hz, 6),
        "nearest_s": round((at.nearest - at.zero) / hz, 6),
        "clearance_m": rounded(clearance[rows], 2),
        **axes_of(columns["own.pos_enu_m"][coarse]),
        **{name: rounded(columns[column][coarse] * factor, digits) for name, column, factor, digits in CURVES},
        "roll_rate_dps": rounded(roll_rate[coarse] / DEG, 1),
        "wind": axes_of(columns["air.wind_enu_mps"][coarse]),
        "ground_z_m": round(float(record.plan.terrain_z_m), 1),
        "obstacles": _obstacles(record, coarse),
        "decisions": [_decision(event, at.zero / hz) for event in record.events if begin <= event.time_s * hz <= at.last][:MOST_DECISIONS],
    }


def instants(record: FlightRecord, clearance: Array) -> Instants:
    """Zero is the first decision about the obstacle that came nearest; without one its detection; else the closest approach."""
    hz, n = record.plan.rates.plant_hz, len(clearance)
    nearest = int(np.nanargmin(clearance))
    spec = min(record.plan.obstacles, key=lambda one: _last(record.columns[f"obstacle.{one.name}.clearance_m"][nearest]))
    reach_m = record.plan.sensor.shown_reach_m(spec.radius_m)
    seen = np.flatnonzero(record.columns[f"obstacle.{spec.name}.clearance_m"] + spec.radius_m <= reach_m)
    detected = int(seen[0]) if len(seen) else None
    about = [event for event in record.events if event.obstacle == spec.name] or list(record.events)
    if about:
        zero, zero_is = min(round(about[0].time_s * hz), n - 1), DECISION
    elif detected is not None:
        zero, zero_is = detected, DETECTION
    else:
        zero, zero_is = nearest, CLOSEST
    shown = detected if detected is not None and 0 <= zero - detected <= SEEN_S * hz else zero
    first = max(0, shown - round(BEFORE_S * hz))
    last = min(n - 1, max(nearest, zero) + round(AFTER_S * hz), first + round(LONGEST_S * hz))
    return Instants(zero, zero_is, detected, nearest, first, max(last, zero))


def _last(value: float) -> float:
    """For sorting: what is not known comes last."""
    return value if math.isfinite(value) else math.inf


def _obstacles(record: FlightRecord, rows: Array) -> list[dict[str, Any]]:
    """Where those that come nearest were, nearest first."""

    def least(name: str) -> float:
        clearance = record.columns[f"obstacle.{name}.clearance_m"][rows]
        return float(np.nanmin(clearance)) if np.isfinite(clearance).any() else math.inf

    near = sorted((spec for spec in record.plan.obstacles if least(spec.name) < math.inf), key=lambda spec: least(spec.name))
    return [
        {"name": spec.name, "radius_m": spec.radius_m, **axes_of(record.columns[f"obstacle.{spec.name}.pos_enu_m"][rows])}
        for spec in near[:MOST_OBSTACLES]
    ]


def _decision(event: ReplanEvent, zero_s: float) -> dict[str, Any]:
    inserted = math.isfinite(sum(event.insertion_enu_m)) and math.isfinite(event.insertion_time_s)
    return {
        "time_s": round(event.time_s - zero_s, 6),
        "decision": str(event.decision),
        "obstacle": event.obstacle,
        "alpha_deg": rounded(np.array([event.alpha_rad / DEG]), 1)[0],
        "alpha0_deg": rounded(np.array([event.alpha0_rad / DEG]), 1)[0],
        "insertion_enu_m": rounded(np.array(event.insertion_enu_m), 2) if inserted else None,
    }


_NUMBERS: Final = ("clearance_m", "x", "y", "z", *(name for name, *_ in CURVES), "roll_rate_dps")


def fits(told: Any) -> bool:
    """Whether a stored close-up, which may come from elsewhere, has the form that ``close_up`` gives it."""
    if told is None:
        return True
    if not isinstance(told, dict) or told.get("zero_is") not in ZEROS:
        return False
    if not (_is_number(told.get("hz")) and told["hz"] > 0 and isinstance(told.get("first"), int) and -FAR < told["first"] <= 0):
        return False
    places: Any = told.get("x")
    n = len(places) if isinstance(places, list) else 0
    lists = [told.get(name) for name in _NUMBERS[1:]] + _parts(told.get("wind"))
    obstacles, decisions = told.get("obstacles"), told.get("decisions")
    if not (n and isinstance(obstacles, list) and obstacles and isinstance(decisions, list)):
        return False
    for one in obstacles:
        if not (isinstance(one, dict) and isinstance(one.get("name"), str) and _is_number(one.get("radius_m"))):
            return False
        lists += _parts(one)
    clearance: Any = told.get("clearance_m")
    return (
        all(_are_numbers(values) and isinstance(values, list) and len(values) == n for values in lists)
        and any(None not in place for place in zip(*_parts(told), strict=True))
        and _are_numbers(clearance)
        and EVERY * (n - 1) < len(clearance) <= EVERY * n
        and all(_is_number(told.get(name)) for name in ("zero_s", "nearest_s", "ground_z_m"))
        and (told.get("detected_s") is None or _is_number(told["detected_s"]))
        and all(_is_decision(one) for one in decisions)
    )


def _is_decision(one: Any) -> bool:
    if not (isinstance(one, dict) and _is_number(one.get("time_s")) and all(isinstance(one.get(k), str) for k in ("decision", "obstacle"))):
        return False
    point = one.get("insertion_enu_m")
    return all(one.get(k) is None or _is_number(one[k]) for k in ("alpha_deg", "alpha0_deg")) and (
        point is None or (isinstance(point, list) and len(point) == 3 and all(map(_is_number, point)))
    )


def _parts(told: Any) -> list[Any]:
    return [told.get(axis) if isinstance(told, dict) else None for axis in "xyz"]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and -FAR < value < FAR


def _are_numbers(values: Any) -> bool:
    return isinstance(values, list) and all(value is None or _is_number(value) for value in values)
