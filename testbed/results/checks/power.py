"""Checks of energy: climb at full throttle, and energy gained against the work of thrust and drag of a data sheet."""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from testbed.campaign.words.check import Energy, ExcessPower
from testbed.core.catalogue import aircraft_folders
from testbed.core.units import DEG, FT, G0_MPS2
from testbed.flight.plants.aircraft import load_aircraft
from testbed.flight.record import FlightRecord
from testbed.results.checks.modes import lagged
from testbed.results.checks.verdict import CheckResult, Evidence, Flown, flown_by

Array = np.ndarray
FULL = 0.999
SETTLED_S = 5.0  # at full throttle, from a start close to it: two thrust lags of the slowest engine
WINDOW_S = 1.0  # either side of the instant at which the speed is right
POUND_N = 4.4482216152605  # a pound of force (exact to these digits)


def energy_height(record: FlightRecord) -> Array:
    """Height plus V^2 / 2g (n,), m above the frame's origin."""
    return np.asarray(record.columns["own.pos_enu_m"][:, 2] + record.columns["own.airspeed_mps"] ** 2 / (2.0 * G0_MPS2))


def climb_flown(check: ExcessPower, record: FlightRecord) -> Evidence:
    """At the instant the speed falls through the one asked for: slope of the energy height, load factor, seconds since full throttle."""
    speed, throttle = record.columns["own.airspeed_mps"], record.columns["own.throttle"]
    full = np.where(np.isnan(throttle), record.columns["guidance.saturated"] > 0.0, throttle >= FULL)
    through = np.flatnonzero((speed[:-1] >= check.at_speed_mps) & (speed[1:] < check.at_speed_mps))
    hz = record.plan.rates.plant_hz
    reach = round(WINDOW_S * hz)
    if not len(through) or not reach <= through[0] < len(speed) - reach:
        return {"power_mps": math.nan, "load_factor": math.nan, "full_throttle_s": math.nan}
    k = int(through[0])
    near = slice(k - reach, k + reach + 1)
    slope = np.polyfit(record.columns["time_s"][near], energy_height(record)[near], 1)[0]
    not_full = np.flatnonzero(~full[: k + reach])
    since = (k - int(not_full[-1])) / hz if len(not_full) else k / hz
    if since < SETTLED_S:
        slope = math.nan
    return {"power_mps": float(slope), "load_factor": float(record.columns["own.load_factor"][near].mean()), "full_throttle_s": since}


def excess_power(check: ExcessPower, flights: Sequence[Flown]) -> Iterable[CheckResult]:
    """For six degrees of freedom V sin of the published climb, for the point its own thrust and drag in closed form."""
    for flight in flights:
        name = flown_by(flight.plan)
        truth = check.at_speed_mps * math.sin(check.steepest_climb_deg * DEG)
        if flight.plan.plant.kind == "point_mass":
            model, aircraft = load_aircraft(flight.plan.aircraft).point_mass, load_aircraft(flight.plan.aircraft)
            square = (check.at_speed_mps / aircraft.autopilot.reference_mps) ** 2
            drag = model.drag_zero * square + model.drag_lift * flight["load_factor"] ** 2 / square
            truth = check.at_speed_mps * (model.thrust_max - drag)
        yield CheckResult(f"{name}: specific excess power", "m/s", truth, flight["power_mps"], check.power_tolerance_mps)


def energy_flown(_check: Energy, record: FlightRecord) -> Evidence:
    """Greatest difference between the energy height gained and the work done on each unit of weight; both at the end, too."""
    gained = energy_height(record) - energy_height(record)[0]
    power = _specific_power(record)
    steps = 0.5 * (power[1:] + power[:-1]) / record.plan.rates.plant_hz
    work = np.concatenate([[0.0], np.cumsum(steps)])
    return {"gained_m": float(gained[-1]), "work_m": float(work[-1]), "apart_m": float(np.abs(gained - work).max())}


def energy(check: Energy, flights: Sequence[Flown]) -> Iterable[CheckResult]:
    """The end of each flight, and the greatest difference on the way."""
    for flight in flights:
        name = f"{flown_by(flight.plan)}, {flight.plan.cell}"
        yield CheckResult(f"{name}: energy height gained", "m", flight["work_m"], flight["gained_m"], check.height_tolerance_m)
        yield CheckResult(f"{name}: greatest difference on the way", "m", 0.0, flight["apart_m"], check.height_tolerance_m)


def _specific_power(record: FlightRecord) -> Array:
    """V (T - D) / W (n,), m/s, from the polynomials of the aircraft's data sheet ``<name>.json``, in a standard atmosphere."""
    plan = record.plan
    data = json.loads((aircraft_folders()[plan.aircraft] / f"{plan.aircraft}.json").read_text(encoding="utf-8"))
    column = record.columns
    speed = column["own.airspeed_mps"]
    temperature = 1.0 - 0.0065 * (column["own.pos_enu_m"][:, 2] - plan.terrain_z_m) / 288.15  # ICAO standard atmosphere, of sea level's
    pressure = temperature**5.25588
    dynamic = 0.5 * 1.225 * pressure / temperature * speed**2
    force = dynamic * data["geometry"]["S_ft2"] * FT * FT
    net = _thrust(data["engine"], column["own.throttle"], plan.rates.plant_hz, pressure, force)
    known = _regressors(record, data)
    known["de"] = known["de"] + _elevator_trim(data, known, net / force)
    drag = force * _polynomial(data["aero"]["coefficients"]["CD"], known)
    thrust = net * _thrust_direction(data["engine"], column["own.alpha_rad"], column["own.beta_rad"])
    return np.asarray(speed * (thrust - drag) / (data["mass"]["weight_lb"] * POUND_N))


def _regressors(record: FlightRecord, data: Mapping[str, Any]) -> dict[str, Array]:
    """What the polynomials are made of: angles (rad), rates times b/2V or c/2V, surfaces (rad) beside their trim behind their servos."""
    column, hz = record.columns, record.plan.rates.plant_hz
    half_span, half_chord = (0.5 * data["geometry"][name] * FT / column["own.airspeed_mps"] for name in ("b_ft", "cbar_ft"))
    p, q, r = column["own.rates_body_radps"].T
    servo = data["actuators"]
    surface = {
        name: lagged(column[f"own.{name}"], hz, 1.0 / servo["bandwidth_rad_s"]) * servo["deg_per_unit_command"][name] * DEG
        for name in ("elevator", "aileron", "rudder")
    }
    return {
        "alpha": column["own.alpha_rad"],
        "beta": column["own.beta_rad"],
        "p": p * half_span,
        "q": q * half_chord,
        "r": r * half_span,
        "de": surface["elevator"],
        "da": surface["aileron"],
        "dr": surface["rudder"],
    }


def _elevator_trim(data: Mapping[str, Any], known: Mapping[str, Array], thrust_coefficient: Array) -> float:
    """The elevator's trim (rad) is not in the record: over a flight the pitching moment about the centre of gravity is zero on average."""
    coefficients, inches = data["aero"]["coefficients"], 12.0 * data["geometry"]["cbar_ft"]
    gravity, reference, engine = data["mass"]["cg_in"], data["geometry"]["aero_ref_in"], data["engine"]["location_in"][0]
    aft, below = (reference[0] - gravity[0]) / inches, (gravity[2] - reference[2]) / inches

    def moment(trim: float) -> float:
        moved = {**known, "de": known["de"] + trim}
        lift, drag, pitch = (_polynomial(coefficients[name], moved) for name in ("CL", "CD", "Cm"))
        return float(np.mean(pitch - aft * lift - below * drag + thrust_coefficient * (gravity[2] - engine[2]) / inches))

    before, trim = 0.0, 1.0 * DEG
    for _ in range(6):  # secants: the moment is all but linear in the elevator
        slope = (moment(trim) - moment(before)) / (trim - before) if trim != before else math.inf
        before, trim = trim, trim - moment(trim) / slope
    return trim


def _polynomial(coefficients: Mapping[str, float], known: Mapping[str, Array]) -> Array:
    """Sum of terms such as ``alpha^2*de``."""
    total = np.zeros(len(known["alpha"]))
    for term, coefficient in coefficients.items():
        product = np.full(len(total), coefficient)
        for factor in () if term == "1" else term.split("*"):
            name, _, exponent = factor.partition("^")
            product = product * known[name] ** int(exponent or 1)
        total += product
    return total


def _thrust(engine: Mapping[str, Any], throttle: Array, hz: int, pressure: Array, force_n: Array) -> Array:
    """Net thrust of all engines (n,), N: throttle through two equal lags to speed of rotation to static thrust, less ram drag."""
    spool = lagged(lagged(throttle, hz, 1.0 / engine["two_equal_lags_rad_s"]), hz, 1.0 / engine["two_equal_lags_rad_s"])
    rpm = np.polyval(engine["rpm_pct_poly_of_throttle_pct"], 100.0 * spool)
    static = np.polyval(engine["thrust_poly_lb_of_rpm_pct"], rpm) * POUND_N
    return np.asarray(len(engine["location_in"]) * np.maximum(0.0, pressure * static - engine["ram_drag_coef"] * force_n))


def _thrust_direction(engine: Mapping[str, Any], alpha: Array, beta: Array) -> Array:
    """Cosine of the angle between thrust and airspeed; toed-in engines cancel sideways."""
    tilt, toe = engine["tilt_up_deg"] * DEG, engine["toe_in_deg"] * DEG
    return np.asarray(np.cos(beta) * (math.cos(tilt) * math.cos(toe) * np.cos(alpha) - math.sin(tilt) * np.sin(alpha)))
