"""What tuned gains must show before they are written: steps of every loop, margins, and a course of bends near the turn limit."""

from typing import NamedTuple

import numpy as np

from testbed.airframe.identify import bank_step, load_factor_step, speed_step, surface_lags
from testbed.airframe.linearise import linearise
from testbed.airframe.loops import lateral, pitch
from testbed.airframe.proof_courses import random_bends, turn_radius
from testbed.airframe.trial import follow
from testbed.airframe.trim import steepest_climb
from testbed.core.units import DEG
from testbed.flight.plants.aircraft import Aircraft
from testbed.flight.plants.rig import Rig


class Check(NamedTuple):
    """One line of the verification."""

    what: str
    value: float
    bound: float
    unit: str

    @property
    def passed(self) -> bool:
        """NaN does not pass."""
        return self.value <= self.bound


def line(check: Check) -> str:
    """The check in a line of a report."""
    return f"{check.what:46} {check.value:8.3g} (at most {check.bound:.3g}) {check.unit:2}"


def verify(aircraft: Aircraft) -> list[Check]:
    """Steps of every loop on the real plant, margins of the linear ones, and a course of bends."""
    speed = aircraft.autopilot.reference_mps
    model = linearise(Rig(aircraft, speed))
    lags = surface_lags(aircraft, model)
    small, _ = bank_step(aircraft, speed)
    large, turning = bank_step(aircraft, speed, 0.5 * aircraft.limits.bank_deg * DEG)
    lift, _ = load_factor_step(aircraft, speed)
    faster = speed_step(aircraft, speed)["airspeed"] - speed
    radius = 1.5 * turn_radius(speed, aircraft.limits.bank_deg * DEG)
    climb = 0.5 * steepest_climb(aircraft, speed)
    flights = [follow(aircraft, random_bends(np.random.default_rng(k), radius, climb), speed) for k in range(4)]
    return [
        Check("greatest sensitivity, aileron and rudder", lateral(model, aircraft.autopilot, lags).sensitivity(), 1.45, ""),
        Check("greatest sensitivity, elevator", pitch(model, aircraft.autopilot, lags).sensitivity(), 1.45, ""),
        Check("bank step 10 deg, overshoot", 100.0 * small.overshoot, 5.0, "%"),
        Check("bank step 10 deg, settled within 5 % after", small.settling_s(), 10.0 * small.lag_s(1.0), "s"),
        Check("bank step to half the limit, overshoot", 100.0 * large.overshoot, 5.0, "%"),
        Check("bank step to half the limit, sideslip after 5 s", abs(float(turning["beta"][-1])) / DEG, 0.5, "deg"),
        Check("load factor step 0.2, overshoot", 100.0 * lift.overshoot, 12.0, "%"),
        Check("load factor step 0.2, off after 5 s", 100.0 * abs(1.0 - float(lift.response[-1])), 6.0, "%"),
        Check("speed step 2 m/s, overshoot", 50.0 * max(0.0, float(faster.max()) - 2.0), 25.0, "%"),
        Check("speed step 2 m/s, off after 30 s", 50.0 * abs(float(faster[-1]) - 2.0), 10.0, "%"),
        Check("bends at 1.5 turn radii, worst cross-track RMS", max(flight.rms_m for flight in flights), 0.5, "m"),
    ]
