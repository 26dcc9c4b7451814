"""The check of turbulence: standard deviation and spectrum of the air that was met, and of what turned in it, against MIL-F-8785C."""

import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np

from testbed.campaign.words.air import DrydenTurbulence, NoTurbulence
from testbed.campaign.words.check import TurbulenceStatistics
from testbed.core.frames import vec3
from testbed.core.units import DEG
from testbed.flight.air import make_wind
from testbed.flight.air.dryden import Dryden, autocorrelation, dryden, spectrum
from testbed.flight.air.rotary import rotary_spectra
from testbed.flight.record import FlightRecord
from testbed.results.checks.verdict import CheckResult, Evidence, Flown, flown_by, groups, worst

Array = np.ndarray
SPIN_UP_S = 20.0  # JSBSim's own turbulence begins with nothing; its slowest filter has a time constant of 6 s at 50 m/s, 200 m
BANDS_HZ = tuple(itertools.pairwise((0.05 * 2.0 ** np.arange(8)).tolist()))  # octaves: the periods of a manoeuvre to those of a roll mode
AXES = ("along", "across", "up")
RATES = ("roll", "pitch", "yaw")
EVERY_HZ = np.geomspace(1e-4, 1e5, 20001)  # where the powers of rates are integrated: they are flat below, and fall as 1/f^2 above


class Component(NamedTuple):
    """What is specified for a component of the air: standard deviation, power per Hz, and how well a mean square is known (1 s.d.)."""

    axis: str
    unit: str
    sigma: float
    power: Callable[[Array], Array]  # one-sided, of frequencies in Hz
    mean_square_error: float


def gusts_met(check: TurbulenceStatistics, record: FlightRecord) -> Evidence:
    """Number of samples; mean square and, by octave, the sum of the periodogram (Hann) along, across and up, and of roll, pitch and yaw."""
    from scipy.signal import periodogram

    gusts = dict(zip(AXES, _gusts(record).T, strict=True))
    if check.span_m is not None and not np.isnan(record.columns["air.rotation_body_radps"]).any():
        gusts |= zip(RATES, _rates(record).T, strict=True)
    out: Evidence = {"samples": len(gusts[AXES[0]])}
    for axis, series in gusts.items():
        frequency, power = periodogram(series, record.plan.rates.plant_hz, window="hann", detrend=False)
        out[f"mean_square_{axis}"] = float(np.mean(series**2))
        out[f"power_{axis}"] = [float(power[_inside(frequency, band)].sum()) for band in BANDS_HZ]
    return out


def _inside(frequency: Array, band: tuple[float, float]) -> Array:
    return (frequency >= band[0]) & (frequency < band[1])


def _gusts(record: FlightRecord) -> Array:
    """Along, across (left) and up (n,3), relative to the mean wind, in the axes of the route's start; without JSBSim's spin-up."""
    wind = make_wind(record.plan.air, record.plan.terrain_z_m)
    pos, air = record.columns["own.pos_enu_m"], record.columns["air.wind_enu_mps"]
    return _in_route_axes(record, air - np.array([wind(0.0, vec3(p)) for p in pos]))


def _rates(record: FlightRecord) -> Array:
    """Roll, pitch and yaw rates of the air (n,3), rad/s, in level axes (forward, right, down) along the route's start."""
    from scipy.spatial.transform import Rotation

    attitude = Rotation.from_quat(record.columns["own.quat_enu_from_body_xyzw"])
    return _in_route_axes(record, attitude.apply(record.columns["air.rotation_body_radps"].copy())) * np.array([1.0, -1.0, -1.0])


def _in_route_axes(record: FlightRecord, enu: Array) -> Array:
    azimuth = record.plan.route.start_direction_deg[0] * DEG
    cos, sin = math.cos(azimuth), math.sin(azimuth)
    first = round(SPIN_UP_S * record.plan.rates.plant_hz) if record.plan.air.turbulence.kind == "jsbsim" else 0
    return np.column_stack([cos * enu[:, 0] + sin * enu[:, 1], cos * enu[:, 1] - sin * enu[:, 0], enu[:, 2]])[first:]


def turbulence(check: TurbulenceStatistics, flights: Sequence[Flown]) -> Iterable[CheckResult]:
    """Standard deviation of each component, and the octave whose power is off most, for each source and plant."""
    for name, mine in groups(flights, lambda plan: f"{plan.air.turbulence.kind} in {flown_by(plan)}"):
        plan = mine[0].plan
        turbulent, hz = plan.air.turbulence, plan.rates.plant_hz
        if isinstance(turbulent, NoTurbulence):
            continue
        height = plan.route.start_enu_m[2] - plan.terrain_z_m
        if isinstance(turbulent, DrydenTurbulence) and turbulent.height_m is not None:
            height = turbulent.height_m
        model = dryden(turbulent.severity, height)
        samples = np.array([flight["samples"] for flight in mine])
        parts = _velocities(model, plan.speed_mps, (samples / hz).tolist())
        if check.span_m is not None and plan.plant.kind == "jsbsim":  # a point does not feel the air turn
            parts += _rotations(model, plan.speed_mps, check.span_m, float(samples.sum()) / hz)
        for part in parts:
            measured = math.sqrt(float(np.average([flight[f"mean_square_{part.axis}"] for flight in mine], weights=samples)))
            error = 0.5 * part.mean_square_error / part.sigma
            yield CheckResult(f"{name}: sigma {part.axis}", part.unit, part.sigma, measured, check.deviations * error)
            powers = [(flight["samples"], flight[f"power_{part.axis}"]) for flight in mine]
            yield _worst_band(check, f"{name}: power {part.axis}", powers, hz, part.power)


def _velocities(model: Dryden, speed_mps: float, lengths_s: Sequence[float]) -> list[Component]:
    """Along, across and up."""
    out = []
    for column, axis in enumerate(AXES):
        sigma, tau_s, two_stage = model[column], model[column + 3] / speed_mps, column > 0

        def power(f: Array, variance: float = sigma**2, tau_s: float = tau_s, two_stage: bool = two_stage) -> Array:
            return variance * spectrum(f, tau_s, two_stage)

        error = sigma**2 * math.sqrt(variance_of_power(tau_s, two_stage, lengths_s))
        out.append(Component(axis, "m/s", sigma, power, error))
    return out


def _rotations(model: Dryden, speed_mps: float, span_m: float, total_s: float) -> list[Component]:
    """Roll, pitch and yaw. The variance of a mean square over T is int S^2 df / T, for a T that is long beside the correlation time."""
    out = []
    for row, (axis, powers) in enumerate(zip(RATES, rotary_spectra(EVERY_HZ, model, speed_mps, span_m), strict=True)):

        def power(f: Array, row: int = row) -> Array:
            return np.asarray(rotary_spectra(f, model, speed_mps, span_m)[row])

        sigma = math.sqrt(float(np.trapezoid(powers, EVERY_HZ)))
        error = math.sqrt(float(np.trapezoid(powers**2, EVERY_HZ)) / total_s)
        out.append(Component(axis, "rad/s", sigma, power, error))
    return out


def variance_of_power(tau_s: float, two_stage: bool, lengths_s: Sequence[float]) -> float:
    """Variance of the mean square of a Gaussian series of unit variance over independent stretches: 2/T^2 int int R^2."""
    total = sum(lengths_s)
    out = 0.0
    for length in lengths_s:
        lag = np.linspace(0.0, length, 4001)
        out += 4.0 * length * float(np.trapezoid((1.0 - lag / length) * autocorrelation(lag, tau_s, two_stage) ** 2, lag))
    return out / total**2


def _worst_band(
    check: TurbulenceStatistics, quantity: str, powers: Sequence[tuple[int, list[float]]], hz: int, specified: Callable[[Array], Array]
) -> CheckResult:
    """The octave whose mean power is furthest from the specified one, beside the error of its average."""
    results = []
    grids = [np.fft.rfftfreq(n, 1.0 / hz) for n, _ in powers]
    for k, band in enumerate(BANDS_HZ):
        lines = [grid[_inside(grid, band)] for grid in grids]
        shares = [power[k] / float(specified(line).sum()) for line, (_, power) in zip(lines, powers, strict=True)]
        independent = sum(len(line) for line in lines) / 1.5  # neighbouring lines of a Hann window are not independent
        tolerance = check.band_share_tolerance + check.deviations / math.sqrt(independent)
        name = f"{quantity} from {band[0]:g} to {band[1]:g} Hz"
        results.append(CheckResult(name, "of what is specified", 1.0, float(np.mean(shares)), tolerance))
    return worst(results)
