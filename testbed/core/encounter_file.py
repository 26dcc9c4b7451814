"""Sets of encounters as MIT Lincoln Laboratory's tools sample and fly them: initial states and controls of two aircraft, in a MATLAB file.

The file has a struct array ``samples``, an encounter each, with the fields of their ``ScriptedEncounter``: ``v_ftps n_ft e_ft h_ft
heading_rad pitch_rad`` (and, where they are, ``a_ftpss``, ``runTime_s``), a number for each aircraft, and ``updates``, for each aircraft a
struct with ``time_s verticalRate_fps turnRate_radps longitudeAccel_ftpss``: from each time on the aircraft has these rates. A field
``weight`` is what an encounter counts. Here it is all in metres and seconds; azimuths and turns go to the left.
"""

import io
import math
from typing import Any, NamedTuple

import numpy as np

from testbed.core import datafiles
from testbed.core.arcs import Piece, along
from testbed.core.frames import Vec3
from testbed.core.kept import Kept
from testbed.core.units import FT
from testbed.core.utf8 import clipped, reason

MOST = 100_000
LASTS_S = 60.0
"""An encounter that does not say how long it lasts."""


class Control(NamedTuple):
    """Rates that are kept for a while: of the turn (rad/s, to the left), the climb (m/s; none: as before) and the level speed (m/s^2)."""

    lasts_s: float
    turn: float
    climb: float | None
    rate: float


class Flown(NamedTuple):
    """One aircraft of an encounter: place (ENU m), level speed (m/s), azimuth (rad), vertical speed (m/s), and its controls."""

    pos: Vec3
    speed: float
    azimuth: float
    climb: float
    controls: tuple[Control, ...]

    def end(self) -> tuple[Vec3, Vec3]:
        """Place and velocity after its controls."""
        pos, speed, azimuth, climb = self.pos, self.speed, self.azimuth, self.climb
        vel = (speed * math.cos(azimuth), speed * math.sin(azimuth), climb)
        for control in self.controls:
            climb = climb if control.climb is None else control.climb
            pos, vel = along(Piece(0.0, pos, speed, control.rate, azimuth, control.turn, climb), control.lasts_s)
            speed, azimuth = max(0.0, speed + control.rate * control.lasts_s), azimuth + control.turn * control.lasts_s
        return pos, vel


class Scripted(NamedTuple):
    """An encounter of two."""

    aircraft: tuple[Flown, Flown]
    weight: float


_sets: Kept[tuple[Scripted, ...]] = Kept(300_000, len)


def encounters(name: str, sha256: str | None = None) -> tuple[Scripted, ...]:
    """All encounters of a file. Raises ``ValueError`` with the file, and which encounter it is."""
    sha256 = sha256 or datafiles.look_up(name).sha256
    return _sets.get(sha256, lambda: _read(name, datafiles.content(name, sha256)))


def _read(name: str, data: bytes) -> tuple[Scripted, ...]:
    from scipy.io import loadmat

    try:
        file: Any = io.BytesIO(data)  # the stubs know of paths only
        found = loadmat(file, simplify_cells=True, variable_names=["samples"]).get("samples")
    except NotImplementedError:
        raise ValueError(f"{name}: is of MATLAB's version 7.3; save it with -v7") from None
    except Exception as bug:
        raise ValueError(f"{name}: is no MATLAB file that can be read ({clipped(reason(bug), 80)})") from None
    samples = [found] if isinstance(found, dict) else list(found) if isinstance(found, list | np.ndarray) else []
    if not samples or not all(isinstance(one, dict) for one in samples):
        raise ValueError(f"{name}: has no struct array 'samples' of encounters")
    if len(samples) > MOST:
        raise ValueError(f"{name}: has {len(samples):,} encounters; at most {MOST:,}")
    made = []
    for k, sample in enumerate(samples, start=1):
        try:
            made.append(_scripted(sample))
        except ValueError as problem:
            raise ValueError(f"{name}: encounter {k}: {problem}") from None
    if not any(one.weight > 0.0 for one in made):
        raise ValueError(f"{name}: all encounters have the weight 0; one must have more")
    return tuple(made)


def _scripted(sample: dict[str, Any]) -> Scripted:
    run_s = float(_numbers(sample, "runTime_s", 1, LASTS_S)[0])
    if not run_s > 0.0:
        raise ValueError(f"runTime_s is {run_s:g}; it must be more than 0")
    updates = sample.get("updates")
    updates = list(updates) if isinstance(updates, list | np.ndarray) else []
    if len(updates) != 2 or not all(isinstance(one, dict) for one in updates):
        raise ValueError("updates must be a struct for each of two aircraft")
    speed, north, east, up, heading = (_numbers(sample, field, 2) for field in ("v_ftps", "n_ft", "e_ft", "h_ft", "heading_rad"))
    pitch, gain = _numbers(sample, "pitch_rad", 2, 0.0), _numbers(sample, "a_ftpss", 2, 0.0)
    weight = float(_numbers(sample, "weight", 1, 1.0)[0])
    if weight < 0.0:
        raise ValueError(f"weight is {weight:g}; it must not be less than 0")
    aircraft = []
    for k in (0, 1):
        if speed[k] < 0.0:
            raise ValueError(f"v_ftps of aircraft {k + 1} is {speed[k]:g}; it must not be less than 0")
        if abs(pitch[k]) > math.pi / 2.0:
            raise ValueError(f"pitch_rad of aircraft {k + 1} is {pitch[k]:g}; it must be between -pi/2 and pi/2, straight down and up")
        level, climb = FT * speed[k] * math.cos(pitch[k]), FT * speed[k] * math.sin(pitch[k])
        controls = _controls(updates[k], run_s, FT * gain[k])
        pos = (FT * east[k], FT * north[k], FT * up[k])
        aircraft.append(Flown(pos, level, math.pi / 2.0 - heading[k], climb, _checked(controls, level, k)))
    return Scripted((aircraft[0], aircraft[1]), weight)


def _controls(update: dict[str, Any], run_s: float, gain: float) -> tuple[Control, ...]:
    time_s = np.atleast_1d(np.asarray(update.get("time_s", []), dtype=float))
    rates = [_numbers(update, field, len(time_s)) for field in ("verticalRate_fps", "turnRate_radps", "longitudeAccel_ftpss")]
    if not np.isfinite(time_s).all() or (len(time_s) and time_s[0] < 0.0) or (np.diff(time_s) <= 0.0).any():
        raise ValueError("the times of its updates must go up from 0")
    made = [Control(min(time_s[0], run_s), 0.0, None, gain)] if len(time_s) and time_s[0] > 0.0 else []
    if not len(time_s):
        return (Control(run_s, 0.0, None, gain),)
    ends = [*time_s[1:].tolist(), math.inf]
    for begin, end, climb, turn, rate in zip(time_s.tolist(), ends, *(rate.tolist() for rate in rates), strict=True):
        if begin < run_s:
            made.append(Control(min(end, run_s) - begin, -turn, FT * climb, FT * rate))
    return tuple(made)


def _checked(controls: tuple[Control, ...], level: float, k: int) -> tuple[Control, ...]:
    for control in controls:
        level += control.rate * control.lasts_s
        if level < -1e-9:
            raise ValueError(f"aircraft {k + 1} brakes to a standstill and goes on braking")
    return controls


def _numbers(struct: dict[str, Any], field: str, count: int, default: float | None = None) -> np.ndarray:
    """That many finite numbers of a field."""
    if field not in struct and default is not None:
        return np.full(count, default)
    try:
        found = np.atleast_1d(np.asarray(struct[field], dtype=float)).ravel()
    except KeyError:
        raise ValueError(f"has no {field}") from None
    except (ValueError, TypeError):
        raise ValueError(f"{field} is no list of numbers") from None
    if len(found) == 0 and default is not None:
        return np.full(count, default)
    if len(found) != count or not np.isfinite(found).all():
        raise ValueError(f"{field} must be {count} finite number{'' if count == 1 else 's'}")
    return found
