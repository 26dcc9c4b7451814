"""A run directory from Python: typed rows, series, and two runs side by side."""

import subprocess
import sys

import numpy as np
import pandas as pd
import pytest

from testbed import open_run
from testbed.run import runner
from testbed.run.directory import BadInputError
from testbed.run.runner import Order
from tests.run.little import Here

CAMPAIGN = """\
name: opened
question: Can the run be read?
seed: 5
columns: all
recordings: none
route: {start_enu_m: [0, 0, 0], goal_enu_m: [500, 200, 100], start_direction_deg: [40.87, 26.13], goal_direction_deg: [10.00, 2.84]}
obstacles:
  - {name: O, radius_m: 25, position_enu_m: [254, 63.6, 60.7], speed_mps: 40, direction_deg: [106.1, 10.4],
     when: {own_reaches_enu_m: [162, 101, 64.3]}}
plant: {kind: kinematic}
sweep:
  replan.k: [1.25, 1.5]
  method.kind: [none, scoam]
  wind_mps: {"0": {}, "5": {air.wind: {kind: steady, speed_mps: 5, from_deg: 0}}}
"""


def flown(folder, *overrides):
    folder.mkdir(exist_ok=True)
    (folder / "opened.yaml").write_text(CAMPAIGN)
    runner.run(Order(source=folder / "opened.yaml", engine=Here(), out=folder / "out", overrides=overrides))
    return open_run(folder / "out")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return flown(tmp_path_factory.mktemp("opened"))


def test_results_are_typed_in_plan_order_and_say_their_units(run):
    assert list(run.results["flight_id"]) == [plan.flight_id for plan in run.plans]
    assert run.campaign.name == "opened"
    kinds = {name: run.results[name].dtype.kind for name in ("label.replan.k", "label.wind_mps", "kept_clear", "least_clearance_m")}
    assert kinds == {"label.replan.k": "f", "label.wind_mps": "i", "kept_clear": "b", "least_clearance_m": "f"}
    assert run.results.attrs["units"]["encounter_closing_mps"] == "m/s"
    assert run.results.attrs["definitions"]["kept_clear"].startswith("Whether every radius was kept")
    kept = run.results["least_clearance_m"] >= -1e-6
    assert (run.results["kept_clear"] == kept).all()
    assert set(run.results.loc[run.results["method"] == "none", "encounter_radius_m"]) == {25.0}


def test_a_share_of_kept_flights_leaves_out_those_that_met_nothing(tmp_path):
    run = flown(tmp_path / "some", "columns=none", "sweep={wind_mps: {'0': {}, '5': {obstacles: []}}}")
    assert run.results["kept_clear"].isna().tolist() == [False, True]
    assert run.results["kept_clear"].mean() in (0.0, 1.0)


def test_axes_stand_in_the_order_of_the_sweep(run):
    axes = [name for name in run.results if name.startswith("label.")]
    assert axes == ["label.replan.k", "label.method.kind", "label.wind_mps"] == list(run.results)[-3:]


def test_csv_and_parquet_can_be_joined_on_every_axis(run):
    axes = [name for name in run.results if name.startswith("label.")]
    from_csv = pd.read_csv(run.directory / "results.csv")
    assert from_csv[axes].dtypes.to_dict() == run.results[axes].dtypes.to_dict()
    assert len(run.results.merge(from_csv, on=axes)) == len(run.plans) == 8


def test_series_are_those_that_were_stored(run):
    series = run.series()
    assert list(dict.fromkeys(series["flight_id"])) == [plan.flight_id for plan in run.plans]
    one = series[series["flight_id"] == run.plans[0].flight_id]
    assert np.allclose(np.diff(one["time_s"]), 1 / 120)
    assert np.linalg.norm(one[[f"own.vel_enu_mps.{axis}" for axis in "xyz"]], axis=1) == pytest.approx(50.0)


def test_series_can_be_thinned_and_picked(run):
    series = run.series(["own.pos_enu_m", "own.vel_enu_mps.z"], every_s=0.5)
    assert list(series) == ["flight_id", "time_s", "own.pos_enu_m.x", "own.pos_enu_m.y", "own.pos_enu_m.z", "own.vel_enu_mps.z"]
    for _, one in series.groupby("flight_id"):
        assert one["time_s"].tolist() == pytest.approx(np.arange(len(one)) * 0.5)
    odd = run.series(["own.pos_enu_m.x"], every_s=0.007)  # no multiple of a tick
    one = odd[odd["flight_id"] == run.plans[0].flight_id]["time_s"]
    assert one.is_unique
    assert (np.abs(one - np.round(one / 0.007) * 0.007) <= 0.5 / 120 + 1e-9).all()
    with pytest.raises(ValueError, match=r"no signal 'own.speed' was kept; there are: time_s, own.pos_enu_m.x"):
        run.series(["own.speed"])
    with pytest.raises(ValueError, match="above 0 s"):
        run.series(every_s=0.0)


def test_two_runs_are_paired_on_what_they_share(run, tmp_path):
    other = flown(tmp_path / "faster", "speed_mps=60", "columns=none")
    pairs = run.join(other, on=["method.kind", "replan.k", "label.wind_mps"])
    assert len(pairs) == 8
    assert (pairs["flight_time_s"] > pairs["flight_time_s_other"]).all()
    with pytest.raises(ValueError, match=r"several flights have \{'label.wind_mps': 0\}; name more columns"):
        run.join(other, on="wind_mps")
    with pytest.raises(ValueError, match="'wind' is no column of both runs; there are: flight_id"):
        run.join(other, on="wind")
    with pytest.raises(BadInputError, match="kept no series; fly the campaign with --set columns=all"):
        other.series()


def test_one_name_is_enough_and_what_cannot_be_is_said_in_words(run):
    assert list(run.series("own.pos_enu_m")) == list(run.series(["own.pos_enu_m"]))
    with pytest.raises(ValueError, match=r"no signal 'nope' was kept; there are: time_s, own\.pos_enu_m\.x"):
        run.series("nope")
    with pytest.raises(ValueError, match="columns: name at least one column"):
        run.series([])
    with pytest.raises(ValueError, match="on: name at least one column"):
        run.join(run, on=[])
    with pytest.raises(ValueError, match="'nope' is no column of both runs; there are: flight_id"):
        run.join(run, on="nope")
    for there in (run.directory.path, str(run.directory.path)):
        with pytest.raises(ValueError, match=r"give the other run as open_run\('.*out'\), not as "):
            run.join(there, on="flight_id")


def test_what_is_no_run_is_said_so(run, tmp_path):
    with pytest.raises(BadInputError, match="no such directory"):
        open_run(tmp_path / "nowhere")
    copy = tmp_path / "copy"
    copy.mkdir()
    (copy / "manifest.json").write_bytes((run.directory / "manifest.json").read_bytes())
    with pytest.raises(BadInputError, match="testbed report"):
        _ = open_run(copy).results


def test_reading_a_run_does_not_need_jsbsim(run):
    code = "import sys; sys.modules['jsbsim'] = None; from testbed import open_run; r = open_run(sys.argv[1]); print(len(r.results), "
    code += "len(r.plans))"
    done = subprocess.run([sys.executable, "-c", code, run.directory.path], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["8", "8"]
