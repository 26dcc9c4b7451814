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
from collections.abc import Callable

import numpy as np
import rerun as rr

from testbed.core.units import DEG
from testbed.flight.record import FlightRecord
from testbed.show import palette, shapes, words
from testbed.show.palette import rgba
from testbed.show.recording.timeline import Clock, ragged
from testbed.show.velocity_space import Corners, Sight, corners
from testbed.show.words import number
from vosc import Cap

Array = np.ndarray
Named = Callable[[str, str], str]
"""Of a symbol and an obstacle what stands in the picture."""

ROOT = "velocity"
NONE = np.zeros((0, 3))
PSI, THETA, GAMMA = "\N{GREEK SMALL LETTER PSI}", "\N{GREEK SMALL LETTER THETA}", "\N{GREEK SMALL LETTER GAMMA}"
HAT = "v\N{COMBINING CIRCUMFLEX ACCENT}_u"


def log(clock: Clock, record: FlightRecord, rows: Array, sights: list[Sight]) -> None:
    """Everything the velocity view shows. ``sights`` belong to ``rows``."""
    time_s, own = record.columns["time_s"][rows], record.columns["own.vel_enu_mps"][rows]
    speed = np.linalg.norm(own, axis=1)
    clock.static(ROOT, rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    clock.static(
        f"{ROOT}/sphere/label", rr.Points3D([[0.0, 0.0, -1.06]], labels=["VS"], colors=rgba(palette.GREY), radii=rr.Radius.ui_points(0.1))
    )
    lines = rr.LineStrips3D(shapes.graticule(), colors=rgba(palette.NIGHT_LINES), radii=rr.Radius.ui_points(0.6))
    clock.static(f"{ROOT}/sphere/lines", lines)
    clock.send(f"{ROOT}/sphere", time_s, lambda k: rr.Transform3D.columns(scale=np.repeat(speed[k, None], 3, axis=1)))
    _log_axes(clock, float(speed.max()))
    everywhere = np.ones(len(rows), bool)
    _log_vector(clock, "own", "v_u", palette.OWN, time_s, own, everywhere)

    def name_of(symbol: str, name: str) -> str:
        return f"{symbol} of {name}" if len(sights) > 1 else symbol

    for sight in sights:
        if sight.in_range.any():
            _log_cones(clock, sight, time_s, own, speed, name_of)
        _log_cap(clock, sight, time_s, speed, name_of)
    for pair in corners(sights, speed):
        _log_corners(clock, pair, time_s)
    threats = np.sum([sight.is_threat for sight in sights], axis=0) if sights else np.zeros(len(rows))
    _log_commands(clock, record, time_s, threats)


def _log_axes(clock: Clock, length: float) -> None:
    colour, tips = rgba(palette.NIGHT_LINES), np.eye(3) * length
    arrows = rr.Arrows3D(origins=[[0, 0, 0]] * 3, vectors=tips, radii=rr.Radius.ui_points(1), colors=colour)
    clock.static(f"{ROOT}/axes", arrows)
    names = rr.Points3D(
        [*(tips * 1.12), [0, 0, 0]], labels=["east", "north", "up", "P_u"], radii=rr.Radius.ui_points(0.1), colors=rgba(palette.GREY)
    )
    clock.static(f"{ROOT}/axes/names", names)


def _log_vector(
    clock: Clock, entity: str, said: str, colour: str, time_s: Array, vector: Array, shown: Array, label_at: float = 1.12
) -> None:
    """An arrow from the origin, with its name beyond its tip, where other arrows do not cover it."""
    arrow, label = f"{ROOT}/{entity}/arrow", f"{ROOT}/{entity}/label"
    clock.static(arrow, rr.Arrows3D.from_fields(colors=rgba(colour), radii=rr.Radius.ui_points(2.5)))

    def build(k: Array) -> rr.ComponentColumnList:
        chosen = vector[k][shown[k]]
        return rr.Arrows3D.columns(origins=np.zeros_like(chosen), vectors=chosen).partition(shown[k].astype(int))

    clock.send(arrow, time_s, build)
    _log_points(
        clock, label, [said], colour, time_s, [label_at * v[None] if there else NONE for v, there in zip(vector, shown, strict=True)]
    )


def _log_points(clock: Clock, entity: str, said: list[str], colour: str, time_s: Array, places: list[Array], size: float = 0.1) -> None:
    """Points with names, some of the time."""
    clock.static(entity, rr.Points3D.from_fields(colors=rgba(colour), labels=said, radii=rr.Radius.ui_points(size)))
    clock.send(entity, time_s, ragged(rr.Points3D.columns, "positions", places))


def _log_lines(clock: Clock, entity: str, colour: str, width: float, time_s: Array, lines: list[Array | None]) -> None:
    """One line, some of the time."""
    clock.static(entity, rr.LineStrips3D.from_fields(colors=rgba(colour), radii=rr.Radius.ui_points(width)))

    def build(k: Array) -> rr.ComponentColumnList:
        strips = [line for row in k if (line := lines[row]) is not None]
        return rr.LineStrips3D.columns(strips=strips or [NONE]).partition([lines[row] is not None for row in k])

    if any(line is not None for line in lines):
        clock.send(entity, time_s, build)


def _log_cones(clock: Clock, sight: Sight, time_s: Array, own: Array, speed: Array, name_of: Named) -> None:
    """ACC as a body as far as the velocity sphere, where its rim is the exact border of what is forbidden; RCC as its outline."""
    seen, entity = sight.in_range, f"{ROOT}/obstacle/{sight.name}"
    where = np.flatnonzero(seen)
    rims: list[Array | None] = [None] * len(seen)
    for row, rim in zip(where, _rims(sight.apex_mps[seen], sight.axis[seen], sight.half_angle_rad[seen], speed[seen]), strict=True):
        rims[row] = rim
    sides = [NONE if rim is None else np.vstack([sight.apex_mps[row], rim[:-1]]) for row, rim in enumerate(rims)]
    body = rr.Mesh3D.from_fields(triangle_indices=shapes.cone_triangles(), albedo_factor=rgba(palette.OBSTACLE, 0.22))
    clock.static(f"{entity}/cone", body)
    clock.send(f"{entity}/cone", time_s, ragged(rr.Mesh3D.columns, "vertex_positions", sides))
    _log_lines(clock, f"{entity}/cone/rim", palette.OBSTACLE, 1.5, time_s, rims)
    tops = [NONE if rim is None else rim[[int(np.argmax(rim[:, 2]))]] * 1.06 for rim in rims]
    _log_points(clock, f"{entity}/cone/label", [name_of("ACC", sight.name)], palette.OBSTACLE, time_s, tops)
    _log_vector(clock, f"obstacle/{sight.name}", name_of("v_o, P_3-DVO", sight.name), palette.OBSTACLE, time_s, sight.apex_mps, seen)
    relative = own - sight.apex_mps
    _log_vector(
        clock,
        f"obstacle/{sight.name}/relative",
        name_of("v_uo = v_u \N{MINUS SIGN} v_o", sight.name),
        palette.RELATIVE,
        time_s,
        relative,
        seen,
    )
    outlines: list[Array | None] = [None if rim is None else _outline(rim - sight.apex_mps[row]) for row, rim in enumerate(rims)]
    _log_lines(clock, f"{entity}/relative_cone", palette.dimmed(palette.RELATIVE), 0.8, time_s, outlines)
    bottoms = [
        NONE if rim is None else (low := rim - sight.apex_mps[row])[[int(np.argmin(low[:, 2]))]] * 1.05 for row, rim in enumerate(rims)
    ]
    _log_points(clock, f"{entity}/relative_cone/label", [name_of("RCC", sight.name)], palette.RELATIVE, time_s, bottoms)


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


def _log_cap(clock: Clock, sight: Sight, time_s: Array, speed: Array, name_of: Named) -> None:
    """The cap as a patch of the sphere with its rim, centre M, radius r, half-angle gamma and critical velocities, while it is a threat."""
    shown = np.flatnonzero([found is not None for found in sight.caps])
    if not len(shown):
        return
    gamma, axis = sight.of_caps("half_angle_rad"), sight.cap_axis
    size = speed[shown, None, None] * 1.004  # a hair outside, or the lines of the sphere would cut it
    at = {int(row): n for n, row in enumerate(shown)}
    patches = shapes.turned_from_x_axis(shapes.caps(gamma[shown]), axis[shown]) * size
    rims = shapes.turned_from_x_axis(shapes.circles(gamma[shown]), axis[shown]) * size
    entity, rows = f"{ROOT}/obstacle/{sight.name}/cap", range(len(time_s))
    clock.static(entity, rr.Mesh3D.from_fields(triangle_indices=shapes.cap_triangles(), albedo_factor=rgba(palette.ORANGE, 0.35)))
    clock.send(entity, time_s, ragged(rr.Mesh3D.columns, "vertex_positions", [patches[at[k]] if k in at else NONE for k in rows]))
    _log_lines(clock, f"{entity}/rim", palette.ORANGE, 1.5, time_s, [rims[at[k]] if k in at else None for k in rows])
    middle = sight.of_caps("radius_mps")[:, None] * axis
    near, far = sight.of_caps("nearest_mps", 3), sight.of_caps("farthest_mps", 3)
    frames = [np.vstack([np.zeros(3), middle[k], near[k], np.zeros(3), far[k], middle[k]]) if k in at else None for k in rows]
    _log_lines(clock, f"{entity}/vectors", palette.ORANGE, 0.8, time_s, frames)
    arcs = [_arc(axis[k], near[k] / speed[k]) * (0.45 * speed[k]) if k in at else None for k in rows]
    _log_lines(clock, f"{entity}/gamma", palette.ORANGE, 1.2, time_s, arcs)
    marks = [np.vstack([near[k], far[k]]) if k in at else NONE for k in rows]
    _log_points(clock, f"{entity}/critical", [name_of("B", sight.name), name_of("C", sight.name)], palette.ORANGE, time_s, marks, 4.0)
    _log_measure(clock, f"{entity}/centre", sight, time_s, middle, name_of("SC", sight.name))


def cap_values(found: Cap) -> str:
    """G in the paper's letters."""
    azimuth, elevation, gamma = (f"{number(angle / DEG, 1)}" for angle in (found.azimuth_rad, found.elevation_rad, found.half_angle_rad))
    return f"r {number(found.radius_mps, 1)} m/s, {PSI}_r {azimuth}, {THETA}_r {elevation}, {GAMMA} {gamma} deg"


def _log_measure(clock: Clock, entity: str, sight: Sight, time_s: Array, middle: Array, said: str) -> None:
    """M, with the four numbers of G beside it."""
    texts = [f"M of {said}: {cap_values(found)}" if found is not None else "" for found in sight.caps]
    there = np.array([found is not None for found in sight.caps])
    clock.static(entity, rr.Points3D.from_fields(colors=rgba(palette.ORANGE), radii=rr.Radius.ui_points(4)))

    def build(k: Array) -> rr.ComponentColumnList:
        chosen = k[there[k]]
        return rr.Points3D.columns(positions=middle[chosen], labels=[texts[row] for row in chosen]).partition(there[k].astype(int))

    clock.send(entity, time_s, build)


def _arc(first: Array, last: Array, points: int = 16) -> Array:
    """Between two unit vectors, on the unit sphere."""
    angle = math.acos(max(-1.0, min(1.0, float(first @ last))))
    share = np.linspace(0.0, 1.0, points)[:, None]
    if angle < 1e-9:
        return np.repeat(first[None], points, axis=0)
    return np.asarray((np.sin((1.0 - share) * angle) * first + np.sin(share * angle) * last) / math.sin(angle))


def _log_corners(clock: Clock, pair: Corners, time_s: Array) -> None:
    """S and S'."""
    there = np.isfinite(pair.points_mps).all(axis=(1, 2))
    places = [points if shown else NONE for points, shown in zip(pair.points_mps, there, strict=True)]
    _log_points(clock, f"{ROOT}/corners/{'_'.join(pair.names)}", ["S", "S\N{PRIME}"], palette.YELLOW, time_s, places, 5.0)


def _log_commands(clock: Clock, record: FlightRecord, time_s: Array, threats: Array) -> None:
    """The velocity each decision asked for, from that decision on; K where several obstacles were threats."""
    asked = [event for event in record.events if all(math.isfinite(x) for x in event.command_enu_mps)]
    colour = rgba(palette.COMMAND)
    for event in asked:
        vector = np.array(event.command_enu_mps)
        several = threats[int(np.argmin(np.abs(time_s - event.time_s)))] > 1
        said = f"{'K = ' if several else ''}{HAT}, chosen by {words.method(event.method)}"
        clock.log(
            f"{ROOT}/command/arrow",
            event.time_s,
            rr.Arrows3D(origins=[[0, 0, 0]], vectors=[vector], colors=colour, radii=rr.Radius.ui_points(2.5)),
        )
        label = rr.Points3D([1.3 * vector], labels=[said], colors=colour, radii=rr.Radius.ui_points(0.1))
        clock.log(f"{ROOT}/command/label", event.time_s, label)
