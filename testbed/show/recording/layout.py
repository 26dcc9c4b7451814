"""What the viewer shows when a recording is opened."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from rerun.encodings import EntityPath

from testbed.flight.record import FlightRecord
from testbed.results.columns import FlightMetrics
from testbed.show import palette
from testbed.show.encounter import Window
from testbed.show.flight_summary import path_points, route_ends
from testbed.show.palette import rgba
from testbed.show.recording import timeline

CLEARANCE_SHOWN_M = (-6.0, 24.0)  # so little that 3 m are a tenth of the picture; a flight that keeps farther away gets more
PLAY_SPEED = 0.25  # an encounter takes two seconds, which nobody can follow
STILL_SPEED = 1.0
OPENS_WITH = 0  # of the tabs of the scene: the encounter from near
Trails = Mapping[EntityPath | str, Any]
"""Entities that leave one behind them, to what shows it."""

ONLY_CLOSE, ONLY_CHASE = "/world/close/**", "/world/chase/**"


def blueprint(record: FlightRecord, metrics: FlightMetrics, window: Window, scale: float) -> rrb.Blueprint:
    """The encounter from near, with the curves that say whether it was flown; all else in tabs. ``scale``: of the aircraft on the route."""
    whole = _route(record, f"Whole route ({_times(scale)})", window)
    scenes = [*_filmed(record, window), whole, _velocity()]
    details = rrb.Tabs(
        rrb.TextLogView(origin="/events", name="Events", columns=rrb.TextLogColumns(text_log_columns=["LogLevel", "Body"])),
        rrb.TextDocumentView(origin="/summary", name="Summary"),
        rrb.StateTimelineView(origin="/modes", name="Modes"),
        curves("cross_track", "Cross-track, m", legend=False),
        curves("throttle", "Throttle, %", legend=False),
        curves("alpha", "Angle of attack, deg", legend=False),
        active_tab=0,
        name="Details",
    )
    panels = rrb.Vertical(
        curves("clearance", "Clearance, m", rrb.ScalarAxis(range=clearance_range(metrics.least_clearance_m))),
        curves("bank", "Bank, deg (right is positive)"),
        curves("load_factor", "Load factor"),
        curves("airspeed", "Airspeed, m/s"),
        row_shares=[4, 3, 3, 3],
    )
    left = rrb.Vertical(rrb.Tabs(*scenes, active_tab=min(OPENS_WITH, len(scenes) - 1), name="Scene"), details, row_shares=[5, 2])
    return page(rrb.Horizontal(left, panels, column_shares=[5, 3]), bool(window.obstacle))


def page(root: rrb.Container, plays: bool) -> rrb.Blueprint:
    """The viewer with nothing open but the pictures; it plays the encounter again and again, or waits at the start of the flight."""
    panel = rrb.TimePanel(
        timeline=timeline.ENCOUNTER if plays else timeline.TIMELINE,
        state="collapsed",
        play_state="playing" if plays else "paused",
        loop_mode="all" if plays else "off",
        playback_speed=PLAY_SPEED if plays else STILL_SPEED,
    )
    panels = (panel, rrb.BlueprintPanel(state="hidden"), rrb.SelectionPanel(state="hidden"))
    return rrb.Blueprint(root, *panels, auto_views=False, auto_layout=False)


def clearance_range(least_m: float) -> tuple[float, float]:
    """What of the clearance is shown: from below the surface, or below the least clearance, to 30 m more, or as far as the least is."""
    low, high = CLEARANCE_SHOWN_M
    if not math.isfinite(least_m):
        return low, high
    return min(low, least_m - 3.0), max(high, 1.5 * least_m) if least_m > 0.0 else high


def spatial(record: FlightRecord, name: str, eye: rrb.EyeControls3D, without: list[str], trails: Trails | None = None) -> rrb.Spatial3DView:
    """A view of the scene, without some of its entities."""
    return rrb.Spatial3DView(
        origin="/world",
        contents=["+ $origin/**", *(f"- {entity}" for entity in without)],
        name=name,
        background=rgba(palette.NIGHT),
        line_grid=rrb.LineGrid3D(
            visible=True,
            spacing=50.0,
            plane=rr.components.Plane3D.XY.with_distance(record.plan.terrain_z_m),
            stroke_width=1.0,
            color=rgba(palette.NIGHT_GRID),
        ),
        eye_controls=eye,
        overrides={"/world/trail": timeline.trail_ranges()} if trails is None else trails,
    )


def _filmed(record: FlightRecord, window: Window) -> list[rrb.Spatial3DView]:
    """The encounter from near and from behind the aircraft; nothing without an obstacle."""
    if not window.obstacle:
        return []
    names = [f"/world/obstacle/{spec.name}/name" for spec in record.plan.obstacles]
    velocities = [f"/world/obstacle/{spec.name}/velocity" for spec in record.plan.obstacles]
    hidden = ["/world/own/symbol", "/world/closest_approach", "/world/plan/ends", "/world/far/**"]
    close = [*hidden, ONLY_CHASE, *names, *velocities]
    chase = [*hidden, ONLY_CLOSE, *velocities]
    return [
        spatial(record, "Encounter (aircraft at its true size)", looking_through("close"), close),
        spatial(record, "Chase", looking_through("chase"), chase),
    ]


def looking_through(camera: str) -> rrb.EyeControls3D:
    """The eye of a view that is filmed."""
    return rrb.EyeControls3D(tracking_entity=f"/world/camera/{camera}")


def _times(scale: float) -> str:
    return f"aircraft drawn {scale:.0f} times its size" if scale > 1.0 else "aircraft at its true size"


def _route(record: FlightRecord, name: str, window: Window) -> rrb.Spatial3DView:
    """The whole route from its right-hand side and above; without a route, the surroundings of the start."""
    places = [point for path in record.paths for piece in path_points(path, 8) for point in piece]
    places += route_ends(record)
    start = np.array(record.plan.route.start_enu_m)
    box = np.array(places or [start, start + np.array([100.0, 0.0, 0.0])])
    low, high = box.min(axis=0), box.max(axis=0)
    centre, extent = (low + high) / 2, float(np.linalg.norm(high - low))
    along = box[-1] - box[-2]
    along = along / max(float(np.linalg.norm(along[:2])), 1.0)
    aside = np.array([along[1], -along[0], 0.0])
    position = centre + extent * (0.60 * aside - 0.14 * along * [1, 1, 0] + np.array([0.0, 0.0, 0.45]))
    eye = rrb.EyeControls3D(kind=rrb.Eye3DKind.Orbital, position=position, look_target=centre, eye_up=(0, 0, 1))
    without = [ONLY_CLOSE, ONLY_CHASE, "/world/streaks", "/world/camera/**", "/world/clearance"]
    return spatial(record, name, eye, [*without, "/world/own/body"] if window.obstacle else without)


def _velocity() -> rrb.Spatial3DView:
    """Velocity space through its camera."""
    return rrb.Spatial3DView(
        origin="/velocity",
        name="Velocity space (m/s), as in the paper",
        background=rgba(palette.NIGHT),
        line_grid=False,
        eye_controls=rrb.EyeControls3D(tracking_entity="/velocity/camera"),
    )


def curves(entity: str, name: str, axis: rrb.ScalarAxis | None = None, legend: bool = True) -> rrb.TimeSeriesView:
    """A plot."""
    return rrb.TimeSeriesView(
        origin=f"/signals/{entity}",
        name=name,
        axis_y=axis,
        plot_legend=rrb.PlotLegend(visible=legend, corner=rrb.Corner2D.RightTop),
        background=rrb.archetypes.PlotBackground(color=rgba(palette.NIGHT), show_grid=True),
    )
