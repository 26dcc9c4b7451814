"""A trim for engines that need time: started, and let run until their thrust is steady, while the aircraft is held at its speed.

JSBSim's own trim asks a propeller for its thrust at once: it tries a closed throttle, the engine stops, and every later try finds it
dead. Here the throttle is sought from full down, each time with the engine settled in the flow of the flight; between two tries
Newton's method takes out what is left of the accelerations. Feet and pounds are JSBSim's and stay in here.

Holding still means that JSBSim integrates neither place, velocity, attitude nor rates, while engines, servos and filters go on. The
Earth turns under an aircraft that is held: it starts as far to the east as it is carried to the west.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from testbed.core.units import DEG, FT
from testbed.flight.plants.base import TrimFailedError

HELD = tuple(f"simulation/integrator/{what}/{motion}" for what in ("rate", "position") for motion in ("rotational", "translational"))
EARTH_DPS = 7.292115e-5 / DEG  # turn of the Earth, deg/s (WGS84)
START_MPS, START_S = 1.0, 4.0  # engines are started slowly: in a full flow a propeller stalls them
LEAST_S, MOST_S, HOLD_S = 5.0, 20.0, 12.0  # a try of the throttle; the last hold before a flight
STEADY = 2e-5  # of the weight: change of the thrust in a second
OPENINGS = 0.25  # steps in which the throttle is closed until the aircraft slows down
MOST_TRIES = 30
LEFT_FPS2 = 3e-3  # along the path
LEFT = np.array([2e-3, 2e-4, 2e-4, 2e-4, 2e-3])  # ft/s^2 and rad/s^2, of ``ACCELERATIONS`` but the first
ACCELERATIONS = tuple(f"accelerations/{rate}_sec2" for rate in ("udot-ft", "wdot-ft", "qdot-rad", "pdot-rad", "rdot-rad", "vdot-ft"))
STEP, LONGEST = 2e-3, 0.15  # of the differences, and of one step of Newton's method
BOUNDS = np.array([35.0 * DEG, 1.0, 1.0, 1.0, 30.0 * DEG])
SUSPENDED_RUNS = 4  # passes in which the angle-of-attack rate that drives the forces becomes the one that they cause

Array = np.ndarray
Fdm = Any


class Balance(NamedTuple):
    """Straight flight without sideslip: radians, throttle 0..1, surface commands -1..1 (elevator: its trim)."""

    throttle: float
    alpha: float
    elevator: float
    aileron: float
    rudder: float
    bank: float


def hold(fdm: Fdm, seconds: float) -> None:
    """Let engines, servos and filters go on while the aircraft stays in the state it is in."""
    rules = [fdm[name] for name in HELD]
    for name in HELD:
        fdm[name] = 0
    for _ in range(round(seconds / fdm.get_delta_t())):
        fdm.run()
    for name, rule in zip(HELD, rules, strict=True):
        fdm[name] = rule


def longitude_deg() -> float:
    """Where an aircraft starts that ``HOLD_S`` of holding are to carry to longitude 0."""
    return EARTH_DPS * HOLD_S


def start_engines(fdm: Fdm) -> None:
    """Pistons by their starters, others running at once; all with a full throttle, in a weak flow."""
    fdm["ic/vt-fps"], fdm["ic/gamma-rad"] = START_MPS / FT, 0.0
    _set_throttle(fdm, 1.0)
    fdm.run_ic()
    fdm["propulsion/fuel_freeze"] = 1  # a tank that is empty by the model's file starves no engine
    fdm["propulsion/set-running"] = -1
    if fdm.get_property_manager().get_node("propulsion/engine/volumetric-efficiency") is not None:  # a piston may have stopped again
        fdm["propulsion/magneto_cmd"], fdm["propulsion/starter_cmd"] = 3, 1
    hold(fdm, START_S)
    fdm["propulsion/starter_cmd"] = 0


def put(fdm: Fdm, speed_mps: float, climb_rad: float, balance: Balance) -> None:
    """Straight flight to the north in that balance; the engines keep their state."""
    _set_throttle(fdm, balance.throttle)
    fdm["ic/phi-rad"] = 0.0
    fdm["ic/vt-fps"], fdm["ic/beta-rad"], fdm["ic/alpha-rad"] = speed_mps / FT, 0.0, balance.alpha
    fdm["ic/gamma-rad"], fdm["ic/phi-rad"], fdm["ic/psi-true-deg"] = climb_rad, balance.bank, 0.0
    fdm["ic/p-rad_sec"] = fdm["ic/q-rad_sec"] = fdm["ic/r-rad_sec"] = 0.0
    fdm["fcs/pitch-trim-cmd-norm"], fdm["fcs/aileron-cmd-norm"], fdm["fcs/rudder-cmd-norm"] = balance[2:5]
    fdm.run_ic()


def find_balance(load: Callable[[], Fdm], speed_mps: float, climb_rad: float) -> Balance:
    """The trim, sought on an executive of its own, which ``load`` makes ready for its first ``run_ic``. Raises ``TrimFailedError``."""
    fdm = load()
    if not fdm.get_propulsion().get_num_engines():
        raise TrimFailedError("it has no engine: a glider cannot hold its speed and height")
    start_engines(fdm)
    balance = Balance(1.0, 0.05, 0.0, 0.0, 0.0, 0.0)
    slow: tuple[float, float] | None = None  # the highest throttle known to be too little, and what it leaves
    fast: tuple[float, float] | None = None
    for _ in range(MOST_TRIES):
        balance, left = _balanced(fdm, speed_mps, climb_rad, balance, _settled(fdm, speed_mps, climb_rad, balance))
        if abs(left) <= LEFT_FPS2:
            return balance
        throttle = balance.throttle
        if left < 0.0:
            if throttle >= 1.0:
                raise TrimFailedError("full throttle is too little")
            slow = throttle, left
        else:
            if throttle <= 0.0:
                raise TrimFailedError("a closed throttle is too much")
            fast = throttle, left
        balance = balance._replace(throttle=_next(slow, fast))
    raise TrimFailedError("the thrust does not settle")


def _next(slow: tuple[float, float] | None, fast: tuple[float, float] | None) -> float:
    """The throttle to try: step by step down from full, then by regula falsi, no nearer to an end than a tenth of what is between."""
    assert fast is not None, "full throttle comes first"
    if slow is None:
        return max(0.0, fast[0] - OPENINGS)
    width = fast[0] - slow[0]
    share = -slow[1] / (fast[1] - slow[1])
    return slow[0] + width * min(0.9, max(0.1, share))


def _set_throttle(fdm: Fdm, throttle: float) -> None:
    for i in range(fdm.get_propulsion().get_num_engines()):
        fdm[f"fcs/throttle-cmd-norm[{i}]"] = throttle


def _settled(fdm: Fdm, speed_mps: float, climb_rad: float, balance: Balance) -> Array:
    """Hold until the thrust has not changed for two seconds; what running engines add to the accelerations of ``_react``."""
    put(fdm, speed_mps, climb_rad, balance)
    weight, before, calm, seconds = fdm["inertia/weight-lbs"], math.inf, 0, 0.0
    while seconds < MOST_S and not (calm >= 2 and seconds >= LEAST_S):
        hold(fdm, 1.0)
        seconds += 1.0
        thrust = fdm["forces/fbx-prop-lbs"] / weight
        calm = calm + 1 if abs(thrust - before) < STEADY else 0
        before = thrust
    running = _accelerations(fdm)
    return running - _react(fdm, speed_mps, climb_rad, balance)


def _balanced(fdm: Fdm, speed_mps: float, climb_rad: float, balance: Balance, engines: Array) -> tuple[Balance, float]:
    """Newton's method on all but the acceleration along the path, with the engines as they are; and that (ft/s^2).

    Raises ``TrimFailedError``.
    """
    x = np.array(balance[1:])

    def left(at: Array) -> Array:
        return _react(fdm, speed_mps, climb_rad, Balance(balance.throttle, *at)) + engines

    for _ in range(15):
        now = left(x)
        if not np.all(np.isfinite(now)):
            break
        if np.all(np.abs(now[1:]) < LEFT):
            return Balance(balance.throttle, *x.tolist()), float(now[0] * math.cos(x[0]) + now[1] * math.sin(x[0]))
        steps = STEP * np.eye(len(x))
        slopes = np.column_stack([(left(x + step) - left(x - step))[1:] / (2.0 * STEP) for step in steps])
        if not np.all(np.isfinite(slopes)) or np.linalg.cond(slopes) > 1e9:
            break
        x = np.clip(x + np.clip(-np.linalg.solve(slopes, now[1:]), -LONGEST, LONGEST), -BOUNDS, BOUNDS)
    raise TrimFailedError("no angle of attack and surfaces balance it")


def _react(fdm: Fdm, speed_mps: float, climb_rad: float, balance: Balance) -> Array:
    """The accelerations in that state, surfaces where they are told to be, thrust as it is; some engines have no torque then."""
    fdm.set_trim_status(True)
    put(fdm, speed_mps, climb_rad, balance)
    fdm.suspend_integration()
    for _ in range(SUSPENDED_RUNS):
        fdm.run()
    fdm.resume_integration()
    fdm.set_trim_status(False)
    return _accelerations(fdm)


def _accelerations(fdm: Fdm) -> Array:
    return np.array([fdm[name] for name in ACCELERATIONS])
