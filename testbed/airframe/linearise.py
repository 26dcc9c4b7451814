"""The linear model of a trimmed aircraft, by central differences on the accelerations of the non-linear one, and its modes.

States in body axes (u, w, q, pitch | v, p, r, bank), inputs elevator, aileron, rudder and throttle per unit of command; servo and
engine lags are left out. The two groups are kept apart: what couples them (a propeller's torque) is small by definition of a trim.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from testbed.core.units import G0_MPS2
from testbed.flight.plants.rig import Controls, Motion, Reaction, Rig

Array = np.ndarray
LONGITUDINAL = ("u", "w", "q", "pitch")
LATERAL = ("v", "p", "r", "bank")
STEP_SPEED = 0.01  # of the airspeed
STEP_RATE = 0.01  # rad/s
STEP_ANGLE = 0.01  # rad
STEP_SURFACE = 0.01


@dataclass(frozen=True)
class LinearModel:
    """dx/dt = a x + b u for each group; ``load_factor`` = c x + d u of the longitudinal one."""

    speed_mps: float
    pitch_rad: float
    a_long: Array  # (4, 4) on LONGITUDINAL
    b_long: Array  # (4, 2): elevator, throttle
    c_load_factor: Array  # (4,)
    d_load_factor: Array  # (2,)
    a_lat: Array  # (4, 4) on LATERAL
    b_lat: Array  # (4, 2): aileron, rudder


class Mode(NamedTuple):
    """A mode by its name: angular frequency and damping ratio of a pair, or the time constant (s, negative: it grows) of a real root."""

    name: str
    frequency_rad_s: float
    damping: float
    time_constant_s: float


def linearise(rig: Rig) -> LinearModel:
    """Perturb the trimmed aircraft."""
    base = rig.motion
    sizes = {name: _step(name, rig.speed_mps) for name in Motion._fields}

    def slope(motions: tuple[Motion, Motion], controls: tuple[Controls, Controls], size: float) -> Reaction:
        ahead, behind = (rig.react(m, c) for m, c in zip(motions, controls, strict=True))
        return Reaction(*((a - b) / (2.0 * size) for a, b in zip(ahead, behind, strict=True)))

    trimmed = Controls()
    by_state = {
        name: slope((_moved(base, name, size), _moved(base, name, -size)), (trimmed, trimmed), size) for name, size in sizes.items()
    }
    by_control = {
        name: slope((base, base), (Controls(**{name: STEP_SURFACE}), Controls(**{name: -STEP_SURFACE})), STEP_SURFACE)
        for name in Controls._fields
    }
    a_long = np.array([[getattr(by_state[x], row) for x in LONGITUDINAL] for row in ("u", "w", "q")] + [[0.0, 0.0, 1.0, 0.0]])
    b_long = np.array([[getattr(by_control[c], row) for c in ("elevator", "throttle")] for row in ("u", "w", "q")] + [[0.0, 0.0]])
    tangent = math.tan(base.pitch)
    a_lat = np.array([[getattr(by_state[x], row) for x in LATERAL] for row in ("v", "p", "r")] + [[0.0, 1.0, tangent, 0.0]])
    b_lat = np.array([[getattr(by_control[c], row) for c in ("aileron", "rudder")] for row in ("v", "p", "r")] + [[0.0, 0.0]])
    return LinearModel(
        rig.speed_mps,
        base.pitch,
        a_long,
        b_long,
        np.array([by_state[x].load_factor for x in LONGITUDINAL]),
        np.array([by_control[c].load_factor for c in ("elevator", "throttle")]),
        a_lat,
        b_lat,
    )


def _step(name: str, speed_mps: float) -> float:
    if name in "uvw":
        return STEP_SPEED * speed_mps
    return STEP_RATE if name in "pqr" else STEP_ANGLE


def _moved(motion: Motion, name: str, by: float) -> Motion:
    return motion._replace(**{name: getattr(motion, name) + by})


def modes(model: LinearModel) -> list[Mode]:
    """Short period, phugoid, Dutch roll, roll, spiral."""
    long = sorted(np.linalg.eigvals(model.a_long), key=abs)
    lat = sorted(np.linalg.eigvals(model.a_lat), key=lambda root: (abs(root.imag) < 1e-9, abs(root)))
    found = [_pair("short period", long[2:]), _pair("phugoid", long[:2]), _pair("Dutch roll", lat[:2])]
    slow, fast = lat[2:]
    if abs(slow.imag) > 1e-9:
        return [*found, _pair("roll-spiral", lat[2:])]
    return [*found, _real("roll", fast), _real("spiral", slow)]


def _pair(name: str, roots: list[complex]) -> Mode:
    frequency = math.sqrt(abs(roots[0] * roots[1]))
    return Mode(name, frequency, -(roots[0] + roots[1]).real / (2.0 * frequency), math.nan)


def _real(name: str, root: complex) -> Mode:
    return Mode(name, math.nan, math.nan, -1.0 / root.real if root.real else math.inf)


def respond(a: Array, b: Array, start: Array, time_s: Array) -> Array:
    """States (n, m) of dx/dt = a x + b from ``start``, exact at equally spaced times; ``b`` (m,) is a constant input."""
    from scipy.linalg import expm

    size = len(a)
    augmented = np.zeros((size + 1, size + 1))
    augmented[:size, :size], augmented[:size, size] = a, b
    step = expm(augmented * float(time_s[1] - time_s[0]))
    states = np.append(start, 1.0)[:, None]
    while states.shape[1] < len(time_s):  # as many again at once: the step is then that of all there are
        states, step = np.hstack([states, step @ states]), step @ step
    return states[:size, : len(time_s)].T


def roll_in_one_degree(model: LinearModel) -> tuple[float, float]:
    """Time constant (s) of the pure rolling motion and its steady roll rate (rad/s) per unit of aileron."""
    damping, power = -model.a_lat[1, 1], model.b_lat[1, 0]
    return 1.0 / damping, power / damping


def load_factor_per_rad(model: LinearModel) -> float:
    """Load factor per radian of angle of attack at constant airspeed, surfaces held: what a small vertical gust adds at once."""
    by_u, by_w = model.c_load_factor[:2]
    alpha = model.pitch_rad  # of level flight
    return float(model.speed_mps * (by_w * math.cos(alpha) - by_u * math.sin(alpha)))


def load_factor_per_speed2(speed_mps: float) -> float:
    """Pitch rate (rad/s) per g of load factor above 1 in steady flight: g / V."""
    return G0_MPS2 / speed_mps
