"""A flight of a run flown again."""

import json

import pytest

from testbed.run.directory import BadInputError
from testbed.run.replay import replay
from tests.run import fakes
from tests.run.little import fly, little_campaign

__all__ = ["little_campaign"]  # every test here has it


@pytest.mark.slow
def test_a_replay_equals_its_row_and_records(tmp_path):
    directory = fly(tmp_path).directory
    flight = json.loads((directory / "plan.json").read_text())["flights"][5]["flight_id"]
    again = replay(directory, flight[:8], job=fakes.fly)
    assert (again.flight_id, again.differences, again.same_code) == (flight, [], True)
    assert again.recording == directory.resolve() / "recordings" / f"{flight}.rrd"
    assert again.recording.exists()
    elsewhere = replay(directory, flight, tmp_path / "x.rrd", job=fakes.fly)
    assert (tmp_path / "x.rrd").exists()
    assert elsewhere.differences == []


@pytest.mark.slow
def test_a_replay_that_differs_says_where(tmp_path):
    directory = fly(tmp_path).directory
    rows = directory / "rows.jsonl"
    lines = [json.loads(line) for line in rows.read_text().splitlines()]
    lines[0]["row"]["max_bank_deg"] = 1.5
    rows.write_text("".join(json.dumps(line) + "\n" for line in lines))
    again = replay(directory, lines[0]["row"]["flight_id"], tmp_path / "x.rrd", job=fakes.fly)
    (difference,) = again.differences
    assert difference.startswith("max_bank_deg: 1.5 there, ")


@pytest.mark.parametrize(("wanted", "message"), [("zzz", "no flight 'zzz'; there are "), ("", "several flights begin with ''")])
def test_a_replay_of_no_one_flight_is_refused(tmp_path, wanted, message):
    directory = fly(tmp_path).directory
    with pytest.raises(BadInputError, match=message):
        replay(directory, wanted)
