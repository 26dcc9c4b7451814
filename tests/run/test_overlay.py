"""Rungs of one encounter of a run, flown again into one recording."""

import pytest

from testbed.run.directory import BadInputError
from testbed.run.overlay import overlay
from tests.run.little import Here, fly, little_campaign
from tests.show.test_recording import entities

__all__ = ["little_campaign"]  # every test here has it

CAMPAIGN = """\
name: rungs
question: Who is shown with whom?
seed: 5
route: {start_enu_m: [0, 0, 0], goal_enu_m: [500, 200, 100], start_direction_deg: [40.87, 26.13], goal_direction_deg: [10.00, 2.84]}
begin: {climb_at_most_deg: 18}
obstacles:
  - name: O
    radius_m: 25
    position_enu_m: [254, 63.6, 60.7]
    speed_mps: 40
    direction_deg: [106, 12.4]
    when: {own_reaches_enu_m: [162, 101, 64.3]}
recordings: none
sweep:
  method.kind: [none, scoam]
  rung:
    rails: {plant.kind: kinematic}
    mass: {plant.kind: point_mass}
    rolls_at_once: {plant: {kind: point_mass, ideal: [roll]}}
    light: {plant.kind: point_mass, air.wind: {kind: steady, speed_mps: 5, from_deg: 0}}
    strong: {plant.kind: point_mass, air.wind: {kind: steady, speed_mps: 12, from_deg: 90}}
"""


@pytest.fixture
def run(tmp_path):
    (tmp_path / "rungs.yaml").write_text(CAMPAIGN)
    return fly(tmp_path, source=tmp_path / "rungs.yaml", job=_least).directory


def _least(job):
    """A row without a flight, in which the stronger wind brings the flight nearer."""
    from tests.run import fakes

    done = fakes.fly(job)
    wind = job.plan.air.wind
    done.row["least_clearance_m"] = -getattr(wind, "speed_mps", 0.0)
    return done


@pytest.mark.slow
def test_one_flight_of_each_rung_the_nearest_in_wind_and_the_asked_one_first(run, tmp_path):
    found = overlay(run, "scoam/mass", tmp_path / "rungs.rrd", engine=Here())
    assert found.names == ("point mass in calm air", "point on rails in calm air", "point mass in wind 12 m/s from 90 deg")
    assert found.left_out == ()
    assert len(found.differences) == 3  # the rows were not flown
    there = entities(found.recording)
    for number in range(3):
        assert f"/world/flight_{number}/label" in there
    assert "/world/flight_3/label" not in there
    every = overlay(run, "scoam/rails", tmp_path / "every.rrd", every=True, engine=Here())
    assert every.names == (
        "point on rails in calm air",
        "point mass in calm air",
        "point mass without limits of roll in calm air",
        "point mass in wind 12 m/s from 90 deg",
    )


@pytest.mark.slow
def test_the_beginning_of_a_cell_means_its_most_faithful_flight(run, tmp_path):
    found = overlay(run, "scoam", tmp_path / "x.rrd", engine=Here())
    assert found.names[0] == "point mass in calm air"


def test_a_cell_that_is_not_there_is_told_with_the_nearest(run):
    with pytest.raises(BadInputError, match="no cell or flight 'scaom/rails'; nearest: scoam/rails, "):
        overlay(run, "scaom/rails", engine=Here())
