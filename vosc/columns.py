"""Many three-vectors as columns x, y, z, each (n,): the kernels of ``vosc.vec`` over arrays.

No axis of length 3 to sum over, nothing to stack: for a hundred vectors that is where the time of numpy goes.
"""

import numpy as np

from vosc.vec import FloatArray, IntArray, Vec

Columns = tuple[FloatArray, FloatArray, FloatArray]


def minus(a: Columns, b: Vec) -> Columns:
    """Differences of all vectors and one."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def over(a: Columns, k: FloatArray) -> Columns:
    """Vectors, each divided by its number."""
    return a[0] / k, a[1] / k, a[2] / k


def along(a: Columns, k: FloatArray | float, b: Columns) -> Columns:
    """Sums a + k b."""
    return a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]


def dot(a: Columns, b: Columns) -> FloatArray:
    """Scalar products."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def length(a: Columns) -> FloatArray:
    """Lengths, without underflow of the squares."""
    out: FloatArray = np.hypot(np.hypot(a[0], a[1]), a[2])
    return out


def cross(a: Columns, b: Columns) -> Columns:
    """Vector products."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def chosen(a: Columns, rows: IntArray) -> Columns:
    """Some of the vectors."""
    return a[0][rows], a[1][rows], a[2][rows]
