"""Whether, when and how deep an aircraft is in a volume about another one that both pass on straight lines.

All in closed form for a relative motion p + v t (m, m/s; horizontal parts first), for arrays of such pieces, so that a flight that is
known at ticks is exact between them. With s, v the horizontal parts, D the radius and T the threshold of the modified tau:

    tau_mod = (D^2 - s.s) / (s.v)    outside of D and closing; 0 within D; none (infinite) outside and not closing
    lost    = (|s| <= D, or both would pass within D and 0 <= tau_mod <= T) and |height| <= H

which is the well-clear volume of DO-365 as NASA's DAIDALUS has it (WCV_TAUMOD without a vertical time). On straight lines the
horizontal part is one interval of time, or none: from tc - T/2 - sqrt(T^2/4 + d) to tc + sqrt(d), with tc the time of the closest
approach and d = (D^2 - miss^2) / v.v. Severity is that of DO-365: 1 less the Fernandez-Guasti norm of range over the range at which
the volume begins, horizontal miss over D and height over H; 0 outside, 1 through the middle. Of a sphere: the depth over the radius.
"""

from typing import NamedTuple

import numpy as np

from testbed.campaign.words.daa import Volume

Array = np.ndarray


class Inside(NamedTuple):
    """Of each piece the time at which it is inside first and last; none where the second is before the first."""

    first_s: Array
    last_s: Array
    ever: Array


def tau_mod(s: Array, v: Array, dmod_m: float) -> Array:
    """Modified tau (...,) in s of horizontal positions and velocities (..., 2)."""
    range2, closing = np.einsum("...i,...i", s, s), np.einsum("...i,...i", s, v)
    outside = range2 > dmod_m**2
    with np.errstate(divide="ignore", invalid="ignore"):
        tau = (dmod_m**2 - range2) / closing
    return np.where(outside, np.where(closing < 0.0, tau, np.inf), 0.0)


def inside(p: Array, v: Array, lasts_s: Array, volume: Volume) -> Inside:
    """Of pieces (n,3) that begin at time 0 and last so long."""
    flat = slice(0, 3 if volume.shape == "sphere" else 2)
    first, last = _in_circle(p[:, flat], v[:, flat], volume.radius_m, volume.tau_s)
    if volume.half_height_m is not None:
        low, high = _in_layer(p[:, 2], v[:, 2], volume.half_height_m)
        first, last = np.maximum(first, low), np.minimum(last, high)
    first, last = np.maximum(first, 0.0), np.minimum(last, lasts_s)
    return Inside(first, last, first <= last if volume.edge == "in" else _opened(p, v, first, last, volume))


def _opened(p: Array, v: Array, first: Array, last: Array, volume: Volume) -> Array:
    """The limit itself is outside: inside in the middle of the time, not only on the limit all along or for a moment."""
    with np.errstate(invalid="ignore"):
        middle = p + (0.5 * (first + last))[:, None] * v
    flat = middle[:, : 3 if volume.shape == "sphere" else 2]
    within = (np.einsum("ij,ij->i", flat, flat) < volume.radius_m**2) | (volume.tau_s > 0.0)
    level = np.full(len(p), True) if volume.half_height_m is None else np.abs(middle[:, 2]) < volume.half_height_m
    return (first < last) & within & level


def _in_circle(s: Array, v: Array, radius_m: float, tau_s: float) -> tuple[Array, Array]:
    """From when to when; from infinity to minus infinity for never."""
    a, b = np.einsum("ij,ij->i", v, v), np.einsum("ij,ij->i", s, v)
    c = np.einsum("ij,ij->i", s, s) - radius_m**2
    if s.shape[1] == 2:
        across = s[:, 0] * v[:, 1] - s[:, 1] * v[:, 0]
        room = a * radius_m**2 - across**2  # a^2 d; b^2 - a c would lose the digits of a grazing pass
    else:
        normal = np.cross(s, v)
        room = a * radius_m**2 - np.einsum("ij,ij->i", normal, normal)
    with np.errstate(divide="ignore", invalid="ignore"):
        middle, reach2 = -b / a, np.maximum(room, 0.0) / a**2
        first = middle - 0.5 * tau_s - np.sqrt(0.25 * tau_s**2 + reach2)
        last = middle + np.sqrt(reach2)
    still = a == 0.0
    never = np.where(still, ~(c <= 0.0), ~(room >= 0.0))  # NaN is never inside
    first, last = np.where(still, -np.inf, first), np.where(still, np.inf, last)
    return np.where(never, np.inf, first), np.where(never, -np.inf, last)


def _in_layer(z: Array, w: Array, half_m: float) -> tuple[Array, Array]:
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = (-half_m - z) / w, (half_m - z) / w
    still, within = w == 0.0, np.abs(z) <= half_m
    low = np.where(still, np.where(within, -np.inf, np.inf), np.minimum(one, other))
    high = np.where(still, np.where(within, np.inf, -np.inf), np.maximum(one, other))
    return low, high


def norm(a: Array, b: Array) -> Array:
    """Fernandez-Guasti's of two numbers from 0 to 1: 1 where either is."""
    return np.sqrt(a**2 + b**2 - a**2 * b**2)


def severity(p: Array, v: Array, volume: Volume) -> Array:
    """How deep (n,), from 0 to 1, in states (n,3)."""
    if volume.shape == "sphere":
        return np.maximum(0.0, 1.0 - np.linalg.norm(p, axis=1) / volume.radius_m)
    s, u, d, tau = p[:, :2], v[:, :2], volume.radius_m, volume.tau_s
    distance, speed2, closing = np.linalg.norm(s, axis=1), np.einsum("ij,ij->i", u, u), np.einsum("ij,ij->i", s, u)
    with np.errstate(divide="ignore", invalid="ignore"):
        rate = np.where(distance > 0.0, closing / distance, 0.0)
        miss = np.where(closing < 0.0, np.abs(s[:, 0] * u[:, 1] - s[:, 1] * u[:, 0]) / np.sqrt(speed2), distance)
    begins = np.maximum(d, 0.5 * (np.sqrt((rate * tau) ** 2 + 4.0 * d**2) - rate * tau))
    horizontal = norm(np.minimum(distance / begins, 1.0), np.minimum(miss / d, 1.0))
    assert volume.half_height_m is not None
    return 1.0 - norm(horizontal, np.minimum(np.abs(p[:, 2]) / volume.half_height_m, 1.0))


def deepest(p: Array, v: Array, found: Inside, volume: Volume) -> float:
    """The largest severity while inside: looked for at both ends of each piece's time inside, at its closest approach, and where the
    two are at one height.
    """
    which = found.ever
    if not which.any():
        return 0.0
    p, v, first, last = p[which], v[which], found.first_s[which], found.last_s[which]
    flat = slice(0, 3 if volume.shape == "sphere" else 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        nearest = -np.einsum("ij,ij->i", p[:, flat], v[:, flat]) / np.einsum("ij,ij->i", v[:, flat], v[:, flat])
        level = -p[:, 2] / v[:, 2]
    times = [first, last, *(np.clip(np.nan_to_num(time), first, last) for time in (nearest, level))]
    return max(float(np.max(severity(p + time[:, None] * v, v, volume))) for time in times)
