"""How a check campaign is judged: what was flown against a truth that does not come from the flight.

A judge takes the ``check`` section of a campaign and the records of its flights, and says for each quantity what is true, what was
measured, and whether that is near enough. ``judge`` finds the judge by name.
"""

import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from testbed.flight.air import ground_speed_along, make_wind
from testbed.flight.air.dryden import autocorrelation, dryden, spectrum
from testbed.flight.air.gusts import shape
from testbed.frames import unit_from_direction, vec3
from testbed.spec.air import DrydenTurbulence, NoTurbulence, OneMinusCosineGust, StepGust
from testbed.spec.check import GustResponse, TurbulenceStatistics, WindInvariance, WindTriangle
from testbed.spec.model import Campaign, FlightPlan
from testbed.types import FlightRecord, ReplanEvent
from testbed.units import DEG

Array = np.ndarray
SPIN_UP_S = 20.0  # JSBSim's own turbulence begins with nothing; its slowest filter has a time constant of 6 s at 50 m/s, 200 m
BANDS_HZ = 0.05 * 2.0 ** np.arange(8)  # octaves from 0.05 to 6.4 Hz: the periods of a manoeuvre to those of a roll mode


@dataclass(frozen=True)
class CheckResult:
    """One line of a judgement, in the unit that ``quantity`` names."""

    quantity: str
    truth: float
    measured: float
    tolerance: float

    @property
    def passed(self) -> bool:
        return abs(self.measured - self.truth) <= self.tolerance  # false for NaN


Records = Sequence[FlightRecord]


def judge(campaign: Campaign, records: Records) -> tuple[CheckResult, ...]:
    """The lines of a campaign's check, in a fixed order; empty if it has none. ``ValueError`` when it flies nothing to judge."""
    if campaign.check is None:
        return ()
    results = tuple(CHECKS[campaign.check.kind](campaign.check, records))
    if not results:
        raise ValueError(f"check {campaign.check.kind}: none of the {len(records)} flights can be judged")
    return results


def flown_by(plan: FlightPlan) -> str:
    """Plant, and the aircraft where there is one."""
    return plan.plant.kind if plan.plant.kind == "kinematic" else f"{plan.plant.kind} {plan.aircraft}"


def groups(records: Records, key: Callable[[FlightPlan], str]) -> Iterable[tuple[str, list[FlightRecord]]]:
    """Records of equal key, keys in the order of their first flight."""
    order = list(dict.fromkeys(key(record.plan) for record in records))
    return ((name, [record for record in records if key(record.plan) == name]) for name in order)


def worst(results: Sequence[CheckResult]) -> CheckResult:
    """The one that is off most; NaN counts as most."""
    return max(results, key=lambda r: math.inf if math.isnan(r.measured) else abs(r.measured - r.truth) / r.tolerance)


def wind_triangle(check: WindTriangle, records: Records) -> Iterable[CheckResult]:
    """Drift angle (nose right of the track: positive) and ground speed of the last half of each flight; the worst of each plant."""
    for name, mine in groups(records, flown_by):
        speeds, drifts = [], []
        for record in mine:
            half = slice(len(record.columns["time_s"]) // 2, None)
            place = record.columns["own.pos_enu_m"][half].mean(axis=0)
            wind = make_wind(record.plan.air, record.plan.terrain_z_m)(0.0, vec3(place))
            along = unit_from_direction(*record.plan.route.start_direction_deg)
            ground = ground_speed_along(along, record.plan.speed_mps, wind)
            vx, vy = ground * along[0] - wind[0], ground * along[1] - wind[1]
            v = record.columns["own.vel_enu_mps"][half]
            track = np.arctan2(v[:, 0], v[:, 1])
            drift = (record.columns["own.heading_rad"][half] - track + math.pi) % math.tau - math.pi
            speeds.append(
                CheckResult(f"{name}: ground speed, m/s", ground, float(np.linalg.norm(v, axis=1).mean()), check.speed_tolerance_mps)
            )
            expected = (math.atan2(vx, vy) - math.atan2(along[0], along[1]) + math.pi) % math.tau - math.pi
            drifts.append(CheckResult(f"{name}: drift angle, deg", expected / DEG, float(drift.mean()) / DEG, check.angle_tolerance_deg))
        yield worst(speeds)
        yield worst(drifts)


def gust_response(check: GustResponse, records: Records) -> Iterable[CheckResult]:
    """Duhamel: the response to a gust is the sum of the responses to the steps that it is made of.

    The greatest difference of load factor, at any time, as a share of the greatest response. Each plant needs three flights that
    differ in the gust alone: none, a step, a one-minus-cosine.
    """
    for name, mine in groups(records, flown_by):
        by_kind = {record.plan.air.gust.kind: record for record in mine}
        if not {"none", "step", "one_minus_cosine"} <= set(by_kind):
            continue
        load = {kind: record.columns["own.load_factor"] for kind, record in by_kind.items()}
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
        yield CheckResult(f"{name}: load factor, share of its peak", 0.0, float(error), check.share_tolerance)


def turbulence(check: TurbulenceStatistics, records: Records) -> Iterable[CheckResult]:
    """Standard deviation along, across and up, and the octave whose power is off most, for each source and plant."""
    for name, mine in groups(records, lambda plan: f"{plan.air.turbulence.kind} in {flown_by(plan)}"):
        turbulent = mine[0].plan.air.turbulence
        if isinstance(turbulent, NoTurbulence):
            continue
        gusts, hz = [_gusts(record) for record in mine], mine[0].plan.rates.plant_hz
        height = mine[0].plan.route.start_enu_m[2] - mine[0].plan.terrain_z_m
        if isinstance(turbulent, DrydenTurbulence) and turbulent.height_m is not None:
            height = turbulent.height_m
        model = dryden(turbulent.severity, height)
        for column, axis in enumerate(("along", "across", "up")):
            sigma, tau = model[column], model[column + 3] / mine[0].plan.speed_mps
            series = [one[:, column] for one in gusts]
            measured = math.sqrt(float(np.mean(np.concatenate(series) ** 2)))
            error = 0.5 * sigma * math.sqrt(variance_of_power(tau, column > 0, [len(one) / hz for one in series]))
            yield CheckResult(f"{name}: sigma {axis}, m/s", sigma, measured, check.deviations * error)
            yield _worst_band(check, f"{name}: power {axis}", series, hz, sigma, tau, column > 0)


def _gusts(record: FlightRecord) -> Array:
    """Along, across (left) and up (n,3), relative to the mean wind, in the axes of the route's start; without JSBSim's spin-up."""
    wind = make_wind(record.plan.air, record.plan.terrain_z_m)
    pos, air = record.columns["own.pos_enu_m"], record.columns["air.wind_enu_mps"]
    gusts = air - np.array([wind(0.0, vec3(p)) for p in pos])
    azimuth = record.plan.route.start_direction_deg[0] * DEG
    cos, sin = math.cos(azimuth), math.sin(azimuth)
    first = round(SPIN_UP_S * record.plan.rates.plant_hz) if record.plan.air.turbulence.kind == "jsbsim" else 0
    return np.column_stack([cos * gusts[:, 0] + sin * gusts[:, 1], cos * gusts[:, 1] - sin * gusts[:, 0], gusts[:, 2]])[first:]


def variance_of_power(tau_s: float, two_stage: bool, lengths_s: Sequence[float]) -> float:
    """Variance of the mean square of a Gaussian series of unit variance over independent stretches: 2/T^2 int int R^2."""
    total = sum(lengths_s)
    out = 0.0
    for length in lengths_s:
        lag = np.linspace(0.0, length, 4001)
        out += 4.0 * length * float(np.trapezoid((1.0 - lag / length) * autocorrelation(lag, tau_s, two_stage) ** 2, lag))
    return out / total**2


def _worst_band(
    check: TurbulenceStatistics, quantity: str, series: Sequence[Array], hz: int, sigma: float, tau_s: float, two_stage: bool
) -> CheckResult:
    """The octave whose mean periodogram (Hann) is furthest from the specified power, beside the error of its average."""
    from scipy.signal import periodogram

    n = min(len(one) for one in series)
    spectra = [periodogram(one[:n], hz, window="hann", detrend=False) for one in series]
    frequency, power = spectra[0][0], np.mean([p for _, p in spectra], axis=0)
    expected = sigma**2 * spectrum(frequency, tau_s, two_stage)
    results = []
    for low, high in itertools.pairwise(BANDS_HZ):
        band = (frequency >= low) & (frequency < high)
        independent = band.sum() * len(series) / 1.5  # neighbouring lines of a Hann window are not independent
        tolerance = check.band_share_tolerance + check.deviations / math.sqrt(independent)
        ratio = float(power[band].sum() / expected[band].sum())
        results.append(CheckResult(f"{quantity} from {low:g} to {high:g} Hz, share of what is specified", 1.0, ratio, tolerance))
    return worst(results)


def invariance(check: WindInvariance, records: Records) -> Iterable[CheckResult]:
    """The first decision in each wind against the one in calm air, seen from a balloon: largest difference of each kind."""
    for name, mine in groups(records, lambda plan: f"{plan.method.kind}, {flown_by(plan)}"):
        calm = next((record for record in mine if record.plan.air.wind.kind == "calm"), None)
        windy = [record for record in mine if record is not calm]
        if calm is None or not windy:
            continue
        reference = _from_a_balloon(calm)
        limits = {"place, m": check.place_tolerance_m, "velocity, m/s": check.speed_tolerance_mps, "angle, deg": check.angle_tolerance_deg}
        limits["time, s"] = 1.0 / calm.plan.rates.planner_hz
        for kind, tolerance in limits.items():
            found = [_from_a_balloon(record)[kind] for record in windy]
            error = max(float(np.abs(one - reference[kind]).max()) for one in found)
            yield CheckResult(f"{name}: {kind}", 0.0, error, tolerance)


def _from_a_balloon(record: FlightRecord) -> dict[str, Array]:
    """Numbers of the first event as a balloon sees them that left the origin with the wind at time 0; NaN if there was no new path."""
    event = record.events[0] if record.events else None
    if event is None or event.decision != "replanned":
        return {kind: np.array([np.nan]) for kind in ("place, m", "velocity, m/s", "angle, deg", "time, s")}
    wind = np.array(make_wind(record.plan.air, record.plan.terrain_z_m)(0.0, event.own_pos_enu_m))
    return _seen(event, wind)


def _seen(event: ReplanEvent, wind: Array) -> dict[str, Array]:
    now, then = wind * event.time_s, wind * (event.time_s + event.insertion_time_s)
    places = [(event.own_pos_enu_m, now), (event.obstacle_pos_enu_m, now), (event.insertion_enu_m, then)]
    velocities = (event.own_vel_enu_mps, event.obstacle_vel_enu_mps, event.command_enu_mps)
    angles = (
        event.alpha_rad,
        event.alpha0_rad,
        event.cap_half_angle_rad,
        event.deflection_rad,
        event.cap_azimuth_rad,
        event.cap_elevation_rad,
    )
    return {
        "place, m": np.concatenate([[event.miss_m], *(np.asarray(place) - drift for place, drift in places)]),
        "velocity, m/s": np.concatenate([[event.cap_radius_mps], *(np.asarray(v) - wind for v in velocities)]),
        "angle, deg": np.array(angles) / DEG,
        "time, s": np.array([event.time_s, event.time_to_cpa_s, event.insertion_time_s]),
    }


CHECKS: dict[str, Callable[[Any, Records], Iterable[CheckResult]]] = {
    "wind_triangle": wind_triangle,
    "gust_response": gust_response,
    "turbulence": turbulence,
    "invariance": invariance,
}
