import json
import math
from dataclasses import fields
from pathlib import Path

import pytest

from testbed.campaign import expand, load_campaign
from testbed.results.columns import FlightMetrics
from testbed.results.plain import plain
from testbed.run import journal
from testbed.run.job import Job, run_job

SMOKE = Path(__file__).parents[2] / "campaigns" / "smoke.yaml"


@pytest.fixture(scope="module")
def plan():
    plans = expand(load_campaign(SMOKE))
    return next(plan for plan in plans if plan.plant.kind == "kinematic" and plan.method.kind == "scoam")


def test_a_row_holds_who_flew_what_came_out_and_what_was_decided(plan):
    result = run_job(Job(plan))
    row = result.row
    assert row["traceback"] == ""
    who = (row["flight_id"], row["cell"], row["labels"], row["replicate"], row["seed"], row["plant"], row["aircraft"], row["method"])
    assert who == (plan.flight_id, plan.cell, plan.labels, 0, plan.seed, "kinematic", "gtm_t2", "scoam")
    assert {field.name for field in fields(FlightMetrics)} <= set(row)
    assert [event["obstacle"] for event in row["events"]] == ["O"]
    assert row["recording"] is None
    assert result.series is None
    assert {"fly", "measure"} <= set(result.timings)


def test_the_same_plan_is_the_same_row_and_series(plan):
    first, second = (run_job(Job(plan, want_series=True)) for _ in range(2))
    texts = [json.dumps(plain([result.row, result.series])) for result in (first, second)]
    assert texts[0] == texts[1]
    assert first.series


def test_a_recording_is_written_beside_the_row(plan, monkeypatch, tmp_path):
    monkeypatch.setattr("testbed.show.recording.write_recording", lambda _, metrics, path: path.write_text(metrics.outcome))
    row = run_job(Job(plan, tmp_path / "recordings" / "x.rrd")).row
    assert row["recording"] == "recordings/x.rrd"
    assert (tmp_path / "recordings" / "x.rrd").read_text() == row["outcome"]


def test_raw_columns_are_written_before_the_row_is_given_back(plan, tmp_path):
    path = tmp_path / "columns" / "x.parquet"
    result = run_job(Job(plan, columns_path=path))
    assert path.read_bytes()[:4] == b"PAR1"
    assert "columns" in result.timings


@pytest.mark.parametrize("stage", ["testbed.flight.fly.fly", "testbed.results.metrics.measure", "testbed.show.series.flight_series"])
def test_a_bug_anywhere_is_a_row_with_its_traceback(plan, monkeypatch, stage):
    def broken(*_):
        return {}["no such column"]

    monkeypatch.setattr(stage, broken)
    result = run_job(Job(plan, want_series=True))
    assert result.row["outcome"] == "crashed"
    assert result.row["message"] == "KeyError: 'no such column'"
    assert "in broken" in result.row["traceback"]
    assert result.row["flight_id"] == plan.flight_id
    assert math.isnan(result.row["least_clearance_m"])
    assert journal.decode(journal.encode(result)).row["events"] == []


def test_a_message_that_is_no_text_is_a_row_all_the_same(plan, monkeypatch):
    """A lone surrogate, as Python makes of bytes that are not UTF-8, would cost the journal and the page."""

    def fails(_):
        raise RuntimeError("bytes \udc80 from somewhere")

    monkeypatch.setattr("testbed.flight.fly.fly", fails)
    result = run_job(Job(plan))
    assert result.row["outcome"] == "crashed"
    assert "bytes \\udc80 from" in result.row["message"]
    assert journal.decode(journal.encode(result)).row["message"] == result.row["message"]
