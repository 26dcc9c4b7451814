"""``testbed aircraft new``: an aircraft.yaml for a model that nobody has flown here, with every number marked by where it is from.

The engines are started and settle before anything is trimmed (``plants/jsbsim_settled.py``). Level trims over speed give the speeds
that can be held, the trimmed lift curve the angle of attack and the stall, a rule of airworthiness the load factor, and these the
bank. ``testbed tune`` then finds the gains: until it has, those in the file are placeholders and nothing that needs them flies.
"""

import math
import re
import shutil
from collections import Counter
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element, ParseError

from testbed.airframe.gains import rounded
from testbed.airframe.trim import LiftCurve, lift_curve, stall_speed, trim
from testbed.airframe.tune import PLACEHOLDER
from testbed.campaign.reading.aircraft import FILE
from testbed.campaign.reading.problems import did_you_mean
from testbed.campaign.words.aircraft import Aircraft, AutopilotGains, GuidanceGains, Limits, Model, PointMass
from testbed.core.catalogue import aircraft_roots
from testbed.core.model_files import engines, missing_files, model_path, read_xml, wheel_models
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.plants.base import TrimFailedError
from testbed.flight.plants.rig import LBF_N, Rig

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_\-]*")
SLOWEST_MPS, FASTEST_MPS, RATIO = 12.0, 330.0, 1.1  # of the speeds that are tried
LIFT_SHARE = 0.85  # of the most trimmed lift: the angle of attack that carries it is the limit
HIGHEST_ALPHA_DEG = 15.0  # few tables of lift are measured beyond
SLOWEST_STALLS = 1.2
CRUISE, CRUISE_SHARE = 1.6, 0.85  # the reference airspeed: times the airspeed at which 1 g takes the angle of attack; of the fastest
BANK_SHARE, MOST_BANK_DEG = 0.9, 60.0  # the level turn at the largest bank asks for so much of the largest load factor


class NewAircraftError(Exception):
    """No aircraft comes of this model; the message says why."""


class Source(NamedTuple):
    """A model: in the wheel, or a JSBSim file of the user's, whose folder is the aircraft's or is copied into it."""

    files: str
    file: Path


class Measured(NamedTuple):
    """What the model has been asked."""

    speeds_mps: list[float]
    speed_mps: float
    mass_kg: float
    curve: LiftCurve
    stall_mps: float
    alpha_max_deg: float
    has_servos: bool


def add_aircraft(name: str, wheel: str | None, path: Path | None, speed_mps: float | None, out: Path | None) -> str:
    """What the command does: one of ``wheel`` and ``path`` names the model. Raises ``NewAircraftError``."""
    if (wheel is None) == (path is None):
        raise NewAircraftError("name the model: --wheel MODEL for one that JSBSim ships, or --path for a file or folder of yours")
    if not NAME.fullmatch(name):
        raise NewAircraftError(f"'{name}' is no name for an aircraft: letters, digits, _ and - only")
    if speed_mps is not None and not (math.isfinite(speed_mps) and speed_mps > 0.0):
        raise NewAircraftError(f"--speed must be a finite number of m/s above 0, not {speed_mps:g}")
    source = wheel_source(wheel) if wheel is not None else file_source(path or Path())
    return new_aircraft(name, source, out or aircraft_roots()[-1], speed_mps)


def wheel_source(name: str) -> Source:
    """A model of the wheel by its name, whatever its capitals. Raises ``NewAircraftError``."""
    by_name = {known.lower(): known for known in wheel_models()}
    if name.lower() not in by_name:
        hint = did_you_mean(name, by_name)
        raise NewAircraftError(
            f"JSBSim's wheel has no aircraft '{name}'" + (f"; {hint}" if hint else f"; it has: {', '.join(wheel_models())}")
        )
    return Source("wheel", model_path("wheel", by_name[name.lower()], Path()))


def file_source(path: Path) -> Source:
    """A JSBSim file, or a folder with one of the same name in it. Raises ``NewAircraftError``."""
    file = path / f"{path.resolve().name}.xml" if path.is_dir() else path
    if not file.is_file():
        raise NewAircraftError(f"{file}: no such file" + (f"; name the JSBSim file in {path} itself" if path.is_dir() else ""))
    return Source("own", file)


def new_aircraft(name: str, source: Source, out: Path, speed_mps: float | None = None) -> str:
    """Write ``out/name/aircraft.yaml`` and report on it. Raises ``NewAircraftError``; then nothing is left behind."""
    folder = out / name
    if (folder / FILE).exists():
        raise NewAircraftError(f"{folder / FILE} is there already; remove it, or take another name")
    xml = _read(source.file)
    there = folder.exists()
    if source.files == "own" and source.file.resolve().parent != folder.resolve():
        if there:
            raise NewAircraftError(f"{folder} is there already; remove it, or take another name")
        shutil.copytree(source.file.parent, folder)
    try:
        model = Model(files=source.files, name=source.file.stem, start="settled")  # type: ignore[arg-type]
        measured = _measure(_draft(model, folder), speed_mps)
        text = _yaml(name, model, xml, measured)
    except BaseException:
        if not there and folder.exists():
            shutil.rmtree(folder)
        raise
    folder.mkdir(parents=True, exist_ok=True)
    (folder / FILE).write_text(text, encoding="utf-8")
    return _report(name, folder, measured)


def _read(file: Path) -> Element:
    try:
        xml = read_xml(file)
        if lost := missing_files(xml, file):
            raise NewAircraftError("; ".join(f"{file.name} names a {part.what} file '{part.name}' that is not there" for part in lost))
        count = engines(xml, file)
    except ParseError as error:
        raise NewAircraftError(f"{file} is no XML that can be read: {error}") from error
    if not count:
        raise NewAircraftError(f"'{file.stem}' has no engine: gliders are not supported, since a campaign holds speed and height")
    return xml


def _measure(draft: Aircraft, asked_mps: float | None) -> Measured:
    """Trims, lift and servo of the model. Raises ``NewAircraftError`` when it cannot be flown."""
    name = draft.model.name
    try:
        speeds = trimmed_speeds(draft)
    except (KeyError, RuntimeError, FileNotFoundError) as error:
        raise NewAircraftError(f"'{name}' cannot be started in JSBSim: {_plainly(error)}") from error
    if not speeds:
        raise NewAircraftError(f"'{name}' trims in level flight at no speed from {SLOWEST_MPS:g} to {FASTEST_MPS:g} m/s: {_why(draft)}")
    if asked_mps is not None and trim(draft, asked_mps) is None:
        raise NewAircraftError(f"'{name}' does not trim at {asked_mps:g} m/s, but from {speeds[0]:g} to {speeds[-1]:g} m/s")
    speed = asked_mps or _usual_speed(draft, speeds)
    rig = Rig(draft, speed)
    curve = lift_curve(draft, speed, rig)
    if len(curve.alpha_rad) < 2:
        raise NewAircraftError(f"'{name}' has no trimmed lift curve at {speed:g} m/s: its elevator does not balance it")
    alpha = alpha_limit_deg(curve)
    if curve.lift_at(alpha * DEG) <= 1.05:
        raise NewAircraftError(f"{speed:g} m/s leaves '{name}' no lift to turn with; it trims from {speeds[0]:g} to {speeds[-1]:g} m/s")
    return Measured(speeds, speed, rig.mass_kg, curve, stall_speed(draft, speed), alpha, _has_servos(draft, speed))


def trimmed_speeds(aircraft: Aircraft) -> list[float]:
    """The speeds at which level flight trims, in whole m/s: a scan in steps of a tenth, its ends sought to 1 m/s."""
    tried = _scan()
    good = [k for k, speed in enumerate(tried) if trim(aircraft, speed) is not None]
    if not good:
        return []
    found = [tried[k] for k in good]
    for at, beyond in ((good[0], good[0] - 1), (good[-1], good[-1] + 1)):
        if 0 <= beyond < len(tried):
            found.append(_edge(aircraft, tried[at], tried[beyond]))
    return sorted(set(found))


def _scan() -> list[float]:
    count = round(math.log(FASTEST_MPS / SLOWEST_MPS) / math.log(RATIO)) + 1
    return [float(round(SLOWEST_MPS * RATIO**k)) for k in range(count)]


def _edge(aircraft: Aircraft, good: float, bad: float) -> float:
    while abs(good - bad) > 1.0:
        middle = float(round(0.5 * (good + bad)))
        good, bad = (middle, bad) if trim(aircraft, middle) is not None else (good, middle)
    return good


def _why(aircraft: Aircraft) -> str:
    """The reasons, the most frequent first."""
    reasons: Counter[str] = Counter()
    for speed in _scan():
        try:
            Rig(aircraft, speed)
        except TrimFailedError as error:
            reasons[str(error).rpartition(": ")[2]] += 1
    return ", ".join(f"{reason} (at {count} speeds)" for reason, count in reasons.most_common())


def _usual_speed(aircraft: Aircraft, speeds: list[float]) -> float:
    """Fast enough to turn, slow enough to have power left; in whole m/s."""
    curve = lift_curve(aircraft, middle := speeds[len(speeds) // 2])
    if len(curve.alpha_rad) < 2:
        return middle
    slowest = middle / math.sqrt(curve.lift_at(alpha_limit_deg(curve) * DEG))
    wanted = min(CRUISE * slowest, CRUISE_SHARE * speeds[-1])
    return min(speeds, key=lambda speed: abs(speed - wanted)) if trim(aircraft, float(round(wanted))) is None else float(round(wanted))


def alpha_limit_deg(curve: LiftCurve) -> float:
    """The angle of attack (deg, in halves) that carries ``LIFT_SHARE`` of the most trimmed lift, 15 deg at most."""
    alpha = curve.alpha_for(LIFT_SHARE * curve.most) / DEG
    return max(1.0, min(HIGHEST_ALPHA_DEG, math.floor(2.0 * alpha) / 2.0))


def rule_load_factor(mass_kg: float) -> float:
    """The limit load factor of 14 CFR 23.337 (normal category): 2.1 + 24000 / (W + 10000), W in lb, at most 3.8; 2.5 at least (25.337)."""
    weight_lb = mass_kg * G0_MPS2 / LBF_N
    return max(2.5, min(3.8, 2.1 + 24000.0 / (weight_lb + 10000.0)))


def _has_servos(aircraft: Aircraft, speed_mps: float) -> bool:
    from testbed.airframe.identify import servo_lag_s
    from testbed.airframe.linearise import linearise

    return servo_lag_s(aircraft, linearise(Rig(aircraft, speed_mps))) > 0.0


def _plainly(error: Exception) -> str:
    return str(error.args[0]) if isinstance(error, KeyError) and error.args else " ".join(str(error).split())


def _draft(model: Model, folder: Path) -> Aircraft:
    """An aircraft good enough to be trimmed."""
    limits = Limits.model_construct(**dict.fromkeys(Limits.model_fields, 1.0))
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
CHOSEN = {"damping", "thrust_min", "thrust_per_mps"}  # of those three sections: not even tune measures them


def _yaml(name: str, model: Model, xml: Element, measured: Measured) -> str:
    """The file."""
    speed, curve = measured.speed_mps, measured.curve
    rule, lift = rule_load_factor(measured.mass_kg), curve.lift_at(measured.alpha_max_deg * DEG)
    load = math.floor(10.0 * min(rule, lift)) / 10.0
    why = "14 CFR 23.337 and 25.337 for its mass" if rule <= lift else "the lift at alpha_max_deg and reference_mps"
    bank = min(MOST_BANK_DEG, math.floor(math.acos(1.0 / max(1.0 + 1e-3, BANK_SHARE * load)) / DEG))
    slowest = rounded(SLOWEST_STALLS * measured.stall_mps)
    rows = [
        "# `testbed aircraft new` wrote this. measured: from the model as it flies; chosen: by a rule or by hand; copied: from the model's file.",
        f"title: {_quoted(_title(xml, model))}  # copied",
        f"source: {_quoted(_author(xml, model))}  # copied",
        f"licence: {_quoted(_licence(xml, model))}  # copied",
        f"model: {{files: {model.files}, name: {_quoted(model.name)}, start: settled, gear_up: true, mixture: {model.mixture:g}}}  # chosen",
        "limits:",
        f"  speed_min_mps: {slowest:g}  # measured: {SLOWEST_STALLS} stalls",
        f"  speed_max_mps: {max(measured.speeds_mps[-1], slowest + 1.0):g}  # measured: the fastest level trim",
        f"  bank_deg: {max(5.0, bank):g}  # chosen: a level turn that needs {BANK_SHARE:g} of load_factor_max, {MOST_BANK_DEG:g} at most",
        "  load_factor_min: 0.2  # chosen",
        f"  load_factor_max: {load:g}  # {'chosen' if rule <= lift else 'measured'}: {why}",
        f"  roll_rate_dps: 30  {PLACEHOLDER}",
        f"  alpha_max_deg: {measured.alpha_max_deg:g}  # measured: carries {LIFT_SHARE:g} of the most trimmed lift, {HIGHEST_ALPHA_DEG:g} at most",
        f"  alpha_max_1g_mps: {rounded(speed / math.sqrt(lift)):g}  # measured",
        f"  stall_mps: {rounded(measured.stall_mps):g}  # measured: 1 g, trimmed, 150 m above sea level",
        f"command_lag_s: {'0  # measured: the model has servos' if measured.has_servos else '0.05  # chosen: the surfaces of the model follow at once'}",
    ]
    for title, values in (("guidance", GUIDANCE), ("autopilot", {"reference_mps": speed, **AUTOPILOT}), ("point_mass", POINT_MASS)):
        rows.append(f"{title}:")
        for key, value in values.items():
            rows.append(f"  {key}: {value:g}  {'# chosen' if key in CHOSEN or key == 'reference_mps' else PLACEHOLDER}")
    rows += ["gains_found_by: ''  # chosen: by nobody yet", "verified: false"]
    return "\n".join(rows) + "\n"


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


def _report(name: str, folder: Path, measured: Measured) -> str:
    speeds = measured.speeds_mps
    return "\n".join(
        [
            f"trims in level flight from {speeds[0]:g} to {speeds[-1]:g} m/s: {', '.join(f'{speed:g}' for speed in speeds)}",
            f"reference {measured.speed_mps:g} m/s; stall {measured.stall_mps:.1f} m/s; {measured.mass_kg:.0f} kg",
            f"{folder / FILE}: written; next, its gains: testbed --aircraft-path {folder.parent} tune {name}",
        ]
    )
