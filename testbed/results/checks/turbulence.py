"""The check of turbulence: standard deviation and spectrum of the air that was met against MIL-F-8785C."""

import itertools
import math
from collections.abc import Iterable, Sequence

import numpy as np

from testbed.flight.air import make_wind
from testbed.flight.air.dryden import autocorrelation, dryden, spectrum
from testbed.frames import vec3
from testbed.results.checks.verdict import CheckResult, Evidence, Flown, flown_by, groups, worst
from testbed.spec.air import DrydenTurbulence, NoTurbulence
from testbed.spec.check import TurbulenceStatistics
from testbed.types import FlightRecord
from testbed.units import DEG

Array = np.ndarray
SPIN_UP_S = 20.0  # JSBSim's own turbulence begins with nothing; its slowest filter has a time constant of 6 s at 50 m/s, 200 m
BANDS_HZ = tuple(itertools.pairwise((0.05 * 2.0 ** np.arange(8)).tolist()))  # octaves: the periods of a manoeuvre to those of a roll mode
AXES = ("along", "across", "up")


def gusts_met(_check: TurbulenceStatistics, record: FlightRecord) -> Evidence:
    """Number of samples; mean square and, by octave, the sum of the periodogram (Hann) along, across and up."""
    from scipy.signal import periodogram

    gusts = _gusts(record)
    out: Evidence = {"samples": len(gusts)}
    for axis, series in zip(AXES, gusts.T, strict=True):
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
    gusts = air - np.array([wind(0.0, vec3(p)) for p in pos])
    azimuth = record.plan.route.start_direction_deg[0] * DEG
    cos, sin = math.cos(azimuth), math.sin(azimuth)
    first = round(SPIN_UP_S * record.plan.rates.plant_hz) if record.plan.air.turbulence.kind == "jsbsim" else 0
    return np.column_stack([cos * gusts[:, 0] + sin * gusts[:, 1], cos * gusts[:, 1] - sin * gusts[:, 0], gusts[:, 2]])[first:]


def turbulence(check: TurbulenceStatistics, flights: Sequence[Flown]) -> Iterable[CheckResult]:
    """Standard deviation along, across and up, and the octave whose power is off most, for each source and plant."""
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
        for column, axis in enumerate(AXES):
            sigma, tau = model[column], model[column + 3] / plan.speed_mps
            measured = math.sqrt(float(np.average([flight[f"mean_square_{axis}"] for flight in mine], weights=samples)))
            error = 0.5 * sigma * math.sqrt(variance_of_power(tau, column > 0, (samples / hz).tolist()))
            yield CheckResult(f"{name}: sigma {axis}", "m/s", sigma, measured, check.deviations * error)
            powers = [(flight["samples"], flight[f"power_{axis}"]) for flight in mine]
            yield _worst_band(check, f"{name}: power {axis}", powers, hz, sigma, tau, column > 0)


def variance_of_power(tau_s: float, two_stage: bool, lengths_s: Sequence[float]) -> float:
    """Variance of the mean square of a Gaussian series of unit variance over independent stretches: 2/T^2 int int R^2."""
    total = sum(lengths_s)
    out = 0.0
    for length in lengths_s:
        lag = np.linspace(0.0, length, 4001)
        out += 4.0 * length * float(np.trapezoid((1.0 - lag / length) * autocorrelation(lag, tau_s, two_stage) ** 2, lag))
    return out / total**2


def _worst_band(
    check: TurbulenceStatistics,
    quantity: str,
    powers: Sequence[tuple[int, list[float]]],
    hz: int,
    sigma: float,
    tau_s: float,
    two_stage: bool,
) -> CheckResult:
    """The octave whose mean power is furthest from the specified one, beside the error of its average."""
    results = []
    grids = [np.fft.rfftfreq(n, 1.0 / hz) for n, _ in powers]
    for k, band in enumerate(BANDS_HZ):
        lines = [grid[_inside(grid, band)] for grid in grids]
        shares = [
            power[k] / float((sigma**2 * spectrum(line, tau_s, two_stage)).sum()) for line, (_, power) in zip(lines, powers, strict=True)
        ]
        independent = sum(len(line) for line in lines) / 1.5  # neighbouring lines of a Hann window are not independent
        tolerance = check.band_share_tolerance + check.deviations / math.sqrt(independent)
        name = f"{quantity} from {band[0]:g} to {band[1]:g} Hz"
        results.append(CheckResult(name, "of what is specified", 1.0, float(np.mean(shares)), tolerance))
    return worst(results)
