"""Manoeuvres of a batch, flown on by the guidance within the aircraft's limits: directions that are held, and programmes.

A *direction* is a tangent over the ground that the guidance turns the velocity into. A *programme* is a bank and a load factor for a
time, and straight on after it: what the lift would be at that bank is asked for from the first instant, while the aircraft still rolls.
"""

from typing import NamedTuple, Protocol

import numpy as np

from vosc.predict.aeroplane import Aeroplane, Motion, step, thrust_wanted
from vosc.vec import G_MPS2

Array = np.ndarray
FLAT_MPS = 1e-6  # a velocity with less than this over the ground points straight up or down


class Axes(NamedTuple):
    """A batch's velocity over the ground (n,), and what is up and to the left of it."""

    vx: Array
    vy: Array
    vz: Array
    flat: Array
    speed: Array
    left_x: Array
    left_y: Array
    sin_climb: Array
    cos_climb: Array


class Manoeuvres(Protocol):
    """What a batch does, a manoeuvre for each of it."""

    def demand(self, aeroplane: Aeroplane, time_s: float, axes: Axes) -> tuple[Array, Array, Array]:
        """Lift that is asked for, to the left and up (m/s^2, gravity made up for), and the sine of the climb that the engine is told."""


class Directions(NamedTuple):
    """Held directions: unit tangents (n,) over the ground."""

    x: Array
    y: Array
    z: Array

    def demand(self, aeroplane: Aeroplane, time_s: float, axes: Axes) -> tuple[Array, Array, Array]:  # noqa: ARG002
        along = axes.vx * self.x + axes.vy * self.y + axes.vz * self.z
        gain = aeroplane.turn_1ps * along
        ahead = axes.left_y * self.x - axes.left_x * self.y  # along the horizontal of the velocity
        upward = axes.cos_climb * self.z - axes.sin_climb * ahead
        return gain * (self.x * axes.left_x + self.y * axes.left_y), gain * upward + G_MPS2 * axes.cos_climb, self.z


class Programmes(NamedTuple):
    """Bank (rad, right positive) and load factor, for so long (s, from the start of the prediction); arrays (n,)."""

    bank: Array
    load: Array
    lasts_s: Array

    def demand(self, aeroplane: Aeroplane, time_s: float, axes: Axes) -> tuple[Array, Array, Array]:  # noqa: ARG002
        on = time_s < self.lasts_s
        left = np.where(on, -G_MPS2 * self.load * np.sin(self.bank), 0.0)
        up = np.where(on, G_MPS2 * self.load * np.cos(self.bank), G_MPS2 * axes.cos_climb)
        return left, up, axes.sin_climb


class Flown(NamedTuple):
    """Where the batch goes: times (t,), places (t, n), the velocity over the ground at the end (n,), its least airspeed, its rates."""

    time_s: Array
    x: Array
    y: Array
    z: Array
    end_vx: Array
    end_vy: Array
    end_vz: Array
    least_speed: Array
    load_rate: Array  # (t, n)


def asked_for(aeroplane: Aeroplane, left: Array, up: Array, bank_now: Array, speed: Array) -> tuple[Array, Array]:
    """Bank and load factor that a lift demand becomes, within the aircraft's limits; the load factor at the bank that it has now."""
    bank = np.arctan2(-left, np.maximum(up, aeroplane.least_lift_mps2))
    bank = np.minimum(np.maximum(bank, -aeroplane.bank_rad), aeroplane.bank_rad)
    load = (up * np.cos(bank_now) - left * np.sin(bank_now)) / G_MPS2
    most = np.minimum((speed / aeroplane.one_g_mps) ** 2, aeroplane.load_max)
    most = np.minimum(most, 1.0 - aeroplane.unload + aeroplane.unload / aeroplane.slowest_mps * speed)
    return bank, np.where(load < aeroplane.load_min, aeroplane.load_min, np.minimum(load, most))


def fly_on(
    aeroplane: Aeroplane,
    start: Motion,
    manoeuvres: Manoeuvres,
    times_s: Array,
    wind: tuple[float, float, float],
    speed_mps: float,
    airspeed_held: bool = True,
) -> Flown:
    """The batch from ``start`` (n,) through ``times_s`` (t,), the first of which is the start; ``speed_mps`` is what is held."""
    now, count = start, len(start.x)
    places, rates = np.empty((3, len(times_s), count)), np.empty((len(times_s), count))
    least = np.array(start.speed, dtype=float)
    for k, time_s in enumerate(times_s):
        places[0, k], places[1, k], places[2, k], rates[k] = now.x, now.y, now.z, now.load_rate
        if k + 1 == len(times_s):
            break
        axes = _axes(now, wind)
        left, up, sin_climb = manoeuvres.demand(aeroplane, float(time_s), axes)
        bank, load = asked_for(aeroplane, left, up, now.bank, now.speed)
        wanted = speed_mps if airspeed_held else speed_mps - (axes.speed - now.speed)
        thrust = thrust_wanted(aeroplane, now.speed, load, sin_climb, wanted)
        now = step(aeroplane, now, bank, load, thrust, float(times_s[k + 1] - time_s), wind)
        np.minimum(least, now.speed, out=least)
    end = _axes(now, wind)
    return Flown(times_s, places[0], places[1], places[2], end.vx, end.vy, end.vz, least, rates)


def at_once(start: Motion, to: Directions, times_s: Array, wind: tuple[float, float, float]) -> Flown:
    """A point on rails from ``start`` (n,): it flies each direction from now on, at its present speed through the air."""
    with_it = to.x * wind[0] + to.y * wind[1] + to.z * wind[2]
    left = start.speed**2 - sum(w * w for w in wind) + with_it**2
    ground = with_it + np.sqrt(np.maximum(left, 0.0))
    vx, vy, vz = ground * to.x, ground * to.y, ground * to.z
    gone = times_s[:, None]
    x, y, z = start.x + vx * gone, start.y + vy * gone, start.z + vz * gone
    return Flown(times_s, x, y, z, vx, vy, vz, start.speed, np.zeros_like(x))


def _axes(now: Motion, wind: tuple[float, float, float]) -> Axes:
    through = now.speed * np.cos(now.climb)
    vx, vy = through * np.sin(now.track) + wind[0], through * np.cos(now.track) + wind[1]
    vz = now.speed * np.sin(now.climb) + wind[2]
    flat2 = vx * vx + vy * vy
    flat, speed = np.sqrt(flat2), np.maximum(np.sqrt(flat2 + vz * vz), FLAT_MPS)
    upright = np.maximum(flat, FLAT_MPS)
    return Axes(vx, vy, vz, flat, speed, -vy / upright, vx / upright, vz / speed, flat / speed)
