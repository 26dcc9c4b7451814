import errno
import fcntl
import json
import os
import shutil
from pathlib import Path

import pytest

from testbed.campaign import SpecError
from testbed.run import identity, runner
from testbed.run.directory import BadInputError, RunDirectory
from testbed.run.replay import replay
from tests.run import fakes
from tests.run.little import CAMPAIGN, STABLE, contents, flown, fly, little_campaign, stop_after

__all__ = ["little_campaign"]  # every test here has it


def test_a_run_directory_holds_what_it_should(tmp_path):
    summary = fly(tmp_path)
    assert (summary.planned, summary.flown_now, summary.outcomes) == (8, 8, {"reached": 8})
    assert set(contents(summary.directory)) == {
        *(
            "campaign.yaml",
            "plan.json",
            "manifest.json",
            "rows.jsonl",
            "results.csv",
            "results.parquet",
            "timings.csv",
            "answer.json",
            "index.html",
        ),
        ".lock",
    }
    plan, manifest = (json.loads((tmp_path / "out" / name).read_text()) for name in ("plan.json", "manifest.json"))
    ids = [flight["flight_id"] for flight in plan["flights"]]
    for table in ("results.csv", "timings.csv"):
        assert [line.split(",")[0] for line in (tmp_path / "out" / table).read_text().splitlines()] == ["flight_id", *ids], "in plan order"
    assert (tmp_path / "out" / "campaign.yaml").read_text() == CAMPAIGN
    assert manifest["identity"]["versions"]["numpy"]
    assert len(manifest["aircraft"]["gtm_t2"]["aircraft.yaml"]) == 64
    assert [(leg["workers"], leg["flights"], leg["ended"] is None) for leg in manifest["history"]] == [(1, 8, False)]


@pytest.mark.slow
def test_workers_and_their_order_do_not_show_in_the_results(tmp_path):
    one, three = fly(tmp_path, out=tmp_path / "one"), fly(tmp_path, out=tmp_path / "three", workers=3, job=fakes.fly_slowly)
    for name in STABLE:
        assert (one.directory / name).read_bytes() == (three.directory / name).read_bytes(), name


def test_a_finished_run_is_only_reported_again(tmp_path):
    before = contents(fly(tmp_path).directory)
    shutil.rmtree(tmp_path / "out" / "recordings", ignore_errors=True)
    (tmp_path / "out" / "results.csv").unlink()
    again = fly(tmp_path)
    assert again.flown_now == 0
    assert len(flown(tmp_path)) == 8
    assert contents(tmp_path / "out") == before


@pytest.mark.slow
@pytest.mark.parametrize("workers", [None, 2])
def test_an_interrupted_run_is_continued_without_flying_a_stored_flight_again(tmp_path, workers):
    whole = fly(tmp_path, out=tmp_path / "whole").directory
    with pytest.raises(KeyboardInterrupt):
        fly(tmp_path, progress=stop_after(3), workers=workers, job=fakes.fly_slowly)
    stored = (tmp_path / "out" / "rows.jsonl").read_bytes()
    assert stored.count(b"\n") == 3
    summary = fly(tmp_path, workers=workers)
    assert summary.flown_now == 5
    assert (tmp_path / "out" / "rows.jsonl").read_bytes().startswith(stored)
    for name in STABLE:
        assert (summary.directory / name).read_bytes() == (whole / name).read_bytes(), name
    legs = json.loads((tmp_path / "out" / "manifest.json").read_text())["history"]
    assert [(leg["flights"], leg["ended"] is None) for leg in legs] == [(8, True), (5, False)]


def test_a_torn_last_line_is_flown_again(tmp_path):
    fly(tmp_path)
    rows, results = tmp_path / "out" / "rows.jsonl", (tmp_path / "out" / "results.csv").read_bytes()
    rows.write_bytes(rows.read_bytes()[:-30])
    assert fly(tmp_path).flown_now == 1
    assert (tmp_path / "out" / "results.csv").read_bytes() == results


def test_a_run_killed_before_its_plan_was_written_is_continued(tmp_path):
    fly(tmp_path)
    for name in set(contents(tmp_path / "out")) - {"manifest.json"}:
        (tmp_path / "out" / name).unlink()
    assert fly(tmp_path).flown_now == 8


def changed_plan(folder, _monkeypatch):
    (folder / "little.yaml").write_text(CAMPAIGN.replace("seed: 5", "seed: 6") + "sensor: {range_m: 80}\n")
    return ["campaign: seed: 5 there, 6 now", "campaign: sensor.range_m: 100.0 there, 80.0 now"]


def changed_versions(_folder, monkeypatch):
    there = identity.versions()
    monkeypatch.setattr(identity, "versions", lambda: there | {"numpy": "0.1"})
    return [f'version: numpy: "{there["numpy"]}" there, "0.1" now']


def changed_code(_folder, monkeypatch):
    there = identity.code_hash()
    monkeypatch.setattr(identity, "code_hash", lambda: "beef")
    return [f"code: {there} there, beef now"]


@pytest.mark.parametrize("change", [changed_plan, changed_versions, changed_code])
def test_another_run_is_refused_with_what_differs_and_nothing_is_touched(tmp_path, monkeypatch, change):
    fly(tmp_path)
    before = contents(tmp_path / "out")
    expected = change(tmp_path, monkeypatch)
    with pytest.raises(BadInputError) as refusal:
        fly(tmp_path)
    for line in [*expected, "--fresh", "--out"]:
        assert line in str(refusal.value)
    assert contents(tmp_path / "out") == before
    assert fly(tmp_path, fresh=True).flown_now == 8


def test_code_that_changes_during_a_run_is_told_and_the_run_not_continued(tmp_path, monkeypatch):
    now = identity.code_hash()

    def edit(done, _total, _crashed):
        if done == 4:
            monkeypatch.setattr(identity, "code_hash", lambda: "beef")

    summary = fly(tmp_path, progress=edit)
    assert summary.mixed_code
    assert summary.outcomes == {"reached": 8}
    assert runner.report(tmp_path / "out").mixed_code
    for code in (now, "beef"):
        monkeypatch.setattr(identity, "code_hash", lambda code=code: code)
        with pytest.raises(BadInputError, match=f"code: changed while flying there, {code} now"):
            fly(tmp_path)
    assert not fly(tmp_path, fresh=True).mixed_code


def test_fresh_removes_a_former_run_and_nothing_else(tmp_path):
    fly(tmp_path, overrides=("recordings=all",))
    (tmp_path / "out" / "my_notes.txt").write_text("mine")
    assert len(list((tmp_path / "out" / "recordings").iterdir())) == 8
    fly(tmp_path, fresh=True)
    assert list((tmp_path / "out" / "recordings").iterdir()) == []
    assert (tmp_path / "out" / "my_notes.txt").read_text() == "mine"


def test_fresh_can_start_from_the_copy_in_the_directory_itself(tmp_path):
    fly(tmp_path)
    assert fly(tmp_path, source=tmp_path / "out" / "campaign.yaml", fresh=True).flown_now == 8


@pytest.mark.parametrize("fresh", [False, True])
def test_a_folder_with_other_things_in_it_is_never_written_to(tmp_path, fresh):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "thesis.tex").write_text("years of work")
    with pytest.raises(BadInputError, match=r"not of a run \(thesis\.tex\)"):
        fly(tmp_path, fresh=fresh)
    assert contents(tmp_path / "out") == {"thesis.tex": b"years of work"}


@pytest.mark.parametrize("fresh", [False, True])
def test_two_runs_cannot_write_to_one_directory(tmp_path, fresh):
    before = contents(fly(tmp_path).directory)
    with (tmp_path / "out" / ".lock").open() as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        for forbidden in (lambda: fly(tmp_path, fresh=fresh), lambda: runner.report(tmp_path / "out")):
            with pytest.raises(BadInputError, match="another run is writing here"):
                forbidden()
    assert contents(tmp_path / "out") == before
    assert fly(tmp_path).flown_now == 0


def test_a_disk_that_cannot_lock_is_refused_in_words(tmp_path, monkeypatch):
    def missing(*_):
        raise OSError(errno.ENOSYS, "Function not implemented")

    monkeypatch.setattr(fcntl, "flock", missing)
    with pytest.raises(BadInputError, match="this disk cannot lock files"):
        fly(tmp_path)


def test_a_system_that_cannot_sync_a_folder_still_writes_its_files(tmp_path, monkeypatch):
    monkeypatch.delattr(os, "O_DIRECTORY")
    RunDirectory(tmp_path).put("a.txt", b"whole")
    assert contents(tmp_path)["a.txt"] == b"whole"


@pytest.mark.parametrize("name", ["manifest.json", "plan.json"])
@pytest.mark.parametrize("damage", [b"{", b"[]", b"\xff\xfe", b'{"identity": 3}'])
def test_damaged_files_are_named_and_stored(tmp_path, name, damage):
    fly(tmp_path)
    (tmp_path / "out" / name).write_bytes(damage)
    with pytest.raises(BadInputError, match=name.replace(".", r"\.")):
        runner.report(tmp_path / "out")
    assert (tmp_path / "out" / name).read_bytes() == damage


def test_damaged_rows_are_refused_with_their_line(tmp_path):
    fly(tmp_path)
    rows = tmp_path / "out" / "rows.jsonl"
    rows.write_bytes(b"garbage\n" + rows.read_bytes())
    for forbidden in (lambda: fly(tmp_path), lambda: runner.report(tmp_path / "out")):
        with pytest.raises(BadInputError, match=r"rows\.jsonl:1: not a row"):
            forbidden()


@pytest.mark.slow
def test_a_crash_and_a_bug_are_rows_and_the_others_fly_on(tmp_path):
    summary = fly(tmp_path, workers=2, job=fakes.fly_badly)
    assert summary.outcomes == {"reached": 4, "crashed": 4}
    assert summary.crashed == 4
    rows = [json.loads(line)["row"] for line in (tmp_path / "out" / "rows.jsonl").read_text().splitlines()]
    said = {row["message"] for row in rows if row["outcome"] == "crashed"}
    assert said == {"the worker process was killed by SIGKILL, twice", "ZeroDivisionError: a bug"}
    assert all("fly_badly" in row["traceback"] for row in rows if "ZeroDivision" in row["message"])


def test_what_crashed_is_flown_again_when_the_run_is_continued(tmp_path):
    whole = fly(tmp_path, out=tmp_path / "whole").directory
    fly(tmp_path, job=fakes.fly_wrongly)
    summary = fly(tmp_path)
    assert (summary.flown_now, summary.outcomes) == (4, {"reached": 8})
    for name in STABLE:
        assert (summary.directory / name).read_bytes() == (whole / name).read_bytes(), name
    assert fly(tmp_path).flown_now == 0


def test_a_full_disk_leaves_the_old_file_and_no_draft(tmp_path, monkeypatch):
    directory = fly(tmp_path).directory
    before = contents(directory)

    def full(_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        runner.report(directory)
    assert contents(directory) == before


def test_report_writes_the_same_bytes_from_the_rows_alone(tmp_path):
    directory = fly(tmp_path, job=fakes.fly_wrongly).directory
    before = contents(directory)
    for name in (*STABLE, "timings.csv"):
        (directory / name).unlink()
    summary = runner.report(directory)
    assert contents(directory) == before
    assert summary.crashed == 4
    assert len(flown(tmp_path)) == 4


def test_an_unfinished_run_can_be_reported(tmp_path):
    with pytest.raises(KeyboardInterrupt):
        fly(tmp_path, progress=stop_after(3))
    summary = runner.report(tmp_path / "out")
    assert (sum(summary.outcomes.values()), summary.planned) == (3, 8)
    provenance = json.loads((tmp_path / "out" / "index.html").read_text())[3]
    assert (provenance["flights_flown"], provenance["flights_planned"]) == (3, 8)


@pytest.mark.parametrize("directory", ["nowhere", "little.yaml", "."])
def test_what_is_no_run_directory_is_refused(tmp_path, directory):
    for forbidden in (lambda: runner.report(tmp_path / directory), lambda: replay(tmp_path / directory, "x")):
        with pytest.raises(BadInputError, match=r"no such directory|not a run directory"):
            forbidden()
    assert list(contents(tmp_path)) == ["little.yaml"]


def test_overrides_reach_the_flights_and_are_noted(tmp_path):
    directory = fly(tmp_path, overrides=("seed=9", "replicates=1")).directory
    assert [line.split(",")[3] for line in (directory / "results.csv").read_text().splitlines()[1:]] == ["9", "9"]
    assert (directory / "campaign.yaml").read_text() == f"# run with --set seed=9\n# run with --set replicates=1\n{CAMPAIGN}"


def test_a_bad_campaign_leaves_a_run_alone(tmp_path):
    before = contents(fly(tmp_path).directory)
    (tmp_path / "little.yaml").write_text(CAMPAIGN.replace("seed: 5", "sead: 5"))
    with pytest.raises(SpecError):
        fly(tmp_path, fresh=True)
    assert contents(tmp_path / "out") == before


def test_the_default_directory_is_named_after_the_campaign(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert fly(tmp_path, out=None).directory == Path("reports/runs/little")
    assert (tmp_path / "reports/runs/little/results.csv").exists()
