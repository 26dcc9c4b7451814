"""Polynomials as tuples of coefficients, lowest power first: the little algebra the PH curves need."""

import numpy as np

from vosc.vec import FloatArray

Poly = tuple[float, ...]

NOTHING = 1e-150


def product(a: Poly, b: Poly) -> Poly:
    """a(t) b(t)."""
    out = [0.0] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            out[i + j] += x * y
    return tuple(out)


def derivative(a: Poly) -> Poly:
    """a'(t)."""
    return tuple(i * x for i, x in enumerate(a) if i > 0)


def integral(a: Poly, start: float = 0.0) -> Poly:
    """The antiderivative with value ``start`` at t = 0."""
    return (start, *(x / (i + 1) for i, x in enumerate(a)))


def total(polys: "list[Poly]") -> Poly:
    """Sum of polynomials of equal degree."""
    return tuple(sum(c) for c in zip(*polys, strict=True))


def difference(a: Poly, b: Poly) -> Poly:
    """a(t) - b(t), of equal degree."""
    return tuple(x - y for x, y in zip(a, b, strict=True))


def horner(poly: Poly, t: FloatArray) -> FloatArray:
    """Values at t, any shape."""
    out = np.full_like(t, poly[-1])
    for c in poly[-2::-1]:
        out *= t
        out += c
    return out


def extremum_candidates(slope: Poly) -> FloatArray:
    """0, 1 and the real parts of all roots of ``slope`` in between.

    Every extremum on [0, 1] is among them; an extra candidate does no harm.
    """
    size = max(abs(x) for x in slope)
    if not size > 0.0:
        return np.array([0.0, 1.0])
    scaled = np.array(slope[::-1]) / size
    scaled[np.abs(scaled) < NOTHING] = 0.0  # a leading coefficient that small overflows when divided by, and moves no root in [0, 1]
    roots = np.roots(scaled).real
    return np.concatenate(([0.0, 1.0], roots[(roots > 0.0) & (roots < 1.0)]))


def nearest(position: tuple[Poly, ...], points: FloatArray, intervals: int) -> FloatArray:
    """Parameters t (m,) in [0, 1] at which the polynomial curve is nearest to ``points`` (m, 3): the global minimum.

    The squared distance is sampled at ``intervals`` + 1 parameters; every local minimum of the samples that could still hide the
    global one is refined by Newton's method inside its bracket, and the best is kept.
    """
    grid = np.linspace(0.0, 1.0, intervals + 1)
    curve = np.stack([horner(p, grid) for p in position], axis=-1)
    reach = float(np.linalg.norm(np.diff(curve, axis=0), axis=1).max())
    t = np.empty(len(points))
    for first in range(0, len(points), 4096):  # bounds the memory of the table of distances
        t[first : first + 4096] = _nearest_block(position, points[first : first + 4096], grid, curve, reach)
    return t


def _nearest_block(position: tuple[Poly, ...], points: FloatArray, grid: FloatArray, curve: FloatArray, reach: float) -> FloatArray:
    distance = np.sqrt(sum((points[:, None, k] - curve[None, :, k]) ** 2 for k in range(3)))
    padded = np.pad(distance, ((0, 0), (1, 1)), constant_values=np.inf)
    lowest = distance.min(axis=1)
    # between two samples the distance cannot fall by more than the arc between them (a little more than the chord `reach`)
    candidate = (distance <= padded[:, :-2]) & (distance <= padded[:, 2:]) & (distance <= (lowest + 1.5 * reach)[:, None])
    row, column = np.nonzero(candidate)
    spacing = grid[1]
    low, high = np.clip(grid[column] - spacing, 0.0, 1.0), np.clip(grid[column] + spacing, 0.0, 1.0)
    t = _refine(position, points[row], grid[column], low, high)
    squared = sum((horner(position[k], t) - points[row, k]) ** 2 for k in range(3))
    order = np.lexsort((squared, row))
    first = np.searchsorted(row[order], np.arange(len(points)))
    best: FloatArray = t[order][first]
    return best


def _refine(position: tuple[Poly, ...], points: FloatArray, t: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Zero of (r - p).r' by Newton inside [low, high], bisecting where Newton leaves it."""
    velocity = [derivative(p) for p in position]
    change = [derivative(v) for v in velocity]
    for _ in range(60):
        off = [horner(position[k], t) - points[:, k] for k in range(3)]
        v = [horner(velocity[k], t) for k in range(3)]
        f = sum(off[k] * v[k] for k in range(3))
        slope = sum(v[k] * v[k] + off[k] * horner(change[k], t) for k in range(3))
        low, high = np.where(f > 0.0, low, t), np.where(f > 0.0, t, high)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            new = t - f / slope
        new = np.where((slope > 0.0) & (new >= low) & (new <= high), new, 0.5 * (low + high))
        done = bool((np.abs(new - t) < 1e-9).all())
        t = new
        if done:
            break
    return t
