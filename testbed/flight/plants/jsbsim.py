"""Six degrees of freedom: JSBSim flies the aircraft, the autopilot holds its commands.

How the aircraft is loaded and trimmed is in ``jsbsim_start.py``, how the air gets into it in ``jsbsim_air.py``; feet stay there, here
and in ``rig.py``. What is read and written at every step is looked up once and kept as a bound method.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any

from testbed.core.units import FT
from testbed.flight.air import AirModel
from testbed.flight.plants.aircraft import Aircraft
from testbed.flight.plants.autopilot import Autopilot, Memory
from testbed.flight.plants.base import Command, Followable, PlantSetting, Start, State, make
from testbed.flight.plants.jsbsim_air import WIND, GustFeed, rates_in_air, switch_on
from testbed.flight.plants.jsbsim_settled import HOLD_S
from testbed.flight.plants.jsbsim_start import begin, node, trimmed

Read = Callable[[], float]
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
        height = start.pos[2] - terrain_z_m
        fdm, trim = trimmed(aircraft, start, plant_hz, height, turns)
        self._steady = start.wind if air is None else air.steady
        feed = GustFeed(lambda name: node(fdm, name), air, start.wind) if air is not None and air.steady is None else None
        begin(fdm, start, trim, height, feed, HOLD_S if aircraft.model.start == "settled" else 0.0)
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


def make_plant(setting: PlantSetting) -> JsbsimPlant:
    """The aircraft for one flight. Raises ``TrimFailedError``."""
    rates = (setting.plant_hz, setting.guidance_hz)
    return JsbsimPlant(setting.aircraft, setting.start, *rates, setting.terrain_z_m, setting.air)
