"""Several flights of one encounter in one recording, aligned at their decisions: who kept clear, and by how much, at a glance."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from testbed.core.units import DEG
from testbed.flight.record import FlightRecord, inside
from testbed.results.columns import FlightMetrics
from testbed.show import palette, words
from testbed.show.cameras import Shot, close_up, fixed
from testbed.show.encounter import AFTER_S, Window, to_surface, window_of
from testbed.show.flight_summary import path_points, piece_names
from testbed.show.labels import Sheet
from testbed.show.palette import rgba
from testbed.show.recording import layout
from testbed.show.recording.file import readable, written
from testbed.show.recording.film import Text, log_camera, places_of
from testbed.show.recording.scene import log_aircraft, log_arrow, log_label, log_sphere, log_trail
from testbed.show.recording.signals import limit_lines, log_curve, log_level
from testbed.show.recording.timeline import TICK_S, Clock, trail_ranges
from testbed.show.true_size import wing_span_m
from testbed.show.words import number

Array = np.ndarray
HZ = 60.0
COLOURS = (palette.SKY, palette.YELLOW, palette.GREEN, palette.PURPLE, palette.WHITE, "#7FD1AE", "#C8B6FF", "#B5C99A", "#FFD6A5", "#A0C4FF")
SAME_M = 0.05  # spheres of two flights that never differ by more are one
SHEETS = {"world": Sheet(390.0, np.array([0.95, 0.45])), "relative": Sheet(290.0, np.array([1.3, 0.45]))}  # the views that names stand in
BESIDE = 0.25  # so far along the way from the first aircraft to the sphere is the middle of the picture


@dataclass(frozen=True)
class Flown:
    """One of the flights: what it is called, and what came of it."""

    name: str
    record: FlightRecord
    metrics: FlightMetrics


@dataclass(frozen=True)
class _Run:
    """A flight at the common instants: rows (n,) of its record, places, way to the surface of its nearest sphere, clearance."""

    flown: Flown
    window: Window
    colour: str
    time_s: Array
    rows: Array
    own: Array
    vel: Array
    centre: Array
    centre_vel: Array
    gap: Array
    clearance_m: Array
    radius_m: float
    span_m: float


def write_overlay(flights: list[Flown], title: str, path: Path) -> None:
    """Write them all into one file; the first is the one that the camera follows. Each must have come near an obstacle."""
    runs = _aligned(flights)
    first = runs[0]
    shots = {"close": _close(runs), "relative": _relative(first)}
    with written(path, title, f"overlay_{first.flown.record.plan.flight_id}", _blueprint(runs)) as stream:
        clock = Clock(stream, 0.0, float(first.time_s[-1]), whole=False)
        clock.static("summary", rr.TextDocument(readable(_table(runs, title)), media_type="text/markdown"))
        clock.static("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        clock.static("relative", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        for camera, shot in shots.items():
            log_camera(clock, f"world/camera/{camera}", first.time_s, shot)
        _log_paths(clock, first)
        log_sphere(clock, "relative/sphere", palette.OBSTACLE, first.radius_m, first.time_s, np.zeros_like(first.own))
        for number_of, run in enumerate(runs):
            _log_run(clock, number_of, run, runs)
        _log_names(clock, "world", runs, [run.own for run in runs], [run.own + run.gap for run in runs], shots["close"])
        relative = [run.own - run.centre for run in runs]
        _log_names(
            clock, "relative", runs, relative, [place + run.gap for place, run in zip(relative, runs, strict=True)], shots["relative"]
        )
        _log_curves(clock, runs)


def can_be_shown(flown: Flown) -> bool:
    """Whether the flight came near an obstacle at all."""
    window = window_of(flown.record, flown.metrics)
    return bool(window.obstacle) and window.end_s > window.begin_s


def _aligned(flights: list[Flown]) -> list[_Run]:
    """Each at the same times after its decision, as long as all of them last."""
    windows = [window_of(one.record, one.metrics) for one in flights]
    lasts = [float(one.record.columns["time_s"][-1]) - window.begin_s for one, window in zip(flights, windows, strict=True)]
    length = min(max(window.closest_s - window.begin_s for window in windows) + AFTER_S, *lasts)
    time_s = np.arange(int(length * HZ + 1e-6) + 1) / HZ
    return [_run(one, window, COLOURS[k % len(COLOURS)], time_s) for k, (one, window) in enumerate(zip(flights, windows, strict=True))]


def _run(flown: Flown, window: Window, colour: str, time_s: Array) -> _Run:
    record = flown.record
    columns, plan, name = record.columns, record.plan, window.obstacle
    rows = np.clip(np.rint((time_s + window.begin_s) * plan.rates.plant_hz).astype(int), 0, len(columns["time_s"]) - 1)
    radius_m = next(spec.radius_m for spec in plan.obstacles if spec.name == name)
    own, centre = columns["own.pos_enu_m"][rows], columns[f"obstacle.{name}.pos_enu_m"][rows]
    return _Run(
        flown, window, colour, time_s, rows, own, columns["own.vel_enu_mps"][rows], centre, columns[f"obstacle.{name}.vel_enu_mps"][rows],
        to_surface(own, centre, radius_m), columns[f"obstacle.{name}.clearance_m"][rows], radius_m, wing_span_m(plan.aircraft),
    )  # fmt: skip


def _close(runs: list[_Run]) -> Shot:
    """The first flight's encounter, with the others in the picture."""
    first = runs[0]
    others = np.max([np.linalg.norm(run.own - first.own, axis=1) for run in runs], axis=0)
    closest = int(np.argmin(first.clearance_m))
    return close_up(first.own, first.vel, first.centre, first.centre_vel, first.gap, closest, first.span_m, others, BESIDE)


def _relative(first: _Run) -> Shot:
    """The same side, the whole sphere, and nothing that moves but the aircraft."""
    closest = int(np.argmin(first.clearance_m))
    towards = -close_up(first.own, first.vel, first.centre, first.centre_vel, first.gap, closest, first.span_m).axes[0, :, 2]
    beside = first.own[closest] - first.centre[closest]
    return fixed(0.5 * beside, towards, 3.2 * first.radius_m, len(first.time_s))


def _log_paths(clock: Clock, first: _Run) -> None:
    """The paths of the first flight: of the others they are nearly the same."""
    record = first.flown.record
    for count, path in enumerate(record.paths):
        colours = [rgba(palette.dimmed(palette.LEG[leg])) for leg in piece_names(record, count)]
        clock.static(f"world/plan/path_{count}", rr.LineStrips3D(path_points(path), colors=colours, radii=rr.Radius.ui_points(1)))


def _log_run(clock: Clock, count: int, run: _Run, runs: list[_Run]) -> None:
    """Aircraft at its true size, trail, spheres where they are not those of a flight before it, and the way to the surface."""
    columns = run.flown.record.columns
    attitude = columns["own.quat_enu_from_body_xyzw"][run.rows]
    red = np.where(inside(run.clearance_m)[:, None], rgba(palette.ALARM), rgba(run.colour)).astype(np.uint8)
    for root, own in (("world", run.own), ("relative", run.own - run.centre)):
        entity = f"{root}/flight_{count}"
        log_aircraft(clock, f"{entity}/own", run.colour, run.span_m, 1.0, symbol=False)
        clock.send(f"{entity}/own", run.time_s, _poses(own, attitude))
        log_trail(clock, f"{entity}/trail", run.colour, run.time_s, own)
        ways = np.stack([own, own + run.gap], axis=1)
        clock.static(f"{entity}/clearance", rr.LineStrips3D.from_fields(radii=rr.Radius.ui_points(1.2)))
        clock.send(f"{entity}/clearance", run.time_s, _ways(ways, red))
    for spec in run.flown.record.plan.obstacles:
        places = columns[f"obstacle.{spec.name}.pos_enu_m"][run.rows]
        if not any(_same(places, other, spec.name) for other in runs[:count]):
            colour = palette.OBSTACLE if count == 0 else palette.dimmed(run.colour)
            log_sphere(clock, f"world/flight_{count}/obstacle/{spec.name}", colour, spec.radius_m, run.time_s, places, filled=count == 0)
    wind = columns["air.wind_enu_mps"][run.rows] if "air.wind_enu_mps" in columns else np.zeros_like(run.own)
    if np.nanmax(np.linalg.norm(wind, axis=1)) > 0.0:
        scale = run.span_m / 10.0
        log_arrow(clock, f"world/flight_{count}/wind", palette.AIR, run.time_s, run.own - scale * wind, scale * wind)


def _poses(own: Array, attitude: Array):  # type: ignore[no-untyped-def]
    return lambda k: rr.Transform3D.columns(translation=own[k], quaternion=attitude[k])


def _ways(ways: Array, colours: Array):  # type: ignore[no-untyped-def]
    return lambda k: rr.LineStrips3D.columns(strips=list(ways[k]), colors=colours[k])


def _same(places: Array, other: _Run, name: str) -> bool:
    """Whether the other flight's sphere of that name is always where this one is."""
    theirs = other.flown.record.columns.get(f"obstacle.{name}.pos_enu_m")
    return theirs is not None and bool(np.nanmax(np.linalg.norm(theirs[other.rows] - places, axis=1), initial=0.0) <= SAME_M)


def live_names(run: "_Run") -> list[str]:
    """What the flight's label says at each instant: its clearance then, and after the closest approach the least."""
    closest = run.window.closest_s - run.window.begin_s
    return [
        f"{run.flown.name}: passed {words.clearance(run.flown.metrics.least_clearance_m)}"
        if t > closest + TICK_S
        else f"{run.flown.name}: {words.clearance(now)}"
        for t, now in zip(run.time_s, run.clearance_m, strict=True)
    ]


def _log_names(clock: Clock, root: str, runs: list[_Run], own: list[Array], surface: list[Array], shot: Shot) -> None:
    """A label for each flight in a column at the side away from the sphere, with a line from its end to its aircraft."""
    seen = np.stack([shot.seen(place) for place in own], axis=1)
    away = np.sign(np.nanmean(seen[:, :, 0] - np.stack([shot.seen(place)[:, 0] for place in surface], axis=1)))
    away = away if away else -1.0
    sheet = SHEETS[root]
    texts: list[Text] = []
    for k, run in enumerate(runs):
        hit = inside(run.clearance_m) | (
            inside(run.flown.metrics.least_clearance_m) & (run.time_s > run.window.closest_s - run.window.begin_s + TICK_S)
        )
        colours = np.where(hit[:, None], rgba(palette.ALARM), rgba(run.colour)).astype(np.uint8)
        said = live_names(run)
        column = away * (sheet.edge[0] - 0.5 * np.array([sheet.size(text)[0] for text in said]))
        texts.append((run.flown.name, own[k], np.column_stack([column - seen[:, k, 0], np.zeros(len(column))]), said, colours))
    places = places_of(shot, texts, sheet)
    for k, (_, place, _, said, colours) in enumerate(texts):
        at = shot.at(places[:, k])
        log_label(clock, f"{root}/flight_{k}/label", runs[k].time_s, at, said, colours)
        half = 0.5 * np.array([sheet.size(text) for text in said])  # the viewer writes a text below its place
        ends = places[:, k] - np.column_stack([away * half[:, 0], half[:, 1]])
        leader = np.stack([place, shot.at(ends)], axis=1)
        shade = np.repeat(np.array([rgba(palette.dimmed(runs[k].colour))], np.uint8), len(leader), axis=0)
        clock.static(f"{root}/flight_{k}/leader", rr.LineStrips3D.from_fields(radii=rr.Radius.ui_points(0.6)))
        clock.send(f"{root}/flight_{k}/leader", runs[k].time_s, _ways(leader, shade))


CURVES = (
    ("clearance", "", 1.0),
    ("bank", "own.bank_rad", 1.0 / DEG),
    ("load_factor", "own.load_factor", 1.0),
    ("airspeed", "own.airspeed_mps", 1.0),
)


def _log_curves(clock: Clock, runs: list[_Run]) -> None:
    """The same four curves of every flight, with the surface and the limits of the first."""
    for k, run in enumerate(runs):
        for entity, column, factor in CURVES:
            values = run.flown.record.columns[column][run.rows] * factor if column else run.clearance_m
            log_curve(clock, f"signals/{entity}/flight_{k}", run.flown.name, run.colour, run.time_s, values)
    first = runs[0]
    log_level(clock, "signals/clearance/surface", f"surface (radius {number(first.radius_m, 0)} m)", palette.ALARM, first.time_s, 0.0)
    for entity, (name, value) in limit_lines(first.flown.record).items():
        log_level(clock, f"signals/{entity}", name, palette.ALARM, first.time_s, value)


def _table(runs: list[_Run], title: str) -> str:
    """What came of each flight."""
    head = "| flight | closest | most bank | load factor | id |\n|---|---:|---:|---:|---|"
    lines = [
        f"| {run.flown.name} | **{words.clearance(m.least_clearance_m)}** | {number(m.max_bank_deg, 0)} deg "
        f"| {number(m.max_load_factor, 1)} | `{run.flown.record.plan.flight_id}` |"
        for run in runs
        for m in [run.flown.metrics]
    ]
    note = (
        "All flights begin at their decision. Aircraft are drawn at their true size. Above: over the ground, with a sphere for each place "
        "that the obstacle has in one of the flights. Below: as seen from the obstacle, where one sphere serves all."
    )
    return "\n".join([f"#### {title}", "", head, *lines, "", note])


def _blueprint(runs: list[_Run]) -> rrb.Blueprint:
    record, least = runs[0].flown.record, min(run.flown.metrics.least_clearance_m for run in runs)
    trails: layout.Trails = {f"{root}/flight_{k}/trail": trail_ranges() for k in range(len(runs)) for root in ("/world", "/relative")}
    close = layout.spatial(record, "All flights (at their true size), aligned at the decision", layout.looking_through("close"), [], trails)
    relative = rrb.Spatial3DView(
        origin="/relative",
        contents=["+ /relative/**", "+ /world/camera/relative"],
        name="As seen from the obstacle",
        background=rgba(palette.NIGHT),
        line_grid=False,
        eye_controls=layout.looking_through("relative"),
        overrides=trails,
    )
    panels = rrb.Vertical(
        layout.curves("clearance", "Clearance, m", rrb.ScalarAxis(range=layout.clearance_range(least))),
        layout.curves("bank", "Bank, deg (right is positive)", legend=False),
        rrb.Tabs(
            layout.curves("load_factor", "Load factor", legend=False),
            layout.curves("airspeed", "Airspeed, m/s", legend=False),
            active_tab=0,
        ),
        rrb.TextDocumentView(origin="/summary", name="What came of it"),
        row_shares=[3, 2, 2, 3],
    )
    return layout.page(rrb.Horizontal(rrb.Vertical(close, relative, row_shares=[4, 3]), panels, column_shares=[5, 3]), plays=True)
