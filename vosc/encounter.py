"""Two moving bodies: relative motion, closest approach, collision cone and threat test (paper section 2, eq. 1-4).

The own aircraft is a point, the obstacle a sphere that already contains every margin; both fly straight on. Any right-handed frame
will do; the project uses ENU. Degenerate encounters have these answers, and nothing is ever NaN:

=========================================  =================================================================================
encounter                                  answer
=========================================  =================================================================================
inside or on the sphere (distance <= R)    alpha0 = pi/2, so it is a threat exactly while the distance shrinks; ``inside`` is set when < R
at the centre (distance 0)                 alpha = pi/2, no threat: every direction leads out; ``inside`` is set
no relative motion                         alpha = pi/2, closest approach is now (time 0, miss = distance), no threat
obstacle faster, stationary, own at rest   nothing special: only the relative velocity counts
=========================================  =================================================================================
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from vosc.errors import NotNumbers, WrongOption
from vosc.vec import FloatArray, Vec, array, dot, norm, scale, sub, three, unit

SAME_VELOCITY = 1e-12  # relative speeds below this fraction of the speeds are rounding, not motion


@dataclass(frozen=True)
class Own:
    """The own aircraft: position (m) and velocity (m/s); any three floats each, kept as tuples. ``NotNumbers`` if they are not finite."""

    pos_m: Vec
    vel_mps: Vec

    def __post_init__(self) -> None:
        object.__setattr__(self, "pos_m", three("Own.pos_m", self.pos_m))
        object.__setattr__(self, "vel_mps", three("Own.vel_mps", self.vel_mps))


@dataclass(frozen=True)
class Obstacle:
    """A moving sphere: position of its centre (m), velocity (m/s), radius (m, > 0). ``NotNumbers`` if that is not what is given.

    ``is_threat`` is what whoever sees it says of it; None when nobody does. A method may look at obstacles that are no threat.
    """

    pos_m: Vec
    vel_mps: Vec
    radius_m: float
    is_threat: bool | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "pos_m", three("Obstacle.pos_m", self.pos_m))
        object.__setattr__(self, "vel_mps", three("Obstacle.vel_mps", self.vel_mps))
        try:
            radius_m = float(self.radius_m)
        except (TypeError, ValueError, OverflowError):
            raise NotNumbers(f"Obstacle.radius_m: give one number in metres, got {self.radius_m!r}") from None
        if not 0.0 < radius_m <= 1e30:
            raise NotNumbers(f"Obstacle.radius_m: give a finite radius above 0 m, got {radius_m}")
        object.__setattr__(self, "radius_m", radius_m)


@dataclass(frozen=True)
class Threat:
    """Answer of the threat test.

    ``alpha_rad`` angle between relative velocity and line of sight, in [0, pi]; ``alpha0_rad`` half-angle of the collision cone, in
    (0, pi/2]; ``time_to_cpa_s`` straight-line time of closest approach (negative when it has passed); ``miss_m`` distance to the
    centre then, of the whole straight line (also when it has passed); ``distance_m`` distance to the centre now; ``inside`` the own
    point is within the sphere now.
    """

    alpha_rad: float
    alpha0_rad: float
    is_threat: bool
    time_to_cpa_s: float
    miss_m: float
    distance_m: float
    inside: bool


def threatening(obstacles: Iterable[Obstacle]) -> tuple[Obstacle, ...]:
    """Those that are marked as threats, and those that are not marked at all."""
    met = tuple(obstacle for obstacle in obstacles if obstacle.is_threat is not False)
    return obstacles if isinstance(obstacles, tuple) and len(met) == len(obstacles) else met


def relative_velocity(own_vel_mps: Vec, obstacle_vel_mps: Vec) -> tuple[Vec, float]:
    """Eq. 1: v_uo = v_u - v_o and its size; exactly zero when the two agree to rounding."""
    w = sub(own_vel_mps, obstacle_vel_mps)
    size = norm(w)
    if size <= SAME_VELOCITY * (norm(own_vel_mps) + norm(obstacle_vel_mps)):
        return (0.0, 0.0, 0.0), 0.0
    return w, size


def cone_half_angle(distance_m: float, radius_m: float) -> float:
    """alpha_0 = arcsin(R / d_0), step 1 of section 2; pi/2 on and inside the sphere."""
    return math.asin(radius_m / distance_m) if distance_m > radius_m else 0.5 * math.pi


def _alpha(p: Vec, distance_m: float, w: Vec, speed_mps: float) -> float:
    """Angle between line of sight and relative velocity (pi/2 where one of them vanishes)."""
    if distance_m == 0.0 or speed_mps == 0.0:
        return 0.5 * math.pi
    px, py, pz = p[0] / distance_m, p[1] / distance_m, p[2] / distance_m
    wx, wy, wz = w[0] / speed_mps, w[1] / speed_mps, w[2] / speed_mps
    return math.atan2(math.hypot(py * wz - pz * wy, pz * wx - px * wz, px * wy - py * wx), px * wx + py * wy + pz * wz)


def threat(own: Own, obstacle: Obstacle, horizon_s: float = math.inf) -> Threat:
    """Is the relative velocity inside the collision cone (alpha < alpha_0), with its closest approach ahead and within ``horizon_s``?

    Paper section 2, eq. 1-4 and steps 1-3. ``WrongOption`` if the horizon is not above 0.
    """
    if not horizon_s > 0.0:
        raise WrongOption(f"horizon_s: give a time above 0 s (math.inf for none), got {horizon_s}")
    p = sub(obstacle.pos_m, own.pos_m)
    distance = norm(p)
    w, speed = relative_velocity(own.vel_mps, obstacle.vel_mps)
    alpha = _alpha(p, distance, w, speed)
    alpha0 = cone_half_angle(distance, obstacle.radius_m)
    time = distance * math.cos(alpha) / speed if speed > 0.0 and distance > 0.0 else 0.0
    miss = distance * math.sin(alpha)
    return Threat(
        alpha_rad=alpha,
        alpha0_rad=alpha0,
        is_threat=alpha < alpha0 and 0.0 < time < horizon_s,
        time_to_cpa_s=time,
        miss_m=miss,
        distance_m=distance,
        inside=distance < obstacle.radius_m,
    )


def first_threat(own: Own, obstacles: Iterable[Obstacle]) -> Obstacle | None:
    """Of the obstacles that are not marked as no threat the threat that is met first; ``None`` if there is none."""
    met = [(told.time_to_cpa_s, k, o) for k, o in enumerate(threatening(obstacles)) if (told := threat(own, o)).is_threat]
    return min(met, key=lambda one: one[:2])[2] if met else None


def cone_margin(pos_m: Vec, vel_mps: Vec, obstacle: Obstacle) -> float:
    """Angle alpha - alpha_0, rad: how far the velocity lies outside the exact cone of this obstacle (negative: inside it, eq. 3-4).

    No relative motion counts as alpha = pi/2: what does not move relative to the obstacle does not hit it.
    """
    p = sub(obstacle.pos_m, pos_m)
    distance = norm(p)
    w, speed = relative_velocity(vel_mps, obstacle.vel_mps)
    return _alpha(p, distance, w, speed) - cone_half_angle(distance, obstacle.radius_m)


def closest_point(own: Own, obstacle: Obstacle) -> FloatArray:
    """(3,) vector from the obstacle's centre to the own aircraft at closest approach, m, in the obstacle's moving frame."""
    p = sub(obstacle.pos_m, own.pos_m)
    w, speed = relative_velocity(own.vel_mps, obstacle.vel_mps)
    if speed == 0.0:
        return array((-p[0], -p[1], -p[2]))
    if speed < 1e-100:  # only its direction counts, and its square would be lost
        w, speed = unit(scale(1e200, w)), 1.0
    k = dot(p, w) / (speed * speed)
    return array((k * w[0] - p[0], k * w[1] - p[1], k * w[2] - p[2]))
