"""The page of runs: where it is written and where not, and what it says of runs that are whole, cut off or damaged."""

import json

import pytest

from testbed.run import listed, runner
from testbed.run.directory import BadInputError
from tests.run.little import fly, little_campaign, stop_after

__all__ = ["little_campaign"]


def test_it_is_written_where_runs_go_and_nowhere_else(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    fly(tmp_path, out=None)
    page = (tmp_path / "reports/runs/index.html").read_text()
    assert "Does the run directory keep what it is given?" in page
    assert 'href="little/index.html"' in page
    fly(tmp_path, out=tmp_path / "elsewhere/run")
    assert not (tmp_path / "elsewhere/index.html").exists()
    listed.write_page(tmp_path / "elsewhere")  # asked for once, it is kept up
    fly(tmp_path, out=tmp_path / "elsewhere/other")
    assert 'href="other/index.html"' in (tmp_path / "elsewhere/index.html").read_text()


def test_a_page_of_somebody_elses_is_left_alone_and_a_run_ends_all_the_same(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    theirs = tmp_path / "reports/runs/index.html"
    theirs.parent.mkdir(parents=True)
    theirs.write_text("my own")
    assert fly(tmp_path, out=None).outcomes == {"reached": 8}
    assert theirs.read_text() == "my own"
    with pytest.raises(BadInputError, match="is not a page of runs, and is not overwritten"):
        listed.write_page(theirs.parent)
    with pytest.raises(BadInputError, match="is a run itself"):
        listed.write_page(tmp_path / "reports/runs/little")


def test_each_run_says_what_it_is(tmp_path):
    whole = fly(tmp_path, out=tmp_path / "runs/whole")
    with pytest.raises(KeyboardInterrupt):
        fly(tmp_path, out=tmp_path / "runs/cut", progress=stop_after(3))
    for name, damage in (("former", {}), ("nasty", {"lines": ["<script>alert(1)</script>"], "bars": [], "of": "", "flight": ""})):
        fly(tmp_path, out=tmp_path / "runs" / name)
        (tmp_path / "runs" / name / "answer.json").write_text(json.dumps(damage))
    fly(tmp_path, out=tmp_path / "runs/broken")
    (tmp_path / "runs/broken/manifest.json").write_text("{")
    (tmp_path / "runs/notes").mkdir()
    found = {run.path.name: run for run in listed.runs_in(tmp_path / "runs")}
    assert set(found) == {"whole", "cut", "former", "nasty", "broken"}
    assert (found["whole"].state, found["whole"].answer, found["whole"].planned) == ("", whole.answer, 8)
    assert found["cut"].state == "not finished"
    assert found["former"].state.startswith("finished, without an answer")
    assert "damaged" in found["broken"].state
    page = listed.write_page(tmp_path / "runs").read_text()
    assert "<script" not in page
    assert "&lt;script&gt;alert(1)" in page
    runner.report(tmp_path / "runs/cut")
    assert found["cut"].state != (now := {r.path.name: r for r in listed.runs_in(tmp_path / "runs")}["cut"].state)
    assert now == "not finished: 3 of 8 flights"
