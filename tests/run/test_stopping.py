"""A campaign that stops when its intervals are narrow enough stops at the same flight, however it is flown."""

import json
from dataclasses import replace
from itertools import pairwise

import pytest

from testbed.campaign import load_campaign
from testbed.results.statistics import share_interval
from testbed.run import power, runner, stopping
from testbed.run.directory import BadInputError
from tests.run import fakes
from tests.run.little import CAMPAIGN, STABLE, flown, fly, little_campaign, stop_after

__all__ = ["little_campaign"]  # every test here has it

STOP = "stop: {column: entered_near, width: 0.3, every: 20}\n"
DAA = "daa: {standards: [], volumes: {near: {radius_m: 10, half_height_m: 5}}}\n"


def kept_every_other(job):
    """Without avoidance every second flight comes into the volume, with it every fourth."""
    result = fakes.fly(job)
    every = 2 if job.plan.method.kind == "none" else 4
    entered = job.plan.replicate % every == 0
    row = result.row | {"method": job.plan.method.kind, "entered_near": entered, "least_clearance_m": -1.0 if entered else 1.0}
    return replace(result, row=row)


def campaign(folder, text=DAA + STOP, replicates=100):
    (folder / "little.yaml").write_text(CAMPAIGN.replace("replicates: 4", f"replicates: {replicates}") + text)


def first_narrow(width, every, period):
    """By the definition alone: after how many replicates the wider of the two intervals is narrow."""
    n = every
    while max(high - low for low, high in (share_interval(-(-n // k), n) for k in (2, period))) > width:
        n += every
    return n


def test_it_stops_after_the_first_batch_that_is_narrow_enough_and_the_run_is_whole(tmp_path):
    campaign(tmp_path)
    summary = fly(tmp_path, job=kept_every_other)
    replicates = first_narrow(0.3, 20, 4)
    assert replicates == 60
    assert (summary.planned, summary.flown_now) == (2 * replicates, 2 * replicates)
    assert len((summary.directory / "results.csv").read_text().splitlines()) == 1 + 2 * replicates
    assert (summary.directory / "risk.csv").is_file()
    assert json.loads((summary.directory / "answer.json").read_text())["flights_planned"] == 2 * replicates
    assert json.loads((summary.directory / "manifest.json").read_text())["flights"] == 2 * replicates
    again = fly(tmp_path, job=kept_every_other)
    assert again.flown_now == 0
    assert len(flown(tmp_path)) == 2 * replicates
    assert runner.report(summary.directory).planned == 2 * replicates


@pytest.mark.slow
def test_workers_and_interruptions_do_not_show_in_where_it_stops(tmp_path):
    campaign(tmp_path, DAA + "stop: {column: risk_ratio.near, width: 0.5, every: 20}\n", replicates=80)
    whole = fly(tmp_path, out=tmp_path / "whole", job=kept_every_other).directory
    assert 1 < len((whole / "results.csv").read_text().splitlines()) < 161
    two = fly(tmp_path, out=tmp_path / "two", job=kept_every_other, workers=2).directory
    with pytest.raises(KeyboardInterrupt):
        fly(tmp_path, progress=stop_after(47), job=kept_every_other)
    resumed = fly(tmp_path, job=kept_every_other).directory
    for name in (*STABLE, "risk.csv", "answer.json"):
        assert (two / name).read_bytes() == (whole / name).read_bytes(), name
        assert (resumed / name).read_bytes() == (whole / name).read_bytes(), name


def test_it_flies_all_where_the_width_is_never_reached(tmp_path):
    campaign(tmp_path, DAA + STOP.replace("0.3", "0.01"), replicates=30)
    assert fly(tmp_path, job=kept_every_other).planned == 60


def test_batches_grow_with_what_has_been_flown_and_end_with_all():
    assert list(stopping.boundaries(10, 35)) == [10, 20, 30, 35]
    many = list(stopping.boundaries(100, 100_000))
    assert many[:11] == [*range(100, 1100, 100), 1100]
    assert many[-1] == 100_000
    assert len(many) < 70
    assert all(b - a <= 0.1 * a + 100 for a, b in pairwise(many))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("stop: {column: kept_claer, width: 0.1}\n", "no column 'kept_claer'"),
        ("stop: {column: risk_ratio.near, width: 0.1}\n", "goes with a section daa"),
        ("stop: {column: nearest_obstacle, width: 0.1}\n", "no column 'nearest_obstacle' of numbers"),
        ("daa: {weight: nowhere}\n", "daa.weight: no column 'nowhere'"),
    ],
)
def test_a_column_that_there_is_not_is_refused_before_anything_is_flown(tmp_path, text, said):
    campaign(tmp_path, text)
    with pytest.raises(BadInputError, match=said):
        fly(tmp_path)
    assert flown(tmp_path) == []


MET = """\
name: met
question: Do they meet?
seed: 1
replicates: 2
route: {start_enu_m: [0, 0, 0], goal_enu_m: [500, 0, 0], start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}
encounters:
  kind: approaches
  own_at_enu_m: [25, 0, 0]
  own_direction_deg: [0, 0]
  miss_m: MISS
  crossing_deg: 90
  speed_mps: 30
  time_to_cpa_s: 5
  radius_m: 25
daa: {weight: weight}
"""


def test_the_weight_of_encounters_can_be_named_where_they_have_one(tmp_path):
    file = tmp_path / "met.yaml"
    file.write_text(MET.replace("MISS", "{edges: [0, 25, 60], chances: [0.25, 0.75], drawn: [0.5, 0.5]}"))
    stopping.refuse(load_campaign(file))
    file.write_text(MET.replace("MISS", "[0, 60]"))
    with pytest.raises(BadInputError, match=r"daa\.weight: no column 'weight' of numbers"):
        stopping.refuse(load_campaign(file))


def test_validate_says_how_many_flights_a_width_takes(tmp_path):
    n = power.flights_for_share(0.1)
    assert 0.1 >= share_interval(n // 2, n)[1] - share_interval(n // 2, n)[0] > 0.0995
    campaign(tmp_path, "daa: {power: {width: 0.2, ratio: 0.3, share: 0.4, induced: 0.05}}\nstop: {column: kept_clear, width: 0.1}\n")
    ratio, share = power.told(load_campaign(tmp_path / "little.yaml"))
    assert "takes about 239 encounters" in ratio
    assert ratio.endswith("the campaign has 100: too few")
    assert f"takes at most {n:,} flights a cell" in share
    assert stopping.RATIO == "risk_ratio."
