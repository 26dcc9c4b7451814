"""Routes as chains of PH pieces: the paper's, and shapes that prove an aircraft and its guidance."""

import math
from itertools import pairwise

import numpy as np

from testbed.campaign.words.route import Circle, Racetrack, Random, Route, Swerve
from testbed.campaign.words.settings import FlightPlan
from testbed.core.frames import unit_from_direction
from testbed.core.seeds import stream
from testbed.core.units import DEG
from testbed.flight.impossible import NoRouteError
from vosc import ph

Array = np.ndarray
PIECES_PER_RADIUS = 20.0  # pieces this short keep the curvature within 0.3 % of its peak
FINE_M = 0.05
Ends = tuple[Array, Array, Array, Array]  # of a piece: point, derivative, point, derivative (3,), m
Directions = tuple[Array, Array, float]  # heading counter-clockwise and climb (n,), rad, at this spacing, m
Arc = tuple[float, float]  # length (m), turn (rad)


def route_pieces(plan: FlightPlan) -> list[Ends]:
    """The pieces of a plan's route, by their ends, as it is written (before any turn to level).

    Each is the canonical PH quintic of its ends. Raises ``NoRouteError`` when there is none.
    """
    route = plan.route
    if route.shape is None:
        return [_between_ends(route)]
    return _placed(course(route.shape, stream(plan.seed, plan.replicate, "route")), route)


def course(shape: Circle | Racetrack | Swerve | Random, rng: np.random.Generator) -> list[Ends]:
    """The pieces of a shape, from the origin along +x. Only a random one draws from ``rng``. Raises ``NoRouteError`` if it cannot."""
    match shape:
        case Circle():
            arcs = _arc(shape.radius_m, 2.0 * math.pi * shape.turns)
        case Racetrack():
            arcs = (_arc(shape.radius_m, 0.0, shape.straight_m) + _arc(shape.radius_m, math.pi)) * 2 * shape.laps
        case Swerve():
            return _swerve(shape)
        case Random():
            least_radius, limit = rng.uniform(*shape.least_radius_m), shape.climb_at_most_deg * DEG
            return [_quintic(rng, least_radius, limit)] if rng.random() < 0.5 else bends(rng, least_radius, limit)
    return _joined(arcs, 1.0 if shape.side == "left" else -1.0)


def _between_ends(route: Route) -> Ends:
    """End tangents of ``magnitude_chords`` chords."""
    if route.goal_enu_m is None or route.goal_direction_deg is None:
        raise NoRouteError("it has neither a goal nor a shape")
    size = route.magnitude_chords * math.dist(route.start_enu_m, route.goal_enu_m)
    first, last = (size * np.array(unit_from_direction(*direction)) for direction in (route.start_direction_deg, route.goal_direction_deg))
    return np.array(route.start_enu_m), first, np.array(route.goal_enu_m), last


def _placed(pieces: list[Ends], route: Route) -> list[Ends]:
    """Pieces that start at the origin along +x, turned to the start's azimuth and moved to the start."""
    azimuth = route.start_direction_deg[0] * DEG
    turn = np.array([[math.cos(azimuth), -math.sin(azimuth), 0.0], [math.sin(azimuth), math.cos(azimuth), 0.0], [0.0, 0.0, 1.0]])
    start = np.array(route.start_enu_m)
    return [(start + turn @ p0, turn @ d0, start + turn @ p1, turn @ d1) for p0, d0, p1, d1 in pieces]


def _arc(radius_m: float, angle: float, straight_m: float = 0.0) -> list[Arc]:
    """An arc, or a straight, in pieces of at most 15 deg and three radii."""
    if straight_m:
        count = math.ceil(straight_m / (3.0 * radius_m))
        return [(straight_m / count, 0.0)] * count
    count = math.ceil(angle / (15.0 * DEG))
    return [(radius_m * angle / count, angle / count)] * count


def _joined(arcs: list[Arc], side: float) -> list[Ends]:
    """Level arcs one after the other from the origin along +x; ``side`` 1 turns left."""
    pieces: list[Ends] = []
    heading, here = 0.0, np.zeros(3)
    for length, turn in arcs:
        after = heading + side * turn
        chord = length * (math.sin(turn / 2) / (turn / 2) if turn else 1.0)
        middle = 0.5 * (heading + after)
        there = here + chord * np.array([math.cos(middle), math.sin(middle), 0.0])
        first, last = (length * np.array([math.cos(h), math.sin(h), 0.0]) for h in (heading, after))
        pieces.append((here, first, there, last))
        heading, here = after, there
    return pieces


def _swerve(shape: Swerve) -> list[Ends]:
    amplitude = shape.heading_deg * DEG
    s = np.arange(0.0, shape.swings * shape.swing_m + 0.5 * FINE_M, FINE_M)
    heading = -amplitude * np.cos(math.pi * s / shape.swing_m)
    least_radius = shape.swing_m / (amplitude * math.pi)
    return _through((heading, np.zeros(len(s)), FINE_M), least_radius / PIECES_PER_RADIUS)


def _through(directions: Directions, piece_m: float) -> list[Ends]:
    """Pieces of about ``piece_m`` along a path that has these directions."""
    heading, climb, step = directions
    flat = np.cos(climb)
    tangent = np.column_stack([flat * np.cos(heading), flat * np.sin(heading), np.sin(climb)])
    point = np.vstack([np.zeros(3), np.cumsum(0.5 * step * (tangent[1:] + tangent[:-1]), axis=0)])
    count = max(1, round((len(point) - 1) * step / piece_m))
    knots = np.linspace(0, len(point) - 1, count + 1).round().astype(int)
    return [(point[a], (b - a) * step * tangent[a], point[b], (b - a) * step * tangent[b]) for a, b in pairwise(knots)]


def _quintic(rng: np.random.Generator, least_radius_m: float, limit: float) -> Ends:
    """Random end directions up to 75 deg off the chord, scaled until the tightest place has the radius asked for."""
    for _ in range(1000):
        chord, start, end = (
            unit_from_direction(float(rng.uniform(-spread, spread)), float(rng.uniform(-share, share)) * limit / DEG)
            for spread, share in ((0.0, 0.8), (75.0, 1.0), (75.0, 1.0))
        )
        unit = ph.hermite((0.0, 0.0, 0.0), start, chord, end)
        low, high = unit.climb_range_rad()
        if max(-low, high) <= limit + 1e-9:
            size = least_radius_m * unit.max_curvature()
            return np.zeros(3), size * np.array(start), size * np.array(chord), size * np.array(end)
    raise NoRouteError("no random curve within climb_at_most_deg")


def bends(rng: np.random.Generator, least_radius_m: float, limit: float) -> list[Ends]:
    """Curvature that swings smoothly between random values two to four radii apart, while the climb wanders half as fast."""
    spans = rng.uniform(2.0, 4.0, 5) * least_radius_m
    bends = np.concatenate([[0.0], rng.uniform(-1.0, 1.0, 4), [0.0]])
    bends /= np.max(np.abs(bends))
    climbs = rng.uniform(-0.85, 0.85, 3) * limit
    knots = np.concatenate([[0.0], np.cumsum(spans)])
    s = np.arange(0.0, knots[-1], FINE_M)
    climb, bend = _eased(s, knots[[0, 2, 5]], climbs), _eased(s, knots, bends)
    total = np.sqrt((bend * np.cos(climb)) ** 2 + (np.gradient(climb, FINE_M) * least_radius_m) ** 2)
    heading = np.cumsum(bend / total.max()) * FINE_M / least_radius_m
    return _through((heading, climb, FINE_M), least_radius_m / PIECES_PER_RADIUS)


def _eased(s: Array, knots: Array, values: Array) -> Array:
    """From value to value along half cosines: the slope is zero at every knot."""
    index = np.clip(np.searchsorted(knots, s, side="right") - 1, 0, len(knots) - 2)
    share = (s - knots[index]) / (knots[index + 1] - knots[index])
    return np.asarray(values[index] + (0.5 - 0.5 * np.cos(math.pi * share)) * (values[index + 1] - values[index]))
