"""A flyable PH path: a bounded search over what the two end poses leave free, within limits on curvature, climb and bank rate.

Free are the lengths of the two end derivatives and, where the caller offers several, the end point (insertion points of different
k, say) and the end direction (points of the critical curve). With a given start curvature the path continues the present one
without a jump in bank (a G2 join): every candidate is then moved onto the set of interpolants with that curvature, by Newton steps
in the two lengths and in the axis of the preimage, which stands for the two free angles of the family.

Curvature is not monotone in the lengths, so a grid is laid over their bounded square first and refined round the best after that.
Bank is that of a coordinated turn: the lift carries V^2 kappa and the weight.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vosc.errors import NoDirection, OutOfProportion, SamePoint, WrongOption
from vosc.ph_batch import Curves, hermite_many
from vosc.ph_curve import Curve
from vosc.vec import G_MPS2, LARGEST, SMALLEST_M, FloatArray, IntArray, three

SAMPLES = 65
FINE = 513
SLACK = 1e-9
LEAST_MAGNITUDE = 1e-4  # chords: shorter end derivatives are as good as none
MOST_BEND = 1e6  # a start curvature times the distance: beyond, it winds up before it is under way
MOST_GRID = 101
FIELDS = ("max_curvature_per_m", "min_climb_rad", "max_climb_rad", "max_bank_rate_radps")
NAMES = ("curvature", "climb_down", "climb_up", "bank_rate")


@dataclass(frozen=True)
class Limits:
    """What the aircraft can do at ``speed_mps``: curvature 1/m, climb angle rad, bank rate rad/s. Leave out what does not matter."""

    speed_mps: float
    max_curvature_per_m: float = math.inf
    min_climb_rad: float = -0.5 * math.pi
    max_climb_rad: float = 0.5 * math.pi
    max_bank_rate_radps: float = math.inf

    def __post_init__(self) -> None:
        if not 0.0 < self.speed_mps <= LARGEST:
            raise WrongOption(f"Limits.speed_mps: give a speed above 0 m/s, {LARGEST:g} at most, got {self.speed_mps}")
        if not (self.max_curvature_per_m > 0.0 and self.max_bank_rate_radps > 0.0):
            raise WrongOption("Limits: give a curvature and a bank rate above 0, or leave them out")
        if not self.min_climb_rad < self.max_climb_rad:
            raise WrongOption(f"Limits: the climb range {self.min_climb_rad} to {self.max_climb_rad} rad is empty")


@dataclass(frozen=True, eq=False)
class Flyable:
    """Answer of the search.

    ``curve`` the shortest path within all limits, or the one that exceeds them least (``None`` if not even the join can be met);
    ``ok`` within all; ``missed`` names of the limits that are the reason: ``join``, ``curvature``, ``climb_down``, ``climb_up``,
    ``bank_rate``; ``together`` every single limit can be met by some candidate, but not these together; ``point``, ``direction``
    which of the offered ends; ``max_curvature_per_m``, ``climb_rad`` (least, largest), ``max_bank_rate_radps`` of the curve
    (inf, everything and inf without one);
    ``message`` a sentence.
    """

    curve: Curve | None
    ok: bool
    missed: tuple[str, ...]
    together: bool
    point: int
    direction: int
    max_curvature_per_m: float
    climb_rad: tuple[float, float]
    max_bank_rate_radps: float
    message: str


@dataclass(frozen=True, eq=False)
class _Search:
    """What one search holds fixed: start, offered end poses (k,3) with unit tangents, start curvature, bounds of the magnitudes."""

    p0: FloatArray
    t0: FloatArray
    ends: FloatArray
    tangents: FloatArray
    bend: FloatArray | None
    low: float
    high: float

    def curves(self, magnitudes: FloatArray, end: IntArray) -> Curves:
        """Candidates: magnitudes (n,2) in chords, ``end`` (n,) which end pose."""
        p1, t1 = self.ends[end], self.tangents[end]
        chord = np.linalg.norm(p1 - self.p0, axis=1)[:, None]
        return hermite_many(self.p0, magnitudes[:, 0:1] * chord * self.t0, p1, magnitudes[:, 1:2] * chord * t1, self.bend)


def lift(tangent: FloatArray, bend: FloatArray, speed_mps: FloatArray | float) -> tuple[FloatArray, FloatArray]:
    """What the wings carry in coordinated flight along a path, m/s^2, across it: to the right, and up (...,).

    ``tangent`` and curvature vector ``bend`` (...,3); the bank is the angle of the one over the other.
    """
    vertical = tangent[..., 2]
    climb = np.maximum(1.0 - vertical**2, 1e-12)
    up = (np.array([0.0, 0.0, 1.0]) - vertical[..., None] * tangent) / np.sqrt(climb)[..., None]
    square = np.asarray(speed_mps * speed_mps)
    carried = square[..., None] * bend + G_MPS2 * up * np.sqrt(climb)[..., None]
    return (carried * np.cross(tangent, up)).sum(axis=-1), (carried * up).sum(axis=-1)


def _bank_rate(sigma: FloatArray, tangent: FloatArray, bend: FloatArray, dt: float, speed: float) -> FloatArray:
    """Largest bank rate (n,), rad/s, of coordinated flight along sampled curves."""
    bank = np.unwrap(np.arctan2(*lift(tangent, bend, speed)), axis=1)
    middle = 0.5 * (sigma[:, 1:] + sigma[:, :-1])
    with np.errstate(over="ignore", invalid="ignore"):  # at a cusp
        rate: FloatArray = np.abs(np.diff(bank, axis=1) / (middle * dt)).max(axis=1) * speed
    return rate


def _measure(curves: Curves, limits: Limits, samples: int) -> FloatArray:
    """Largest curvature, least and largest climb angle, largest bank rate (n,4)."""
    sigma, tangent, bend = curves.evaluate(np.linspace(0.0, 1.0, samples))
    curvature = np.linalg.norm(bend, axis=-1).max(axis=1)
    climb = np.arcsin(np.clip(tangent[..., 2], -1.0, 1.0))
    rate = _bank_rate(sigma, tangent, bend, 1.0 / (samples - 1), limits.speed_mps)
    return np.stack([curvature, climb.min(axis=1), climb.max(axis=1), rate], axis=1)


def _excess(measured: FloatArray, limits: Limits) -> FloatArray:
    """How far beyond each limit (n,4), relative for curvature and bank rate, rad for climb; up to 0 is within. Lost curves: inf."""
    with np.errstate(over="ignore", invalid="ignore"):
        out = np.stack(
            [
                measured[:, 0] / limits.max_curvature_per_m - 1.0,
                limits.min_climb_rad - measured[:, 1],
                measured[:, 2] - limits.max_climb_rad,
                measured[:, 3] / limits.max_bank_rate_radps - 1.0,
            ],
            axis=1,
        )
    return np.where(np.isfinite(out), out, math.inf)


def flyable(
    p0_m: Sequence[float],
    tangent0: Sequence[float],
    p1_m: Sequence[float] | FloatArray,
    tangent1: Sequence[float] | FloatArray,
    limits: Limits,
    start_curvature_per_m: Sequence[float] | None = None,
    magnitudes: tuple[float, float] = (0.4, 3.0),
    grid: int = 13,
) -> Flyable:
    """A path from ``p0_m`` along ``tangent0`` to ``p1_m`` along ``tangent1`` within ``limits``, the shortest found.

    ``p1_m`` and ``tangent1`` may be (3,) or (k,3): every pair is tried. ``start_curvature_per_m`` (3,) the present curvature
    vector, 1/m, to be continued; left out, the bank may jump. ``magnitudes`` bounds of the end derivatives in chords, within 3:
    beyond 5 the curve has a cusp. ``NoDirection`` for zero tangents, ``SamePoint`` for
    p0 = p1, ``WrongOption`` for bounds that are not 0 < low < high <= 3.
    """
    if not 2 <= grid <= MOST_GRID:
        raise WrongOption(f"grid: give 2 to {MOST_GRID} magnitudes, got {grid}")
    search = _prepare(p0_m, tangent0, p1_m, tangent1, start_curvature_per_m, magnitudes)
    x = _square(np.geomspace(search.low, search.high, grid))
    end = np.repeat(np.arange(len(search.ends)), len(x))
    x = np.tile(x, (len(search.ends), 1))
    spread = math.log(search.high / search.low) / (grid - 1)
    directions = len(np.atleast_2d(np.asarray(tangent1)))
    found = _best(search, *_refined(search, x, end, limits, spread), limits)
    if found is None:
        anything = (-0.5 * math.pi, 0.5 * math.pi)
        return Flyable(None, False, ("join",), False, -1, -1, math.inf, anything, math.inf, "no curve joins these ends")
    if (found[3] <= SLACK).all():
        return _result(*found[:3], directions, (), False, "within all limits")
    alone = []
    for name, field, k in zip(NAMES, FIELDS, range(len(NAMES)), strict=True):
        if found[3][k] > SLACK:  # can it be met when it is the only one?
            only = Limits(limits.speed_mps, **{field: getattr(limits, field)})
            single = _best(search, *_refined(search, x, end, only, spread), only)
            if single is None or single[3][k] > SLACK:
                alone.append(name)
    missed = tuple(alone) or tuple(name for name, out in zip(NAMES, found[3] > SLACK, strict=True) if out)
    how = "not met by any candidate" if alone else "each can be met, but not together with the rest"
    return _result(*found[:3], directions, missed, not alone, f"{', '.join(missed)}: {how}")


def _refined(search: _Search, x: FloatArray, end: IntArray, limits: Limits, spread: float) -> tuple[FloatArray, IntArray, IntArray]:
    """Candidates with finer ones added round the best, and the order from best to worst."""
    cost = _cost(search, x, end, limits)
    for _ in range(4):
        best = np.argsort(cost, kind="stable")[:6]
        spread *= 0.4
        factor = _square(np.exp(spread * np.array([-1.0, 0.0, 1.0])))
        near = np.clip(np.repeat(x[best], len(factor), axis=0) * np.tile(factor, (len(best), 1)), search.low, search.high)
        place = np.repeat(end[best], len(factor))
        x, end, cost = np.vstack([x, near]), np.concatenate([end, place]), np.concatenate([cost, _cost(search, near, place, limits)])
    return x, end, np.argsort(cost, kind="stable")


def _square(values: FloatArray) -> FloatArray:
    """All pairs of values (n^2, 2)."""
    return np.stack(np.meshgrid(values, values, indexing="ij"), axis=-1).reshape(-1, 2)


def _cost(search: _Search, x: FloatArray, end: IntArray, limits: Limits) -> FloatArray:
    """One number to sort by (n,): the length within all limits, and beyond every length the worst excess."""
    curves = search.curves(x, end)
    worst = _excess(_measure(curves, limits, SAMPLES), limits).max(axis=1)
    length = curves.length_m()
    cost: FloatArray = np.where(worst <= 0.0, 1.0 - 1.0 / (1.0 + length), 1.0 + worst)
    return np.where(np.isnan(cost), math.inf, cost)


def _prepare(
    p0_m: Sequence[float],
    tangent0: Sequence[float],
    p1_m: Sequence[float] | FloatArray,
    tangent1: Sequence[float] | FloatArray,
    bend: Sequence[float] | None,
    magnitudes: tuple[float, float],
) -> _Search:
    low, high = magnitudes
    if not LEAST_MAGNITUDE <= low < high <= 3.0:
        raise WrongOption(f"magnitudes: give bounds with 0 < low < high <= 3 chords ({LEAST_MAGNITUDE:g} at least), got {magnitudes}")
    p0, t0 = np.array(three("p0_m", p0_m)), _sized(np.array(three("tangent0", tangent0)))
    points = np.array([three("p1_m", p) for p in np.atleast_2d(np.asarray(p1_m, dtype=np.float64))])
    tangents = np.array([_sized(np.array(three("tangent1", t))) for t in np.atleast_2d(np.asarray(tangent1, dtype=np.float64))])
    size = np.linalg.norm(tangents, axis=1)
    if not (np.linalg.norm(t0) > 0.0 and (size > 0.0).all()):
        raise NoDirection("tangent0, tangent1: give non-zero directions")
    chords = np.linalg.norm(points - p0, axis=1)
    if chords.min() < SMALLEST_M:
        raise SamePoint("p1_m: give end points that differ from the start")
    t0 = t0 / np.linalg.norm(t0)
    wanted = None
    if bend is not None:
        wanted = np.array(three("start_curvature_per_m", bend))
        if np.abs(wanted).max() * chords.max() > MOST_BEND:
            raise OutOfProportion(f"start_curvature_per_m: give a bend of at most {MOST_BEND:g} over the distance, got {bend}")
        wanted = wanted - (wanted @ t0) * t0
    ends, headings = np.repeat(points, len(tangents), axis=0), np.tile(tangents / size[:, None], (len(points), 1))
    return _Search(p0, t0, ends, headings, wanted, low, high)


def _sized(direction: FloatArray) -> FloatArray:
    """The same direction, longer where the squares of its numbers would be lost."""
    return direction * 1e200 if np.abs(direction).max() < 1e-100 else direction


def _best(
    search: _Search, x: FloatArray, end: IntArray, order: IntArray, limits: Limits
) -> tuple[Curve, FloatArray, int, FloatArray] | None:
    """The first candidate within the limits by its exact extremes (samples may miss a peak), else the best: curve, values, end, excess."""
    best: tuple[Curve, FloatArray, int, FloatArray] | None = None
    for i in order[:20]:
        one = search.curves(x[i : i + 1], end[i : i + 1])
        if np.isnan(one.length_m()[0]):
            break
        curve = one.curve(0)
        rate = float(_measure(one, limits, FINE)[0, 3])
        measured = np.array([curve.max_curvature(), *curve.climb_range_rad(), rate])
        if not np.isfinite(measured).all():  # a cusp
            continue
        excess = _excess(measured[None], limits)[0]
        if best is None or (excess <= SLACK).all():
            best = curve, measured, int(end[i]), excess
        if (best[3] <= SLACK).all():
            break
    return best


def _result(
    curve: Curve, measured: FloatArray, end: int, directions: int, missed: tuple[str, ...], together: bool, message: str
) -> Flyable:
    k, low, high, rate = measured.tolist()
    return Flyable(curve, not missed, missed, together, end // directions, end % directions, k, (low, high), rate, message)
