"""One decision of the planner ``survivor``: manoeuvres that the aircraft could fly now, where each would lead, and which to take.

Taken is the one that deviates least from the direction in which the flight was going, of those that keep the margin from every sphere;
where none does, the one with the most clearance. What flies already is kept as long as it keeps the margin and nothing is much better,
so that a decision that is taken anew does not swing between equals. The margin shrinks as the encounter comes near; what is won by that
is not spent: a manoeuvre that deviates less must keep the margin that was asked for at first.

A state without a roll rate is that of a point on rails, which takes every direction at once and is predicted so.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol

import numpy as np

from testbed.core.frames import Vec3
from testbed.core.units import DEG, G0_MPS2
from testbed.flight.plants.base import State
from testbed.flight.sensing.base import Seen
from vosc.predict import Aeroplane, Directions, Flown, Motion, Programmes, Spheres, at_once, fly_on, least_clearance
from vosc.predict.aeroplane import drag

Array = np.ndarray
RINGS = np.array([3.0, 6.0, 10.0, 14.0, 19.0, 25.0, 32.0, 40.0, 50.0, 62.0, 75.0]) * DEG
ROUND = np.arange(16) * math.tau / 16
NEAR = np.array([1.0, 2.5]) * DEG  # rings about what flies already
NEAR_ROUND = np.arange(8) * math.tau / 8
STEEPEST_SIN = math.sin(60.0 * DEG)
ASIDE_COS = math.cos(84.0 * DEG)  # a direction further aside is turned to by way of another (``steering.py``)
BANKS, LOADS = np.linspace(-1.0, 1.0, 17), np.array([0.0, 0.33, 0.67, 1.0, 3.0])
"""Shares of what the limits allow. Three times the greatest load factor is asked for to have all of it while the aircraft still rolls."""
LASTS_S = np.array([0.3, 0.6, 1.0, 1.5, 2.5])
AFTER_S, SHORTEST_S, LONGEST_S = 0.8, 1.2, 5.0  # looked at: so long past the closest approach, and between these
FINE_S, FINE_UNTIL_S, COARSE_S = 0.05, 1.0, 0.1
KEPT_RAD, KEPT_M = 2.0 * DEG, 0.5  # what flies is given up for so much less deviation, or more clearance
REACH_STEP_S, REACH_MARGIN_M = 0.25, 20.0  # an obstacle further away than any manoeuvre leads is left out
NO_LAG_S = 1e-4
SLOWING = 0.97  # an aircraft at its least airspeed may lose a little more


class Held(NamedTuple):
    """What is flown: a unit direction over the ground, or bank (rad) and load factor until a time (s)."""

    direction: Vec3 | None
    bank: float = 0.0
    load: float = 1.0
    until_s: float = 0.0


class Choice(NamedTuple):
    """A decision, and what is expected of it: clearance (m) from the nearest surface, ``to_go_s`` from now, and the track."""

    held: Held
    clearance_m: float
    margin_m: float  # what was asked for at that time to go
    to_go_s: float
    deviation_rad: float
    keeps: bool
    time_s: Array  # of the flight
    place: Array  # (3, t)
    load_rate: Array

    def expected(self, time_s: float) -> tuple[Vec3, float]:
        """Place and rate of the load factor at a time of the flight."""
        x, y, z = (float(np.interp(time_s, self.time_s, each)) for each in self.place)
        return (x, y, z), float(np.interp(time_s, self.time_s, self.load_rate))


class MarginAt(Protocol):
    """Margins (n,) for times to go (n,)."""

    def __call__(self, time_s: Array) -> Array: ...


class Situation(NamedTuple):
    """What a decision is taken on."""

    time_s: float
    state: State
    load_rate: float  # of the load factor, 1/s, as far as it is known
    wind: Vec3
    base: Vec3  # unit vector over the ground: where the flight was going
    known: Sequence[Seen]
    flying: Held | None
    asked_m: float  # margin of the first decision


class Outlook:
    """Predictions of one flight's aircraft. ``speed_mps`` is what is held, of the airspeed or over the ground."""

    def __init__(self, aeroplane: Aeroplane, margin: MarginAt, speed_mps: float, airspeed_held: bool, programmes: bool) -> None:
        self._aeroplane, self._margin, self._programmes = aeroplane, margin, programmes
        self._speed, self._airspeed_held = speed_mps, airspeed_held
        at_once = {"bank_lag_s": NO_LAG_S, "load_lag_s": NO_LAG_S, "roll_start_s": 0.0, "load_start_s": 0.0, "roll_rate_radps": math.inf}
        self._railed = replace(aeroplane, **at_once)

    def decide(self, now: Situation) -> Choice:
        """The manoeuvre to take."""
        return self._taken(now, self._candidates(now))

    def expect(self, now: Situation) -> Choice:
        """What is to be expected of what flies already, and of nothing else."""
        assert now.flying is not None
        return self._taken(now, [now.flying])

    def _candidates(self, now: Situation) -> list[Held]:
        """What flies already first, if anything does."""
        flying = [now.flying] if now.flying else []
        return flying + (self._banks(now) if self._programmes else _directions(now))

    def _banks(self, now: Situation) -> list[Held]:
        a = self._aeroplane
        shares = LOADS[LOADS <= 1.0] if math.isnan(now.state.p) else LOADS
        loads = np.concatenate([[0.5 * (1.0 + a.load_min), a.load_min], 1.0 + (a.load_max - 1.0) * shares])
        return [Held(None, 0.0, 1.0, now.time_s)] + [
            Held(None, float(bank), float(load), now.time_s + float(lasts))
            for bank in BANKS * a.bank_rad
            for load in loads
            for lasts in LASTS_S
            if load > 1.0 or bank == 0.0  # to unload in a bank turns little
        ]

    def _taken(self, now: Situation, candidates: list[Held]) -> Choice:
        """The one to take, of manoeuvres that are all directions or all programmes."""
        spheres = _in_reach(now, self._aeroplane)
        times = _times(now, spheres)
        flown, cos = self._flown(now, candidates, times)
        clearance, to_go = least_clearance(flown, spheres)
        clearance = np.where(np.isfinite(clearance), clearance, -np.inf)
        margin = self._margin(to_go)
        deviation = np.arccos(np.clip(np.where(np.isfinite(cos), cos, -1.0), -1.0, 1.0))
        fast = flown.least_speed >= min(self._aeroplane.slowest_mps, SLOWING * now.state.airspeed)
        k, keeps = chosen(clearance - margin, clearance - np.maximum(margin, now.asked_m), deviation, fast, now.flying is not None)
        place = np.array([flown.x[:, k], flown.y[:, k], flown.z[:, k]])
        numbers = (float(clearance[k]), float(margin[k]), float(to_go[k]), float(deviation[k]))
        return Choice(candidates[k], *numbers, keeps, now.time_s + times, place, flown.load_rate[:, k])

    def _flown(self, now: Situation, candidates: list[Held], times: Array) -> tuple[Flown, Array]:
        """Where they lead, and the cosine of what each deviates by: the direction held, or the one in which a programme ends."""
        on_rails = math.isnan(now.state.p)
        start, base = _started(self._aeroplane, now, len(candidates)), now.base
        aeroplane = self._railed if on_rails else self._aeroplane
        told = (now.wind, self._speed, self._airspeed_held)
        if not self._programmes:
            x, y, z = np.array([one.direction for one in candidates]).T
            to = Directions(x, y, z)
            flown = at_once(start, to, times, now.wind) if on_rails else fly_on(aeroplane, start, to, times, *told)
            return flown, base[0] * x + base[1] * y + base[2] * z
        bank, load, until = np.array([(one.bank, one.load, one.until_s) for one in candidates]).T
        flown = fly_on(aeroplane, start, Programmes(bank, load, until - now.time_s), times, *told)
        speed = np.sqrt(flown.end_vx**2 + flown.end_vy**2 + flown.end_vz**2)
        along = base[0] * flown.end_vx + base[1] * flown.end_vy + base[2] * flown.end_vz
        return flown, along / np.maximum(speed, 1e-9)


def chosen(spare_m: Array, spare_of_first_m: Array, deviation_rad: Array, fast: Array, first_flies: bool) -> tuple[int, bool]:
    """Which of the batch (n,) to take, and whether it keeps the margin. ``spare_m`` is clearance less margin, and less the margin that was
    asked for at first; ``fast``: it keeps its airspeed; ``first_flies``: the first of them is what is flown already.
    """
    if not fast.any():
        fast = np.ones_like(fast)
    keeping = fast & (spare_m >= 0.0)
    if keeping.any():
        holds = first_flies and bool(keeping[0])
        cost = np.where(fast & (spare_of_first_m >= 0.0) if holds else keeping, deviation_rad, np.inf)
        k = int(np.argmin(cost))
        return (0 if holds and deviation_rad[0] <= cost[k] + KEPT_RAD else k), True
    worth = np.where(fast, spare_m, -np.inf)
    k = int(np.argmax(worth))
    return (0 if first_flies and worth[0] >= worth[k] - KEPT_M else k), False


def _directions(now: Situation) -> list[Held]:
    """Rings about where the flight was going, and finer ones about what flies already."""
    found = [now.base, *_rings(now.base, RINGS, ROUND)]
    if now.flying and now.flying.direction:
        found += _rings(now.flying.direction, NEAR, NEAR_ROUND)
    velocity = np.array(now.state[3:6])
    tried = np.array(found)
    ahead = tried @ velocity >= ASIDE_COS * np.linalg.norm(velocity)
    shallow = np.abs(tried[:, 2]) <= max(STEEPEST_SIN, abs(now.base[2]))
    kept = tried[ahead & shallow]
    return [Held((float(x), float(y), float(z))) for x, y, z in (kept if len(kept) else tried[:1])]


def _rings(axis: Vec3, off: Array, around: Array) -> list[Vec3]:
    """Unit vectors at these angles from an axis, at these angles round it."""
    x, y, _ = axis
    flat = math.hypot(x, y)
    left = np.array([-y / flat, x / flat, 0.0]) if flat > 1e-6 else np.array([0.0, 1.0, 0.0])
    up = np.cross(axis, left)
    angle, turn = (each.ravel()[:, None] for each in np.meshgrid(off, around, indexing="ij"))
    vectors = np.cos(angle) * np.array(axis) + np.sin(angle) * (np.cos(turn) * left + np.sin(turn) * up)
    return [(float(a), float(b), float(c)) for a, b, c in vectors]


def _in_reach(now: Situation, aeroplane: Aeroplane) -> Spheres:
    """The spheres that any manoeuvre could meet within the longest prediction; where there is none, all."""
    pos = np.array([one.at(now.time_s) for one in now.known]).reshape(-1, 3)
    vel, radius = np.array([one.vel for one in now.known]).reshape(-1, 3), np.array([one.radius_m for one in now.known])
    times, relative = np.arange(0.0, LONGEST_S + 0.01, REACH_STEP_S)[:, None], vel - np.array(now.state[3:6])
    apart = np.linalg.norm(pos - np.array(now.state[:3]) + relative * times[..., None], axis=2)
    pull_m = 0.5 * G0_MPS2 * (max(aeroplane.load_max, -aeroplane.load_min) + 1.0) * times**2
    between_m = 0.5 * REACH_STEP_S * np.linalg.norm(relative, axis=1)
    near = (apart - pull_m - between_m < radius + REACH_MARGIN_M).any(axis=0)
    near = near if near.any() else np.ones_like(near)
    return Spheres(pos[near], vel[near], radius[near])


def _times(now: Situation, spheres: Spheres) -> Array:
    """Past the last closest approach of all, flying straight on; fine at first, while the aircraft still rolls."""
    apart, relative = spheres.pos_m - np.array(now.state[:3]), spheres.vel_mps - np.array(now.state[3:6])
    closest = -(apart * relative).sum(axis=1) / np.maximum((relative * relative).sum(axis=1), 1e-9)
    last = min(max(float(closest.max(initial=0.0)) + AFTER_S, SHORTEST_S), LONGEST_S)
    fine = np.arange(0.0, FINE_UNTIL_S - 0.5 * FINE_S, FINE_S)
    return np.concatenate([fine, np.arange(FINE_UNTIL_S, last + COARSE_S, COARSE_S)])


def _started(aeroplane: Aeroplane, now: Situation, count: int) -> Motion:
    """The state, as often as there are manoeuvres. The thrust, which nobody sees, is that of steady flight."""
    state = now.state
    vx, vy, vz = (v - w for v, w in zip(state[3:6], now.wind, strict=True))
    flat = math.hypot(vx, vy)
    speed = max(math.hypot(flat, vz), 1.0)
    climb, track = math.atan2(vz, flat), math.atan2(vx, vy)
    roll_rate = 0.0 if math.isnan(state.p) else state.p
    thrust = min(max(float(drag(aeroplane, speed, 1.0)) + math.sin(climb), aeroplane.thrust_min), aeroplane.thrust_max)
    values = (*state[:3], speed, climb, track, state.bank, roll_rate, state.load_factor, now.load_rate, thrust)
    return Motion(*(np.full(count, value) for value in values))
