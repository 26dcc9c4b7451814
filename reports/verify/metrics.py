"""Every quantity that the raw columns of a flight determine, from its definition."""

import math

import numpy as np

from .approach import clear_at, closest
from .outcome import AVOIDING, End, end_of, outcome_of
from .raw import Array, Raw
from .run import NUMBERS, figure_of


def between_deg(a: Array, b: Array) -> Array:
    """Angle (n,) in degrees between vectors (n,3) and one (3,), by Kahan's half-angle formula, good at every angle."""
    a, b = np.atleast_2d(a), np.asarray(b, dtype=float)
    a, b = a / np.linalg.norm(a, axis=1, keepdims=True), b / np.linalg.norm(b)
    return np.degrees(2.0 * np.arctan2(np.linalg.norm(a - b, axis=1), np.linalg.norm(a + b, axis=1)))


def avoidance(raw: Raw, end: End) -> dict[str, float]:
    """What the first avoidance did, in degrees, seconds and metres; nothing where there was none."""
    event = next((decision for decision in raw.about["decisions"] if decision["decision"] in AVOIDING), None)
    hz = raw.about["plant_hz"]
    if event is None:
        return {}
    first, last = round(event["time_s"] * hz), end.row
    command = np.array(event["command_enu_mps"], dtype=float)  # NaN where a law steers
    # a planner that steers counts over the ground, one that answers with a direction through the air that it knows
    known = np.array(event["wind_known_enu_mps"]) * (event["decision"] != "steered")
    found = {"deflection_deg": float(between_deg(np.array(event["own_vel_enu_mps"]) - known, command - known)[0])}
    if not np.isfinite(command).all():  # a manoeuvre, or a law: nothing but what its planner says of it
        found["deflection_deg"] = math.degrees(figure_of(event["deflection_rad"]))
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
        "clear_time_s": math.nan if clear is None else float(raw.time_s[clear] - raw.time_s[first]),
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
    """Every quantity of ``NUMBERS`` and ``WORDS``, NaN where it does not exist for this flight; and why the planner found no path."""
    clearance, at, who = closest(raw)
    end = end_of(raw)
    decisions = raw.about["decisions"]
    found: dict[str, float | str] = dict.fromkeys(NUMBERS, math.nan)
    found |= {
        "outcome": outcome_of(raw, clearance, end),
        "nearest_obstacle": who,
        "least_clearance_m": clearance,
        "time_at_least_clearance_s": at,
        "replans": float(sum(decision["decision"] in AVOIDING for decision in decisions)),
        "no_path": next((decision.get("reason") or "not said" for decision in decisions if decision["decision"] == "no_path"), ""),
    }
    if decisions:
        found |= {"trigger_time_s": float(decisions[0]["time_s"]), "route_miss_m": figure_of(decisions[0]["route_miss_m"])}
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
    return math.sqrt(((along - along.mean()) ** 2).mean()) if len(along) else math.nan
