"""Tracks that are no straight line: legs and waypoints in closed form, files against the track that they were written from."""

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from testbed.campaign import SpecError, expand, load_campaign
from testbed.core import datafiles
from testbed.core.geodesy import enu_from_geodetic, geodetic_from_enu
from testbed.core.seeds import stream
from testbed.flight.scene import make_scene
from testbed.flight.traffic.legs import Leg, Legs
from testbed.flight.traffic.pieces import Pieces, extremes, smooth
from testbed.flight.traffic.track import TrackSetting
from testbed.flight.traffic.waypoints import Waypoints
from tests.plans import plan

Array = np.ndarray
SETTING = TrackSetting("O", 20.0, (100.0, 5.0, -3.0), (30.0, 0.0, 2.0), 4.0, stream(0, 0, "traffic.O"), 30.0)


def test_a_turn_is_a_circle_of_its_radius() -> None:
    """Level speed 30 m/s at 6 deg/s: a radius of 286.48 m about a centre to the left, a round in 60 s; the climb goes on."""
    track = Legs(SETTING, legs=(Leg(duration_s=60.0, turn_rate_dps=6.0),))
    radius = 30.0 / math.radians(6.0)
    pos, vel = track.sampled(np.linspace(4.0, 64.0, 301))
    assert np.allclose(np.hypot(pos[:, 0] - 100.0, pos[:, 1] - 5.0 - radius), radius, atol=1e-9)
    assert np.allclose(np.hypot(vel[:, 0], vel[:, 1]), 30.0, atol=1e-12)
    assert track.at(19.0)[1] == pytest.approx((0.0, 30.0, 2.0), abs=1e-12)  # a quarter of it, to the left
    assert track.at(64.0)[0] == pytest.approx((100.0, 5.0, -3.0 + 120.0), abs=1e-9)


def test_climb_acceleration_and_what_comes_before_and_after() -> None:
    legs = (Leg(duration_s=10.0, acceleration_mps2=-3.0), Leg(duration_s=5.0, climb_mps=-4.0, acceleration_mps2=2.0))
    track = Legs(SETTING._replace(vel=(0.0, 30.0, 2.0)), legs=legs)
    assert track.at(0.0)[0] == pytest.approx((100.0, 5.0 - 120.0, -3.0 - 8.0))  # straight, before `when`
    assert track.at(14.0) == (pytest.approx((100.0, 155.0, 17.0)), pytest.approx((0.0, 0.0, -4.0)))  # braked to a standstill
    assert track.at(21.0)[0] == pytest.approx((100.0, 155.0 + 25.0 + 20.0, 17.0 - 28.0))  # 5 s of a gain of 2 m/s^2, 2 s at 10 m/s
    assert track.at(21.0)[1] == pytest.approx((0.0, 10.0, -4.0))


legs = st.lists(
    st.builds(
        Leg,
        duration_s=st.floats(0.1, 20.0),
        turn_rate_dps=st.one_of(st.floats(-30.0, 30.0), st.floats(-1e-3, 1e-3)),
        climb_mps=st.none() | st.floats(-10.0, 10.0),
        acceleration_mps2=st.floats(0.0, 3.0),
    ),
    min_size=1,
    max_size=4,
)


@settings(max_examples=40)
@given(legs=legs)
def test_any_legs_are_the_integral_of_their_velocity(legs: list[Leg]) -> None:
    """By Simpson's rule within each leg; and at one time as among many."""
    track, pos, time_s = Legs(SETTING, legs=tuple(legs)), np.array(SETTING.pos), 4.0
    for leg in legs:
        times = np.linspace(time_s, math.nextafter(time_s + leg.duration_s, 0.0), 401)
        places, vel = track.sampled(times)
        weights = np.ones(401)
        weights[1:-1:2], weights[2:-1:2] = 4.0, 2.0
        pos = pos + weights @ vel * leg.duration_s / 1200.0
        assert np.allclose(places[-1], pos, atol=1e-5)
        assert np.allclose(track.at(times[137])[0], places[137], atol=1e-8)
        assert np.allclose(track.at(times[137])[1], vel[137], atol=1e-8)
        time_s += leg.duration_s


def test_waypoints_are_reached_when_their_speeds_say() -> None:
    track = Waypoints(SETTING, points_enu_m=((100.0, 305.0, -3.0), (500.0, 305.0, 297.0)), speeds_mps=(30.0, 50.0))
    assert track.at(14.0) == (pytest.approx((100.0, 305.0, -3.0)), pytest.approx((40.0, 0.0, 30.0)))
    assert track.at(24.0)[0] == pytest.approx((500.0, 305.0, 297.0))
    assert track.at(25.0)[0] == pytest.approx((540.0, 305.0, 327.0))  # straight on
    assert track.at(3.0) == (pytest.approx((100.0, -25.0, -3.0)), pytest.approx((0.0, 30.0, 0.0)))
    assert np.allclose(np.hstack(track.sampled(np.array([3.0, 14.0, 25.0]))), [np.hstack(track.at(t)) for t in (3.0, 14.0, 25.0)])


@settings(max_examples=40)
@given(st.lists(st.tuples(st.floats(0.05, 5.0), st.floats(-500, 500), st.floats(-500, 500)), min_size=2, max_size=12), st.randoms())
def test_a_track_through_rows_has_them_all_and_no_jump(rows: list[tuple[float, float, float]], random) -> None:
    time_s = np.cumsum([row[0] for row in rows])
    pos = np.array([(x, y, 0.1 * x) for _, x, y in rows])
    track = Pieces("O", 1.0, smooth(time_s, pos))
    assert np.allclose(track.sampled(time_s)[0], pos, atol=1e-6)
    asked = [random.uniform(time_s[0] - 1.0, time_s[-1] + 1.0) for _ in range(40)] + time_s.tolist()  # in no order
    places, vel = track.sampled(np.array(asked))
    for time, *row in zip(asked, places, vel, strict=True):
        moving = track.at(time)
        assert (moving is None) == (not time_s[0] <= time <= time_s[-1])
        assert np.isnan(row).all() if moving is None else np.allclose(row, moving, atol=1e-9)
    for time in (*time_s[1:-1], *(0.5 * (time_s[1:] + time_s[:-1]))):
        before, after = track.at(math.nextafter(time, 0.0)), track.at(time)
        assert np.allclose(before, after, atol=1e-5), "neither place nor velocity"


def test_a_constant_acceleration_is_exact_whatever_the_rows() -> None:
    time_s = np.array([0.0, 1.0, 1.5, 4.0, 9.0])
    where = lambda t: np.column_stack([3.0 + 20.0 * t - 0.7 * t**2, 5.0 * t**2, 2.0 * t])  # noqa: E731
    pos, vel = Pieces("O", 1.0, smooth(time_s, where(time_s))).sampled(t := np.linspace(0.0, 9.0, 91))
    assert np.allclose(pos, where(t), atol=1e-9)
    assert np.allclose(vel, np.column_stack([20.0 - 1.4 * t, 10.0 * t, np.full_like(t, 2.0)]), atol=1e-9)


@settings(max_examples=20)
@given(st.lists(st.tuples(st.floats(0.05, 5.0), st.floats(-500, 500), st.floats(-500, 500)), min_size=2, max_size=8))
def test_how_fast_and_how_far_a_track_gets_between_rows(rows: list[tuple[float, float, float]]) -> None:
    """Against places and velocities at many times of each interval."""
    time_s, pos = np.cumsum([row[0] for row in rows]), np.array([(x, y, 0.1 * x) for _, x, y in rows])
    track, (speed, reach) = Pieces("O", 1.0, smooth(time_s, pos)), extremes(time_s, pos)
    for k, (begin, end) in enumerate(pairwise(time_s)):
        places, vel = track.sampled(np.linspace(begin, math.nextafter(end, 0.0), 2001))
        assert np.linalg.norm(vel, axis=1).max() == pytest.approx(speed[k], rel=1e-6, abs=1e-6)
        assert np.abs(places).max(axis=0) == pytest.approx(reach[k], rel=1e-4, abs=1e-3)


def test_latitudes_are_wgs84() -> None:
    """Against the ellipsoid's own formula, and there and back."""
    origin, place = (47.0, 8.5, 430.0), np.array([[47.2, 8.9, 3000.0], [46.9, 8.5, 430.0]])

    def ecef(latitude: float, longitude: float, height: float) -> Array:
        f = 1.0 / 298.257223563
        a, e2, phi, lam = 6378137.0, f * (2.0 - f), math.radians(latitude), math.radians(longitude)
        n = a / math.sqrt(1.0 - e2 * math.sin(phi) ** 2)
        flat = (n + height) * math.cos(phi)
        return np.array([flat * math.cos(lam), flat * math.sin(lam), (n * (1.0 - e2) + height) * math.sin(phi)])

    phi, lam = math.radians(47.0), math.radians(8.5)
    east = [-math.sin(lam), math.cos(lam), 0.0]
    north = [-math.sin(phi) * math.cos(lam), -math.sin(phi) * math.sin(lam), math.cos(phi)]
    up = [math.cos(phi) * math.cos(lam), math.cos(phi) * math.sin(lam), math.sin(phi)]
    expected = [np.array([east, north, up]) @ (ecef(*row) - ecef(*origin)) for row in place]
    assert np.allclose(enu_from_geodetic(place, origin), expected, atol=1e-6)
    assert np.allclose(geodetic_from_enu(enu_from_geodetic(place, origin), origin), place, atol=1e-6)


ORIGIN = (47.0, 8.5, 430.0)
TIMES = np.arange(0.0, 60.0, 2.5)
FLOWN = np.column_stack([3000.0 - 60.0 * TIMES, 0.5 * TIMES**2, 100.0 + TIMES])  # a constant acceleration: any rows of it are exact
HEAD = """\
name: tracks
question: Where does it fly?
route: {start_enu_m: [0, 0, 0], goal_enu_m: [3000, 0, 0], start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}
plant: {kind: kinematic}
obstacles:
  - {name: F, radius_m: 20, kind: file, %s}
"""


def written(folder: Path) -> dict[str, str]:
    """The same track in each form, with another aircraft's rows between; to the options that read it."""
    geo = geodetic_from_enu(FLOWN, ORIGIN)
    enu = "".join(f"{t},{x},{y},{z}\n" for t, (x, y, z) in zip(TIMES, FLOWN.tolist(), strict=True))
    (folder / "enu.csv").write_text("time_s,east_m,north_m,up_m\n" + enu)
    (folder / "feet.csv").write_text("T;X;Y;Z\n" + "".join(
        f"{1000 * t};{x / 1000};{y / 1852};{z / 0.3048}\n" for t, (x, y, z) in zip(TIMES, FLOWN.tolist(), strict=True)))  # fmt: skip
    lines = [",timestamp,icao24,callsign,latitude,longitude,altitude,groundspeed,track"]
    for k, (t, (lat, lon, h)) in enumerate(zip(TIMES, geo.tolist(), strict=True)):
        date = f"2024-05-01 12:{int(t) // 60:02}:{t % 60:06.3f}+00:00"
        lines += [f"{2 * k},{date},4b1814,SWR1,{lat},{lon},{h / 0.3048},120,90", f"{2 * k + 1},{date},4b1815,SWR2,46,8,,,"]
    (folder / "traffic.csv").write_text("\n".join(lines))
    columns = {"time": 1714564800 + np.repeat(TIMES, 2), "icao24": ["4b1814", "4b1815"] * len(TIMES)}
    columns |= {name: np.repeat(geo[:, k], 2) for k, name in enumerate(("lat", "lon", "geoaltitude"))}
    pq.write_table(pa.table(columns), folder / "opensky.parquet")
    (folder / "mac.csv").write_bytes((folder / "enu.csv").read_bytes().replace(b"\n", b"\r"))
    named = "columns: {time_ms: T, east_km: X, north_nmi: Y, up_ft: Z}"
    origin = f"origin_deg_m: {list(ORIGIN)}"
    return {
        "enu.csv": "",
        "mac.csv": "",
        "feet.csv": named,
        "traffic.csv": f"track: 4b1814, {origin}",
        "opensky.parquet": f"track: 4b1814, {origin}",
    }


def flown(folder: Path, options: str, more: str = ""):
    (folder / "c.yaml").write_text(HEAD % f"options: {{{options}}}{more}")
    (made,) = expand(load_campaign(folder / "c.yaml"))
    return make_scene(made).tracks[0]


def test_every_form_of_a_file_is_the_track_that_it_was_written_from(tmp_path: Path) -> None:
    t = np.linspace(0.0, TIMES[-1], 77)
    where = np.column_stack([3000.0 - 60.0 * t, 0.5 * t**2, 100.0 + t])
    for name, options in written(tmp_path).items():
        track = flown(tmp_path, f"path: {name}, {options}")
        pos, vel = track.sampled(t)
        assert np.allclose(pos, where, atol=2e-4), name  # a double of the seconds since 1970 has steps of a quarter microsecond
        assert np.allclose(vel[:, 1], t, atol=1e-3), name
        assert track.at(-0.01) is None
        assert track.at(TIMES[-1] + 0.01) is None


def test_a_recorded_track_is_brought_to_the_own_aircraft(tmp_path: Path) -> None:
    """10 s of it, turned to fly west there, when the plan has the aircraft 1000 m along; from 12 s to 25 s only."""
    written(tmp_path)
    place = ", position_enu_m: [1000, 40, 7], when: {own_reaches_enu_m: [1000, 0, 0]}, appears_at_s: 12, leaves_at_s: 25"
    track = flown(tmp_path, "path: traffic.csv, track: 4b1814, at_track_s: 10, azimuth_deg: 180", place)
    pos, vel = track.at(20.0)  # at 50 m/s
    speed = math.hypot(60.0, 10.0)
    assert pos == pytest.approx((1000.0, 40.0, 7.0), abs=1e-6)
    assert vel == pytest.approx((-speed, 0.0, 1.0), abs=0.03)  # upright where the track is then, not at an origin: 0.5 deg for 50 km
    went = np.subtract(track.at(24.0)[0], pos)
    assert np.hypot(*went[:2]) == pytest.approx(np.hypot(240.0, 0.5 * (14.0**2 - 10.0**2)), abs=0.1)
    assert (track.at(11.9), track.at(25.1)) == (None, None)
    assert np.isnan(track.sampled(np.array([11.9, 12.1]))[0]).all(axis=1).tolist() == [True, False]


def test_means_over_intervals_quiet_a_noisy_track(tmp_path: Path) -> None:
    t = np.arange(0.0, 60.0, 0.1)
    noise = stream(1, 0, "noise").normal(0.0, 5.0, len(t))
    rows = "".join(f"{a},{50.0 * a + b},0,0\n" for a, b in zip(t, noise, strict=True))
    (tmp_path / "noisy.csv").write_text("time_s,east_m,north_m,up_m\n" + rows)
    asked = np.linspace(5.0, 55.0, 200)
    raw, quiet = (flown(tmp_path, f"path: noisy.csv{more}").sampled(asked)[1][:, 0] for more in ("", ", resample_s: 5"))
    assert np.std(quiet - 50.0) < 0.05 * np.std(raw - 50.0)


GOOD = "time_s,east_m,north_m,up_m\n0,700,0,0\n5,550,0,0\n10,400,0,0\n15,250,0,0\n"
BAD_FILES = [
    ("550", "nan", "row 3: has no time or no place"),
    ("550", "", "row 3: has no time or no place"),
    ("550", "x", "row 3: east_m is no number, but 'x'"),
    ("10,400", "5,400", "row 4: has the time of the row before it"),
    ("10,400", "3,400", "row 4: is 2 s earlier than the row before it"),
    ("10,400,0,0", "10,400,0", "row 4: has 3 values under 4 headings"),
    ("15,250", "\n95,250", "row 6: comes 85 s after the row before it; longest_gap_s is 60"),
    ("250", "2.5e6", "row 5: is 2,500 km from the origin; at most 200, as the ground is flat"),
    ("up_m", "up", "has no column of up (up_m); if it is called otherwise name all under 'columns'"),
    (GOOD[:27], "t,x,y,z\n", "has the columns t, x, y, z, of which none are known to be time and place; name them under 'columns'"),
    (
        GOOD,
        "time_s,time_ms,east_m,north_m,up_m\n0,0,700,0,0\n5,5000,550,0,0\n",
        "has the columns time_s and time_ms, each of which is the time; name",
    ),
    ("15,250", "10.001,250", "row 5: is reached at "),
    ("250", "1e300", "row 5: is 1e+297 km from the origin"),
    ("0,700", "0\r,700", "row 2: has "),
    (GOOD[27:], "0,1,2,3\n", "has 1 row of that track that can be used; a track has two at least"),
    (GOOD, "", "is empty, or its first row has no headings"),
    (GOOD, "PAR1", "is no Parquet file that can be read: "),
]


@pytest.mark.parametrize(("old", "new", "said"), BAD_FILES)
def test_a_bad_file_is_one_sentence_with_its_row(tmp_path: Path, old: str, new: str, said: str) -> None:
    assert GOOD.count(old) == 1
    (tmp_path / "t.csv").write_text(GOOD.replace(old, new))
    with pytest.raises(SpecError) as told:
        flown(tmp_path, "path: t.csv")
    assert str(told.value).splitlines()[0].partition(": ")[2].startswith(f"obstacles.F: t.csv: {said}")
    assert str(told.value).count("\n") == 2  # the line of the campaign, and where in it
    if "time of the row" in said or "earlier" in said or "no place" in said:
        assert flown(tmp_path, "path: t.csv, bad_rows: drop").at(12.0)[0] == pytest.approx((340.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("motion", "said"),
    [
        ("kind: file, options: {path: no.csv}", "no.csv: no such file"),
        ("kind: file, options: {path: geo.csv}", "geo.csv: has latitudes: give origin_deg_m, or a position_enu_m"),
        ("kind: file, options: {path: two.csv}", "two.csv: has 2 tracks in its column icao24 (a, b); name one of them with 'track'"),
        ("kind: file, speed_mps: 3, options: {path: t.csv}", "a track of the kind 'file' has its own: leave this out"),
        ("kind: file, options: {path: t.csv, columns: {time_s: t}}", "name one of time, and either those of east, north and up or"),
        ("kind: file, options: {path: t.csv, at_track_s: 16}", "at_track_s: 16 s is past the end of the track, which lasts 15 s"),
        ("kind: file, options: {path: t.csv, origin_deg_m: [1, 2, 3]}", "origin_deg_m: has no effect on t.csv, whose places are in"),
        ("kind: file, options: {path: t.csv, origin_deg_m: [95, 2, 3]}", "must be at most 90 deg, not 95 deg"),
        (
            "kind: file, position_enu_m: [9, 9, 9], options: {path: t.csv, resample_s: 7}",
            "at_track_s: 0 s is before the first mean of resample_s, which is at 2.5 s",
        ),
        ("kind: file, options: {path: bool.parquet}", "bool.parquet: row 1: east_m is no number, but 'True'"),
        ("kind: waypoints, speed_mps: 3, options: {points_enu_m: [[9, 9, 9]]}", "this key is missing"),
        (
            "kind: waypoints, speed_mps: 3, position_enu_m: [9, 9, 9], options: {points_enu_m: [[9, 9, 9]]}",
            "points_enu_m: item 0 is where the",
        ),
        (
            "kind: legs, speed_mps: 30, position_enu_m: [9, 9, 9], direction_deg: [0, 0], "
            "options: {legs: [{duration_s: 5}, {duration_s: 4, acceleration_mps2: -10}]}",
            "legs: item 1 brakes 30 m/s to a standstill after 3 s",
        ),
    ],
)
def test_a_track_that_cannot_be_is_told_at_its_obstacle(tmp_path: Path, motion: str, said: str) -> None:
    (tmp_path / "t.csv").write_text(GOOD)
    (tmp_path / "geo.csv").write_text("time,lat,lon,baroaltitude\n0,47,8,300\n1,47,8,300\n")
    pq.write_table(pa.table({"time_s": [0, 1], "east_m": [True, False], "north_m": [1, 2], "up_m": [1, 2]}), tmp_path / "bool.parquet")
    (tmp_path / "two.csv").write_text("time,icao24,lat,lon,baroaltitude\n0,a,47,8,300\n1,b,47,8,300\n")
    (tmp_path / "c.yaml").write_text((HEAD % "").replace("kind: file, ", motion))
    with pytest.raises(SpecError) as told:
        load_campaign(tmp_path / "c.yaml")
    assert said in str(told.value)
    assert str(told.value).startswith(f"{tmp_path}/c.yaml:6:")


def test_what_is_in_a_file_is_part_of_what_the_flight_is(tmp_path: Path) -> None:
    """Another content, another id; the same content elsewhere, the same id; and nobody flies with what has changed meanwhile."""
    there = tmp_path / "elsewhere"
    there.mkdir()
    (tmp_path / "c.yaml").write_text(HEAD % "options: {path: t.csv}")
    (there / "c.yaml").write_text(HEAD % "options: {path: t.csv}")
    for folder in (tmp_path, there):
        (folder / "t.csv").write_text(GOOD)
    (one,), (copy,) = (expand(load_campaign(folder / "c.yaml")) for folder in (tmp_path, there))
    assert one.flight_id == copy.flight_id
    (there / "t.csv").write_text(GOOD.replace("400", "401"))
    with pytest.raises(ValueError, match=r"t\.csv: changed since the campaign was read"):
        datafiles.content("t.csv", one.plugins["t.csv"])
    (other,) = expand(load_campaign(there / "c.yaml"))
    assert other.flight_id != one.flight_id
    assert make_scene(other).tracks[0].at(10.0)[0][0] == pytest.approx(401.0)


def test_without_anything_new_a_flight_is_who_it_was() -> None:
    """The ids are by what is said; what an obstacle can do since then is said only where it is used."""
    from testbed.campaign.reading.expand import flight_id

    plain = {"name": "O", "radius_m": 20, "position_enu_m": [1, 2, 3], "speed_mps": 4, "direction_deg": [5, 6]}
    straight = flight_id(plan(obstacles=[plain]))
    assert straight == "f7d69527cd86"
    assert flight_id(plan(obstacles=[plain | {"leaves_at_s": 9}])) != straight
