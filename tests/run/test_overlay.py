"""Rungs of one encounter of a run, flown again into one recording."""

import json

import pytest

from testbed.run.directory import BadInputError
from testbed.run.overlay import asked_for, chosen_rungs, overlay
from testbed.run.replay import replay
from testbed.run.stored import existing, plan_of
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
    assert [(kept, told.split()[-1]) for kept, told in found.told] == [
        ("collided", "inside"),
        ("kept clear", "clear"),
        ("kept clear", "clear"),
    ]
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


PARTS = """\
parts:
  windy:
    set: {air.wind: {kind: steady, speed_mps: 10, from_deg: 240}}
    sweep: &rungs
      flown_by:
        rails: {plant.kind: kinematic}
        mass: {plant.kind: point_mass}
        rails_level: {plant.kind: kinematic, geometry: level}
        mass_level: {plant.kind: point_mass, geometry: level, aircraft: c172p}
  strong:
    set: {air.wind: {kind: steady, speed_mps: 15, from_deg: 240}}
    sweep: {flown_by: {mass: {plant.kind: point_mass, traffic.in_wind: drifts}}}
  calm:
    sweep: *rungs
"""


@pytest.mark.parametrize(
    ("asked", "shown"),
    [
        # in one wind both rungs; and who flies, in calm air, which only another part has
        (("windy/rails", "windy/mass"), {"windy/rails", "windy/mass", "calm/mass"}),
        # a point on rails is set to the default aircraft, and is a rung of the one that flies this encounter
        (("windy/rails_level", "windy/mass_level"), {"windy/rails_level", "windy/mass_level", "calm/mass_level"}),
        (("calm/rails", "calm/mass"), {"calm/rails", "calm/mass", "strong/mass"}),
        # one rung in this wind: the others in calm air
        (("strong/mass",), {"calm/rails", "calm/mass", "strong/mass"}),
    ],
)
def test_the_rungs_are_the_same_whichever_of_them_is_asked_for(of_parts, asked, shown):
    directory, planned, flights = of_parts
    for cell in asked:
        chosen = [flights[n]["cell"] for n in chosen_rungs(directory, planned, flights, asked_for(directory.path, flights, cell), False)]
        assert chosen[0] == cell
        assert sorted(chosen) == sorted(shown)


@pytest.fixture
def of_parts(tmp_path):
    """A run that has rungs in calm air and in wind, each in a part of its own."""
    (tmp_path / "parts.yaml").write_text(CAMPAIGN.partition("sweep:")[0] + PARTS)
    directory = existing(fly(tmp_path, source=tmp_path / "parts.yaml", job=_least).directory)
    _, planned = plan_of(directory)
    return directory, planned, list(planned.flights)


def test_a_recording_that_cannot_be_written_is_refused_before_anything_flies(run, tmp_path):
    (tmp_path / "file").write_text("")
    too_long = tmp_path / f"{'x' * 246}.rrd"  # for what stands beside it while it is written
    flight_id = json.loads((run / "rows.jsonl").read_text().splitlines()[0])["row"]["flight_id"]
    for write in (lambda out: overlay(run, "scoam/mass", out), lambda out: replay(run, flight_id, out, job=None)):
        with pytest.raises(BadInputError, match=rf"^{too_long}: File name too long$"):
            write(too_long)
        with pytest.raises(OSError, match="file"):
            write(tmp_path / "file/x.rrd")
