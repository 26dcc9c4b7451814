"""What is far away is passed over: a sensor sees, and a record has, to the last digit what they would if every track were asked."""

import math
from typing import NamedTuple

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from testbed.core.seeds import stream
from testbed.flight.plants.base import State
from testbed.flight.record.columns import Columns
from testbed.flight.sensing import SensorContext
from testbed.flight.sensing.imperfect import Imperfect
from testbed.flight.sensing.truth import Truth
from testbed.flight.traffic import Sampled, Track, TrackSetting, Traffic
from testbed.flight.traffic.bounds import bounds_of
from testbed.flight.traffic.legs import Leg, Legs
from testbed.flight.traffic.pieces import Pieces, smooth
from testbed.flight.traffic.straight import Straight, shifted
from testbed.flight.traffic.track import Present, least_clearance
from testbed.flight.traffic.waypoints import Waypoints

HZ, LASTS_S = 10, 30.0
REACH_M = 120.0


class Asked(Sampled):
    """The same track, of which nothing is known: it is asked at every look."""

    def __init__(self, track: Track) -> None:
        self.name, self.radius_m, self._track = track.name, track.radius_m, track

    def at(self, time_s: float):
        return self._track.at(time_s)

    def sampled(self, time_s: np.ndarray):
        return self._track.sampled(time_s)


def number(least: float, most: float) -> st.SearchStrategy[float]:
    return st.floats(least, most, width=32)


place = st.tuples(number(-900, 900), number(-900, 900), number(-100, 100))
velocity = st.tuples(number(-60, 60), number(-60, 60), number(-5, 5))
legs = st.lists(
    st.builds(Leg, duration_s=number(0.5, 8), turn_rate_dps=number(-40, 40), acceleration_mps2=number(0, 9)), min_size=1, max_size=4
)
moment = number(0, LASTS_S)


@st.composite
def tracks(draw: st.DrawFn) -> Traffic:
    """A few of every kind, some carried by a wind, some that appear or leave."""
    found = []
    for k in range(draw(st.integers(1, 5))):
        kind, pos, radius_m = draw(st.sampled_from(["line", "legs", "waypoints", "recorded"])), draw(place), draw(number(1, 60))
        setting = TrackSetting(f"O{k}", radius_m, pos, draw(velocity), draw(moment), stream(0, 0, "traffic"), speed_mps=draw(number(1, 80)))
        track: Track = Straight(setting.name, radius_m, pos, setting.vel)
        if kind == "legs":
            track = Legs(setting, tuple(draw(legs)))
        elif kind == "waypoints":
            track = Waypoints(setting, ((pos[0] + 50.0, pos[1], pos[2]), *draw(st.lists(place, max_size=3, unique=True))))
        elif kind == "recorded":
            rows = draw(st.lists(place, min_size=2, max_size=8))
            track = Pieces(setting.name, radius_m, smooth(draw(moment) + 3.0 * np.arange(len(rows)), np.array(rows)))
        if draw(st.booleans()) and (there := track.at(setting.time_s)):
            track = shifted(track, setting.time_s, np.array(there[0]), np.array(there[1]) + draw(velocity))
        if draw(st.booleans()):
            track = Present(track, draw(st.none() | moment), draw(st.none() | moment))
        found.append(track)
    return Traffic(tuple(found))


class Flown(NamedTuple):
    """Times (n,) and places (n,3) of the aircraft."""

    time_s: np.ndarray
    pos: np.ndarray


@st.composite
def flights(draw: st.DrawFn) -> Flown:
    """There and back, at up to hundreds of metres a second."""
    corners = np.array(draw(st.lists(place, min_size=2, max_size=5)))
    time_s = np.arange(int(HZ * LASTS_S)) / HZ
    at = np.linspace(0.0, LASTS_S, len(corners))
    return Flown(time_s, np.column_stack([np.interp(time_s, at, one) for one in corners.T]))


@settings(max_examples=40)
@given(traffic=tracks(), flown=flights(), range_to=st.sampled_from(["centre", "surface"]), shuffled=st.booleans())
def test_a_sensor_sees_what_it_would_if_it_asked_every_track(traffic: Traffic, flown: Flown, range_to: str, shuffled: bool) -> None:
    looks = np.random.default_rng(len(traffic.tracks)).permutation(len(flown.time_s)) if shuffled else range(len(flown.time_s))
    poor = {"range_to": range_to, "azimuth_width_deg": 200, "update_hz": 7, "latency_s": 0.3, "position_noise_m": 2, "bearing_noise_deg": 1}
    poor |= {"dropouts_per_s": 0.4, "dropout_lasts_s": 1.5, "false_tracks_per_s": 0.2}
    everybody = Traffic(tuple(Asked(track) for track in traffic.tracks))
    kinds = [Truth(range_to), Truth(range_to), *([] if shuffled else [Imperfect(**poor), Imperfect(**poor)])]  # it measures as time goes on
    memories = [sensor.start(SensorContext(REACH_M, HZ, np.random.default_rng(1))) for sensor in kinds]
    for k in looks:
        time_s, pos = float(flown.time_s[k]), tuple(flown.pos[k].tolist())
        own, answers = State(*pos, *[0.0] * 17), []
        for j, sensor in enumerate(kinds):
            memories[j], seen = sensor.sense(memories[j], time_s, own, everybody if j % 2 else traffic)
            answers.append(seen)
        bodies = traffic.at(time_s)
        reach_m = [REACH_M + (body.radius_m if range_to == "surface" else 0.0) for body in bodies]
        assert answers[0] == tuple(body for body, far in zip(bodies, reach_m, strict=True) if math.dist(body.pos, pos) <= far)
        assert answers[0::2] == answers[1::2]


@settings(max_examples=40)
@given(traffic=tracks())
def test_a_track_keeps_within_its_bounds(traffic: Traffic) -> None:
    time_s = np.linspace(0.0, LASTS_S + 30.0, 400)
    for track in traffic.tracks:
        bounds = bounds_of(track)
        assert bounds is not None
        pos = track.sampled(time_s)[0]
        step = np.linalg.norm(np.diff(pos, axis=0), axis=1)
        assert not (step > bounds.top_mps * np.diff(time_s) * 1.000001 + 1e-6).any()
        assert np.isnan(pos[(time_s < bounds.from_s) | (time_s > bounds.to_s)]).all()


@settings(max_examples=40)
@given(traffic=tracks(), flown=flights(), lost=st.tuples(moment, moment), unknown=st.booleans())
def test_the_nearest_obstacle_is_among_the_contenders(traffic: Traffic, flown: Flown, lost: tuple[float, float], unknown: bool) -> None:
    """Also where the point is nowhere for a while, and where nothing is known of one of the tracks."""
    time_s, all_of = flown.time_s, traffic.tracks
    point = np.where(((time_s > lost[0]) & (time_s < lost[1]))[:, None], np.nan, flown.pos)
    all_of = (*all_of[:-1], Asked(all_of[-1])) if unknown else all_of
    columns = Columns({"time_s": time_s, "own.pos_enu_m": flown.pos.copy()}, all_of)
    of = {track.name: least_clearance(time_s, point, track.sampled(time_s)[0], track.radius_m).clearance_m for track in all_of}
    may = [track.name for track in columns.contenders(point, all_of)]
    least = np.nanmin(list(of.values())) if np.isfinite(list(of.values())).any() else math.nan
    for name, clearance_m in of.items():
        assert name in may or clearance_m > least or (math.isnan(clearance_m) and not math.isnan(least))


def test_far_away_obstacles_are_neither_asked_nor_logged_and_a_track_of_one_s_own_at_once() -> None:
    class Counted(Straight):
        asked = 0

        def at(self, time_s: float):
            Counted.asked += 1
            return Straight.at(self, time_s)

        bounds = Straight.bounds

    far = Traffic(tuple(Counted(f"O{k}", 20.0, (5000.0 + 100.0 * k, 0.0, 0.0), (-30.0, 0.0, 0.0)) for k in range(50)))
    sensor = Truth()
    memory, time_s = sensor.start(SensorContext(REACH_M, 60, np.random.default_rng(0))), np.arange(1800) / 60.0
    for time in time_s.tolist():
        memory, seen = sensor.sense(memory, time, State(50.0 * time, *[0.0] * 19), far)
        assert not seen
    assert Counted.asked < 50 * 12  # of 1800 looks

    own = {"time_s": time_s, "own.pos_enu_m": np.column_stack([50.0 * time_s, 0.0 * time_s, 0.0 * time_s])}
    mine = Asked(far.tracks[3])
    columns = Columns(own, (far.tracks[0], far.tracks[1], mine))
    assert list(columns) == [*own, *(f"obstacle.{n}.{p}" for n in ("O0", "O1", "O3") for p in ("pos_enu_m", "vel_enu_mps", "clearance_m"))]
    assert [track.name for track in columns.contenders(own["own.pos_enu_m"], [far.tracks[0], far.tracks[1], mine])] == ["O0", "O3"]
    assert set(columns._known) == {*own, *(name for name in columns if ".O3." in name)}
    everything = columns | {"time_s": 2.0 * time_s}
    assert type(everything) is dict
    assert list(everything) == list(columns)
    pos, vel = far.tracks[1].sampled(time_s)
    assert np.array_equal(columns["obstacle.O1.pos_enu_m"], pos)
    assert np.array_equal(columns["obstacle.O1.vel_enu_mps"], vel)
    assert not columns["obstacle.O1.vel_enu_mps"].flags.writeable
    assert np.array_equal(columns["obstacle.O1.clearance_m"], np.linalg.norm(own["own.pos_enu_m"] - pos, axis=1) - 20.0)


def test_bounds_are_those_of_the_class_that_says_where_a_track_is() -> None:
    class Jumps(Straight):
        def at(self, time_s: float):
            return (0.0, 0.0, 0.0) if time_s > 1.0 else (1e4, 0.0, 0.0), (0.0, 0.0, 0.0)

    assert bounds_of(Jumps("J", 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))) is None
    assert bounds_of(Present(Jumps("J", 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), 1.0, 2.0)) is None
