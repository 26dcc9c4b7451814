"""A run whose traffic is in a file: continued, reported and replayed while the file is what it was, refused when it is not."""

from pathlib import Path

import pytest

from testbed.run import runner
from testbed.run.directory import BadInputError
from testbed.run.replay import replay
from testbed.run.runner import Order
from testbed.run.stored import existing, rows_of
from tests.here import Here

CAMPAIGN = """\
name: recorded
question: Does a recorded aircraft fly?
route: {start_enu_m: [0, 0, 0], goal_enu_m: [400, 0, 0], start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}
plant: {kind: kinematic}
obstacles: [{name: F, kind: file, radius_m: 20, options: {path: tracks/a.csv}}]
method: {kind: scoam}
recordings: none
"""
ROWS = "time_s,east_m,north_m,up_m\n0,500,15,0\n4,340,15,0\n9,140,15,0\n"


@pytest.mark.slow
def test_a_file_that_changes_is_noticed(tmp_path: Path) -> None:
    (tmp_path / "tracks").mkdir()
    track, source, out = tmp_path / "tracks" / "a.csv", tmp_path / "c.yaml", tmp_path / "out"
    source.write_text(CAMPAIGN)
    track.write_text(ROWS)
    fly = lambda **more: runner.run(Order(**{"source": source, "out": out, "engine": Here(), **more}))  # noqa: E731
    first = fly()
    assert (first.flown_now, first.crashed) == (1, 0)
    assert fly().flown_now == 0
    flight = f"{rows_of(existing(out)).ids[0]:012x}"
    again = replay(out, flight)  # in a worker, which is told where the file is
    assert again.differences == []
    assert fly(source=out / "campaign.yaml").flown_now == 0  # the copy in the run, which has no file beside it

    track.write_text(ROWS.replace("140,15", "140,25"))
    with pytest.raises(BadInputError, match=r"data file tracks/a\.csv: \w{12} there, \w{12} now"):
        fly()
    with pytest.raises(BadInputError, match=r"tracks/a\.csv: changed since the campaign was read"):
        replay(out, flight)
    track.unlink()
    assert runner.report(out).outcomes == first.outcomes  # of what was flown; nothing is flown for it
    track.write_text(ROWS.replace("140,15", "140,25"))
    assert fly(fresh=True).flown_now == 1
