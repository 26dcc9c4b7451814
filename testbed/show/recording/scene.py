"""The scene: paths, aircraft, air, trail and spheres in local ENU metres (the viewer draws in single precision)."""

import math

import numpy as np
import rerun as rr

from testbed.flight.record import FlightRecord, inside
from testbed.results.columns import FlightMetrics
from testbed.show import palette, shapes, words
from testbed.show.flight_summary import path_points, piece_names, route_ends, route_size
from testbed.show.palette import rgba
from testbed.show.recording.timeline import Clock, ragged, thinned

Array = np.ndarray
SYMBOL_SHARE = 0.04  # on the whole route an aircraft of its size could not be seen: there it is this share of the route's size
SCENE_HZ, TRAIL_HZ = 60.0, 20.0
ARROW_S = 0.5  # a velocity arrow ends where the thing will be after this time


def symbol_scale(record: FlightRecord, span_m: float) -> float:
    """How many times its size the aircraft has in the view of the whole route."""
    return max(1.0, SYMBOL_SHARE * route_size(record) * shapes.SPAN_OF_LENGTH / span_m) if record.paths else 1.0


def log_route(clock: Clock, record: FlightRecord) -> None:
    """The original path with its ends, and every later path from the instant it was planned."""
    clock.static("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    ends = rr.Points3D(route_ends(record), labels=["start", "goal"], colors=rgba(palette.GREY), radii=rr.Radius.ui_points(4))
    clock.static("world/plan/ends", ends)
    for count, path in enumerate(record.paths):
        colours = [rgba(palette.LEG[leg], 0.9) for leg in piece_names(record, count)]
        lines = rr.LineStrips3D(path_points(path), colors=colours, radii=rr.Radius.ui_points(1.5))
        if count == 0:
            clock.static("world/plan/route", lines)
        else:
            clock.log(f"world/plan/replanned_{count}", path.from_time_s, lines)
    for count, event in enumerate(record.events, start=1):
        if all(math.isfinite(x) for x in event.insertion_enu_m):
            point = rr.Points3D(
                [event.insertion_enu_m], labels="insertion point", colors=rgba(palette.COMMAND), radii=rr.Radius.ui_points(5)
            )
            clock.log(f"world/plan/insertion_{count}", event.time_s, point)


def log_motion(clock: Clock, record: FlightRecord, metrics: FlightMetrics, rows: Array, span_m: float) -> None:
    """Everything that moves."""
    plant_hz, columns = record.plan.rates.plant_hz, record.columns
    fine, coarse = thinned(rows, SCENE_HZ, plant_hz), thinned(rows, TRAIL_HZ, plant_hz)
    time_s, pos, vel = columns["time_s"], columns["own.pos_enu_m"], columns["own.vel_enu_mps"]
    log_aircraft(clock, "world/own", palette.WHITE, span_m, symbol_scale(record, span_m))
    attitude = columns["own.quat_enu_from_body_xyzw"]
    clock.send("world/own", time_s[fine], lambda k: rr.Transform3D.columns(translation=pos[fine[k]], quaternion=attitude[fine[k]]))
    log_arrow(clock, "world/far/velocity", palette.OWN, time_s[fine], pos[fine], vel[fine] * ARROW_S)
    log_trail(clock, "world/trail", palette.OWN, time_s[coarse], pos[coarse])
    for spec in record.plan.obstacles:
        centre, motion = columns[f"obstacle.{spec.name}.pos_enu_m"], columns[f"obstacle.{spec.name}.vel_enu_mps"]
        entity = f"world/obstacle/{spec.name}"
        log_sphere(clock, entity, palette.OBSTACLE, spec.radius_m, time_s[fine], centre[fine])
        names = rr.Points3D.from_fields(colors=rgba(palette.OBSTACLE), labels=[spec.name], radii=rr.Radius.ui_points(0.1))
        clock.static(f"{entity}/name", names)
        clock.send(f"{entity}/name", time_s[fine], ragged(rr.Points3D.columns, "positions", centre[fine][:, None]))
        log_arrow(clock, f"{entity}/velocity", palette.OBSTACLE, time_s[fine], centre[fine], motion[fine] * ARROW_S)
        track = rr.LineStrips3D([centre[coarse]], colors=rgba(palette.dimmed(palette.OBSTACLE)), radii=rr.Radius.ui_points(1))
        clock.static(f"{entity}/track", track)
    _log_closest(clock, record, metrics)


def log_aircraft(clock: Clock, entity: str, colour: str, span_m: float, scale: float, symbol: bool = True) -> None:
    """The aircraft in its own axes, at its true size and, below ``symbol``, so many times as large."""
    shape = shapes.aeroplane(span_m / shapes.SPAN_OF_LENGTH)
    for name, size in (("body", 1.0), ("symbol", scale))[: 1 + symbol]:
        mesh = rr.Mesh3D(
            vertex_positions=shape.points * size,
            triangle_indices=shape.triangles,
            vertex_normals=shape.normals,
            albedo_factor=rgba(colour),
        )
        clock.static(f"{entity}/{name}", mesh)


def log_sphere(clock: Clock, entity: str, colour: str, radius_m: float, time_s: Array, centre: Array, filled: bool = True) -> None:
    """A sphere that can be seen through, with a net on it by which its surface can be told from near; or the net alone."""
    style = rr.Ellipsoids3D.from_fields(
        half_sizes=[(radius_m,) * 3],
        colors=rgba(colour),
        fill_mode=rr.components.FillMode.TransparentFillMajorWireframe,
        line_radii=rr.Radius.ui_points(0.75),
    )
    if filled:
        clock.static(entity, style)
        clock.send(entity, time_s, ragged(rr.Ellipsoids3D.columns, "centers", centre[:, None]))
    net = [radius_m * line for line in shapes.graticule(10.0)]
    clock.static(f"{entity}/net", rr.LineStrips3D(net, colors=rgba(palette.dimmed(colour)), radii=rr.Radius.ui_points(0.5)))
    clock.send(f"{entity}/net", time_s, lambda k: rr.Transform3D.columns(translation=centre[k]))


def log_arrow(clock: Clock, entity: str, colour: str, time_s: Array, origin: Array, vector: Array) -> None:
    """An arrow that moves."""
    clock.static(entity, rr.Arrows3D.from_fields(colors=rgba(colour), radii=rr.Radius.ui_points(2)))
    clock.send(entity, time_s, lambda k: rr.Arrows3D.columns(origins=origin[k], vectors=vector[k]).partition([1] * len(k)))


def log_trail(clock: Clock, entity: str, colour: str, time_s: Array, pos: Array) -> None:
    """What was flown, piece by piece."""
    pieces = np.stack([pos[:-1], pos[1:]], axis=1)
    if len(pieces):
        clock.static(entity, rr.LineStrips3D.from_fields(colors=rgba(colour), radii=rr.Radius.ui_points(2)))
        clock.send(entity, time_s[1:], lambda k: rr.LineStrips3D.columns(strips=list(pieces[k])))


def log_label(clock: Clock, entity: str, time_s: Array, places: Array, texts: list[str], colours: Array) -> None:
    """A text that moves and changes."""
    clock.static(entity, rr.Points3D.from_fields(radii=rr.Radius.ui_points(0.1)))
    clock.send(entity, time_s, lambda k: rr.Points3D.columns(positions=places[k], labels=[texts[row] for row in k], colors=colours[k]))


def _log_closest(clock: Clock, record: FlightRecord, metrics: FlightMetrics) -> None:
    """From the instant of closest approach on: the line between the two centres at that instant."""
    name, at_s, time_s = metrics.nearest_obstacle, metrics.time_at_least_clearance_s, record.columns["time_s"]
    if not name or not math.isfinite(at_s):
        return
    ends = [
        np.array([np.interp(at_s, time_s, record.columns[column][:, k]) for k in range(3)])
        for column in ("own.pos_enu_m", f"obstacle.{name}.pos_enu_m")
    ]
    colour = palette.ALARM if inside(metrics.least_clearance_m) else palette.WHITE
    line = rr.LineStrips3D(
        [ends], labels=f"closest: {words.clearance(metrics.least_clearance_m)}", colors=rgba(colour), radii=rr.Radius.ui_points(1)
    )
    clock.log("world/closest_approach", at_s, line)
