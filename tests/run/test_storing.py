"""What a run stores of each flight."""

import csv
import json
import math

import pytest

from testbed.run import runner, storing
from tests.run.little import CAMPAIGN, contents, fly, little_campaign, stop_after

__all__ = ["little_campaign"]  # every test here has it


@pytest.mark.parametrize(("how", "count"), [("all", 8), ("selected", 2), ("none", 0)])
def test_recordings_are_stored_as_asked(tmp_path, how, count):
    directory = fly(tmp_path, overrides=(f"recordings={how}",)).directory
    rows = [json.loads(line)["row"] for line in (directory / "rows.jsonl").read_text().splitlines()]
    named = {row["recording"] for row in rows if row["recording"]}
    assert named == {f"recordings/{path.name}" for path in (directory / "recordings").glob("*")}
    assert len(named) == count
    if how == "selected":
        assert {row["replicate"] for row in rows if row["recording"]} == {0}


@pytest.mark.parametrize(("how", "replicates"), [("all", {0, 1, 2, 3}), ("selected", {0}), ("none", set())])
def test_raw_columns_are_stored_as_asked_and_cleared_with_the_run(tmp_path, how, replicates):
    directory = fly(tmp_path, overrides=(f"columns={how}",)).directory
    flights = json.loads((directory / "plan.json").read_text())["flights"]
    expected = {f"{flight['flight_id']}.parquet" for flight in flights if flight["replicate"] in replicates}
    assert {path.name for path in (directory / "columns").glob("*")} == expected
    fly(tmp_path, overrides=("columns=none",), fresh=True)
    assert not list((directory / "columns").glob("*"))


def test_series_are_stored_for_the_first_cells_only_however_the_run_is_cut(tmp_path, monkeypatch):
    monkeypatch.setattr(storing, "SERIES", 1)
    with pytest.raises(KeyboardInterrupt):
        fly(tmp_path, progress=stop_after(6))
    directory = fly(tmp_path).directory
    first = json.loads((directory / "plan.json").read_text())["flights"][0]["flight_id"]
    assert json.loads((directory / "index.html").read_text())[2] == {first: {"z_m": [0.0, math.pi]}}


PARTS = """\
parts:
  many: {recordings: all, sweep: {sensor.range_m: [1, 2, 3, 4, 5, 6]}, replicates: 2}
  few: {sweep: {method.kind: [none, scoam]}, recordings: selected}
  one: {replicates: 3}
"""


def test_each_part_is_recorded_and_pictured_in_its_own_right(tmp_path, monkeypatch):
    """Ten flights have a first replicate, six of them in the first part; four series are one of each part, then one more."""
    monkeypatch.setattr(storing, "SERIES", 4)
    (tmp_path / "little.yaml").write_text(CAMPAIGN.partition("sweep:")[0] + PARTS)
    directory = fly(tmp_path).directory
    with (directory / "results.csv").open(newline="") as table:
        rows = list(csv.DictReader(table))
    assert [(row["label.part"], row["label.sensor.range_m"], row["label.method.kind"]) for row in rows] == [
        *[("many", str(k // 2 + 1), "") for k in range(12)],
        *[("few", "", method) for method in ("none", "scoam") for _ in range(4)],
        *[("one", "", "")] * 3,
    ]
    there = {row["flight_id"]: (row["cell"], row["replicate"]) for row in rows}
    series = json.loads((directory / "index.html").read_text())[2]
    assert {there[flight_id] for flight_id in series} == {("many/1", "0"), ("many/2", "0"), ("few/none", "0"), ("one", "0")}
    recorded = [there[path.stem] for path in (directory / "recordings").glob("*")]
    assert sorted(recorded) == sorted([*[(f"many/{k}", r) for k in range(1, 7) for r in "01"], ("few/none", "0"), ("few/scoam", "0")])
    before = contents(directory)
    runner.report(directory)
    assert contents(directory) == before
