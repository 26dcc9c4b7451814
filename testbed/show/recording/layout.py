"""What the viewer shows when a recording is opened."""

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from testbed.flight.record import FlightRecord
from testbed.show import palette
from testbed.show.flight_summary import path_points, route_ends
from testbed.show.palette import rgba
from testbed.show.recording import timeline

MANY = ("clearance", "bank", "load_factor")  # plots with more than one curve, which need a legend
CLEARANCE_SHOWN_M = (-30.0, 150.0)  # where decisions are made; farther away the curve says nothing


def blueprint(record: FlightRecord) -> rrb.Blueprint:
    """Scene, velocity space and summary on the left; curves, modes and events on the right."""
    left = rrb.Vertical(
        rrb.Tabs(_overview(record), *_close_up(record), name="Scene"),
        rrb.Horizontal(_velocity(record), rrb.TextDocumentView(origin="/summary", name="Summary"), column_shares=[1, 1]),
        row_shares=[3, 2],
    )
    right = rrb.Vertical(
        rrb.Horizontal(
            _curves("clearance", "Clearance, m", rrb.ScalarAxis(range=CLEARANCE_SHOWN_M)), _curves("cross_track", "Cross-track, m")
        ),
        rrb.Horizontal(_curves("bank", "Bank, deg"), _curves("load_factor", "Load factor")),
        rrb.Horizontal(_curves("airspeed", "Airspeed, m/s"), rrb.Tabs(_curves("throttle", "Throttle, %"), _curves("alpha", "Alpha, deg"))),
        rrb.StateTimelineView(origin="/modes", name="Modes"),
        rrb.TextLogView(origin="/events", name="Events", columns=rrb.TextLogColumns(text_log_columns=["LogLevel", "Body"])),
        row_shares=[3, 3, 3, 2, 2],
    )
    return rrb.Blueprint(
        rrb.Horizontal(left, right, column_shares=[10, 9]),
        rrb.TimePanel(timeline=timeline.TIMELINE, state="collapsed", play_state="paused"),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        auto_views=False,
        auto_layout=False,
    )


def _trail() -> rrb.VisibleTimeRanges:
    """The trail up to now, not to the end."""
    everything = rrb.VisibleTimeRange(
        timeline.TIMELINE, start=rrb.TimeRangeBoundary.infinite(), end=rrb.TimeRangeBoundary.cursor_relative(seconds=0.0)
    )
    return rrb.VisibleTimeRanges([everything])


def _spatial(record: FlightRecord, name: str, eye: rrb.EyeControls3D) -> rrb.Spatial3DView:
    return rrb.Spatial3DView(
        origin="/world",
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
        overrides={"/world/trail": _trail()},
    )


def _overview(record: FlightRecord) -> rrb.Spatial3DView:
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
    position = centre + extent * (0.50 * aside - 0.14 * along * [1, 1, 0] + np.array([0.0, 0.0, 0.32]))
    eye = rrb.EyeControls3D(kind=rrb.Eye3DKind.Orbital, position=position, look_target=centre, eye_up=(0, 0, 1))
    return _spatial(record, "Scene (ENU, m)", eye)


def _close_up(record: FlightRecord) -> list[rrb.Spatial3DView]:
    """The surroundings of the closest approach, where attitude and distances can be read; none without an obstacle."""
    if not record.plan.obstacles or not len(record.columns["time_s"]):
        return []
    nearest = min(
        record.plan.obstacles, key=lambda spec: float(np.nanmin(record.columns[f"obstacle.{spec.name}.clearance_m"], initial=np.inf))
    )
    row = int(np.argmin(np.nan_to_num(record.columns[f"obstacle.{nearest.name}.clearance_m"], nan=np.inf)))
    own, there = record.columns["own.pos_enu_m"][row], record.columns[f"obstacle.{nearest.name}.pos_enu_m"][row]
    if not np.isfinite(own).all():
        return []
    centre, forward = (own + there) / 2, record.columns["own.vel_enu_mps"][row]
    forward = forward / max(float(np.linalg.norm(forward)), 1e-9)
    away = 2.5 * nearest.radius_m + float(np.linalg.norm(own - there)) / 2
    position = centre + away * (1.1 * np.array([forward[1], -forward[0], 0.0]) - 0.9 * forward + np.array([0.0, 0.0, 0.8]))
    eye = rrb.EyeControls3D(kind=rrb.Eye3DKind.Orbital, position=position, look_target=centre, eye_up=(0, 0, 1))
    return [_spatial(record, "Closest approach", eye)]


def _velocity(record: FlightRecord) -> rrb.Spatial3DView:
    """Velocity space from behind and above the present velocity, so that the cap faces the reader."""
    size = record.plan.speed_mps
    velocity = record.columns["own.vel_enu_mps"]
    heading = np.array(record.events[0].own_vel_enu_mps) if record.events else velocity[0] if len(velocity) else np.array([size, 0.0, 0.0])
    forward = heading / max(float(np.linalg.norm(heading)), 1e-9)
    aside = np.array([forward[1], -forward[0], 0.0])
    position = size * (1.1 * forward + 1.9 * aside + np.array([0.0, 0.0, 0.85]))
    return rrb.Spatial3DView(
        origin="/velocity",
        name="Velocity space (m/s)",
        background=rgba(palette.NIGHT),
        line_grid=False,
        eye_controls=rrb.EyeControls3D(kind=rrb.Eye3DKind.Orbital, position=position, look_target=0.3 * size * forward, eye_up=(0, 0, 1)),
    )


def _curves(entity: str, name: str, axis: rrb.ScalarAxis | None = None) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        origin=f"/signals/{entity}",
        name=name,
        axis_y=axis,
        plot_legend=rrb.PlotLegend(visible=entity in MANY, corner=rrb.Corner2D.RightTop),
        background=rrb.archetypes.PlotBackground(color=rgba(palette.NIGHT), show_grid=True),
    )
