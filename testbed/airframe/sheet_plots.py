"""The pictures of the data sheet."""

import math
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from testbed.airframe.chart import Line, chart
from testbed.airframe.identify import bank_step, load_factor_step, speed_step
from testbed.airframe.linearise import LATERAL, LONGITUDINAL, LinearModel, respond
from testbed.airframe.trim import LiftCurve
from testbed.core.units import DEG
from testbed.flight.plants.aircraft import Aircraft
from testbed.flight.plants.rig import Controls, Rig

if TYPE_CHECKING:
    from testbed.airframe.performance import Performance

Array = np.ndarray
Plot = tuple[str, Markup]
PULSE, PULSE_S = 0.05, 4.0


def plots(aircraft: Aircraft, model: LinearModel, performance: "Performance", curve: LiftCurve) -> dict[str, list[Plot]]:
    """Caption and SVG of every picture, by section."""
    return {
        "trim": _trims(aircraft, performance, curve),
        "modes": _linear_against_flown(aircraft, model),
        "limits": _full_controls(aircraft),
        "loops": _steps(aircraft),
    }


def _trims(aircraft: Aircraft, performance: "Performance", curve: LiftCurve) -> list[Plot]:
    speeds = np.array(performance.speeds_mps)

    def lines(field: str, scale: float) -> list[Line]:
        return [
            Line(
                speeds,
                np.array([getattr(p, field) / scale if p else math.nan for p in row]),
                f"{climb / DEG:.0f} deg",
                1 + k % 5,
                marks=True,
            )
            for k, (climb, row) in enumerate(zip(performance.climbs_rad, performance.trims, strict=True))
        ]

    limits = aircraft.limits
    usable = curve.lift_factor > -0.2
    lift = Line(curve.alpha_rad[usable] / DEG, curve.lift_factor[usable], colour=1)
    steepest = Line(speeds, np.array(performance.steepest_rad) / DEG, colour=1, marks=True)
    return [
        ("Angle of attack in straight flight, by climb.", chart(lines("alpha_rad", DEG), "airspeed, m/s", "alpha, deg")),
        ("Throttle in straight flight, by climb.", chart(lines("throttle", 1.0), "airspeed, m/s", "throttle", y_range=(0.0, 1.0))),
        ("The steepest climb that trims.", chart([steepest], "airspeed, m/s", "climb, deg", y_range=(0.0, None))),
        (
            f"Trimmed lift at {curve.speed_mps:g} m/s, up to its maximum, and the load factor that guidance may ask for.",
            chart([lift], "alpha, deg", "lift / weight", levels=[(limits.load_factor_max, f"limit {limits.load_factor_max:g}")]),
        ),
    ]


def _linear_against_flown(aircraft: Aircraft, model: LinearModel) -> list[Plot]:
    """Small steps of elevator and aileron: the linear model beside the aircraft it was taken from."""
    found = []
    groups = (
        ("elevator", model.a_long, model.b_long[:, 0], LONGITUDINAL, "q", "pitch rate, deg/s"),
        ("aileron", model.a_lat, model.b_lat[:, 0], LATERAL, "p", "roll rate, deg/s"),
        ("rudder", model.a_lat, model.b_lat[:, 1], LATERAL, "r", "yaw rate, deg/s"),
    )
    for control, a, b, states, shown, label in groups:
        flown = Rig(aircraft, model.speed_mps).release(PULSE_S, Controls(**{control: PULSE}))
        linear = respond(a, b * PULSE, np.zeros(4), flown["time_s"])[:, states.index(shown)]
        pair = [
            Line(flown["time_s"], (flown[shown] - flown[shown][0]) / DEG, "aircraft", 1),
            Line(flown["time_s"], linear / DEG, "linear model", 2, "dash"),
        ]
        found.append((f"A step of {PULSE:g} of {control}, held.", chart(pair, "time, s", label)))
    return found


def _full_controls(aircraft: Aircraft) -> list[Plot]:
    speed = aircraft.autopilot.reference_mps
    roll = Rig(aircraft, speed).release(2.0, Controls(aileron=1.0))
    seen = roll["bank"] <= 90.0 * DEG
    seen &= np.cumsum(~seen) == 0
    pull = Rig(aircraft, speed).release(2.0, Controls(elevator=-1.0))
    time = roll["time_s"]
    return [
        (
            "Full aileron from level flight: bank.",
            chart([Line(time[seen], roll["bank"][seen] / DEG)], "time, s", "bank, deg", levels=[(45.0, "45 deg")]),
        ),
        ("Full aileron: roll rate.", chart([Line(time[seen], roll["p"][seen] / DEG)], "time, s", "roll rate, deg/s")),
        (
            "Full up elevator from level flight: load factor, beyond the limit that guidance keeps.",
            chart(
                [Line(time, pull["load_factor"])],
                "time, s",
                "load factor, g",
                levels=[(limit := aircraft.limits.load_factor_max, f"limit {limit:g}")],
            ),
        ),
    ]


def _steps(aircraft: Aircraft) -> list[Plot]:
    speed = aircraft.autopilot.reference_mps
    half = 0.5 * aircraft.limits.bank_deg
    small, large = bank_step(aircraft, speed)[1], bank_step(aircraft, speed, half * DEG)[1]
    lift, fast = load_factor_step(aircraft, speed)[1], speed_step(aircraft, speed)

    def told(flown: dict[str, Array], name: str, scale: float, colour: int) -> list[Line]:
        shown = flown["time_s"] <= 3.0
        command = Line(flown["time_s"][shown], flown[f"{name}_cmd"][shown] / scale, "", 0, "dot")
        return [command, Line(flown["time_s"][shown], flown[name][shown] / scale, "", colour)]

    banks = [*told(small, "bank", DEG, 1), *told(large, "bank", DEG, 2)]
    airspeed = [
        Line(fast["time_s"], np.full(len(fast["time_s"]), speed + 2.0), "commanded", 0, "dot"),
        Line(fast["time_s"], fast["airspeed"], "airspeed", 1),
    ]
    return [
        (f"Bank commands of 10 and {half:g} deg (dotted) and what is flown.", chart(banks, "time, s", "bank, deg")),
        ("A load factor command of 1.2 (dotted) and what is flown.", chart(told(lift, "load_factor", 1.0, 1), "time, s", "load factor, g")),
        ("An airspeed command 2 m/s up; height is held.", chart(airspeed, "time, s", "airspeed, m/s")),
    ]
