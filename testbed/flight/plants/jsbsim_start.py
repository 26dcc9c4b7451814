"""An aircraft in JSBSim, loaded, trimmed and put on its path: everything before the first step.

The only file that imports jsbsim. JSBSim creates a property that is written under a wrong name and reads 0 from a missing one, so a name
is looked up by ``node``, which refuses one that is absent.
"""

import math
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import jsbsim

from testbed.core.frames import Vec3, body_rates, enu_from_wind_axes, euler_from_enu_from_body
from testbed.core.model_files import model_path
from testbed.core.units import DEG, FT
from testbed.flight.air import ground_speed_along
from testbed.flight.plants.aircraft import Aircraft
from testbed.flight.plants.base import Start, TrimFailedError
from testbed.flight.plants.jsbsim_again import stamp, trimmed_again
from testbed.flight.plants.jsbsim_air import GustFeed
from testbed.flight.plants.jsbsim_model import changed_root
from testbed.flight.plants.jsbsim_settled import HOLD_S, Balance, find_balance, hold, longitude_deg, put, start_engines
from testbed.flight.plants.kinematic import coordinated

LATITUDE_DEG = 37.0  # where the flat ground of the ENU frame touches the ellipsoid; any mid latitude does
FLAT_RAD = 0.5 * DEG  # a climb less steep than this starts from the level trim
INTEGRATORS = {"rate/rotational": 3, "position/rotational": 3}
"""Adams-Bashforth of second order for body rates and attitude, as JSBSim has it for the velocity; its own choice is Euler's rule."""


class _Quiet(jsbsim.FGLogger):
    """Swallows JSBSim's console output; what matters is checked and reported by us."""

    def set_level(self, level: object) -> None: ...
    def file_location(self, filename: str, line: int) -> None: ...
    def message(self, message: str) -> None: ...
    def format(self, format: object) -> None: ...
    def flush(self) -> None: ...


_quiet = _Quiet()


def load_model(aircraft: Aircraft, plant_hz: int, air_turns: bool = False) -> jsbsim.FGFDMExec:
    """A fresh executive with the aircraft loaded (a used one keeps fuel, engine and filter state: never reuse it).

    ``air_turns``: its aerodynamics feel the angular velocity of the air that is written into it.
    """
    jsbsim.FGJSBBase().debug_lvl = 0
    jsbsim.set_logger(_quiet)
    file = model_file(aircraft)
    fdm = jsbsim.FGFDMExec(str(file.parents[2]))
    fdm.set_dt(1.0 / plant_hz)
    for motion, rule in INTEGRATORS.items():
        node(fdm, f"simulation/integrator/{motion}").set_double_value(rule)
    with changed_root(file, aircraft.model.factors, air_turns) as root:
        fdm.set_aircraft_path(str(root))
        if not _loads(fdm, aircraft.model.name):
            raise TrimFailedError(f"JSBSim cannot load '{aircraft.model.name}' ({aircraft.model.files} files)")
    return fdm


def _loads(fdm: jsbsim.FGFDMExec, name: str) -> bool:
    """Without the files that some models write while they fly."""
    with TemporaryDirectory(prefix="output-") as folder:
        fdm.set_output_path(folder)
        try:
            loaded = bool(fdm.load_model(name))
        except RuntimeError as refused:  # what the files say makes no aircraft; that they are there and can be read was seen to before
            raise TrimFailedError(f"JSBSim cannot load '{name}': {' '.join(str(refused).split())}") from refused
    fdm.disable_output()
    return loaded


def model_file(aircraft: Aircraft) -> Path:
    """The aircraft's own JSBSim file or the wheel's."""
    return model_path(aircraft.model.files, aircraft.model.name, aircraft.folder)


def node(fdm: jsbsim.FGFDMExec, name: str) -> jsbsim.FGPropertyNode:
    """The property of that name. Raises ``KeyError`` when the aircraft has none."""
    found = fdm.get_property_manager().get_node(name)
    if found is None:
        raise KeyError(f"this aircraft has no property '{name}'")
    return found


class Trim(NamedTuple):
    """Straight flight in still air: the throttle of level flight, and the angle of attack of the trim the aircraft is in."""

    throttle: float
    alpha: float


def trim_level(fdm: jsbsim.FGFDMExec, aircraft: Aircraft, speed_mps: float, height_m: float, climb_rad: float = 0.0) -> Trim:
    """Trim at a true airspeed and a height above the ground, level unless told to climb. Raises ``TrimFailedError``."""
    if aircraft.model.start == "settled":
        return _trim_settled(fdm, aircraft, speed_mps, height_m, climb_rad)
    _switch_on(fdm, aircraft, speed_mps, height_m, climb_rad)
    if not _trims(fdm):
        raise TrimFailedError(_no_trim(speed_mps, height_m, climb_rad))
    return Trim(fdm["fcs/throttle-cmd-norm"], fdm["aero/alpha-rad"])


def _switch_on(fdm: jsbsim.FGFDMExec, aircraft: Aircraft, speed_mps: float, height_m: float, climb_rad: float) -> None:
    _make_ready(fdm, aircraft, speed_mps, height_m, climb_rad)
    fdm.run_ic()
    fdm["propulsion/set-running"] = -1
    fdm["propulsion/fuel_freeze"] = 1


def _no_trim(speed_mps: float, height_m: float, climb_rad: float) -> str:
    straight = f"trim in a climb of {climb_rad / DEG:.1f} deg" if climb_rad else "level trim"
    return f"no {straight} at {speed_mps:g} m/s, {height_m:.0f} m"


def _make_ready(fdm: jsbsim.FGFDMExec, aircraft: Aircraft, speed_mps: float, height_m: float, climb_rad: float) -> None:
    """Everything before the first ``run_ic``."""
    set_ = fdm.__setitem__
    fdm["atmosphere/turb-type"] = 0
    fdm["ic/terrain-elevation-ft"] = 0.0
    fdm["ic/lat-geod-deg"], fdm["ic/long-gc-deg"], fdm["ic/h-sl-ft"] = LATITUDE_DEG, 0.0, height_m / FT
    fdm["ic/vt-fps"], fdm["ic/gamma-rad"], fdm["ic/psi-true-deg"] = speed_mps / FT, climb_rad, 0.0
    if aircraft.model.gear_up and fdm.get_property_manager().get_node("gear/gear-cmd-norm") is not None:
        fdm["gear/gear-cmd-norm"] = fdm["gear/gear-pos-norm"] = 0.0
    for i in range(fdm.get_propulsion().get_num_engines()):
        set_(f"fcs/mixture-cmd-norm[{i}]", aircraft.model.mixture)
        set_(f"fcs/advance-cmd-norm[{i}]", 1.0)
    fdm["propulsion/magneto_cmd"] = 3


def _model_key(aircraft: Aircraft) -> tuple[object, ...]:
    """Everything about an aircraft that its trim depends on."""
    model = aircraft.model
    return (*stamp(model_file(aircraft)), model.gear_up, model.mixture, tuple(sorted(model.factors.items())))


@dataclass(frozen=True)
class _Case:
    """What a settled trim depends on; the aircraft itself has no hash, ``key`` stands for it."""

    aircraft: Aircraft = field(compare=False)
    key: tuple[object, ...]
    hz: int
    speed_mps: float
    height_m: float
    climb_rad: float

    def ready(self) -> jsbsim.FGFDMExec:
        fdm = load_model(self.aircraft, self.hz)
        _make_ready(fdm, self.aircraft, self.speed_mps, self.height_m, self.climb_rad)
        return fdm


@lru_cache(maxsize=512)
def _balance(case: _Case) -> Balance | str:
    """The balance, found once for all flights of a process that start alike; or why there is none."""
    try:
        return find_balance(case.ready, case.speed_mps, case.climb_rad)
    except TrimFailedError as error:
        return f"{_no_trim(case.speed_mps, case.height_m, case.climb_rad)}: {error}"


def _trim_settled(fdm: jsbsim.FGFDMExec, aircraft: Aircraft, speed_mps: float, height_m: float, climb_rad: float) -> Trim:
    """The balance is sought on executives of its own, so that a flight starts alike whether it was known or not."""
    balance = _balance(_Case(aircraft, _model_key(aircraft), round(1.0 / fdm.get_delta_t()), speed_mps, height_m, climb_rad))
    if isinstance(balance, str):
        raise TrimFailedError(balance)
    _make_ready(fdm, aircraft, speed_mps, height_m, climb_rad)
    start_engines(fdm)
    fdm["ic/long-gc-deg"] = longitude_deg()
    put(fdm, speed_mps, climb_rad, balance)
    hold(fdm, HOLD_S)
    return Trim(balance.throttle, balance.alpha)


def _trims(fdm: jsbsim.FGFDMExec) -> bool:
    try:
        fdm["simulation/do_simple_trim"] = 1
    except jsbsim.TrimFailureError:  # it leaves throttle and alpha at 0: do not fly on from there
        return False
    return True


def trimmed(aircraft: Aircraft, start: Start, plant_hz: int, height_m: float, air_turns: bool = False) -> tuple[jsbsim.FGFDMExec, Trim]:
    """A fresh executive with the aircraft in the trim of its start. Raises ``TrimFailedError``."""

    def search() -> tuple[jsbsim.FGFDMExec, Trim]:
        fdm = load_model(aircraft, plant_hz, air_turns)
        return spool_up(fdm, aircraft, start, trim_level(fdm, aircraft, start.speed, height_m), height_m, air_turns)

    if aircraft.model.start == "settled":
        return search()

    def fresh() -> jsbsim.FGFDMExec:
        fdm = load_model(aircraft, plant_hz, air_turns)
        _switch_on(fdm, aircraft, start.speed, height_m, 0.0)
        return fdm

    key = (*_model_key(aircraft), plant_hz, air_turns, start.speed, height_m, start.tangent[2])
    return trimmed_again(key, fresh, search, lambda fdm, trim: begin(fdm, start, trim, height_m))


def spool_up(
    fdm: jsbsim.FGFDMExec, aircraft: Aircraft, start: Start, level: Trim, height_m: float, air_turns: bool = False
) -> tuple[jsbsim.FGFDMExec, Trim]:
    """Trim again in the climb of the path, so that the engine starts with the power that the path needs there.

    An engine that needs seconds to spool up would otherwise start every climbing flight late. Where the climb cannot be trimmed
    the level trim stands. Returns the executive to fly on with, since a failed trim spoils the one it was tried on.
    """
    climb = math.asin(max(-1.0, min(1.0, start.tangent[2])))
    if abs(climb) < FLAT_RAD:
        return fdm, level
    if aircraft.model.start == "settled":
        try:
            climbing = trim_level(fdm, aircraft, start.speed, height_m, climb)
        except TrimFailedError:  # nothing was done to the executive yet
            return fdm, level
        return fdm, Trim(level.throttle, climbing.alpha)
    fdm["ic/gamma-rad"] = climb
    fdm.run_ic()
    if _trims(fdm):
        return fdm, Trim(level.throttle, fdm["aero/alpha-rad"])
    fresh = load_model(aircraft, round(1.0 / fdm.get_delta_t()), air_turns)
    return fresh, trim_level(fresh, aircraft, start.speed, height_m)


def issue(fdm: jsbsim.FGFDMExec, start: Start, alpha_trim: float, alpha_extra: float, height_m: float) -> tuple[float, float]:
    """Put the trimmed aircraft on the path: track, climb, bank and turn of the curve there, in the wind.

    ``alpha_extra`` is added to the trim's angle of attack. Returns the load factor that the path needs there, and the
    load factor that the aircraft has.
    """
    ground_speed = ground_speed_along(start.tangent, start.speed, start.wind)
    vel: Vec3 = tuple(ground_speed * t for t in start.tangent)  # type: ignore[assignment]
    square = ground_speed * ground_speed
    bank, load_factor = coordinated(vel, (square * start.curvature[0], square * start.curvature[1], square * start.curvature[2]))
    air: Vec3 = tuple(v - w for v, w in zip(vel, start.wind, strict=True))  # type: ignore[assignment]
    attitude = enu_from_wind_axes(air, bank, alpha_trim + alpha_extra)
    roll, pitch, heading = euler_from_enu_from_body(attitude)
    rates = body_rates(attitude, start.tangent, start.curvature, ground_speed)
    wind_speed = math.hypot(start.wind[0], start.wind[1])
    fdm["ic/h-sl-ft"] = height_m / FT
    fdm["ic/vw-mag-fps"] = wind_speed / FT
    fdm["ic/vw-dir-deg"] = math.atan2(start.wind[0], start.wind[1]) / DEG  # JSBSim: the direction the air moves TOWARD
    fdm["ic/vn-fps"], fdm["ic/ve-fps"], fdm["ic/vd-fps"] = vel[1] / FT, vel[0] / FT, -vel[2] / FT
    fdm["ic/theta-rad"], fdm["ic/phi-rad"], fdm["ic/psi-true-rad"] = pitch, roll, heading
    fdm["ic/p-rad_sec"], fdm["ic/q-rad_sec"], fdm["ic/r-rad_sec"] = rates
    fdm.run_ic()
    return load_factor, fdm["accelerations/Nz"]


def begin(fdm: jsbsim.FGFDMExec, start: Start, trim: Trim, height_m: float, feed: GustFeed | None = None, settle_s: float = 0.0) -> None:
    """Two probes give the lift slope; the third start has the angle of attack that the path's load factor needs, and the gusts.

    ``settle_s``: for so long the aircraft is held in that state, for engines that a start sets back.
    """
    probe = 1.0 * DEG
    wanted, low = issue(fdm, start, trim.alpha, 0.0, height_m)
    _, high = issue(fdm, start, trim.alpha, probe, height_m)
    extra = probe * (wanted - low) / (high - low)
    if feed is not None:
        feed.write(0.0, start.pos)
    issue(fdm, start, trim.alpha, max(-5.0 * DEG, min(5.0 * DEG, extra)), height_m)
    if settle_s:
        hold(fdm, settle_s)
