"""Velocity space: the sphere of reachable velocities, what obstacles forbid on it, own and commanded velocity. Unit: m/s."""

import math

import numpy as np
import rerun as rr

from testbed.flight.record import FlightRecord
from testbed.show import palette, shapes
from testbed.show.palette import rgba
from testbed.show.recording import timeline
from testbed.show.velocity_space import Sight

ROOT = "velocity"


def log(stream: rr.RecordingStream, record: FlightRecord, rows: np.ndarray, sights: list[Sight]) -> None:
    """Everything the velocity view shows. ``sights`` belong to ``rows``."""
    time_s, own = record.columns["time_s"][rows], record.columns["own.vel_enu_mps"][rows]
    speed = np.linalg.norm(own, axis=1)
    stream.log(ROOT, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    lines = rr.LineStrips3D(shapes.graticule(), colors=rgba(palette.NIGHT_LINES), radii=rr.Radius.ui_points(0.6))
    stream.log(f"{ROOT}/sphere/lines", lines, static=True)
    size = rr.Transform3D.columns(scale=np.repeat(speed[:, None], 3, axis=1))
    stream.send_columns(f"{ROOT}/sphere", [timeline.index(time_s)], [*size])
    _log_axes(stream, float(speed.max()))
    _log_vector(stream, "own", palette.OWN, time_s, own, np.ones(len(rows), bool))
    for sight in sights:
        _log_cone(stream, sight, time_s, speed)
        _log_cap(stream, sight, time_s, speed)
    _log_commands(stream, record)


def _log_axes(stream: rr.RecordingStream, length: float) -> None:
    colour, tips = rgba(palette.GREY), np.eye(3) * length
    arrows = rr.Arrows3D(origins=[[0, 0, 0]] * 3, vectors=tips, radii=rr.Radius.ui_points(1), colors=colour)
    stream.log(f"{ROOT}/axes", arrows, static=True)
    names = rr.Points3D(tips * 1.12, labels=["east", "north", "up"], radii=rr.Radius.ui_points(0.1), colors=colour)
    stream.log(f"{ROOT}/axes/names", names, static=True)


def _log_vector(
    stream: rr.RecordingStream, name: str, colour: str, time_s: np.ndarray, vector: np.ndarray, shown: np.ndarray, label_at: float = 1.15
) -> None:
    """An arrow from the origin, with its name beyond its tip, where other arrows do not cover it."""
    entity, label = f"{ROOT}/{name}/arrow", f"{ROOT}/{name}/label"
    stream.log(entity, rr.Arrows3D.from_fields(colors=rgba(colour), radii=rr.Radius.ui_points(2.5)), static=True)
    arrows = rr.Arrows3D.columns(origins=np.zeros_like(vector[shown]), vectors=vector[shown]).partition(shown.astype(int))
    stream.send_columns(entity, [timeline.index(time_s)], arrows)
    stream.log(
        label, rr.Points3D.from_fields(colors=rgba(colour), labels=[name.rsplit("/", 1)[-1]], radii=rr.Radius.ui_points(0.1)), static=True
    )
    points = rr.Points3D.columns(positions=label_at * vector[shown]).partition(shown.astype(int))
    stream.send_columns(label, [timeline.index(time_s)], points)


def _log_cone(stream: rr.RecordingStream, sight: Sight, time_s: np.ndarray, speed: np.ndarray) -> None:
    """The velocity obstacle: apex at the obstacle's velocity, axis along the line of sight, half-angle alpha_0.

    It is drawn as far as the velocity sphere; its rim there is the exact border of what is forbidden at the present speed.
    """
    seen = sight.in_range
    if not seen.any():
        return
    apex = sight.apex_mps[seen]
    rims = _rims(apex, sight.axis[seen], sight.half_angle_rad[seen], speed[seen])
    sides = np.concatenate([apex[:, None], rims[:, :-1]], axis=1)
    entity, at = f"{ROOT}/obstacle/{sight.name}/cone", [timeline.index(time_s)]
    stream.log(
        entity, rr.Mesh3D.from_fields(triangle_indices=shapes.cone_triangles(), albedo_factor=rgba(palette.OBSTACLE, 0.25)), static=True
    )
    stream.send_columns(entity, at, rr.Mesh3D.columns(vertex_positions=sides.reshape(-1, 3)).partition(seen * sides.shape[1]))
    stream.log(f"{entity}/rim", rr.LineStrips3D.from_fields(colors=rgba(palette.OBSTACLE), radii=rr.Radius.ui_points(1.5)), static=True)
    stream.send_columns(f"{entity}/rim", at, rr.LineStrips3D.columns(strips=list(rims)).partition(seen.astype(int)))
    _log_vector(stream, f"obstacle/{sight.name}", palette.OBSTACLE, time_s, sight.apex_mps, seen)


def _rims(apex_mps: np.ndarray, axis: np.ndarray, half_angle_rad: np.ndarray, speed_mps: np.ndarray) -> np.ndarray:
    """Where the side lines of each cone leave the velocity sphere (n, m, 3); one that misses the sphere is drawn one radius long."""
    along = shapes.turned_from_x_axis(shapes.circles(half_angle_rad), axis)
    toward = np.einsum("nmi,ni->nm", along, apex_mps)
    under_root = (speed_mps**2 - np.einsum("ni,ni->n", apex_mps, apex_mps))[:, None] + toward**2
    length = np.sqrt(np.maximum(under_root, 0.0)) - toward
    reach = np.where((under_root > 0.0) & (length > 0.0), length, speed_mps[:, None])
    rims: np.ndarray = apex_mps[:, None] + reach[:, :, None] * along
    return rims


def _log_cap(stream: rr.RecordingStream, sight: Sight, time_s: np.ndarray, speed: np.ndarray) -> None:
    """The spherical cap as a patch of the sphere with its rim; nothing while the obstacle is no threat."""
    shown = np.isfinite(sight.cap_half_angle_rad)
    if not shown.any():
        return
    half_angle, axis = sight.cap_half_angle_rad[shown], sight.cap_axis[shown]
    radius = speed[shown, None, None] * 1.004  # a hair outside, or the lines of the sphere would cut it
    patches = shapes.turned_from_x_axis(shapes.caps(half_angle), axis) * radius
    rims = shapes.turned_from_x_axis(shapes.circles(half_angle), axis) * radius
    entity = f"{ROOT}/obstacle/{sight.name}/cap"
    style = rr.Mesh3D.from_fields(triangle_indices=shapes.cap_triangles(), albedo_factor=rgba(palette.ORANGE, 0.35))
    stream.log(entity, style, static=True)
    at = [timeline.index(time_s)]
    stream.send_columns(entity, at, rr.Mesh3D.columns(vertex_positions=patches.reshape(-1, 3)).partition(shown * patches.shape[1]))
    stream.log(f"{entity}/rim", rr.LineStrips3D.from_fields(colors=rgba(palette.ORANGE), radii=rr.Radius.ui_points(1.5)), static=True)
    stream.send_columns(f"{entity}/rim", at, rr.LineStrips3D.columns(strips=list(rims)).partition(shown.astype(int)))


def _log_commands(stream: rr.RecordingStream, record: FlightRecord) -> None:
    """The velocity each decision asked for, from that decision on."""
    asked = [event for event in record.events if all(math.isfinite(x) for x in event.command_enu_mps)]
    if asked:
        time_s, vectors = np.array([event.time_s for event in asked]), np.array([event.command_enu_mps for event in asked])
        _log_vector(stream, "command", palette.COMMAND, time_s, vectors, np.ones(len(asked), bool), label_at=1.35)
