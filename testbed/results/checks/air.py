"""Checks of wind and gusts: the wind triangle, linear gust response, invariance of decisions in a uniform wind."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from testbed.campaign.words.air import OneMinusCosineGust, StepGust
from testbed.campaign.words.check import GustResponse, WindInvariance, WindTriangle
from testbed.core.frames import unit_from_direction, vec3
from testbed.core.units import DEG
from testbed.flight.air import ground_speed_along, make_wind
from testbed.flight.air.gusts import shape
from testbed.flight.record import Decision, FlightRecord
from testbed.results.checks.verdict import CheckResult, Evidence, Flown, flown_by, groups, worst

Array = np.ndarray


def triangle_flown(_check: WindTriangle, record: FlightRecord) -> Evidence:
    """Means over the last half: place, ground speed, and drift angle (nose right of the track: positive)."""
    half = slice(len(record.columns["time_s"]) // 2, None)
    v = record.columns["own.vel_enu_mps"][half]
    drift = _wrapped(record.columns["own.heading_rad"][half] - np.arctan2(v[:, 0], v[:, 1]))
    return {
        "place_enu_m": record.columns["own.pos_enu_m"][half].mean(axis=0).tolist(),
        "ground_speed_mps": float(np.linalg.norm(v, axis=1).mean()),
        "drift_rad": float(drift.mean()),
    }


def _wrapped(angle: Any) -> Any:
    return (angle + math.pi) % math.tau - math.pi


def wind_triangle(check: WindTriangle, flights: Sequence[Flown]) -> Iterable[CheckResult]:
    """Ground speed and drift angle; the worst of each plant."""
    for name, mine in groups(flights, flown_by):
        speeds, drifts = [], []
        for flight in mine:
            wind = make_wind(flight.plan.air, flight.plan.terrain_z_m)(0.0, vec3(np.array(flight["place_enu_m"])))
            along = unit_from_direction(*flight.plan.route.start_direction_deg)
            ground = ground_speed_along(along, flight.plan.speed_mps, wind)
            expected = _wrapped(math.atan2(ground * along[0] - wind[0], ground * along[1] - wind[1]) - math.atan2(along[0], along[1]))
            speeds.append(CheckResult(f"{name}: ground speed", "m/s", ground, flight["ground_speed_mps"], check.speed_tolerance_mps))
            drifts.append(CheckResult(f"{name}: drift angle", "deg", expected / DEG, flight["drift_rad"] / DEG, check.angle_tolerance_deg))
        yield worst(speeds)
        yield worst(drifts)


def load_factor_flown(_check: GustResponse, record: FlightRecord) -> Evidence:
    """The load factor at every tick."""
    return {"load_factor": record.columns["own.load_factor"].tolist()}


def gust_response(check: GustResponse, flights: Sequence[Flown]) -> Iterable[CheckResult]:
    """Duhamel: the response to a gust is the sum of the responses to the steps that it is made of.

    The greatest difference of load factor, at any time, as a share of the greatest response. Each plant needs three flights that
    differ in the gust alone: none, a step, a one-minus-cosine. The peak of a point mass is held against that of six degrees of freedom.
    """
    peaks = {}
    for name, mine in groups(flights, flown_by):
        by_kind = {flight.plan.air.gust.kind: flight for flight in mine}
        if not {"none", "step", "one_minus_cosine"} <= set(by_kind):
            continue
        load = {kind: np.array(flight["load_factor"]) for kind, flight in by_kind.items()}
        n = min(len(column) for column in load.values())
        step, gust = by_kind["step"].plan.air.gust, by_kind["one_minus_cosine"].plan.air.gust
        assert isinstance(step, StepGust)
        assert isinstance(gust, OneMinusCosineGust)
        assert step.at_time_s is not None
        assert gust.at_time_s is not None
        plan = by_kind["step"].plan
        time_s = np.arange(n) / plan.rates.plant_hz
        share = shape(gust)
        course = np.array([share(plan.speed_mps * (t - gust.at_time_s)) for t in time_s])
        first = math.ceil(step.at_time_s * plan.rates.plant_hz - 1e-9)
        of_step = (load["step"][first:n] - load["none"][first:n]) * gust.amplitude_mps / step.amplitude_mps
        expected = np.convolve(np.diff(course, prepend=0.0), of_step)[:n]
        found = load["one_minus_cosine"][:n] - load["none"][:n]
        error = np.abs(found - expected).max() / np.abs(expected).max()
        yield CheckResult(f"{name}: load factor off by", "of its peak", 0.0, float(error), check.share_tolerance)
        peaks[plan.plant.kind, plan.aircraft] = float(np.abs(found).max())
    for (kind, aircraft), peak in peaks.items():
        truth = peaks.get(("jsbsim", aircraft), math.nan)
        if kind == "point_mass" and truth > 0.0:
            yield CheckResult(f"point_mass {aircraft}: peak", "of jsbsim's", 1.0, peak / truth, check.point_mass_share_tolerance)


NUMBERS = (("place", "m"), ("velocity", "m/s"), ("angle", "deg"), ("time", "s"))


def invariance(check: WindInvariance, flights: Sequence[Flown]) -> Iterable[CheckResult]:
    """The first decision in each wind against the one in calm air, seen from a balloon: largest difference of each kind."""
    for name, mine in groups(flights, lambda plan: f"{plan.method.kind}, {flown_by(plan)}"):
        calm = next((flight for flight in mine if flight.plan.air.wind.kind == "calm"), None)
        windy = [_from_a_balloon(flight) for flight in mine if flight is not calm]
        if calm is None or not windy:
            continue
        reference = _from_a_balloon(calm)
        limits = (check.place_tolerance_m, check.speed_tolerance_mps, check.angle_tolerance_deg, 1.0 / calm.plan.rates.planner_hz)
        for (kind, unit), tolerance in zip(NUMBERS, limits, strict=True):
            error = max(float(np.abs(one[kind] - reference[kind]).max()) for one in windy)
            yield CheckResult(f"{name}: {kind} off by", unit, 0.0, error, tolerance)


def _from_a_balloon(flight: Flown) -> dict[str, Array]:
    """Numbers of the first event as a balloon sees them that left the origin with the wind at time 0; NaN if there was no new path."""
    events = flight.row["events"]
    if not events or events[0]["decision"] != Decision.REPLANNED:
        return {kind: np.array([np.nan]) for kind, _ in NUMBERS}
    place = vec3(np.array(events[0]["own_pos_enu_m"]))
    return _seen(events[0], np.array(make_wind(flight.plan.air, flight.plan.terrain_z_m)(0.0, place)))


def _seen(event: Mapping[str, Any], wind: Array) -> dict[str, Array]:
    now, then = wind * event["time_s"], wind * (event["time_s"] + event["insertion_time_s"])
    places = [(event["own_pos_enu_m"], now), (event["obstacle_pos_enu_m"], now), (event["insertion_enu_m"], then)]
    velocities = (event["own_vel_enu_mps"], event["obstacle_vel_enu_mps"], event["command_enu_mps"])
    angles = ("alpha_rad", "alpha0_rad", "cap_half_angle_rad", "deflection_rad", "cap_azimuth_rad", "cap_elevation_rad")
    return {
        "place": np.concatenate([[event["miss_m"]], *(np.asarray(place) - drift for place, drift in places)]),
        "velocity": np.concatenate([[event["cap_radius_mps"]], *(np.asarray(v) - wind for v in velocities)]),
        "angle": np.array([event[name] for name in angles]) / DEG,
        "time": np.array([event[name] for name in ("time_s", "time_to_cpa_s", "insertion_time_s")]),
    }
