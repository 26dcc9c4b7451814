"""Three-vectors as tuples of floats: the scalar kernels of the library.

A numpy call on three numbers costs about a microsecond of overhead; the same sum on a tuple a tenth of it. Everything that is
called once per obstacle is written with these; arrays appear at the edges, where results are handed out.
"""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vosc.errors import NotNumbers

Vec = tuple[float, float, float]
FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.intp]

G_MPS2 = 9.80665
LARGEST = 1e30  # fourth powers of what is accepted still fit into a float, so no formula can overflow into inf - inf
SMALLEST_M = 1e-30  # points nearer to each other than this are the same
SMALLEST_SINE = 1e-12  # two directions closer than this are parallel: the plane through them is rounding noise


def three(name: str, value: Iterable[Any]) -> Vec:
    """``value`` as three finite floats, or ``NotNumbers`` saying what ``name`` should be."""
    try:
        x, y, z = value
        out = (float(x), float(y), float(z))
    except (TypeError, ValueError, OverflowError):
        raise NotNumbers(f"{name}: give three numbers (x, y, z), got {value!r}") from None
    if not (abs(out[0]) <= LARGEST and abs(out[1]) <= LARGEST and abs(out[2]) <= LARGEST):
        raise NotNumbers(f"{name}: all three numbers must be finite and below {LARGEST:g} in size, got {out}")
    return out


def array(a: Vec) -> FloatArray:
    """``a`` as a read-only (3,) array."""
    out = np.array(a, dtype=np.float64)
    out.flags.writeable = False
    return out


def sub(a: Vec, b: Vec) -> Vec:
    """Difference a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def add(a: Vec, b: Vec) -> Vec:
    """Sum a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def scale(k: float, a: Vec) -> Vec:
    """Multiple k a."""
    return (k * a[0], k * a[1], k * a[2])


def along(a: Vec, k: float, b: Vec) -> Vec:
    """Sum a + k b."""
    return (a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2])


def combine(j: float, a: Vec, k: float, b: Vec) -> Vec:
    """Sum j a + k b."""
    return (j * a[0] + k * b[0], j * a[1] + k * b[1], j * a[2] + k * b[2])


def dot(a: Vec, b: Vec) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vec, b: Vec) -> Vec:
    """Vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def norm(a: Vec) -> float:
    """Length, without underflow of the squares."""
    return math.hypot(a[0], a[1], a[2])


def unit(a: Vec) -> Vec:
    """Direction a / |a|; the zero vector stays zero."""
    n = math.hypot(a[0], a[1], a[2])
    return (a[0] / n, a[1] / n, a[2] / n) if n > 0.0 else (0.0, 0.0, 0.0)


def angle(a: Vec, b: Vec) -> float:
    """Angle between two unit vectors, rad in [0, pi]; accurate at both ends, where the arc cosine is not."""
    return math.atan2(norm(cross(a, b)), dot(a, b))


def deflection(a: Vec, b: Vec) -> float:
    """Angle between two vectors of any length, rad in [0, pi] (0 if one of them is zero)."""
    return angle(unit(a), unit(b))


def perpendicular(a: Vec, *hints: Vec) -> Vec:
    """Unit vector perpendicular to the unit vector ``a``, on the side of the first hint that is not parallel to it."""
    for hint in hints:
        size = norm(hint)
        if size > 0.0:
            off = along(hint, -dot(hint, a), a)
            if norm(off) > SMALLEST_SINE * size:
                off = unit(off)
                return unit(along(off, -dot(off, a), a))  # once more: what is left along a after the first subtraction is rounding
    smallest = min(range(3), key=lambda i: abs(a[i]))
    axis = (float(smallest == 0), float(smallest == 1), float(smallest == 2))
    return unit(along(axis, -dot(axis, a), a))


def azimuth_elevation(a: Vec) -> tuple[float, float]:
    """Direction of ``a``: azimuth counter-clockwise from +x in (-pi, pi], elevation up from the x-y plane, rad (0, 0 for the zero
    vector).

    The arc cosine of the paper's eq. 19 and 26 loses the sign of y; atan2 keeps it.
    """
    return math.atan2(a[1], a[0]), math.atan2(a[2], math.hypot(a[0], a[1]))


def direction(azimuth_rad: float, elevation_rad: float) -> Vec:
    """Unit vector of an azimuth (counter-clockwise from +x) and an elevation (up from the x-y plane)."""
    c = math.cos(elevation_rad)
    return (c * math.cos(azimuth_rad), c * math.sin(azimuth_rad), math.sin(elevation_rad))


def right_of(a: Vec) -> Vec:
    """Horizontal unit vector to the right of ``a`` seen from above; of a vertical ``a``, -y (what is right of +x)."""
    size = math.hypot(a[0], a[1])
    return (a[1] / size, -a[0] / size, 0.0) if size > SMALLEST_SINE * abs(a[2]) and size > 0.0 else (0.0, -1.0, 0.0)


def up_and_right(a: Vec) -> tuple[Vec, Vec]:
    """Unit vectors across ``a``, as a pilot with level wings who flies along it sees them; straight up, up is the way of a right turn."""
    u = unit(a)
    up = perpendicular(u, (0.0, 0.0, 1.0), right_of(u))
    return up, cross(u, up)
