"""The truth: tracks by time and as columns, moved as a whole, and the closest approach to one that comes and goes."""

import math

import numpy as np
import pytest

from testbed.core.chain import Chain
from testbed.core.seeds import stream
from testbed.flight.air import CALM, make_wind
from testbed.flight.traffic import Sampled, TrackSetting, Traffic
from testbed.flight.traffic.schedule import Schedule, anchored
from testbed.flight.traffic.straight import Straight, make_track, shifted
from testbed.flight.traffic.track import least_clearance
from tests.plans import plan
from vosc import ph

SETTING = TrackSetting("O", 20.0, (100.0, 5.0, -3.0), (10.0, -2.0, 1.0), 4.0, stream(0, 0, "traffic.O"))


class Circling(Sampled):
    """Round the origin once in 40 s, there from 2 s to 30 s."""

    name, radius_m = "C", 10.0

    def at(self, time_s: float):
        if not 2.0 <= time_s <= 30.0:
            return None
        angle, rate = math.tau * time_s / 40.0, math.tau / 40.0
        cos, sin = 200.0 * math.cos(angle), 200.0 * math.sin(angle)
        return (cos, sin, 0.0), (-rate * sin, rate * cos, 0.0)


def test_a_line_is_where_it_was_told_to_be() -> None:
    line = make_track(SETTING)
    assert line.at(4.0)[0] == pytest.approx(SETTING.pos)
    assert line.at(6.0) == (pytest.approx((120.0, 1.0, -1.0)), SETTING.vel)


@pytest.mark.parametrize("track", [make_track(SETTING), Circling()])
def test_the_columns_are_the_track_time_by_time(track) -> None:
    times = np.linspace(0.0, 35.0, 36)
    pos, vel = track.sampled(times)
    for time, *row in zip(times, pos, vel, strict=True):
        moving = track.at(time)
        assert np.isnan(row).all() if moving is None else np.allclose(row, moving)


def test_traffic_is_everybody_who_is_there() -> None:
    traffic = Traffic((make_track(SETTING), Circling()))
    assert [body.name for body in traffic.at(1.0)] == ["O"]
    both = traffic.at(10.0)
    assert [body.name for body in both] == ["O", "C"]
    assert both[1].pos == pytest.approx((0.0, 200.0, 0.0), abs=1e-9)
    assert both[1].at(12.0) == pytest.approx((-2 * math.tau * 5.0, 200.0, 0.0), abs=1e-9)  # straight on


def test_a_track_is_moved_as_a_whole() -> None:
    """At the given time it is where it should be; between two times it has gone the old way, carried by the frame."""
    for track in (make_track(SETTING), Circling()):
        pos, vel = np.array([7.0, 8.0, 9.0]), np.asarray(track.at(10.0)[1]) + np.array([3.0, -4.0, 0.5])
        moved = shifted(track, 10.0, pos, vel)
        assert np.allclose(moved.at(10.0), (pos, vel))
        went = np.array(moved.at(16.0)[0]) - moved.at(10.0)[0]
        assert np.allclose(went, np.array(track.at(16.0)[0]) - track.at(10.0)[0] + 6.0 * np.array([3.0, -4.0, 0.5]))
        assert np.allclose(moved.sampled(np.array([16.0]))[0][0], moved.at(16.0)[0])
        assert (moved.name, moved.radius_m) == (track.name, track.radius_m)
    assert isinstance(shifted(make_track(SETTING), 1.0, pos, vel), Straight)
    with pytest.raises(ValueError, match=r"C is not there at 1\.00 s"):
        shifted(Circling(), 1.0, pos, vel)


def test_an_anchored_track_of_any_kind_keeps_its_encounter() -> None:
    """In a wind along a straight route: the same miss vector and closing velocity at the same time, for a circle as well."""
    windy = plan(air={"wind": {"kind": "steady", "speed_mps": 12, "from_deg": 270}})
    route = Chain([ph.hermite((-300, 150, 0), (600, 0, 0), (300, 150, 0), (600, 0, 0))])
    calm, wind = Schedule(route, 0.0, windy, CALM.mean), Schedule(route, 0.0, windy, make_wind(windy.air, windy.terrain_z_m))
    track = Circling()
    moved = anchored(track, calm, wind)
    time = calm.closest_time(track)
    assert wind.closest_time(moved) == pytest.approx(time, abs=0.02)
    before, after = (np.array(one.at(time)) - schedule.at(time) for one, schedule in ((track, calm), (moved, wind)))
    assert np.allclose(before, after, atol=1e-9)


def test_who_is_never_there_cannot_be_anchored() -> None:
    class Absent(Circling):
        def at(self, time_s: float):  # noqa: ARG002
            return None

    route = Chain([ph.hermite((-300, 150, 0), (600, 0, 0), (300, 150, 0), (600, 0, 0))])
    with pytest.raises(ValueError, match="C is not there while the route is flown"):
        Schedule(route, 0.0, plan(), CALM.mean).closest_time(Absent())


def test_the_closest_approach_does_not_join_what_is_apart() -> None:
    """A track that leaves on one side and comes back on the other has not gone through the aircraft."""
    time_s, own = np.arange(6.0), np.zeros((6, 3))
    there = np.column_stack([[-30.0, -20.0, np.nan, np.nan, 20.0, 30.0], np.zeros(6), np.full(6, 5.0)])
    approach = least_clearance(time_s, own, there, 10.0)
    assert approach.clearance_m == pytest.approx(math.hypot(20, 5) - 10)
    joined = least_clearance(time_s[[1, 4]], own[:2], there[[1, 4]], 10.0)
    assert joined == pytest.approx((5.0 - 10.0, 2.5))
