"""Six degrees of freedom: JSBSim flies the aircraft, the autopilot holds its commands.

The only file that imports jsbsim; feet stay here and in ``jsbsim_air.py`` and ``rig.py``. JSBSim creates a property that is written under a
wrong name and reads 0 from a missing one, so every name is looked up once, refused when absent, and kept as a bound method.
"""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import jsbsim

from testbed.flight.air import AirModel, ground_speed_along
from testbed.flight.aircraft import Aircraft
from testbed.flight.autopilot import Autopilot, Memory
from testbed.flight.plants.base import Command, Followable, Start, State, TrimFailedError, make
from testbed.flight.plants.jsbsim_air import WIND, GustFeed, rates_in_air, switch_on
from testbed.flight.plants.jsbsim_model import changed_root
from testbed.flight.plants.kinematic import coordinated
from testbed.frames import Vec3, body_rates, enu_from_wind_axes, euler_from_enu_from_body
from testbed.units import DEG, FT

LATITUDE_DEG = 37.0  # where the flat ground of the ENU frame touches the ellipsoid; any mid latitude does
FLAT_RAD = 0.5 * DEG  # a climb less steep than this starts from the level trim
Read = Callable[[], float]
INTEGRATORS = {"rate/rotational": 3, "position/rotational": 3}
"""Adams-Bashforth of second order for body rates and attitude, as JSBSim has it for the velocity; its own choice is Euler's rule."""
OBSERVED = (
    *(f"position/ecef-{axis}-ft" for axis in "xyz"),
    *(f"velocities/v-{axis}-fps" for axis in ("east", "north", "down")),
    "attitude/phi-rad",
    "attitude/theta-rad",
    "attitude/psi-rad",
    "forces/fbz-total-lbs",  # of this step; accelerations/Nz is that of the step before
    "velocities/vt-fps",
    "aero/alpha-rad",
    "aero/beta-rad",
    "velocities/p-rad_sec",
    "velocities/q-rad_sec",
    "velocities/r-rad_sec",
)
CONTROLS_END = len(OBSERVED) + 4  # in a sample: throttle, elevator, aileron and rudder come next, then the air where it changes


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
        if not fdm.load_model(aircraft.model.name):
            raise FileNotFoundError(f"JSBSim cannot load '{aircraft.model.name}' ({aircraft.model.files} files)")
    return fdm


def model_file(aircraft: Aircraft) -> Path:
    """The aircraft's own JSBSim file or the wheel's: ``<root>/<folder of aircraft>/<name>/<name>.xml``."""
    aircraft_root = aircraft.folder.parent if aircraft.model.files == "own" else Path(jsbsim.get_default_root_dir()) / "aircraft"
    return aircraft_root / aircraft.model.name / f"{aircraft.model.name}.xml"


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
    fdm.run_ic()
    fdm["propulsion/set-running"] = -1
    fdm["propulsion/fuel_freeze"] = 1
    if not _trims(fdm):
        straight = f"trim in a climb of {climb_rad / DEG:.1f} deg" if climb_rad else "level trim"
        raise TrimFailedError(f"no {straight} at {speed_mps:g} m/s, {height_m:.0f} m")
    return Trim(fdm["fcs/throttle-cmd-norm"], fdm["aero/alpha-rad"])


def _trims(fdm: jsbsim.FGFDMExec) -> bool:
    try:
        fdm["simulation/do_simple_trim"] = 1
    except jsbsim.TrimFailureError:  # it leaves throttle and alpha at 0: do not fly on from there
        return False
    return True


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


def begin(fdm: jsbsim.FGFDMExec, start: Start, trim: Trim, height_m: float, feed: GustFeed | None = None) -> None:
    """Two probes give the lift slope; the third start has the angle of attack that the path's load factor needs, and the gusts."""
    probe = 1.0 * DEG
    wanted, low = issue(fdm, start, trim.alpha, 0.0, height_m)
    _, high = issue(fdm, start, trim.alpha, probe, height_m)
    extra = probe * (wanted - low) / (high - low)
    if feed is not None:
        feed.write(0.0, start.pos)
    issue(fdm, start, trim.alpha, max(-5.0 * DEG, min(5.0 * DEG, extra)), height_m)


def _sampler(read: Sequence[Read], read_air: Sequence[Read], controls: Sequence[float]) -> Callable[[], Sequence[float]]:
    """One row of the raw log: what JSBSim has, then the controls as they are by then, then the air where it changes.

    A closure over the reads, called one by one: the quickest that the language has, and this is called at every step.
    """
    x, y, z, ve, vn, vd, bank, pitch, heading, down_force, airspeed, alpha, beta, p, q, r = read

    # fmt: off
    def still() -> Sequence[float]:
        throttle, elevator, aileron, rudder = controls
        return (
            x(), y(), z(), ve(), vn(), vd(), bank(), pitch(), heading(), down_force(), airspeed(), alpha(), beta(), p(), q(), r(),
            throttle, elevator, aileron, rudder,
        )
    # fmt: on

    def moving() -> Sequence[float]:
        return (*still(), *[part() for part in read_air])

    return moving if read_air else still


class JsbsimPlant:
    """One flight in JSBSim, from a trimmed start. Raises ``TrimFailedError``."""

    def __init__(
        self, aircraft: Aircraft, start: Start, plant_hz: int, guidance_hz: int, terrain_z_m: float, air: AirModel | None = None
    ) -> None:
        turns = air is not None and air.rotation is not None
        fdm = load_model(aircraft, plant_hz, turns)
        height = start.pos[2] - terrain_z_m
        fdm, trim = spool_up(fdm, aircraft, start, trim_level(fdm, aircraft, start.speed, height), height, turns)
        self._steady = start.wind if air is None else air.steady
        feed = GustFeed(lambda name: node(fdm, name), air, start.wind) if air is not None and air.steady is None else None
        begin(fdm, start, trim, height, feed)
        self._per_lift = -1.0 / fdm["inertia/weight-lbs"]  # load factor per lb along the body's z axis; no fuel is burnt
        self._fdm = fdm  # the bound methods below do not keep it alive
        self._autopilot = Autopilot(aircraft, trim.throttle, 1.0 / guidance_hz)
        self._memory = Memory()
        lag = aircraft.command_lag_s
        self._keep = math.exp(-1.0 / (guidance_hz * lag)) if lag > 0.0 else 0.0  # of a command, until the next one
        in_air = () if air is None else rates_in_air(air)
        self._air_turns = bool(in_air)
        read = tuple(node(fdm, name).get_double_value for name in OBSERVED)
        read_air = tuple(node(fdm, name).get_double_value for name in WIND + in_air) if self._steady is None else ()
        self._ground_force = node(fdm, "forces/fbz-gear-lbs").get_double_value
        self._set_elevator = node(fdm, "fcs/elevator-cmd-norm").set_double_value
        self._set_aileron = node(fdm, "fcs/aileron-cmd-norm").set_double_value
        self._set_rudder = node(fdm, "fcs/rudder-cmd-norm").set_double_value
        engines = fdm.get_propulsion().get_num_engines()
        self._set_throttles = tuple(node(fdm, f"fcs/throttle-cmd-norm[{i}]").set_double_value for i in range(engines))
        self.step_bare = fdm.run  # JSBSim's own call, for the benchmark
        self.step: Callable[[], object] = fdm.run
        # throttle, elevator, aileron, rudder; the surfaces beside their trim, of which JSBSim keeps only the pitch in a property of its own
        self._controls = [float(fdm["fcs/throttle-cmd-norm"]), 0.0, 0.0, 0.0]
        self.sample: Callable[[], Sequence[float]] = _sampler(read, read_air, self._controls)
        self._aileron_trim, self._rudder_trim = fdm["fcs/aileron-cmd-norm"], fdm["fcs/rudder-cmd-norm"]  # against a propeller's torque
        self._origin = (*(position() for position in read[:3]), *start.pos)
        latitude = fdm["position/lat-geod-rad"]
        self._sin, self._cos = math.sin(latitude), math.cos(latitude)
        if feed is not None:
            self.step = self._stepper(feed, read[:3], plant_hz)
        if air is not None and air.built_in is not None:
            switch_on(lambda name: node(fdm, name), air.built_in)

    def _stepper(self, feed: GustFeed, position: Sequence[Read], plant_hz: int) -> Callable[[], object]:
        """A step in air that changes: it feels the air of its end, at the place and attitude of one step ago."""
        (read_x, read_y, read_z), run, tick = position, self.step_bare, 0

        def step() -> None:
            nonlocal tick
            tick += 1
            feed.write(tick / plant_hz, self._place(read_x(), read_y(), read_z()))
            run()

        return step

    def follow(self, path: Followable, s_m: float) -> None:
        """Guidance knows the path; the aeroplane does not."""

    def touches_ground(self) -> bool:
        """JSBSim pushes a wheel, wing or belly that is in the ground back up: a crash would be a bounce."""
        return bool(self._ground_force() != 0.0)

    def state(self, sample: Sequence[Any]) -> State:
        # fmt: off
        if self._steady is None:
            east, north, down = sample[CONTROLS_END : CONTROLS_END + 3]
            wx, wy, wz = FT * east, FT * north, -FT * down
        else:
            wx, wy, wz = self._steady
        (
            ex, ey, ez, ve, vn, vd, bank, pitch, heading, down_force, airspeed, alpha, beta, p, q, r,
            throttle, elevator, aileron, rudder,
        ) = sample[:CONTROLS_END]
        x, y, z = self._place(ex, ey, ez)
        return make(State, (
            x, y, z, FT * ve, FT * vn, -FT * vd, bank, pitch, heading, self._per_lift * down_force, FT * airspeed, alpha, beta, p, q, r,
            throttle, elevator, aileron, rudder, wx, wy, wz,
        ))
        # fmt: on

    def air_rotation(self, sample: Sequence[Any]) -> tuple[Any, Any, Any]:
        """The aircraft's rates less those that its aerodynamics use."""
        if not self._air_turns:
            return 0.0, 0.0, 0.0
        (p, q, r), (p_air, q_air, r_air) = sample[len(OBSERVED) - 3 : len(OBSERVED)], sample[-3:]
        return p - p_air, q - q_air, r - r_air

    def _place(self, ex: Any, ey: Any, ez: Any) -> tuple[Any, Any, Any]:
        """ENU metres of ECEF feet. ECEF at longitude 0: east is +y, north and up lie in the x-z plane."""
        ox, oy, oz, x0, y0, z0 = self._origin
        dx, dz = FT * (ex - ox), FT * (ez - oz)
        sin, cos = self._sin, self._cos
        return x0 + FT * (ey - oy), y0 + cos * dz - sin * dx, z0 + cos * dx + sin * dz

    def command(self, state: State, command: Command) -> bool:
        (elevator, aileron, rudder, throttle, saturated), self._memory = self._autopilot.step(self._memory, state, command)
        if self._keep:  # the lag that the model itself lacks
            keep, (_, last_elevator, last_aileron, last_rudder) = self._keep, self._controls
            elevator += keep * (last_elevator - elevator)
            aileron += keep * (last_aileron - aileron)
            rudder += keep * (last_rudder - rudder)
        self._controls[:] = throttle, elevator, aileron, rudder
        self._set_elevator(elevator)
        self._set_aileron(self._aileron_trim + aileron)
        self._set_rudder(self._rudder_trim + rudder)
        for set_throttle in self._set_throttles:
            set_throttle(throttle)
        return saturated
