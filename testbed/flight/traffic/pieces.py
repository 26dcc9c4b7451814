"""A track in pieces of constant acceleration: what waypoints and recorded tracks become."""

import math
import struct
from array import array
from bisect import bisect_right
from functools import cached_property

import numpy as np

from testbed.core.frames import Vec3
from testbed.flight.traffic.bounds import Bounds

Array = np.ndarray
WIDTH = 12
_row = struct.Struct(f"{WIDTH}d").unpack_from
BYTES = 8 * WIDTH
NOWHERE = (math.inf, -math.inf, *(0.0,) * (WIDTH - 2))


class Pieces:
    """An obstacle that moves piece by piece; before the first and after the last there is none.

    A row of the table (n,12): from when and until when the piece holds, the moment that it counts from, and the place, the velocity and
    half the acceleration at that moment.
    """

    def __init__(self, name: str, radius_m: float, table: Array) -> None:
        self.name, self.radius_m = name, radius_m
        self._table = table
        self._starts = array("d", table[:, 0].tobytes())
        self._rows = table.tobytes()
        self._piece: tuple[float, ...] = NOWHERE  # the one asked for last: a flight asks for it again and again, or for the next
        # most recordings have a row every so often: the piece of a time is then where a division says
        first_s, lasts_s, self._last = self._starts[0], self._starts[-1] - self._starts[0], float(len(table) - 1)
        self._first_s, self._per_s = (first_s, self._last / lasts_s) if math.isfinite(lasts_s) and lasts_s > 0.0 else (0.0, 0.0)

    def at(self, time_s: float) -> tuple[Vec3, Vec3] | None:
        """Centre and velocity; None where there is no piece."""
        low, high, origin, x, y, z, vx, vy, vz, hx, hy, hz = self._piece
        if not low <= time_s < high:
            k = int(min(self._last, max(0.0, (time_s - self._first_s) * self._per_s)))
            low, high, origin, x, y, z, vx, vy, vz, hx, hy, hz = piece = _row(self._rows, BYTES * k)
            if not low <= time_s < high:
                k = bisect_right(self._starts, time_s) - 1
                if k < 0:
                    return None
                low, high, origin, x, y, z, vx, vy, vz, hx, hy, hz = piece = _row(self._rows, BYTES * k)
                if not time_s < high:
                    return None
            self._piece = piece
        u = time_s - origin
        ax, ay, az = u * hx, u * hy, u * hz
        vx, vy, vz = vx + ax, vy + ay, vz + az
        return (x + u * vx, y + u * vy, z + u * vz), (vx + ax, vy + ay, vz + az)

    def bounds(self) -> Bounds:
        """See ``Bounds``: the pieces join, and on each the speed is greatest at one of its ends."""
        return self._bounds

    @cached_property
    def _bounds(self) -> Bounds:
        low, high, origin, vel, half = self._table[:, 0], self._table[:, 1], self._table[:, 2], self._table[:, 6:9], self._table[:, 9:12]
        straight = ~half.any(axis=1)  # and may last forever
        ends = [np.where(straight, 0.0, end - origin)[:, None] for end in (low, high)]
        top = max(float(np.linalg.norm(vel + 2.0 * u * half, axis=1).max()) for u in ends)
        return Bounds(top, float(low[0]), math.nextafter(float(high[-1]), -math.inf) if math.isfinite(high[-1]) else math.inf)

    def sampled(self, time_s: Array) -> tuple[Array, Array]:
        """The same at times (n,), as arrays (n,3)."""
        times = np.asarray(time_s, dtype=float)
        k = np.searchsorted(self._table[:, 0], times, side="right") - 1
        row = self._table[np.maximum(k, 0)]
        u = np.where((k >= 0) & (times < row[:, 1]), times - row[:, 2], np.nan)[:, None]
        gained = u * row[:, 9:12]
        return row[:, 3:6] + u * (row[:, 6:9] + gained), row[:, 6:9] + 2.0 * gained


def smooth(time_s: Array, pos: Array) -> Array:
    """Pieces through places (n,3) at times (n,), n > 1: two from each place to the next, one acceleration each. At a place the velocity
    is that of the parabola through it and its neighbours. Exact for a constant acceleration; two places make a straight line.
    """
    lasts, vel, halfway = _velocities(time_s, pos)
    first, second = (halfway - vel[:-1]) / lasts, (vel[1:] - halfway) / lasts  # half the acceleration over half the time
    table = np.empty((2 * len(lasts), WIDTH))
    table[0::2, 0], table[1::2, 0] = time_s[:-1], time_s[:-1] + 0.5 * lasts[:, 0]
    table[:-1, 1], table[-1, 1] = table[1:, 0], math.nextafter(time_s[-1], math.inf)
    table[:, 2] = table[:, 0]
    table[0::2, 3:6], table[1::2, 3:6] = pos[:-1], pos[:-1] + 0.25 * lasts * (vel[:-1] + halfway)
    table[0::2, 6:9], table[1::2, 6:9] = vel[:-1], halfway
    table[0::2, 9:12], table[1::2, 9:12] = first, second
    return table


def _velocities(time_s: Array, pos: Array) -> tuple[Array, Array, Array]:
    """What ``smooth`` is made of: how long it is from each place to the next (n-1,1), the velocities at the places and halfway."""
    lasts = np.diff(time_s)[:, None]
    mean = np.diff(pos, axis=0) / lasts
    vel = np.empty_like(pos)
    vel[1:-1] = (mean[:-1] * lasts[1:] + mean[1:] * lasts[:-1]) / (lasts[1:] + lasts[:-1])
    vel[0], vel[-1] = (mean[0], mean[0]) if len(mean) == 1 else (2.0 * mean[0] - vel[1], 2.0 * mean[-1] - vel[-2])
    return lasts, vel, 2.0 * mean - 0.5 * (vel[:-1] + vel[1:])


def extremes(time_s: Array, pos: Array) -> tuple[Array, Array]:
    """Of ``smooth`` from each place to the next: the largest speed (n-1,), and how far from 0 each coordinate gets (n-1,3).

    The velocity is linear in a piece, so that its size is largest at an end; a coordinate turns back where its velocity is 0.
    """
    lasts, vel, halfway = _velocities(time_s, pos)
    speeds = [np.linalg.norm(one, axis=1) for one in (vel[:-1], halfway, vel[1:])]
    reach = np.maximum(np.abs(pos[:-1]), np.abs(pos[1:]))
    for place, at, sign in ((pos[:-1], vel[:-1], 1.0), (pos[1:], vel[1:], -1.0)):
        turns = (at * halfway <= 0.0) & (at != 0.0)
        beyond = at * lasts * at / (4.0 * np.where(turns, at - halfway, 1.0))
        reach = np.where(turns, np.maximum(reach, np.abs(place + sign * beyond)), reach)
    return np.max(speeds, axis=0), reach


def polygon(time_s: Array, pos: Array) -> Array:
    """Pieces straight from place to place (n,3) at times (n,), n > 1, and straight on at either end."""
    table = np.zeros((len(time_s) - 1, WIDTH))
    table[:, 0], table[:, 1], table[:, 2] = time_s[:-1], time_s[1:], time_s[:-1]
    table[0, 0], table[-1, 1] = -math.inf, math.inf
    table[:, 3:6], table[:, 6:9] = pos[:-1], np.diff(pos, axis=0) / np.diff(time_s)[:, None]
    return table
