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

from testbed.airframe.identify import servo_lag_s
from testbed.airframe.linearise import linearise
from testbed.airframe.new_file import HIGHEST_ALPHA_DEG, LIFT_SHARE, Measured, draft_of, file_text
from testbed.airframe.trim import LiftCurve, lift_curve, stall_speed, trim
from testbed.campaign.reading.aircraft import FILE
from testbed.campaign.reading.problems import did_you_mean
from testbed.campaign.words.aircraft import Model
from testbed.core.catalogue import aircraft_roots
from testbed.core.model_files import engines, missing_files, model_path, read_xml, wheel_models
from testbed.core.units import DEG
from testbed.flight.plants.aircraft import Aircraft
from testbed.flight.plants.base import TrimFailedError
from testbed.flight.plants.rig import Rig

VALID_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_\-]*")
SLOWEST_MPS, FASTEST_MPS, RATIO = 12.0, 330.0, 1.1  # of the speeds that are tried
CRUISE, CRUISE_SHARE = 1.6, 0.85  # the reference airspeed: times the airspeed at which 1 g takes the angle of attack; of the fastest


class NewAircraftError(Exception):
    """No aircraft comes of this model; the message says why."""


class Source(NamedTuple):
    """A model: in the wheel, or a JSBSim file of the user's, whose folder is the aircraft's or is copied into it."""

    files: str
    file: Path


def add_aircraft(name: str, wheel: str | None, path: Path | None, speed_mps: float | None, out: Path | None) -> str:
    """What the command does: one of ``wheel`` and ``path`` names the model. Raises ``NewAircraftError``."""
    if (wheel is None) == (path is None):
        raise NewAircraftError("name the model: --wheel MODEL for one that JSBSim ships, or --path for a file or folder of yours")
    if not VALID_NAME.fullmatch(name):
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
        measured = _measure(draft_of(model, folder), speed_mps)
        text = file_text(model, xml, measured)
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


def _has_servos(aircraft: Aircraft, speed_mps: float) -> bool:
    return servo_lag_s(aircraft, linearise(Rig(aircraft, speed_mps))) > 0.0


def _plainly(error: Exception) -> str:
    return str(error.args[0]) if isinstance(error, KeyError) and error.args else " ".join(str(error).split())


def _report(name: str, folder: Path, measured: Measured) -> str:
    speeds = measured.speeds_mps
    return "\n".join(
        [
            f"trims in level flight from {speeds[0]:g} to {speeds[-1]:g} m/s: {', '.join(f'{speed:g}' for speed in speeds)}",
            f"reference {measured.speed_mps:g} m/s; stall {measured.stall_mps:.1f} m/s; {measured.mass_kg:.0f} kg",
            f"{folder / FILE}: written; next, its gains: testbed --aircraft-path {folder.parent} tune {name}",
        ]
    )
