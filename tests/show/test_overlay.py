"""Several flights in one recording: each where its record says, with its clearance, and its name beside the others' names."""

import subprocess
from dataclasses import replace

import numpy as np
import pytest

from testbed.show import words
from testbed.show.recording.overlay import Flown, can_be_shown, write_overlay
from tests import made
from tests.show.test_recording import RERUN, read, seconds

LATER_S = 0.5


@pytest.fixture(scope="module")
def flights():
    """The synthetic flight, and the same half a second later, 20 m higher and passing at another distance."""
    first = made.record(plant={"kind": "jsbsim"})
    second = made.record()
    columns = {name: column.copy() for name, column in second.columns.items()}
    columns["own.pos_enu_m"] = columns["own.pos_enu_m"] + [0.0, 0.0, 40.0]
    distance = np.linalg.norm(columns["obstacle.O.pos_enu_m"] - columns["own.pos_enu_m"], axis=1)
    columns["obstacle.O.clearance_m"] = distance - 25.0
    events = tuple(replace(event, time_s=event.time_s + LATER_S) for event in second.events)
    higher = replace(second, columns=columns, events=events)
    metrics = made.metrics(first), made.metrics(higher)
    return [Flown("flown", first, metrics[0]), Flown("point on rails", higher, metrics[1])]


@pytest.fixture(scope="module")
def written(flights, tmp_path_factory):
    path = tmp_path_factory.mktemp("overlay") / "both.rrd"
    write_overlay(flights, "both", path)
    return path


def test_the_viewers_own_check_finds_nothing_wrong(written):
    found = subprocess.run([str(RERUN), "rrd", "verify", str(written)], capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr


@pytest.mark.parametrize(("number", "decided_s"), [(0, made.TRIGGER_S), (1, made.TRIGGER_S + LATER_S)])
def test_each_is_where_its_record_says_from_its_decision_on(flights, written, number, decided_s):
    columns = flights[number].record.columns
    own, seen = read(written, f"/world/flight_{number}/own"), read(written, f"/relative/flight_{number}/own")
    assert "sim_time" not in own
    since = seconds(own["encounter"])
    assert since[0] == 0.0
    rows = np.rint((since + decided_s) * made.HZ).astype(int)
    assert np.array(own["translation"])[:, 0] == pytest.approx(columns["own.pos_enu_m"][rows], abs=1e-3)
    apart = columns["own.pos_enu_m"][rows] - columns["obstacle.O.pos_enu_m"][rows]
    assert np.array(seen["translation"])[:, 0] == pytest.approx(apart, abs=1e-3)
    label = read(written, f"/world/flight_{number}/label")
    least, name = flights[number].metrics, flights[number].name
    for k, row in enumerate(rows):
        passed = since[k] + decided_s > least.time_at_least_clearance_s + 1e-6
        told = words.clearance(least.least_clearance_m if passed else columns["obstacle.O.clearance_m"][row])
        assert label["labels"][k] == [f"{name}: {'passed ' if passed else ''}{told}"]
        hit = (least.least_clearance_m if passed else columns["obstacle.O.clearance_m"][row]) < 0.0
        hit |= columns["obstacle.O.clearance_m"][row] < 0.0
        assert (label["colors"][k] == [0xFF4B4BFF]) == hit


def test_the_sphere_of_the_other_is_drawn_where_it_is_elsewhere(written):
    from tests.show.test_recording import entities

    assert "/world/flight_0/obstacle/O" in entities(written)  # filled
    assert "/world/flight_1/obstacle/O/net" in entities(written)  # half a second on


def test_a_flight_that_met_nobody_is_not_shown(flights):
    alone = made.record(obstacles=[], method={"kind": "none"})
    assert can_be_shown(flights[0])
    assert not can_be_shown(Flown("alone", alone, made.metrics(alone)))
