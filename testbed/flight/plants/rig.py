"""An aircraft on a test rig: put into any state to read its accelerations, or let go with its controls held.

The rig speaks SI; feet end here and in ``jsbsim.py``. Its state is that of small-disturbance theory in body axes (Etkin, "Dynamics
of Atmospheric Flight"): u, w, q, pitch and v, p, r, bank. Surfaces are commands beside the trim, in the aircraft's own sense.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from testbed.core.units import FT
from testbed.flight.plants.aircraft import Aircraft
from testbed.flight.plants.jsbsim_start import load_model, node, trim_level

Array = np.ndarray
HEIGHT_M = 150.0  # above the ground, at sea level: where the published figures of the GTM-T2 were taken
LBF_N = 4.4482216152605  # newtons in a pound of force (exact to these digits)
SLUG_KG = LBF_N / FT
SETTLING_RUNS = 4  # passes in which the angle-of-attack rate that drives the forces becomes the one that they cause


class Motion(NamedTuple):
    """m/s, rad/s and rad in body axes (x forward, y right, z down)."""

    u: float
    w: float
    q: float
    pitch: float
    v: float
    p: float
    r: float
    bank: float


class Controls(NamedTuple):
    """Commands beside the trim: surfaces -1..1 (elevator + nose down, aileron + rolls right, rudder + nose left), throttle 0..1."""

    elevator: float = 0.0
    aileron: float = 0.0
    rudder: float = 0.0
    throttle: float = 0.0


TRIMMED = Controls()


class Reaction(NamedTuple):
    """Body accelerations (m/s^2, rad/s^2), load factor along -z, and aerodynamic lift and drag in multiples of the weight."""

    u: float
    w: float
    q: float
    v: float
    p: float
    r: float
    load_factor: float
    lift_factor: float
    drag_factor: float


RECORDED = {  # column of ``Rig.release`` -> property, factor to SI
    "u": ("velocities/u-fps", FT),
    "w": ("velocities/w-fps", FT),
    "q": ("velocities/q-rad_sec", 1.0),
    "pitch": ("attitude/theta-rad", 1.0),
    "v": ("velocities/v-fps", FT),
    "p": ("velocities/p-rad_sec", 1.0),
    "r": ("velocities/r-rad_sec", 1.0),
    "bank": ("attitude/phi-rad", 1.0),
    "load_factor": ("accelerations/Nz", 1.0),
    "airspeed": ("velocities/vt-fps", FT),
    "alpha": ("aero/alpha-rad", 1.0),
    "thrust": ("propulsion/engine/thrust-lbs", LBF_N),  # of the first engine
}
REACTED = {
    "u": ("accelerations/udot-ft_sec2", FT),
    "w": ("accelerations/wdot-ft_sec2", FT),
    "q": ("accelerations/qdot-rad_sec2", 1.0),
    "v": ("accelerations/vdot-ft_sec2", FT),
    "p": ("accelerations/pdot-rad_sec2", 1.0),
    "r": ("accelerations/rdot-rad_sec2", 1.0),
    "load_factor": ("accelerations/Nz", 1.0),
}


class Rig:
    """One aircraft trimmed straight and level, or in a climb. Raises ``TrimFailedError``."""

    def __init__(self, aircraft: Aircraft, speed_mps: float, climb_rad: float = 0.0, height_m: float = HEIGHT_M, hz: int = 120) -> None:
        fdm = load_model(aircraft, hz)
        trim = trim_level(fdm, aircraft, speed_mps, height_m, climb_rad)
        self._fdm: Any = fdm
        self._hz = hz
        self.speed_mps, self.climb_rad = speed_mps, climb_rad
        self.alpha_rad, self.throttle = trim.alpha, float(fdm["fcs/throttle-cmd-norm"])
        self.elevator = float(fdm["fcs/pitch-trim-cmd-norm"])
        self.mass_kg = float(fdm["inertia/mass-slugs"]) * SLUG_KG
        self.motion = Motion(*(float(fdm[RECORDED[name][0]]) * RECORDED[name][1] for name in Motion._fields))
        self._trimmed = Controls(0.0, float(fdm["fcs/aileron-cmd-norm"]), float(fdm["fcs/rudder-cmd-norm"]), self.throttle)
        self._engines = fdm.get_propulsion().get_num_engines()
        self._react = tuple((node(fdm, name).get_double_value, factor) for name, factor in REACTED.values())

    def react(self, motion: Motion, controls: Controls = TRIMMED) -> Reaction:
        """Accelerations in that state with the surfaces where they are told to be: servos and engine lags are passed by."""
        fdm = self._fdm
        fdm.set_trim_status(True)
        self._put(motion)
        self._hold(controls)
        fdm.run_ic()
        fdm.suspend_integration()
        for _ in range(SETTLING_RUNS):
            fdm.run()
        fdm.resume_integration()
        fdm.set_trim_status(False)
        weight = float(fdm["inertia/weight-lbs"])
        lift, drag = (float(fdm[f"forces/fw{axis}-aero-lbs"]) / weight for axis in "zx")
        return Reaction._make([*(float(read()) * factor for read, factor in self._react), lift, drag])

    def release(self, seconds: float, controls: Controls = TRIMMED, motion: Motion | None = None) -> dict[str, Array]:
        """Time responses, a column each from time zero on, with the controls held. A rig is let go once: engines remember."""
        fdm = self._fdm
        if motion is not None:
            self._put(motion)
            fdm.run_ic()
        self._hold(controls)
        reads = [node(fdm, name).get_double_value for name, _ in RECORDED.values()]
        steps = round(seconds * self._hz)
        rows = np.empty((steps + 1, len(reads)))
        for k in range(steps + 1):
            rows[k] = [read() for read in reads]
            fdm.run()
        rows *= [factor for _, factor in RECORDED.values()]
        return {"time_s": np.arange(steps + 1) / self._hz} | dict(zip(RECORDED, rows.T, strict=True))

    def _put(self, motion: Motion) -> None:
        fdm = self._fdm
        fdm["ic/theta-rad"], fdm["ic/phi-rad"], fdm["ic/psi-true-rad"] = motion.pitch, motion.bank, 0.0
        fdm["ic/u-fps"], fdm["ic/v-fps"], fdm["ic/w-fps"] = motion.u / FT, motion.v / FT, motion.w / FT
        fdm["ic/p-rad_sec"], fdm["ic/q-rad_sec"], fdm["ic/r-rad_sec"] = motion.p, motion.q, motion.r

    def _hold(self, controls: Controls) -> None:
        fdm = self._fdm
        trimmed = self._trimmed  # the elevator's trim has a property of its own
        fdm["fcs/elevator-cmd-norm"] = controls.elevator
        fdm["fcs/aileron-cmd-norm"] = trimmed.aileron + controls.aileron
        fdm["fcs/rudder-cmd-norm"] = trimmed.rudder + controls.rudder
        for k in range(self._engines):
            fdm.set_property_value(f"fcs/throttle-cmd-norm[{k}]", min(1.0, max(0.0, trimmed.throttle + controls.throttle)))


def level(alpha_rad: float, speed_mps: float) -> Motion:
    """Straight level flight at an angle of attack, in balance or not."""
    u, w = speed_mps * math.cos(alpha_rad), speed_mps * math.sin(alpha_rad)
    return Motion(u, w, 0.0, alpha_rad, 0.0, 0.0, 0.0, 0.0)
