"""The text of a new ``aircraft.yaml``: every line with a number says whether it is measured, chosen or copied."""

import math
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element

from testbed.airframe.gains import rounded
from testbed.airframe.gains_file import PLACEHOLDER
from testbed.airframe.trim import LiftCurve
from testbed.campaign.words.aircraft import Aircraft, AutopilotGains, GuidanceGains, Limits, Model, PointMass
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.plants.rig import LBF_N

LIFT_SHARE = 0.85  # of the most trimmed lift: the angle of attack that carries it is the limit
HIGHEST_ALPHA_DEG = 15.0  # few tables of lift are measured beyond
SLOWEST_STALLS = 1.2
LEAST_BANK_DEG = 5.0
BANK_SHARE, MOST_BANK_DEG = 0.9, 60.0  # the level turn at the largest bank asks for so much of the largest load factor


class Measured(NamedTuple):
    """What the model has been asked."""

    speeds_mps: list[float]
    speed_mps: float
    mass_kg: float
    curve: LiftCurve
    stall_mps: float
    alpha_max_deg: float
    has_servos: bool


def draft_of(model: Model, folder: Path) -> Aircraft:
    """An aircraft good enough to be trimmed."""
    limits = Limits.model_construct(None, **dict.fromkeys(Limits.model_fields, 1.0))
    return Aircraft.model_construct(
        title="", source="", licence="", model=model, limits=limits, command_lag_s=0.0, guidance=GuidanceGains(**GUIDANCE),
        autopilot=AutopilotGains(reference_mps=1.0, **AUTOPILOT), point_mass=PointMass(**POINT_MASS), gains_found_by="", folder=folder,
    )  # fmt: skip


# of an aircraft that nobody has tuned; ``tune`` replaces every one of them
GUIDANCE = {"bandwidth_rad_s": 0.5, "damping": 0.8, "integral_1ps": 0.125, "bank_lead_s": 0.4, "load_factor_lead_s": 0.3}
AUTOPILOT = {
    "bank_1ps": 3.0, "aileron_per_roll_rate_s": 1.0, "aileron_feed_forward_s": 0.5, "elevator_per_load_factor": 0.2,
    "load_factor_lag_s": 0.3, "elevator_p": 0.1, "elevator_i_1ps": 1.0, "elevator_per_pitch_rate_s": 1.0, "rudder_per_aileron": 0.0,
    "rudder_per_roll_rate_s": 0.0, "rudder_per_turn_rate_s": 0.0, "rudder_p": 1.0, "rudder_i_1ps": 1.0, "rudder_per_yaw_rate_s": 1.0,
    "throttle_per_mps": 0.05, "throttle_integral_1ps": 0.003, "throttle_per_accel_g": 1.5, "throttle_lag_s": 1.0,
}  # fmt: skip
POINT_MASS = {
    "bank_lag_s": 0.4, "load_factor_lag_s": 0.3, "load_factor_per_rad": 15.0, "gust_frequency_rad_s": 4.0, "gust_damping": 0.5,
    "gust_surge_s": 0.1, "thrust_lag_s": 1.0, "thrust_min": 0.0, "thrust_max": 0.3, "thrust_per_mps": 0.02, "drag_zero": 0.08,
    "drag_lift": 0.03,
}  # fmt: skip
CHOSEN = {"reference_mps", "damping", "thrust_min", "thrust_per_mps"}  # of those three sections: tune leaves them


HEAD = "# `testbed aircraft new` wrote this. measured: from the model as it flies; chosen: by a rule or by hand; copied: from its file."


def file_text(model: Model, xml: Element, measured: Measured) -> str:
    """The file; the numbers that ``tune`` is to find are placeholders."""
    rows = [
        HEAD,
        f"title: {_quoted(_title(xml, model))}  # copied",
        f"source: {_quoted(_author(xml, model))}  # copied",
        f"licence: {_quoted(_licence(xml, model))}  # copied",
        f"model: {{files: {model.files}, name: {_quoted(model.name)}, start: {model.start}, mixture: {model.mixture:g}}}  # chosen",
        "limits:",
        *_limits(measured),
        "command_lag_s: " + ("0  # measured: its surfaces lag" if measured.has_servos else "0.05  # chosen: its surfaces follow at once"),
    ]
    autopilot = {"reference_mps": measured.speed_mps, **AUTOPILOT}
    for title, values in (("guidance", GUIDANCE), ("autopilot", autopilot), ("point_mass", POINT_MASS)):
        rows.append(f"{title}:")
        rows += [f"  {key}: {value:g}  {'# chosen' if key in CHOSEN else PLACEHOLDER}" for key, value in values.items()]
    rows += ["gains_found_by: ''  # chosen: by nobody yet", "verified: false"]
    return "\n".join(rows) + "\n"


def _limits(measured: Measured) -> list[str]:
    """Lines of the envelope."""
    rule, lift = rule_load_factor(measured.mass_kg), measured.curve.lift_at(measured.alpha_max_deg * DEG)
    load = math.floor(10.0 * min(rule, lift)) / 10.0
    why = "chosen: 14 CFR 23.337 and 25.337 for its mass" if rule <= lift else "measured: the lift at alpha_max_deg and reference_mps"
    bank = min(MOST_BANK_DEG, math.floor(math.acos(min(1.0, 1.0 / (BANK_SHARE * load))) / DEG))
    slowest = rounded(SLOWEST_STALLS * measured.stall_mps)
    rows = {
        "speed_min_mps": (slowest, f"measured: {SLOWEST_STALLS:g} stalls"),
        "speed_max_mps": (max(measured.speeds_mps[-1], slowest + 1.0), "measured: the fastest level trim"),
        "bank_deg": (max(LEAST_BANK_DEG, bank), f"chosen: a level turn with {BANK_SHARE:g} of load_factor_max, {MOST_BANK_DEG:g} at most"),
        "load_factor_min": (0.2, "chosen"),
        "load_factor_max": (load, why),
        "roll_rate_dps": (30.0, PLACEHOLDER.removeprefix("# ")),
        "alpha_max_deg": (measured.alpha_max_deg, f"measured: {LIFT_SHARE:g} of the most trimmed lift, {HIGHEST_ALPHA_DEG:g} at most"),
        "alpha_max_1g_mps": (rounded(measured.speed_mps / math.sqrt(lift)), "measured"),
        "stall_mps": (rounded(measured.stall_mps), "measured: 1 g, trimmed, 150 m above sea level"),
    }
    return [f"  {key}: {value:g}  # {mark}" for key, (value, mark) in rows.items()]


def rule_load_factor(mass_kg: float) -> float:
    """The limit load factor of 14 CFR 23.337 (normal category): 2.1 + 24000 / (W + 10000), W in lb, at most 3.8; 2.5 at least (25.337)."""
    weight_lb = mass_kg * G0_MPS2 / LBF_N
    return max(2.5, min(3.8, 2.1 + 24000.0 / (weight_lb + 10000.0)))


def _quoted(text: str) -> str:
    return "'" + " ".join(text.split()).replace("'", "''") + "'"


def _title(xml: Element, model: Model) -> str:
    return f"{xml.get('name') or model.name} (JSBSim's model)" if model.files == "wheel" else xml.get("name") or model.name


def _author(xml: Element, model: Model) -> str:
    authors = ", ".join(" ".join((author.text or "").split()) for author in xml.findall("fileheader/author"))
    where = "loaded from JSBSim's wheel" if model.files == "wheel" else "the model's own files"
    return f"{model.name}.xml{f' by {authors}' if authors else ''}, {where}"


def _licence(xml: Element, model: Model) -> str:
    licence = xml.find("fileheader/license")
    said = "" if licence is None else licence.get("licenseName") or " ".join((licence.text or "").split())
    return (said or "not said in the model's file") + ("; no file of it is copied here" if model.files == "wheel" else "")
