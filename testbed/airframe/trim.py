"""Straight flight: trims over speed and climb, the steepest climb, the trimmed lift curve and the stall it ends in."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from testbed.core.units import DEG
from testbed.flight.plants.aircraft import Aircraft
from testbed.flight.plants.base import TrimFailedError
from testbed.flight.plants.rig import Controls, Reaction, Rig, level

Array = np.ndarray
CLIMB_STEP_RAD = 0.25 * DEG
MOST_CLIMB_STEPS = 240
LIFT_STEP_RAD = 0.5 * DEG
HIGHEST_ALPHA_RAD = 30.0 * DEG


class TrimPoint(NamedTuple):
    """Straight flight without sideslip. The elevator is its trim command, -1..1, + nose down."""

    speed_mps: float
    climb_rad: float
    alpha_rad: float
    throttle: float
    elevator: float


def trim(aircraft: Aircraft, speed_mps: float, climb_rad: float = 0.0) -> TrimPoint | None:
    """The trim at a true airspeed and climb angle, 150 m above sea level; None where there is none."""
    try:
        rig = Rig(aircraft, speed_mps, climb_rad)
    except TrimFailedError:
        return None
    return TrimPoint(speed_mps, climb_rad, rig.alpha_rad, rig.throttle, rig.elevator)


def trim_table(aircraft: Aircraft, speeds_mps: list[float], climbs_rad: list[float]) -> list[list[TrimPoint | None]]:
    """A row for every climb angle, in it a trim for every speed."""
    return [[trim(aircraft, speed, climb) for speed in speeds_mps] for climb in climbs_rad]


def steepest_climb(aircraft: Aircraft, speed_mps: float) -> float:
    """The steepest climb (rad), in quarter degrees, that trims at that airspeed; NaN when level flight does not.

    Sought along the throttle that the trims need, because a trim that fails costs a hundred times one that succeeds.
    """
    reached = trim(aircraft, speed_mps)
    if reached is None:
        return math.nan
    good, failed, ahead = 0, MOST_CLIMB_STEPS, 4
    while failed - good > 1:
        at = good + ahead if good + ahead < failed else (good + failed) // 2
        found = trim(aircraft, speed_mps, at * CLIMB_STEP_RAD)
        if found is None:
            failed = at
        else:
            per_step = (found.throttle - reached.throttle) / (at - good)
            left = (1.0 - found.throttle) / per_step if per_step > 0.0 else MOST_CLIMB_STEPS
            good, reached, ahead = at, found, max(1, int(min(left, MOST_CLIMB_STEPS)))
    return good * CLIMB_STEP_RAD


def fastest_level(aircraft: Aircraft, speed_mps: float, most_mps: float) -> float:
    """The fastest airspeed in whole m/s, up to a bound, that trims in level flight; at least ``speed_mps``, which is taken to."""
    low, high = math.floor(speed_mps), math.floor(most_mps) + 1
    if trim(aircraft, float(high - 1)) is not None:
        return float(high - 1)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if trim(aircraft, float(middle)) is not None else (low, middle)
    return float(low)


@dataclass(frozen=True)
class LiftCurve:
    """Aerodynamic lift and drag in multiples of the weight with the pitching moment trimmed out, up to the first maximum of lift."""

    speed_mps: float
    alpha_rad: Array
    lift_factor: Array
    drag_factor: Array

    @property
    def most(self) -> float:
        """The most lift, in multiples of the weight."""
        return float(self.lift_factor[-1])

    def alpha_for(self, load_factor: float) -> float:
        """Angle of attack (rad) that carries that many times the weight; NaN beyond the most."""
        if load_factor > self.most:
            return math.nan
        return float(np.interp(load_factor, self.lift_factor, self.alpha_rad))

    def lift_at(self, alpha_rad: float) -> float:
        """Multiples of the weight carried at an angle of attack, the most beyond the maximum."""
        return float(np.interp(alpha_rad, self.alpha_rad, self.lift_factor))


def lift_curve(aircraft: Aircraft, speed_mps: float, rig: Rig | None = None) -> LiftCurve:
    """The trimmed lift curve at a true airspeed, with the throttle of the rig's trim (default: level at that speed)."""
    rig = rig or Rig(aircraft, speed_mps)
    alphas: list[float] = []
    lifts: list[float] = []
    drags: list[float] = []
    for alpha in np.arange(0.0, HIGHEST_ALPHA_RAD, LIFT_STEP_RAD):
        balanced = _balanced(rig, float(alpha), speed_mps)
        if balanced is None and not lifts:  # an elevator that balances no small angle of attack
            continue
        if balanced is None or (lifts and balanced.lift_factor <= lifts[-1]):
            break
        alphas.append(float(alpha))
        lifts.append(balanced.lift_factor)
        drags.append(balanced.drag_factor)
    return LiftCurve(speed_mps, np.array(alphas), np.array(lifts), np.array(drags))


def _balanced(rig: Rig, alpha_rad: float, speed_mps: float) -> Reaction | None:
    """Forces with the elevator that takes out the pitching moment; None when no elevator does."""
    motion = level(alpha_rad, speed_mps)
    low, high = -1.0 - rig.elevator, 1.0 - rig.elevator
    moment_low, moment_high = rig.react(motion, Controls(low)).q, rig.react(motion, Controls(high)).q
    if moment_low < 0.0 or moment_high > 0.0:
        return None
    for _ in range(30):  # regula falsi with halving (Illinois)
        middle = high - moment_high * (high - low) / (moment_high - moment_low)
        there = rig.react(motion, Controls(middle))
        if abs(there.q) < 1e-6:
            break
        if there.q * moment_high < 0.0:
            low, moment_low = high, moment_high
        else:
            moment_low *= 0.5
        high, moment_high = middle, there.q
    return there


def stall_speed(aircraft: Aircraft, speed_mps: float) -> float:
    """The airspeed (m/s) at which the most trimmed lift just carries the weight, sought from ``speed_mps`` down."""
    rig = Rig(aircraft, speed_mps)
    for _ in range(8):
        slower = speed_mps / math.sqrt(lift_curve(aircraft, speed_mps, rig).most)
        if abs(slower - speed_mps) < 0.01:
            break
        speed_mps = slower
    return slower
