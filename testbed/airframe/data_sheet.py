"""``testbed aircraft NAME``: one HTML page that says how the aircraft flies, what of it is published, and how its loops answer."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from testbed.airframe import sheet_plots
from testbed.airframe.identify import bank_step, full_control, load_factor_step, surface_lags
from testbed.airframe.linearise import LATERAL, LONGITUDINAL, LinearModel, Mode, linearise, modes
from testbed.airframe.loops import ClosedLoop, lateral, pitch
from testbed.airframe.performance import Performance, measure
from testbed.airframe.trim import lift_curve, steepest_climb
from testbed.core.units import DEG
from testbed.flight.plants.aircraft import Aircraft, load_aircraft
from testbed.flight.plants.rig import HEIGHT_M, Rig


def write_data_sheet(name: str, out: Path) -> Path:
    """Write the page of an aircraft into ``out`` (a folder, made if need be, or a file that ends in .html); returns the file."""
    page = render(load_aircraft(name), name)
    file = out if out.suffix == ".html" else out / f"{name}.html"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(page, encoding="utf-8")
    return file


def render(aircraft: Aircraft, name: str) -> str:
    """The page."""
    speed = aircraft.autopilot.reference_mps
    rig = Rig(aircraft, speed)
    model = linearise(rig)
    lags = surface_lags(aircraft, model)
    performance = measure(aircraft, speed)
    controls = full_control(aircraft, speed)
    curve = lift_curve(aircraft, speed, Rig(aircraft, speed))
    found = modes(model)
    numbers = {
        "alpha": rig.alpha_rad / DEG,
        "throttle": rig.throttle,
        "steepest": steepest_climb(aircraft, speed) / DEG,
        "stall": performance.stall_mps,
        "to_45": controls.time_to_45_s,
        "roll_rate": controls.peak_rate_radps / DEG,
        "pull": controls.peak_load_factor,
    }
    environment = Environment(
        loader=PackageLoader("testbed.airframe"), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["number"] = number
    return environment.get_template("data_sheet.html.j2").render(
        name=name,
        aircraft=aircraft,
        height_m=HEIGHT_M,
        mass_kg=rig.mass_kg,
        numbers=numbers,
        cards=_cards(numbers, found, speed),
        speeds=performance.speeds_mps,
        trims=_trim_rows(performance),
        modes=[_mode_row(mode) for mode in found],
        published=published(aircraft, name, numbers, found),
        plots=sheet_plots.plots(aircraft, model, performance, curve),
        loops=_loop_rows(aircraft, model, lags),
        lags=lags,
        matrices=_matrices(model),
        deg=DEG,
    )


def published(aircraft: Aircraft, name: str, numbers: Mapping[str, float], found: list[Mode]) -> list[tuple[str, str, str, str, str]]:
    """Rows (figure, unit, here, this model as published, original as published) where the aircraft's folder has a truth file."""
    file = aircraft.folder / f"{name}.json"
    truth = json.loads(file.read_text(encoding="utf-8")).get("truth") if file.exists() else None
    if not truth:
        return []
    by_name = {mode.name: mode for mode in found}
    rows = [
        ("angle of attack, level", "deg", numbers["alpha"], truth["trim_alpha_deg"]["0"], 2),
        ("throttle, level", "", numbers["throttle"], truth["trim_throttle"]["0"], 3),
        ("stall, 1 g", "m/s", numbers["stall"], truth["stall_mps"], 1),
        ("bank 0 to 45 deg, full aileron", "s", numbers["to_45"], truth["time_to_bank_45_s"], 3),
        ("peak roll rate", "deg/s", numbers["roll_rate"], truth["peak_roll_rate_dps"], 0),
        ("peak load factor, full up elevator", "g", numbers["pull"], truth["peak_load_factor"], 2),
        ("roll mode", "s", by_name["roll"].time_constant_s, truth["roll_mode_s"], 3),
    ]
    for mode, key in (("short period", "short_period_rad_s_zeta"), ("phugoid", "phugoid"), ("Dutch roll", "dutch_roll")):
        frequencies, dampings = zip(*truth[key], strict=True)
        rows.append((f"{mode}, frequency", "rad/s", by_name[mode].frequency_rad_s, frequencies, 2))
        rows.append((f"{mode}, damping ratio", "", by_name[mode].damping, dampings, 3))
    return [(what, unit, number(value, d), number(pair[0], d), number(pair[1], d)) for what, unit, value, pair, d in rows]


def number(value: float, digits: int) -> str:
    """A number as it stands in a table: a real minus, a dash for what there is not."""
    if not math.isfinite(value):
        return "\u2013"
    text = f"{value:.{digits}f}"
    return text.lstrip("-") if float(text) == 0.0 else text.replace("-", "\u2212")


def _cards(numbers: Mapping[str, float], found: list[Mode], speed: float) -> list[tuple[str, str, str]]:
    by_name = {mode.name: mode for mode in found}
    short, dutch = by_name["short period"], by_name["Dutch roll"]
    return [
        ("stall, 1 g", f"{numbers['stall']:.1f} m/s", f"{speed:g} m/s is {speed / numbers['stall']:.2f} times that"),
        ("steepest climb", f"{numbers['steepest']:.2f} deg", f"{speed * math.sin(numbers['steepest'] * DEG):.1f} m/s up at {speed:g} m/s"),
        ("bank 0 to 45 deg", f"{numbers['to_45']:.2f} s", f"full aileron; {numbers['roll_rate']:.0f} deg/s at most"),
        ("pull", f"{numbers['pull']:.2f} g", "full up elevator, peak"),
        ("short period", f"{short.frequency_rad_s:.2f} rad/s", f"damping ratio {short.damping:.2f}"),
        ("Dutch roll", f"{dutch.frequency_rad_s:.2f} rad/s", f"damping ratio {dutch.damping:.2f}"),
    ]


def _trim_rows(performance: Performance) -> list[dict[str, Any]]:
    return [{"climb": number(climb / DEG, 0), "cells": row} for climb, row in zip(performance.climbs_rad, performance.trims, strict=True)]


def _mode_row(mode: Mode) -> dict[str, str]:
    oscillates = math.isfinite(mode.frequency_rad_s) and mode.damping < 1.0
    period = math.tau / (mode.frequency_rad_s * math.sqrt(1.0 - mode.damping**2)) if oscillates else math.nan
    decay = mode.damping * mode.frequency_rad_s if math.isfinite(mode.frequency_rad_s) else 1.0 / mode.time_constant_s
    return {
        "name": mode.name,
        "frequency": number(mode.frequency_rad_s, 2 if mode.frequency_rad_s > 1.0 else 3),
        "damping": number(mode.damping, 3),
        "period": number(period, 2),
        "constant": number(mode.time_constant_s, 3 if abs(mode.time_constant_s) < 1.0 else 1),
        "half": number(math.log(2.0) / abs(decay), 2),
        "doubles": "double" if decay < 0.0 else "half",
    }


def _loop_rows(aircraft: Aircraft, model: LinearModel, lags: tuple[float, ...]) -> list[dict[str, str]]:
    """Margins of the linear loops and figures of the flown steps."""
    gains, speed = aircraft.autopilot, aircraft.autopilot.reference_mps
    side, nose = lateral(model, gains, lags), pitch(model, gains, lags)
    bank, lift = bank_step(aircraft, speed)[0], load_factor_step(aircraft, speed)[0]
    rows = []
    for what, loop, surface, step in (
        ("bank, by aileron", side, 0, bank),
        ("turn, by rudder", side, 1, None),
        ("load factor, by elevator", nose, 0, lift),
    ):
        phase, gain = loop.margins(surface)
        rows.append(
            {
                "what": what,
                "phase": number(phase / DEG, 0) if math.isfinite(phase) else "no crossover",
                "gain": number(20.0 * math.log10(gain), 1) if math.isfinite(gain) else "\u221e",
                "sensitivity": number(_peak(loop, surface), 2),
                "rise": number(step.rise_s, 2) if step else "\u2013",
                "overshoot": number(100.0 * step.overshoot, 1) if step else "\u2013",
                "lag": number(step.lag_s(1.0), 3) if step else "\u2013",
            }
        )
    return rows


def _peak(loop: ClosedLoop, surface: int) -> float:
    return float(np.max(1.0 / np.abs(1.0 + loop.transfer(surface))))


def _matrices(model: LinearModel) -> list[dict[str, Any]]:
    """A and B of both groups as text."""
    groups = (
        ("Longitudinal", LONGITUDINAL, ("elevator", "throttle"), model.a_long, model.b_long),
        ("Lateral", LATERAL, ("aileron", "rudder"), model.a_lat, model.b_lat),
    )
    return [
        {
            "name": title,
            "states": states,
            "inputs": inputs,
            "rows": [
                (f"d{state}/dt", [number(v + 0.0, 4) for v in (*a_row, *b_row)]) for state, a_row, b_row in zip(states, a, b, strict=True)
            ],
        }
        for title, states, inputs, a, b in groups
    ]
