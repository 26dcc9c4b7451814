"""Velocity space, with the paper's names: what obstacles forbid on the sphere of reachable velocities, and what was chosen. Unit: m/s.

v_u, v_o, v_uo     velocity of the aircraft, of the obstacle, and the first less the second (eq. 1)
RCC, ACC           the collision cone of relative velocities, its apex at the origin P_u, and that of the aircraft's own, carried along
                   by v_o (eq. 3, 4): its apex is P_3-DVO
VS, SC             the sphere of velocities of the present speed, and the spherical cap that the cone cuts out of it
M, r, gamma        centre of the cap's circle, its distance from P_u, the cap's half-angle (eq. 24-28)
B, C               critical velocities on the near and on the far generatrix (fig. 6)
S, S'              where the circles of two caps meet (eq. 29-31)
K                  a point of the critical boundary that is chosen against several threats (eq. 32-33)
"""

import math
from dataclasses import dataclass
from itertools import cycle

import numpy as np
import rerun as rr

from testbed.core.units import DEG
from testbed.flight.record import FlightRecord
from testbed.show import palette, shapes, words
from testbed.show.cameras import velocity_space
from testbed.show.palette import rgba
from testbed.show.recording.film import log_camera
from testbed.show.recording.names import HZ, Names
from testbed.show.recording.timeline import TICK_S, Clock, ragged, thinned
from testbed.show.velocity_space import Corners, Sight, corners
from testbed.show.words import number
from vosc import Cap

Array = np.ndarray
SHADES = ((palette.OBSTACLE, palette.ORANGE), ("#1F8A9C", "#7FD6E8"), ("#8A6FD1", "#C9B8FF"))  # of cone and cap, obstacle by obstacle
ROOT = "velocity"
NONE = np.zeros((0, 3))
PSI, THETA, GAMMA = "\N{GREEK SMALL LETTER PSI}", "\N{GREEK SMALL LETTER THETA}", "\N{GREEK SMALL LETTER GAMMA}"
HAT = "v\N{COMBINING CIRCUMFLEX ACCENT}_u"


def log(clock: Clock, record: FlightRecord, rows: Array, sights: list[Sight], rate_hz: float) -> None:
    """Everything the velocity view shows, from one place. ``sights`` belong to ``rows``, which are ``rate_hz``."""
    time_s, own = record.columns["time_s"][rows], record.columns["own.vel_enu_mps"][rows]
    speed = np.linalg.norm(own, axis=1)
    heading = np.array(record.events[0].own_vel_enu_mps) if record.events else own[0]
    shot = velocity_space(heading, record.plan.speed_mps, 1)
    slow = thinned(np.arange(len(rows)), HZ, rate_hz)
    names = Names(shot.repeated(len(slow)), slow)
    clock.static(ROOT, rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    log_camera(clock, f"{ROOT}/camera", time_s[:1], shot)
    lines = rr.LineStrips3D(shapes.graticule(), colors=rgba(palette.NIGHT_LINES), radii=rr.Radius.ui_points(0.6))
    clock.static(f"{ROOT}/sphere/lines", lines)
    clock.send(f"{ROOT}/sphere", time_s, lambda k: rr.Transform3D.columns(scale=np.repeat(speed[k, None], 3, axis=1)))
    space = _Space(clock, names, time_s, own, speed, several=len(sights) > 1)
    space.arrow("own", "v_u", palette.OWN, own)
    threats = np.sum([sight.is_threat for sight in sights], axis=0) if sights else np.zeros(len(rows))
    _log_commands(space, record, threats)
    for sight, (cone, cap) in zip(sights, cycle(SHADES)):
        if sight.in_range.any():
            _log_cones(space, sight, cone)
        _log_cap(space, sight, cap)
    for pair in corners(sights, speed):
        _log_corners(space, pair)
    _log_axes(space, float(speed.max()))
    names.log(clock, time_s)


def _log_axes(space: "_Space", length: float) -> None:
    tips = np.eye(3) * length
    arrows = rr.Arrows3D(origins=[[0, 0, 0]] * 3, vectors=tips, radii=rr.Radius.ui_points(1), colors=rgba(palette.NIGHT_LINES))
    space.clock.static(f"{ROOT}/axes", arrows)
    n = len(space.time_s)
    for name, place in (
        ("P_u", np.zeros(3)),
        *zip(("east", "north", "up"), 1.05 * tips, strict=True),
        ("VS", np.array([0.0, 0.0, -length])),
    ):
        space.names.add(f"{ROOT}/axes/{name}", name, palette.GREY, np.repeat(place[None], n, axis=0), 0.03)


@dataclass(frozen=True)
class _Space:
    """What is drawn into: the writer and the names, the instants, and the aircraft's velocity at them."""

    clock: Clock
    names: Names
    time_s: Array
    own: Array
    speed: Array
    several: bool

    def of(self, symbol: str, name: str) -> str:
        """What stands in the picture for something of an obstacle."""
        return f"{symbol} of {name}" if self.several else symbol

    def arrow(self, entity: str, said: str, colour: str, vector: Array, width: float = 2.5) -> None:
        """A vector from the origin, NaN while there is none, with its name beyond its tip."""
        shown = np.isfinite(vector).all(axis=1)
        if not shown.any():
            return
        arrow = f"{ROOT}/{entity}/arrow"
        self.clock.static(arrow, rr.Arrows3D.from_fields(colors=rgba(colour), radii=rr.Radius.ui_points(width)))

        def build(k: Array) -> rr.ComponentColumnList:
            chosen = vector[k][shown[k]]
            return rr.Arrows3D.columns(origins=np.zeros_like(chosen), vectors=chosen).partition(shown[k].astype(int))

        self.clock.send(arrow, self.time_s, build)
        self.names.add(f"{ROOT}/{entity}/label", said, colour, 1.08 * vector)

    def dot(self, entity: str, said: str | list[str], colour: str, places: Array) -> None:
        """A point, NaN while there is none, with its name below it."""
        shown = np.isfinite(places).all(axis=1)
        if not shown.any():
            return
        self.clock.static(f"{ROOT}/{entity}", rr.Points3D.from_fields(colors=rgba(colour), radii=rr.Radius.ui_points(4)))
        points = [place[None] if there else NONE for place, there in zip(places, shown, strict=True)]
        self.clock.send(f"{ROOT}/{entity}", self.time_s, ragged(rr.Points3D.columns, "positions", points))
        self.names.add(f"{ROOT}/{entity}/label", said, colour, places, 0.02)

    def line(self, entity: str, colour: str, width: float, lines: list[Array | None]) -> None:
        """A line, some of the time."""
        if all(line is None for line in lines):
            return
        self.clock.static(f"{ROOT}/{entity}", rr.LineStrips3D.from_fields(colors=rgba(colour), radii=rr.Radius.ui_points(width)))

        def build(k: Array) -> rr.ComponentColumnList:
            strips = [line for row in k if (line := lines[row]) is not None]
            return rr.LineStrips3D.columns(strips=strips).partition([lines[row] is not None for row in k])

        self.clock.send(f"{ROOT}/{entity}", self.time_s, build)

    def body(self, entity: str, triangles: Array, colour: str, alpha: float, points: list[Array]) -> None:
        """A surface, some of the time."""
        self.clock.static(f"{ROOT}/{entity}", rr.Mesh3D.from_fields(triangle_indices=triangles, albedo_factor=rgba(colour, alpha)))
        self.clock.send(f"{ROOT}/{entity}", self.time_s, ragged(rr.Mesh3D.columns, "vertex_positions", points))


def _log_cones(space: _Space, sight: Sight, colour: str) -> None:
    """ACC as a body as far as the velocity sphere, where its rim is the exact border of what is forbidden; RCC as its outline."""
    seen, entity = sight.in_range, f"obstacle/{sight.name}"
    rims: list[Array | None] = [None] * len(seen)
    found = _rims(sight.apex_mps[seen], sight.axis[seen], sight.half_angle_rad[seen], space.speed[seen])
    for row, rim in zip(np.flatnonzero(seen), found, strict=True):
        rims[row] = rim
    sides = [NONE if rim is None else np.vstack([sight.apex_mps[row], rim[:-1]]) for row, rim in enumerate(rims)]
    space.body(f"{entity}/cone", shapes.cone_triangles(), colour, 0.22, sides)
    space.line(f"{entity}/cone/rim", colour, 1.5, rims)
    moved: list[Array | None] = [None if rim is None else rim - sight.apex_mps[row] for row, rim in enumerate(rims)]
    space.line(f"{entity}/relative_cone", palette.dimmed(palette.RELATIVE), 0.8, [None if rim is None else _outline(rim) for rim in moved])
    where = np.where(seen[:, None], 1.0, math.nan)
    space.arrow(entity, space.of("v_o, P_3-DVO", sight.name), colour, sight.apex_mps * where)
    relative = space.of("v_uo = v_u \N{MINUS SIGN} v_o", sight.name)
    space.arrow(f"{entity}/relative", relative, palette.RELATIVE, (space.own - sight.apex_mps) * where, 1.8)
    for name, ink, lines, pick in (("cone", colour, rims, np.argmax), ("relative_cone", palette.RELATIVE, moved, np.argmin)):
        ends = np.array([np.full(3, math.nan) if line is None else line[int(pick(line[:, 2]))] for line in lines])
        space.names.add(f"{ROOT}/{entity}/{name}/label", space.of("ACC" if name == "cone" else "RCC", sight.name), ink, ends, -0.03)


def _outline(rim: Array, sides: int = 8) -> Array:
    """A cone with its apex at the origin in one stroke: round its rim, with a line to the apex and back every so often."""
    step, origin = max(1, (len(rim) - 1) // sides), np.zeros((1, 3))
    parts = []
    for k in range(0, len(rim) - 1, step):
        parts += [rim[k : k + 1], origin, rim[k : k + step + 1]]
    return np.vstack(parts)


def _rims(apex_mps: Array, axis: Array, half_angle_rad: Array, speed_mps: Array) -> Array:
    """Where the side lines of each cone leave the velocity sphere (n, m, 3); one that misses the sphere is drawn one radius long."""
    along = shapes.turned_from_x_axis(shapes.circles(half_angle_rad), axis)
    toward = np.einsum("nmi,ni->nm", along, apex_mps)
    under_root = (speed_mps**2 - np.einsum("ni,ni->n", apex_mps, apex_mps))[:, None] + toward**2
    length = np.sqrt(np.maximum(under_root, 0.0)) - toward
    reach = np.where((under_root > 0.0) & (length > 0.0), length, speed_mps[:, None])
    rims: Array = apex_mps[:, None] + reach[:, :, None] * along
    return rims


def _log_cap(space: _Space, sight: Sight, colour: str) -> None:
    """The cap as a patch of the sphere with its rim, centre M, radius r, half-angle gamma and critical velocities, while it is a threat."""
    shown = np.flatnonzero([found is not None for found in sight.caps])
    if not len(shown):
        return
    gamma, axis = sight.of_caps("half_angle_rad"), sight.cap_axis
    size = space.speed[shown, None, None] * 1.004  # a hair outside, or the lines of the sphere would cut it
    at = {int(row): n for n, row in enumerate(shown)}
    patches = shapes.turned_from_x_axis(shapes.caps(gamma[shown]), axis[shown]) * size
    rims = shapes.turned_from_x_axis(shapes.circles(gamma[shown]), axis[shown]) * size
    entity, rows = f"obstacle/{sight.name}/cap", range(len(space.time_s))
    space.body(entity, shapes.cap_triangles(), colour, 0.35, [patches[at[k]] if k in at else NONE for k in rows])
    space.line(f"{entity}/rim", colour, 1.5, [rims[at[k]] if k in at else None for k in rows])
    middle = sight.of_caps("radius_mps")[:, None] * axis
    near, far = sight.of_caps("nearest_mps", 3), sight.of_caps("farthest_mps", 3)
    frames = [np.vstack([np.zeros(3), middle[k], near[k], np.zeros(3), far[k], middle[k]]) if k in at else None for k in rows]
    space.line(f"{entity}/vectors", colour, 0.8, frames)
    arcs = [_arc(axis[k], near[k] / space.speed[k]) * (0.45 * space.speed[k]) if k in at else None for k in rows]
    space.line(f"{entity}/gamma", colour, 1.2, arcs)
    said = space.of("SC", sight.name)
    space.dot(
        f"{entity}/centre", [f"M of {said}: {cap_values(found)}" if found is not None else "" for found in sight.caps], colour, middle
    )
    space.dot(f"{entity}/nearest", space.of("B", sight.name), colour, near)
    space.dot(f"{entity}/farthest", space.of("C", sight.name), colour, far)


def cap_values(found: Cap) -> str:
    """G in the paper's letters."""
    azimuth, elevation, gamma = (f"{number(angle / DEG, 1)}" for angle in (found.azimuth_rad, found.elevation_rad, found.half_angle_rad))
    return f"r {number(found.radius_mps, 1)} m/s, {PSI}_r {azimuth}, {THETA}_r {elevation}, {GAMMA} {gamma} deg"


def _arc(first: Array, last: Array, points: int = 16) -> Array:
    """Between two unit vectors, on the unit sphere."""
    angle = math.acos(max(-1.0, min(1.0, float(first @ last))))
    share = np.linspace(0.0, 1.0, points)[:, None]
    if angle < 1e-9:
        return np.repeat(first[None], points, axis=0)
    return np.asarray((np.sin((1.0 - share) * angle) * first + np.sin(share * angle) * last) / math.sin(angle))


def _log_corners(space: _Space, pair: Corners) -> None:
    """S and S'."""
    for k, name in enumerate(("S", "S\N{PRIME}")):
        space.dot(f"corners/{'_'.join(pair.names)}/{k + 1}", name, palette.YELLOW, pair.points_mps[:, k])


def _log_commands(space: _Space, record: FlightRecord, threats: Array) -> None:
    """The velocity that the last decision asked for; K where several obstacles were threats then."""
    asked = [event for event in record.events if all(math.isfinite(x) for x in event.command_enu_mps)]
    vectors, said = np.full((len(space.time_s), 3), math.nan), [""] * len(space.time_s)
    for event in asked:
        then = min(int(np.searchsorted(space.time_s, event.time_s - TICK_S)), len(space.time_s) - 1)
        several = threats[then] > 1
        for row in np.flatnonzero(space.time_s > event.time_s - TICK_S):
            vectors[row], said[row] = event.command_enu_mps, f"{'K = ' if several else ''}{HAT}, chosen by {words.method(event.method)}"
        colour = rgba(palette.COMMAND)
        arrow = rr.Arrows3D(origins=[[0, 0, 0]], vectors=[event.command_enu_mps], colors=colour, radii=rr.Radius.ui_points(2.5))
        space.clock.log(f"{ROOT}/command/arrow", event.time_s, arrow)
    if asked:
        space.names.add(f"{ROOT}/command/label", said, palette.COMMAND, 1.08 * vectors)
