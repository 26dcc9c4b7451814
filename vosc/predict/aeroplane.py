"""The aircraft of a prediction: a point with lags and limits, of which a batch moves in one step.

    V' = g ((T - D)/W - sin gamma)      gamma' = g/V (n cos phi - cos gamma)      chi' = g n sin phi / (V cos gamma)

with V, gamma, chi of the velocity through the air (chi clockwise from y). D/W = zero (V/Vr)^2 + lift n^2 (Vr/V)^2. Bank and load factor
answer a command in two stages: the command sets a rate, (command - value) / lag, that of the bank at most the roll rate; and the rate
itself comes about with a lag of its own, because an aeroplane has to begin to roll and to pitch. Without that second lag the bank leads
an aeroplane's by a tenth of a second, and a turn of a second ends more than a metre too far aside.
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from vosc.vec import G_MPS2

Array = np.ndarray
SLOWEST_MPS = 1.0  # below this the equations mean nothing
STEEPEST_COS = 0.05


@dataclass(frozen=True)
class Aeroplane:
    """What a prediction knows of an aircraft. Radians, m/s, seconds; thrust and drag over weight, drag at ``reference_mps``."""

    bank_lag_s: float
    roll_start_s: float  # lag of the roll rate; 0: it is there at once
    roll_rate_radps: float
    load_lag_s: float
    load_start_s: float  # lag of the load factor's rate; 0: it is there at once
    thrust_lag_s: float
    thrust_min: float
    thrust_max: float
    thrust_per_mps: float
    drag_zero: float
    drag_lift: float
    reference_mps: float
    bank_rad: float  # what the guidance may ask for: this bank ...
    load_min: float
    load_max: float  # ... and load factors between these,
    one_g_mps: float  # or (V / this)^2 where the wing lifts no more at its greatest angle of attack,
    slowest_mps: float  # and less near this airspeed:
    unload: float  # load factor given up per share of speed lost
    least_lift_mps2: float  # the bank serves at least this lift upwards
    turn_1ps: float  # rate at which the guidance turns a velocity into the direction that is asked for


class Motion(NamedTuple):
    """Where a batch is and how it moves, an array (n,) each: ENU metres, velocity through the air, attitude and the rates of it."""

    x: Array
    y: Array
    z: Array
    speed: Array
    climb: Array
    track: Array
    bank: Array
    roll_rate: Array
    load: Array
    load_rate: Array
    thrust: Array


def drag(aeroplane: Aeroplane, speed: Any, load: Any) -> Any:
    """Drag over weight."""
    square = (speed / aeroplane.reference_mps) ** 2
    return aeroplane.drag_zero * square + aeroplane.drag_lift * load * load / square


def thrust_wanted(aeroplane: Aeroplane, speed: Any, load: Any, sin_climb: Any, wanted_mps: Any) -> Any:
    """Thrust over weight that holds an airspeed, within what there is."""
    raw = drag(aeroplane, speed, load) + sin_climb + aeroplane.thrust_per_mps * (wanted_mps - speed)
    return np.minimum(np.maximum(raw, aeroplane.thrust_min), aeroplane.thrust_max)


def step(aeroplane: Aeroplane, now: Motion, bank: Any, load: Any, thrust: Any, dt_s: float, wind: tuple[float, float, float]) -> Motion:
    """The batch after ``dt_s`` in which bank, load factor and thrust are commanded so; the air moves with ``wind`` (ENU m/s)."""
    roll, roll_rate = _answered(
        bank - now.bank, now.roll_rate, aeroplane.bank_lag_s, aeroplane.roll_start_s, dt_s, aeroplane.roll_rate_radps
    )
    lift, load_rate = _answered(load - now.load, now.load_rate, aeroplane.load_lag_s, aeroplane.load_start_s, dt_s, math.inf)
    engine = now.thrust + (1.0 - math.exp(-dt_s / aeroplane.thrust_lag_s)) * (thrust - now.thrust)
    middle_bank, middle_load = now.bank + 0.5 * roll, now.load + 0.5 * lift
    aside, upward = middle_load * np.sin(middle_bank), middle_load * np.cos(middle_bank)
    lifted = aeroplane.drag_lift * middle_load * middle_load

    def rates(speed: Array, cos: Array, sin: Array) -> tuple[Array, Array, Array]:
        turn = G_MPS2 / speed
        square = (speed / aeroplane.reference_mps) ** 2
        accel = G_MPS2 * (engine - aeroplane.drag_zero * square - lifted / square - sin)
        return accel, turn * (upward - cos), turn * aside / np.maximum(cos, STEEPEST_COS)

    half = 0.5 * dt_s
    faster, steeper, around = rates(now.speed, np.cos(now.climb), np.sin(now.climb))
    speed = np.maximum(now.speed + half * faster, SLOWEST_MPS)
    climb, track = now.climb + half * steeper, now.track + half * around
    cos, sin = np.cos(climb), np.sin(climb)
    faster, steeper, around = rates(speed, cos, sin)
    flat = speed * cos
    return Motion(
        now.x + dt_s * (flat * np.sin(track) + wind[0]),
        now.y + dt_s * (flat * np.cos(track) + wind[1]),
        now.z + dt_s * (speed * sin + wind[2]),
        np.maximum(now.speed + dt_s * faster, SLOWEST_MPS),
        now.climb + dt_s * steeper,
        now.track + dt_s * around,
        now.bank + roll,
        roll_rate,
        now.load + lift,
        load_rate,
        engine,
    )


def _answered(error: Array, rate: Array, lag_s: float, start_s: float, dt_s: float, most: float) -> tuple[Array, Array]:
    """What is gained over ``dt_s`` towards a command that is ``error`` away, no faster than ``most``; and the rate at the end."""
    if start_s <= 0.0:
        gained = np.minimum(np.maximum((1.0 - math.exp(-dt_s / lag_s)) * error, -most * dt_s), most * dt_s)
        return gained, gained / dt_s
    wanted = np.minimum(np.maximum(error / lag_s, -most), most)
    keeps = math.exp(-dt_s / start_s)
    gained = wanted * dt_s + (rate - wanted) * (start_s * (1.0 - keeps))
    return gained, wanted + (rate - wanted) * keeps
