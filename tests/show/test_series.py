"""What the page keeps of a flight: few samples, but the extreme ones; the same bytes every time."""

import json
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from testbed import fly
from testbed.flight.record import FlightRecord
from testbed.show.series import MOST_SAMPLES, flight_series
from tests.plans import paper_obstacle, plan

MakeRecord = Callable[..., FlightRecord]


def test_few_samples_with_every_extreme(make_record: MakeRecord) -> None:
    record = make_record(plant={"kind": "jsbsim"})
    series = flight_series(record)
    assert len(series["time_s"]) <= MOST_SAMPLES < len(record.columns["time_s"])
    assert series["time_s"][0] == 0.0
    assert series["time_s"][-1] == 8.0
    assert series["time_s"] == sorted(set(series["time_s"]))
    assert min(series["clearance_m"]) == round(float(record.columns["obstacle.O.clearance_m"].min()), 3)
    assert max(series["cross_track_m"]) == round(float(record.columns["path.cross_track_m"].max()), 3)
    assert max(series["load_factor"]) == round(float(record.columns["own.load_factor"].max()), 3)
    assert 3.0 in series["time_s"]  # the decision


def test_a_flight_that_never_began_has_no_samples() -> None:
    series = flight_series(fly(plan(obstacles=[paper_obstacle()], begin={"at_route_s_m": 1e5}, plant={"kind": "kinematic"})))
    assert (series["time_s"], series["clearance_m"], series["obstacles"]) == ([], [], [])


def test_json_of_the_same_bytes(make_record: MakeRecord) -> None:
    once, twice = (json.dumps(flight_series(make_record()), allow_nan=False, sort_keys=True) for _ in range(2))
    assert once == twice
    assert len(once) < 40_000


def test_what_is_not_a_number_is_null(make_record: MakeRecord) -> None:
    record = make_record()
    columns = dict(record.columns) | {"own.load_factor": np.full(len(record.columns["time_s"]), math.nan)}
    series = flight_series(replace(record, columns=columns))
    assert set(series["load_factor"]) == {None}


def test_encounter_is_the_same_whoever_flies(make_record: MakeRecord) -> None:
    point, craft = flight_series(make_record()), flight_series(make_record(plant={"kind": "jsbsim"}, method={"kind": "none"}))
    level = flight_series(make_record(geometry="level"))
    assert point["encounter"] == craft["encounter"] != level["encounter"]


def test_obstacle_where_it_was_nearest(make_record: MakeRecord) -> None:
    record = make_record()
    told = flight_series(record)["obstacles"][0]
    nearest = int(np.argmin(record.columns["obstacle.O.clearance_m"]))
    assert told["nearest_enu_m"] == pytest.approx(list(record.columns["obstacle.O.pos_enu_m"][nearest]), abs=0.005)
    ends = [np.array([told[axis][k] for axis in "xyz"]) for k in (0, 1)]
    assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(30.0 * 5.0, abs=0.6)  # 2.5 s either side at 30 m/s


def test_a_flight_without_rows(make_record: MakeRecord) -> None:
    record = make_record()
    series = flight_series(replace(record, columns={name: column[:0] for name, column in record.columns.items()}, events=()))
    assert series["time_s"] == series["obstacles"] == []


def test_roll_rate_of_the_body_or_else_of_the_path(make_record: MakeRecord) -> None:
    flown, point = make_record(plant={"kind": "jsbsim"}), make_record()
    n = len(flown.columns["time_s"])
    rates = np.zeros((n, 3))
    rates[n // 3 + 1, 0] = math.radians(-80.0)  # one row: kept, as an extreme
    series = flight_series(replace(flown, columns=dict(flown.columns) | {"own.rates_body_radps": rates}))
    assert min(series["roll_rate_dps"]) == -80.0
    rolling = {"own.bank_rad": np.radians(12.0 * point.columns["time_s"]), "own.rates_body_radps": np.full((n, 3), math.nan)}
    demanded = flight_series(replace(point, columns=dict(point.columns) | rolling))["roll_rate_dps"]
    assert {rate for rate in demanded if rate is not None} == {12.0}
    assert None in demanded  # where the path changes its bank jumps
