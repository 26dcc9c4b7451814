"""What linearising does not see, from time responses of the non-linear aircraft: servo and engine lags, roll rate, closed-loop lags."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from testbed.airframe.linearise import LATERAL, LinearModel, respond
from testbed.airframe.trial import GUIDANCE_HZ, PLANT_HZ, STILL, hold
from testbed.core.frames import Vec3
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.air import CALM
from testbed.flight.plants.aircraft import Aircraft
from testbed.flight.plants.base import Command, State
from testbed.flight.plants.rig import Controls, Rig

Array = np.ndarray
SMALL = 0.05  # of full aileron, or of full throttle
KICK_S = 0.3  # in this time the linear model and the aircraft still agree, servo apart
STEP_BANK_RAD = 10.0 * DEG
STEP_LOAD_FACTOR = 0.2
STEP_GUST = 0.01  # of the airspeed
SETTLED_S = 5.0


def sampling_lag_s() -> float:
    """From sampled state to the middle of the hold of its command, and half a step of integration."""
    return 0.5 / GUIDANCE_HZ + 0.5 / PLANT_HZ


def servo_lag_s(aircraft: Aircraft, model: LinearModel) -> float:
    """First-order lag (s) between aileron command and surface that explains the first of the roll response best."""
    flown = Rig(aircraft, model.speed_mps).release(KICK_S, Controls(aileron=SMALL))
    time_s, rate = flown["time_s"], flown["p"]
    ideal = respond(model.a_lat, model.b_lat[:, 0] * SMALL, np.zeros(4), time_s)[:, LATERAL.index("p")]
    lags = np.arange(0.0, 0.3, 0.001)
    errors = [float(np.sum((_lagged(ideal, time_s, lag) - rate) ** 2)) for lag in lags]
    lag = float(lags[int(np.argmin(errors))])
    return lag if lag > 1.0 / PLANT_HZ else 0.0


def surface_lags(aircraft: Aircraft, model: LinearModel) -> tuple[float, float, float]:
    """What stands between command and surface: servo, command filter of the plant, sampling (s)."""
    return servo_lag_s(aircraft, model), aircraft.command_lag_s, sampling_lag_s()


def _lagged(signal: Array, time_s: Array, lag_s: float) -> Array:
    """A first-order lag, exact for a signal that is held over each step."""
    if lag_s == 0.0:
        return signal
    keep = math.exp(-float(time_s[1] - time_s[0]) / lag_s)
    out = np.empty_like(signal)
    out[0] = signal[0]
    for k in range(1, len(signal)):
        out[k] = keep * out[k - 1] + (1.0 - keep) * 0.5 * (signal[k] + signal[k - 1])
    return out


def thrust_lag_s(aircraft: Aircraft, speed_mps: float) -> float:
    """Time (s) in which the thrust makes 63 % of its way after a small step of the throttle."""
    flown = Rig(aircraft, speed_mps).release(12.0, Controls(throttle=SMALL))
    thrust = flown["thrust"]
    share = (thrust - thrust[0]) / (thrust[np.argmax(np.abs(thrust - thrust[0]))] - thrust[0])
    return _crossing(flown["time_s"], share, 1.0 - math.exp(-1.0))


class Rolling(NamedTuple):
    """Full aileron from level flight."""

    time_to_45_s: float
    peak_rate_radps: float  # on the way to 90 deg of bank
    peak_load_factor: float  # full up elevator


def full_control(aircraft: Aircraft, speed_mps: float) -> Rolling:
    """The two manoeuvres that show what the controls can do at most."""
    roll = Rig(aircraft, speed_mps).release(4.0, Controls(aileron=1.0))
    on_the_way = np.cumsum(roll["bank"] > 90.0 * DEG) == 0
    pull = Rig(aircraft, speed_mps).release(2.0, Controls(elevator=-1.0))
    return Rolling(
        _crossing(roll["time_s"], roll["bank"], 45.0 * DEG), float(roll["p"][on_the_way].max()), float(pull["load_factor"].max())
    )


def _crossing(time_s: Array, signal: Array, level: float) -> float:
    """First time at which a signal passes a level; NaN if it never does."""
    if not (signal >= level).any():
        return math.nan
    k = max(1, int(np.argmax(signal >= level)))
    return float(np.interp(level, signal[k - 1 : k + 1], time_s[k - 1 : k + 1]))


class StepResponse(NamedTuple):
    """A unit step of a command as the plant answers it, flown by the autopilot."""

    time_s: Array
    response: Array  # 1 = what was asked

    @property
    def overshoot(self) -> float:
        """Greatest excess over the command, as a share of the step."""
        return max(0.0, float(self.response.max()) - 1.0)

    @property
    def rise_s(self) -> float:
        """From 10 to 90 %."""
        return _crossing(self.time_s, self.response, 0.9) - _crossing(self.time_s, self.response, 0.1)

    def settling_s(self, band: float = 0.05) -> float:
        """After this time the response stays within the band about the command."""
        outside = np.flatnonzero(np.abs(self.response - 1.0) > band)
        return float(self.time_s[min(outside[-1] + 1, len(self.time_s) - 1)]) if len(outside) else 0.0

    def transfer(self, frequency_rad_s: Array) -> Array:
        """H(j w) of the closed loop: 1 - j w times the transform of the error, which ends at what is left of it."""
        error = 1.0 - self.response
        left = error[-1]
        jw = 1j * np.asarray(frequency_rad_s)[:, None]
        dt = self.time_s[1] - self.time_s[0]
        kernel = np.exp(-jw * self.time_s[None, :])
        transform = np.sum((error - left)[None, :] * kernel, axis=1) * dt - 0.5 * dt * (error[0] - left)
        return np.asarray(1.0 - left - jw[:, 0] * transform)

    def lag_s(self, frequency_rad_s: float) -> float:
        """The delay (s) that the loop is worth at a frequency."""
        return float(-np.angle(self.transfer(np.array([frequency_rad_s])))[0] / frequency_rad_s)


def bank_step(aircraft: Aircraft, speed_mps: float, step_rad: float = STEP_BANK_RAD) -> tuple[StepResponse, dict[str, Array]]:
    """Bank command from level, height held by the load factor that the bank needs."""

    def command(time_s: float, state: State) -> Command:
        return Command(step_rad if time_s >= 0.0 else 0.0, math.cos(state.pitch) / math.cos(state.bank), speed_mps, 0.0)

    flown = hold(aircraft, speed_mps, SETTLED_S, command)
    return StepResponse(flown["time_s"], (flown["bank"] - flown["bank"][0]) / step_rad), flown


def turn_response(flown: dict[str, Array], step_rad: float = STEP_BANK_RAD) -> StepResponse:
    """The same step as the path sees it: the bank of a coordinated turn that bends the track as the flight did.

    It is later than the bank where a rudder that keeps the nose in the wind pushes the aircraft sideways while it rolls.
    """
    speed, track = np.hypot(flown["vx"], flown["vy"]), np.unwrap(np.arctan2(flown["vx"], flown["vy"]))
    bank = np.arctan(speed * np.gradient(track, flown["time_s"]) / G0_MPS2)
    return StepResponse(flown["time_s"], (bank - bank[0]) / step_rad)


def load_factor_step(aircraft: Aircraft, speed_mps: float, step: float = STEP_LOAD_FACTOR) -> tuple[StepResponse, dict[str, Array]]:
    """Load-factor command from level flight, wings level."""

    def command(_time_s: float, state: State) -> Command:
        return Command(0.0, 1.0 + step, speed_mps, math.sin(state.pitch - state.alpha))

    flown = hold(aircraft, speed_mps, SETTLED_S, command)
    return StepResponse(flown["time_s"], (flown["load_factor"] - flown["load_factor"][0]) / step), flown


def gust_step(aircraft: Aircraft, speed_mps: float, direction: Vec3) -> tuple[Array, Array]:
    """Level flight towards +y into a step of wind, load factor 1 commanded: time (s) since the gust is there, and what it adds.

    That is load factor per gust speed over airspeed (per radian, for a vertical gust), beside the same flight in still air. The mean
    of gusts that come at each tick between two commands: one that comes just after a command waits longest for an answer.
    """
    x, y, z = (STEP_GUST * speed_mps * d for d in direction)

    def flown(from_tick: float) -> Array:
        from_s = (from_tick - 0.5) / PLANT_HZ
        air = replace(CALM, steady=None, at=lambda time_s, _pos: (x, y, z) if time_s > from_s else STILL)
        return hold(aircraft, speed_mps, SETTLED_S, lambda _, s: Command(0.0, 1.0, speed_mps, math.sin(s.pitch - s.alpha)), air)[
            "load_factor"
        ]

    still, ticks = flown(math.inf), range(1, PLANT_HZ // GUIDANCE_HZ + 1)
    count = len(still) - ticks[-1]
    answers = [(flown(tick) - still)[tick : tick + count] / STEP_GUST for tick in ticks]
    return np.arange(count) / PLANT_HZ, np.mean(answers, axis=0)


class GustAnswer(NamedTuple):
    """How the closed loops take out a gust load; see ``plants/point_mass.py``."""

    frequency_rad_s: float
    damping: float
    surge_s: float


def gust_answer(aircraft: Aircraft, speed_mps: float, per_rad: float) -> GustAnswer:
    """By least squares from flown steps: frequency and damping from a vertical gust, then the impulse that a head-on gust leaves."""
    from scipy.optimize import least_squares

    time_s, rising = gust_step(aircraft, speed_mps, (0.0, 0.0, 1.0))

    def error(guess: Array) -> Array:
        return _second_order(time_s, guess[0], guess[1])[0] - rising / per_rad

    frequency, damping = least_squares(error, [5.0, 0.5], bounds=([0.1, 0.05], [50.0, 0.99])).x.tolist()
    load, impulse = _second_order(time_s, frequency, damping)
    left = 0.5 * gust_step(aircraft, speed_mps, (0.0, -1.0, 0.0))[1] - load  # lift goes as the square: the jump is 2
    return GustAnswer(frequency, damping, float(left @ impulse / (impulse @ impulse)))


def _second_order(time_s: Array, frequency: float, damping: float) -> tuple[Array, Array]:
    """Steps of s^2 and of w^2 s (which has an area of 1) over s^2 + 2 d w s + w^2."""
    decay = damping * frequency
    ringing = frequency * math.sqrt(1.0 - damping * damping)
    keep, sine = np.exp(-decay * time_s), np.sin(ringing * time_s) / ringing
    return keep * (np.cos(ringing * time_s) - decay * sine), frequency * frequency * keep * sine


def speed_step(aircraft: Aircraft, speed_mps: float, step_mps: float = 2.0) -> dict[str, Array]:
    """Airspeed command from level flight."""

    def command(_time_s: float, state: State) -> Command:
        climb_rate = -state.vz / speed_mps
        return Command(0.0, math.cos(state.pitch) + 1.5 * climb_rate, speed_mps + step_mps, 0.0)

    return hold(aircraft, speed_mps, 30.0, command)
