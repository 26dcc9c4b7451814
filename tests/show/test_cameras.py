"""What a recording is filmed from: the encounter stays in the picture, words do not cover one another, streaks are air."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from testbed.show import airflow, labels
from testbed.show.cameras import chase, close_up
from testbed.show.encounter import to_surface, window_of
from tests import made


def filmed(span_m=2.1):
    record = made.record()
    columns = record.columns
    window = window_of(record, made.metrics(record))
    inside = (columns["time_s"] >= window.begin_s) & (columns["time_s"] <= window.end_s)
    own, vel = columns["own.pos_enu_m"][inside], columns["own.vel_enu_mps"][inside]
    centre, motion = columns["obstacle.O.pos_enu_m"][inside], columns["obstacle.O.vel_enu_mps"][inside]
    gap = to_surface(own, centre, 25.0)
    closest = int(np.argmin(columns["obstacle.O.clearance_m"][inside]))
    return columns["time_s"][inside], own, vel, gap, centre, close_up(own, vel, centre, motion, gap, closest, span_m)


def test_the_encounter_is_from_the_decision_to_after_the_closest_approach():
    record = made.record()
    window = window_of(record, made.metrics(record))
    closest = float(record.columns["time_s"][np.argmin(record.columns["obstacle.O.clearance_m"])])
    assert (window.begin_s, window.closest_s, window.obstacle) == (made.TRIGGER_S, closest, "O")
    assert window.end_s == pytest.approx(closest + 1.5)


def test_the_way_to_the_surface_ends_on_it_from_both_sides():
    own = np.array([[0.0, 0.0, 0.0], [20.0, 0.0, 0.0], [40.0, 0.0, 0.0]])
    ends = own + to_surface(own, np.tile([40.0, 0.0, 0.0], (3, 1)), 25.0)
    assert ends[:2] == pytest.approx(np.array([[15.0, 0.0, 0.0], [15.0, 0.0, 0.0]]))  # from within, outwards: 5 m
    assert np.linalg.norm(ends - [40.0, 0.0, 0.0], axis=1) == pytest.approx([25.0] * 3)


@pytest.mark.parametrize("span_m", [2.1, 10.9])
def test_aircraft_and_surface_are_in_the_picture_throughout(span_m):
    _, own, _, gap, _, shot = filmed(span_m)
    for place in (own, own + gap):
        seen = np.abs(shot.seen(place))
        assert seen[:, 0].max() < 0.75
        assert seen[:, 1].max() < 0.5
    closest = int(np.argmin(np.linalg.norm(gap, axis=1)))
    assert span_m / shot.height_m[closest] > 0.1  # at its true size the aircraft can be seen where it matters


def test_a_place_in_the_picture_is_seen_where_it_was_put():
    *_, shot = filmed()
    places = np.tile([0.31, -0.22], (len(shot.eye), 1))
    assert shot.seen(shot.at(places)) == pytest.approx(places, abs=1e-9)


def test_the_chase_camera_is_behind_and_sees_the_aircraft_near_the_middle():
    time_s, own, vel, *_ = filmed()
    shot = chase(time_s, own, vel, 2.1)
    assert (np.einsum("ni,ni->n", own - shot.eye, vel) > 0.0).all()
    assert np.abs(shot.seen(own)).max() < 0.2
    assert shot.axes[:, 2, 0] == pytest.approx(np.zeros(len(own)), abs=1e-12)  # the horizon is level


places = st.floats(-0.5, 0.5)


@given(st.lists(st.tuples(places, places, st.sampled_from(["x", "flown in wind: 3.1 m inside", "a\nb\nc"])), min_size=1, max_size=7))
def test_words_never_cover_one_another(texts):
    sheet = labels.Sheet()
    sizes = sheet.sizes([text for *_, text in texts])
    wanted = np.array([[x, y] for x, y, _ in texts])
    spread = labels.spread(wanted, sizes, 10.0)
    assert not labels.overlaps(spread, sizes)
    assert (spread[:, 0] == wanted[:, 0]).all()
    assert (spread[0] == wanted[0]).all()


def test_the_check_of_covered_words_sees_them():
    sizes = labels.Sheet().sizes(["one", "two"])
    assert labels.overlaps(np.array([[0.0, 0.0], [0.01, 0.01]]), sizes)
    assert not labels.overlaps(np.array([[0.0, 0.0], [0.0, 0.2]]), sizes)


def test_streaks_move_with_the_air_and_stay_round_the_aircraft():
    time_s = np.arange(61) / 20.0
    own = np.column_stack([50.0 * time_s, np.zeros(61), np.zeros(61)])
    wind = np.column_stack([np.full(61, 3.0), 4.0 * np.sin(time_s), np.full(61, -1.0)])
    streaks = airflow.streaks(time_s, own, wind, 12.0)
    assert streaks.shape == (61, airflow.COUNT, 2, 3)
    assert (np.abs(streaks[:, :, 1] - own[:, None]) <= 12.0 + 1e-9).all()
    assert streaks[:, :, 1] - streaks[:, :, 0] == pytest.approx(np.broadcast_to(airflow.STREAK_S * wind[:, None], streaks[:, :, 0].shape))
    step = np.diff(streaks[:, :, 1], axis=0)
    moved = 0.5 * (wind[1:] + wind[:-1]) / 20.0
    off = np.mod(step - moved[:, None] + 12.0, 24.0) - 12.0  # a particle may have come in again on the other side
    assert np.abs(off).max() < 1e-9
    assert airflow.is_calm(0.0 * wind)
    assert not airflow.is_calm(wind)
    assert math.isclose(float(airflow.drift(time_s, wind)[-1, 0]), 9.0)
