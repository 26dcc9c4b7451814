"""What a search in space and time is asked: where it begins and ends, whom it passes, what a path may cost the aircraft.

Places are named along the path that the flight is on: so far ahead, so far to its left, so far above it. A path is PH curves through
waypoints, each with a direction. Every curve begins with the curvature that the one before ends with (the first with that of the path
that is left), so that nothing jumps but the rate at which the bank changes (a G2 join). Only where it comes back to a route does it
meet a curvature that it was not made for.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from testbed.core.chain import Chain
from testbed.flight.paths.validity import FORBIDS, SLACK, Ability, Pace, Sampled, Spheres, clearances, excesses, times
from vosc import ph
from vosc.ph_batch import Curves
from vosc.vec import FloatArray

PIECE = np.linspace(0.0, 1.0, 21)  # parameters at which a candidate's piece is looked at
DENSE_M = 1.0  # spacing at which a path that is to be flown is looked at
EASED = (-0.25, 0.7)  # of the chord: what the first and the last derivative change by
TRIED = 40  # so many of the best candidates are looked at that closely
UPRIGHT = 1e-9  # a path that is as good as vertical has no left of its own
PREDICTED_S = 12.0  # so long the rest of a route behind the path is looked at


class Tail(NamedTuple):
    """Where paths end, and the pieces of the route from there on; none at the goal."""

    point: FloatArray
    tangent: FloatArray
    curves: tuple[ph.Curve, ...] = ()


class Found(NamedTuple):
    """The answer of a search: the path, or the candidate that is least far beyond the limits; how many were looked at."""

    curves: tuple[ph.Curve, ...] | None
    excess: FloatArray
    looked: int

    @property
    def keeps(self) -> bool:
        """Is there a path within all limits?"""
        return self.curves is not None and bool((self.excess <= SLACK).all())

    def why_not(self) -> str:
        """The limit that forbids the nearest candidate."""
        if not np.isfinite(self.excess).any():
            return f"no curve of {self.looked:,} candidates joins the present state to the goal"
        share = np.where(np.isfinite(self.excess), self.excess, 0.0)
        over = " and ".join(f"{name} by {100.0 * x:.3g} %" for name, x in zip(FORBIDS, share, strict=True) if x > SLACK)
        return f"of {self.looked:,} candidates none is within the limits; the nearest misses {over}"


@dataclass(frozen=True)
class Course:
    """One search. The first sample is the present state: point, unit tangent, curvature vector 1/m; time counts from now."""

    point: FloatArray
    tangent: FloatArray
    bend: FloatArray
    tail: Tail
    centre: Chain  # the path that the flight is on ...
    from_s_m: float  # ... and where it is on it
    reach_m: float  # waypoints lie so far ahead of it at most
    aside_m: float  # and so far aside
    pace: Pace
    spheres: Spheres
    ability: Ability

    def frames(self, ahead_m: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Of the path that the flight is on, so far ahead (...,): points, directions, level to their left, and above them (...,3)."""
        shape = (*np.shape(ahead_m), 3)
        points, tangents, _ = self.centre.sample(self.from_s_m + np.ravel(ahead_m))
        flat = np.hypot(tangents[:, 0], tangents[:, 1])
        level = np.where((flat > UPRIGHT)[:, None], np.stack([-tangents[:, 1], tangents[:, 0], 0.0 * flat], axis=1), (0.0, 1.0, 0.0))
        left = level / np.linalg.norm(level, axis=1)[:, None]
        points, tangents, left, up = (x.reshape(shape) for x in (points, tangents, left, np.cross(tangents, left)))
        return points, tangents, left, up

    def headings(self, points: FloatArray) -> FloatArray:
        """Directions at waypoints (n,m,3): of the circle through each and its neighbours, start and end counted."""
        n = len(points)
        start, end = (np.broadcast_to(x, (n, 1, 3)) for x in (self.point, self.tail.point))
        steps = np.diff(np.concatenate([start, points, end], axis=1), axis=1)
        square = np.maximum((steps * steps).sum(axis=-1, keepdims=True), 1e-12)
        return units(steps[:, :-1] / square[:, :-1] + steps[:, 1:] / square[:, 1:])

    def joined(self, points: FloatArray, tangents: FloatArray, eases: FloatArray) -> list[Curves]:
        """The pieces of n paths through waypoints (n,m,3) along directions (n,m,3), to the end. ``eases`` (n,m+1): see ``piece``."""
        n = len(points)
        ends = np.concatenate([points, np.broadcast_to(self.tail.point, (n, 1, 3))], axis=1)
        along = np.concatenate([tangents, np.broadcast_to(self.tail.tangent, (n, 1, 3))], axis=1)
        at, heading, bend = (np.broadcast_to(x, (n, 3)) for x in (self.point, self.tangent, self.bend))
        pieces = []
        for k in range(ends.shape[1]):
            pieces.append(piece(at, heading, bend, ends[:, k], along[:, k], eases[:, k]))
            at, heading, bend = ends[:, k], along[:, k], pieces[-1].evaluate(np.ones(1))[2][:, 0]
        return pieces

    def judged(self, pieces: Sequence[Curves], begins_s: FloatArray | None = None) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Of n paths: excesses (n,5), lengths (n,), times of the end (n,). ``begins_s``: of paths that begin later than now."""
        parts = [look(one) for one in pieces]
        starts = np.cumsum([part.s[:, -1] for part in parts], axis=0) - [part.s[:, -1] for part in parts]
        s = np.concatenate([part.s + start[:, None] for part, start in zip(parts, starts, strict=True)], axis=1)
        all_of = Sampled(s, *(np.concatenate([part[k] for part in parts], axis=1) for k in (1, 2, 3)))
        when = times(all_of, self.pace, np.zeros(len(s)) if begins_s is None else begins_s)
        return excesses(all_of, when, self.pace, self.spheres, self.ability), s[:, -1], when[:, -1]

    def cost(self, pieces: Sequence[Curves]) -> tuple[FloatArray, FloatArray]:
        """One number to sort by (n,), and the excesses (n,5): the length within all limits, and beyond every length the excesses."""
        excess, length, _ = self.judged(pieces)
        beyond = np.maximum(excess, 0.0).sum(axis=1)
        return np.where(beyond <= 0.0, 1.0 - 1.0 / (1.0 + length), 1.0 + np.minimum(beyond, 1e9)), excess

    def closely(self, curves: Sequence[ph.Curve]) -> FloatArray:
        """The excesses (5,) of one path, sampled every metre; the route behind it is looked at for its clearance alone."""
        chain = Chain(curves)
        sampled = _dense(chain, chain.length_m)
        when = times(sampled, self.pace, np.zeros(1))
        excess = excesses(sampled, when, self.pace, self.spheres, self.ability)[0]
        if self.tail.curves and len(self.spheres.kept):
            behind = Chain(self.tail.curves)
            on = _dense(behind, min(behind.length_m, PREDICTED_S * self.pace.speed_mps))
            excess[0] = max(excess[0], float(-clearances(on.points, times(on, self.pace, when[:, -1]), self.spheres).min()))
        return excess

    def best(self, pieces: Sequence[Curves], cost: FloatArray, looked: int) -> Found:
        """The first of the candidates, from best to worst, that passes when looked at closely; else the nearest."""
        nearest = Found(None, np.full(len(FORBIDS), math.inf), looked)
        for i in np.argsort(cost, kind="stable")[:TRIED]:
            if any(np.isnan(one.e[0][i]) for one in pieces):
                continue
            curves = tuple(one.curve(int(i)) for one in pieces)
            found = Found(curves, self.closely(curves), looked)
            if found.keeps:
                return found
            if beyond(found) < beyond(nearest):
                nearest = found
        return nearest

    @cached_property
    def length_m(self) -> float:
        """Straight from start to end."""
        return float(np.linalg.norm(self.tail.point - self.point))


def beyond(found: Found) -> float:
    """How far beyond all limits together."""
    return float(np.maximum(found.excess, 0.0).sum())


def units(vectors: FloatArray) -> FloatArray:
    """Unit vectors (...,3)."""
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12))


def better(first: Found, second: Found) -> Found:
    """The shorter of two paths within the limits; where there is none, the one that is less far beyond them."""
    if first.keeps and second.keeps:
        return min(first, second, key=lambda found: sum(curve.length_m for curve in found.curves or ()))
    return first if first.keeps or (not second.keeps and beyond(first) <= beyond(second)) else second


def piece(start: FloatArray, along: FloatArray, bend: FloatArray, end: FloatArray, along_there: FloatArray, ease: FloatArray) -> Curves:
    """PH curves (n) between poses, with the curvature ``bend`` at their start.

    ``ease`` (n,): with 0 both end derivatives are as long as the chord; with 1 the first is shorter and the last longer, so that the
    bend builds up early and fades late. Of a turn from straight flight that reaches 15 % farther aside within the same limits.
    """
    chord = np.linalg.norm(end - start, axis=-1)[:, None]
    first, last = (chord * (1.0 + by * ease[:, None]) for by in EASED)
    return ph.hermite_many(start, first * along, end, last * along_there, bend)


def look(curves: Curves) -> Sampled:
    """Candidates at their samples."""
    points, s = curves.places(PIECE)
    _, tangents, bends = curves.evaluate(PIECE)
    return Sampled(s, points, tangents, bends)


def _dense(chain: Chain, length_m: float) -> Sampled:
    s = np.linspace(0.0, length_m, max(2, math.ceil(length_m / DENSE_M) + 1))
    points, tangents, bends = chain.sample(s)
    return Sampled(s[None], points[None], tangents[None], bends[None])
