"""Recorded tracks: what was flown somewhere, flown again beside the own aircraft."""

import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, field_validator

from testbed.core.geodesy import enu_from_geodetic
from testbed.core.section import FARTHEST_M, FASTEST_MPS, HIGHEST_M, Azimuth, Duration, Number, Section
from testbed.core.units import DEG
from testbed.flight.impossible import NoMeetingError
from testbed.flight.traffic.columns import fault
from testbed.flight.traffic.pieces import Pieces, extremes, smooth
from testbed.flight.traffic.table import Table, table
from testbed.flight.traffic.track import TrackSetting

if TYPE_CHECKING:
    from testbed.campaign.words.obstacles import ObstacleSpec

Array = np.ndarray
Latitude = Annotated[Number, Field(ge=-90, le=90)]
Longitude = Annotated[Number, Field(ge=-360, le=360)]
Origin = tuple[Latitude, Longitude, Annotated[Number, Field(ge=-1000, le=HIGHEST_M)]]


class Options(Section):
    """Which track of which file, and what its columns are."""

    path: Annotated[str, Field(min_length=1)]
    """CSV or Parquet, relative to the campaign."""
    track: str | None = None
    """Name of the track, for a file that holds several."""
    columns: dict[str, str] = {}  # noqa: RUF012 (pydantic copies it)
    """What a column is, with its unit, to its heading: {time_s: t, east_m: x, north_m: y, up_m: z}. Empty: headings that say so
    themselves, and the exports of the `traffic` library and of OpenSky."""
    origin_deg_m: Origin | None = None
    """Latitude, longitude (deg) and height (m) of the place that is [0, 0, 0] in the campaign. Needed for a file of latitudes, unless
    the obstacle has a position_enu_m, to which the track is moved."""
    at_track_s: Annotated[Number, Field(ge=0)] = 0.0
    """The moment of the track, counted from its first row, that is the obstacle's `when`, s."""
    azimuth_deg: Azimuth | None = None
    """Turn the track about the upright through its place at that moment, so that it flies in this direction then."""
    resample_s: Duration | None = None
    """Take the mean of all rows within each interval of this length, s: for positions that are coarse or noisy."""
    longest_gap_s: Duration = 60.0
    """More than this between two rows is refused, s."""
    bad_rows: Literal["refuse", "drop"] = "refuse"
    """What to do with rows that have no place or time, or a time that is not later than the one before: refuse the file, or do without."""

    @field_validator("track", mode="before")
    @classmethod
    def _as_text(cls, name: Any) -> Any:
        return str(name) if isinstance(name, int) and not isinstance(name, bool) else name

    @field_validator("columns")
    @classmethod
    def _are_known(cls, columns: dict[str, str]) -> dict[str, str]:
        if columns and (why := fault(columns)):
            raise ValueError(why)
        return columns


class Recorded(Pieces):
    """A track of a file, on cubics through its rows; there is no obstacle before the first and after the last of them."""

    Options = Options
    uses: ClassVar = ()
    takes: ClassVar = ("position_enu_m",)
    files: ClassVar = ("path",)

    def __init__(self, setting: TrackSetting, **options: Any) -> None:
        told = Options(**options)
        found = table(told.path, setting.files.get(told.path), told.columns, told.track)
        moved = not math.isnan(setting.pos[0])
        time_s, pos, _ = _checked(found, told, moved)
        time_s = time_s + (setting.time_s - told.at_track_s)
        moment = setting.time_s
        if not time_s[0] - 1e-9 <= moment <= time_s[-1] + 1e-9 and (moved or told.azimuth_deg is not None):
            raise NoMeetingError(f"obstacle {setting.name} is not there at {told.at_track_s:g} s of its track")
        moment = min(max(moment, float(time_s[0])), float(time_s[-1]))
        time_s, pos = _cut(time_s, pos, min(0.0, moment), max(setting.until_s, moment))
        if moved or told.azimuth_deg is not None:
            here, velocity = Pieces("", 0.0, smooth(time_s, pos)).at(moment) or ((0.0,) * 3, (0.0,) * 3)
            turn = np.eye(3) if told.azimuth_deg is None else _upright_turn(told.azimuth_deg * DEG - math.atan2(velocity[1], velocity[0]))
            pos = (pos - here) @ turn.T + (np.zeros(3) if moved else np.asarray(here))
        pos = pos @ setting.frame.turn.T + np.asarray(setting.pos) if moved else setting.frame.places(pos)
        super().__init__(setting.name, setting.radius_m, smooth(time_s, pos))

    @classmethod
    def refuse(cls, spec: "ObstacleSpec", **options: Any) -> None:
        """Raise ``ValueError``, with the file and the row, where the track cannot be flown."""
        told = Options(**options)
        if told.origin_deg_m is not None and spec.position_enu_m is not None:
            raise ValueError("origin_deg_m: has no effect beside position_enu_m, to which the track is moved")
        found, moved = table(told.path, None, told.columns, told.track), spec.position_enu_m is not None
        if told.origin_deg_m is not None and not found.geodetic:
            raise ValueError(f"origin_deg_m: has no effect on {told.path}, whose places are in metres")
        time_s, place, rows = _checked(found, told, moved)
        with np.errstate(all="ignore"):
            _between_rows(told.path, time_s, place, rows, moved)
        if told.at_track_s < time_s[0] - 1e-9 and (moved or told.azimuth_deg is not None):
            raise ValueError(
                f"at_track_s: {told.at_track_s:g} s is before the first mean of resample_s, "
                f"which is at {time_s[0]:g} s; the last is at {time_s[-1]:g} s"
            )
        if told.at_track_s > time_s[-1]:
            raise ValueError(f"at_track_s: {told.at_track_s:g} s is past the end of the track, which lasts {time_s[-1]:g} s")


def _upright_turn(angle: float) -> Array:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def _limits(moved: bool) -> Array:
    """How far from 0 a coordinate may be, m."""
    return np.full(3, 10.0 * FARTHEST_M) if moved else np.array([FARTHEST_M, FARTHEST_M, HIGHEST_M])


def _km(place: Array) -> str:
    far = math.hypot(*(place / 1000.0))
    return f"{far:,.0f}" if far < 1e9 else f"{far:.3g}"


def _between_rows(path: str, time_s: Array, place: Array, rows: Array, moved: bool) -> None:
    """Raise ``ValueError`` where what is flown from one row to the next is faster than anything, or leaves the flat ground."""
    speed, reach = extremes(time_s, place)
    if not (speed <= FASTEST_MPS).all():
        k = int(np.nanargmax(speed))
        raise ValueError(f"{path}: row {rows[k + 1]}: is reached at {speed[k]:,.6g} m/s; at most {FASTEST_MPS:g}, as all in the air")
    far = (reach > _limits(moved)).any(axis=1)
    if far.any():
        k = int(np.argmax(far))
        raise ValueError(f"{path}: row {rows[k + 1]}: on the way to it the track is {_km(reach[k])} km from the origin, so hard it turns")


def _checked(found: Table, told: Options, moved: bool) -> tuple[Array, Array, Array]:
    """Times (n,) from the first row on, places (n,3), ENU, and numbers (n,) of the rows that are used. Raises ``ValueError``."""
    try:
        time_s, place, rows = _good(found, told.bad_rows == "drop")
        if found.geodetic:
            moment = int(np.argmin(np.abs(time_s - time_s[0] - told.at_track_s)))
            place = _in_frame(place, rows, told.origin_deg_m, moment if moved else None)
        far = (np.abs(place) > _limits(moved)).any(axis=1)
        if far.any():
            k = int(np.argmax(far))
            raise ValueError(
                f"row {rows[k]}: is {_km(place[k])} km from the origin; at most {FARTHEST_M / 1000.0:g}, as the ground is flat"
            )
        with np.errstate(over="ignore"):
            gap = np.diff(time_s)
        if (gap > told.longest_gap_s).any():
            k = int(np.argmax(gap > told.longest_gap_s))
            raise ValueError(f"row {rows[k + 1]}: comes {gap[k]:g} s after the row before it; longest_gap_s is {told.longest_gap_s:g}")
        time_s = time_s - time_s[0]
        time_s, place, rows = _resampled(time_s, place, rows, told.resample_s) if told.resample_s else (time_s, place, rows)
    except ValueError as problem:
        raise ValueError(f"{told.path}: {problem}") from None
    return time_s, place, rows


def _good(found: Table, drop: bool) -> tuple[Array, Array, Array]:
    """Rows with a time that is later than all before it and a place. Raises ``ValueError`` at the first that is none, unless dropped."""
    time_s, place, rows = found.time_s, found.place, found.rows
    finite = np.isfinite(time_s) & np.isfinite(place).all(axis=1)
    if not drop and not finite.all():
        raise ValueError(f"row {rows[int(np.argmin(finite))]}: has no time or no place")
    time_s, place, rows = time_s[finite], place[finite], rows[finite]
    later = np.append(True, time_s[1:] > np.maximum.accumulate(time_s)[:-1]) if len(time_s) else np.zeros(0, bool)
    if not drop and not later.all():
        k = int(np.argmin(later))
        back_s = time_s[k - 1] - time_s[k]
        raise ValueError(f"row {rows[k]}: {f'is {back_s:g} s earlier than' if back_s else 'has the time of'} the row before it")
    time_s, place, rows = time_s[later], place[later], rows[later]
    if len(rows) < 2:
        raise ValueError(f"has {len(rows)} row{'' if len(rows) == 1 else 's'} of that track that can be used; a track has two at least")
    return time_s, place, rows


def _in_frame(place: Array, rows: Array, origin: Origin | None, moment: int | None) -> Array:
    """Latitudes, longitudes and heights (n,3) as places, ENU; ``moment``: the row about which the track is moved to where it is wanted."""
    if not (np.abs(place[:, 0]) <= 90.0).all():
        raise ValueError(f"row {rows[int(np.argmax(np.abs(place[:, 0]) > 90.0))]}: has a latitude beyond 90 deg")
    if moment is not None:
        latitude, longitude, height = place[moment].tolist()
        return enu_from_geodetic(place, (latitude, longitude, height))
    if origin is None:
        raise ValueError("has latitudes: give origin_deg_m, or a position_enu_m to move the track to")
    return enu_from_geodetic(place, origin)


def _cut(time_s: Array, pos: Array, from_s: float, to_s: float) -> tuple[Array, Array]:
    """The rows that decide where the track is between two times, two more to either side: a day's track is a minute's in a flight."""
    first = max(int(np.searchsorted(time_s, from_s)) - 3, 0)
    last = int(np.searchsorted(time_s, to_s)) + 3
    first = min(first, len(time_s) - 2)
    return time_s[first : max(last, first + 2)], pos[first : max(last, first + 2)]


def _resampled(time_s: Array, place: Array, rows: Array, every_s: float) -> tuple[Array, Array, Array]:
    """Means over intervals, each with the number of its first row."""
    _, first, count = np.unique(np.floor(time_s / every_s), return_index=True, return_counts=True)
    if len(first) < 2:
        raise ValueError(f"has one interval of {every_s:g} s (resample_s) only; a track has two at least")
    mean = np.add.reduceat(np.column_stack([time_s, place]), first) / count[:, None]
    return mean[:, 0], mean[:, 1:], rows[first]
