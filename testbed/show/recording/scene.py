"""The scene: paths, aircraft, trail and spheres in local ENU metres (the viewer draws in single precision)."""

import math

import numpy as np
import rerun as rr

from testbed.flight.record import FlightRecord
from testbed.results.columns import FlightMetrics
from testbed.show import palette, shapes
from testbed.show.flight_summary import path_points, piece_names, route_ends, route_size
from testbed.show.palette import rgba
from testbed.show.recording import timeline
from testbed.show.words import number

SYMBOL_SHARE = 0.04  # the aeroplane is pictured larger than life: this share of the route's size, or it could not be seen
SCENE_HZ, TRAIL_HZ = 60.0, 20.0
ARROW_S = 0.5  # a velocity arrow ends where the thing will be after this time


def log_route(stream: rr.RecordingStream, record: FlightRecord) -> None:
    """The original path with its ends, and every later path from the instant it was planned."""
    stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    stream.log(
        "world/plan/ends",
        rr.Points3D(
            route_ends(record),
            labels=["start", "goal"],
            colors=rgba(palette.GREY),
            radii=rr.Radius.ui_points(4),
        ),
        static=True,
    )
    for count, path in enumerate(record.paths):
        colours = [rgba(palette.LEG[leg], 0.9) for leg in piece_names(record, count)]
        lines = rr.LineStrips3D(path_points(path), colors=colours, radii=rr.Radius.ui_points(1.5))
        if count == 0:
            stream.log("world/plan/route", lines, static=True)
        else:
            stream.set_time(timeline.TIMELINE, duration=path.from_time_s)
            stream.log(f"world/plan/replanned_{count}", lines)
    for count, event in enumerate(record.events, start=1):
        if all(math.isfinite(x) for x in event.insertion_enu_m):
            stream.set_time(timeline.TIMELINE, duration=event.time_s)
            point = rr.Points3D(
                [event.insertion_enu_m], labels="insertion point", colors=rgba(palette.COMMAND), radii=rr.Radius.ui_points(6)
            )
            stream.log(f"world/plan/insertion_{count}", point)
    stream.reset_time()


def log_motion(stream: rr.RecordingStream, record: FlightRecord, metrics: FlightMetrics, rows: np.ndarray) -> None:
    """Everything that moves."""
    plant_hz = record.plan.rates.plant_hz
    fine, coarse = timeline.thinned(rows, SCENE_HZ, plant_hz), timeline.thinned(rows, TRAIL_HZ, plant_hz)
    columns = record.columns
    time_s, pos, vel = columns["time_s"], columns["own.pos_enu_m"], columns["own.vel_enu_mps"]
    symbol = shapes.aeroplane(SYMBOL_SHARE * route_size(record))
    stream.log(
        "world/own/body",
        rr.Mesh3D(
            vertex_positions=symbol.points,
            triangle_indices=symbol.triangles,
            vertex_normals=symbol.normals,
            albedo_factor=rgba(palette.WHITE),
        ),
        static=True,
    )
    pose = rr.Transform3D.columns(translation=pos[fine], quaternion=columns["own.quat_enu_from_body_xyzw"][fine])
    stream.send_columns("world/own", [timeline.index(time_s[fine])], [*pose])
    _log_arrow(stream, "world/own_velocity", palette.OWN, time_s[fine], pos[fine], vel[fine] * ARROW_S)
    segments = np.stack([pos[coarse[:-1]], pos[coarse[1:]]], axis=1)
    if len(segments):
        stream.log("world/trail", rr.LineStrips3D.from_fields(colors=rgba(palette.OWN), radii=rr.Radius.ui_points(2.5)), static=True)
        stream.send_columns("world/trail", [timeline.index(time_s[coarse[1:]])], [*rr.LineStrips3D.columns(strips=list(segments))])
    for spec in record.plan.obstacles:
        centre, motion = columns[f"obstacle.{spec.name}.pos_enu_m"], columns[f"obstacle.{spec.name}.vel_enu_mps"]
        entity = f"world/obstacle/{spec.name}"
        style = rr.Ellipsoids3D.from_fields(
            half_sizes=[(spec.radius_m,) * 3],
            colors=rgba(palette.OBSTACLE),
            labels=[spec.name],
            fill_mode=rr.components.FillMode.TransparentFillMajorWireframe,
            line_radii=rr.Radius.ui_points(0.75),
        )
        stream.log(entity, style, static=True)
        stream.send_columns(
            entity, [timeline.index(time_s[fine])], rr.Ellipsoids3D.columns(centers=centre[fine]).partition([1] * len(fine))
        )
        _log_arrow(stream, f"{entity}/velocity", palette.OBSTACLE, time_s[fine], centre[fine], motion[fine] * ARROW_S)
        track = rr.LineStrips3D([centre[coarse]], colors=rgba(palette.OBSTACLE, 0.35), radii=rr.Radius.ui_points(1))
        stream.log(f"{entity}/track", track, static=True)
    _log_closest(stream, record, metrics)


def _log_arrow(stream: rr.RecordingStream, entity: str, colour: str, time_s: np.ndarray, origin: np.ndarray, vector: np.ndarray) -> None:
    stream.log(entity, rr.Arrows3D.from_fields(colors=rgba(colour), radii=rr.Radius.ui_points(2)), static=True)
    arrows = rr.Arrows3D.columns(origins=origin, vectors=vector).partition([1] * len(time_s))
    stream.send_columns(entity, [timeline.index(time_s)], arrows)


def _log_closest(stream: rr.RecordingStream, record: FlightRecord, metrics: FlightMetrics) -> None:
    """From the instant of closest approach on: the line between the two centres at that instant."""
    name, at_s, time_s = metrics.nearest_obstacle, metrics.time_at_least_clearance_s, record.columns["time_s"]
    if not name or not math.isfinite(at_s):
        return
    ends = [
        np.array([np.interp(at_s, time_s, record.columns[column][:, k]) for k in range(3)])
        for column in ("own.pos_enu_m", f"obstacle.{name}.pos_enu_m")
    ]
    stream.set_time(timeline.TIMELINE, duration=at_s)
    line = rr.LineStrips3D(
        [ends],
        labels=f"least clearance {number(metrics.least_clearance_m, 1)} m",
        colors=rgba(palette.WHITE),
        radii=rr.Radius.ui_points(1.5),
    )
    stream.log("world/closest_approach", line)
    stream.reset_time()
