"""A run directory that somebody has changed is read as data: what is wrong is a sentence, and nothing outside of it is touched."""

import json
import os
import shutil

import pytest

from testbed import open_run
from testbed.run import journal, manifest, runner
from testbed.run.directory import BadInputError, RunDirectory
from testbed.run.foreign import is_id, is_plain, loads
from testbed.run.stored import existing, plan_of
from tests.run.little import contents, fly, little_campaign

__all__ = ["little_campaign"]


@pytest.fixture
def run(tmp_path):
    fly(tmp_path, overrides=("recordings=all", "columns=all"))
    return tmp_path / "out"


def changed(file, *keys, to):
    data = json.loads(file.read_text())
    inner = data
    for key in keys[:-1]:
        inner = inner[key]
    inner[keys[-1]] = to
    file.write_text(json.dumps(data))


@pytest.mark.parametrize("name", ["rows.jsonl", "results.csv", "manifest.json", "plan.json", ".lock", "recordings", "columns"])
def test_a_link_in_it_is_not_followed_by_anything(run, tmp_path, name):
    outside = tmp_path / "outside"
    shutil.move(run / name, outside) if (run / name).exists() else outside.write_text("mine")
    (run / name).symlink_to(outside)
    before = contents(tmp_path / "outside") if outside.is_dir() else outside.read_bytes()
    for act in (lambda: runner.report(run), lambda: fly(tmp_path), lambda: fly(tmp_path, fresh=True)):
        with pytest.raises(BadInputError, match=f"{name}.*: a link"):
            act()
    assert (contents(outside) if outside.is_dir() else outside.read_bytes()) == before


@pytest.mark.parametrize("name", ["recordings/a.rrd", "columns/b.parquet", "plugins/c.py"])
def test_neither_is_one_in_its_folders(run, tmp_path, name):
    (tmp_path / "mine").write_text("mine")
    (run / name).parent.mkdir(exist_ok=True)
    (run / name).symlink_to(tmp_path / "mine")
    with pytest.raises(BadInputError, match="a link"):
        existing(run)


def test_a_pipe_or_a_folder_in_the_place_of_a_file_is_refused_and_not_waited_for(run):
    (run / "rows.jsonl").unlink()
    os.mkfifo(run / "rows.jsonl")
    with pytest.raises(BadInputError, match="a pipe, socket or device"):
        runner.report(run)
    (run / "rows.jsonl").unlink()
    (run / "rows.jsonl").mkdir()
    with pytest.raises(BadInputError, match="a folder, where a run has a file"):
        runner.report(run)


def test_a_draft_that_is_a_link_is_replaced_and_not_written_through(run, tmp_path):
    (tmp_path / "mine").write_text("mine")
    (run / ".index.html.new").symlink_to(tmp_path / "mine")
    runner.report(run)
    assert (tmp_path / "mine").read_text() == "mine"


@pytest.mark.parametrize("bad", ["../../evil", "/elsewhere/evil", "..", "", "a/b", "a\0b", ".hidden", "x" * 400, "a\udcffb", 7, None])
def test_a_flight_s_id_names_a_file_and_nothing_else(run, bad):
    assert not is_id(bad)
    assert not is_plain(bad) or bad == "x" * 400
    changed(run / "plan.json", "flights", 0, "flight_id", to=bad)
    with pytest.raises(BadInputError, match=r"plan\.json: damaged, or not a plan"):
        plan_of(existing(run))


@pytest.mark.parametrize("names", [["../../mine"], ["/etc/passwd"], [".."], [7], "mine", [None], ["a\0b"]])
def test_files_of_a_study_that_are_elsewhere_are_not_removed(run, tmp_path, names):
    (tmp_path.parent / "mine").write_text("mine")
    changed(run / "manifest.json", "study_files", to=names)
    RunDirectory(run).clear()
    assert (tmp_path.parent / "mine").read_text() == "mine"


@pytest.mark.parametrize(
    ("keys", "to"),
    [
        (("history",), "x"),
        (("history",), [1]),
        (("identity",), []),
        (("identity", "plugins"), {"../../evil": "00"}),
        (("identity", "plugins"), ["a"]),
        (("identity", "versions"), 3),
        (("aircraft_path",), "/"),
        (("aircraft_path",), [3]),
        (("study_files",), None),
        (("aircraft",), {"gtm_t2": 3}),
        (("overrides",), 5),
    ],
)
def test_a_manifest_of_other_types_is_damaged(run, keys, to):
    changed(run / "manifest.json", *keys, to=to)
    with pytest.raises(BadInputError, match=r"manifest\.json: damaged"):
        runner.report(run)


@pytest.mark.parametrize(
    "text", [b"", b"[]", b"[" * 100_000, b"\xff\xfe", b"nul", b"{", b"3", b'{"campaign": 3, "flights": 4}', b"9" * 5000]
)
@pytest.mark.parametrize("name", ["manifest.json", "plan.json"])
def test_json_that_is_none_is_told(run, name, text):
    (run / name).write_bytes(text)
    with pytest.raises(BadInputError, match=name):
        runner.report(run)


@pytest.mark.parametrize(
    ("keys", "to"),
    [
        (("row", "flight_id"), "../../x"),
        (("row", "outcome"), "excellent"),
        (("row", "outcome"), 3),
        (("row", "labels"), {"a": 3}),
        (("row", "labels"), []),
        (("row", "events"), {}),
        (("row", "events"), [3]),
        (("row", "least_clearance_m"), "near"),
        (("row", "least_clearance_m"), [1]),
        (("row", "replans"), 1.5),
        (("row", "kept_clear"), "yes"),
        (("row", "message"), None),
        (("row", "recording"), "../../../etc/passwd"),
        (("row", "recording"), "javascript:alert(1)"),
        (("row",), 3),
        (("series",), [3]),
        (("series",), {"time_s": "x"}),
        (("series",), {"close_up": {"hz": 120, "first": -3}}),
        (("timings",), {"fly": "long"}),
        (("row", "deflection_deg"), 10**400),
    ],
)
def test_a_row_that_is_none_is_told_with_its_line(run, keys, to):
    rows = (run / "rows.jsonl").read_text().splitlines(keepends=True)
    first = json.loads(rows[0])
    inner = first
    for key in keys[:-1]:
        inner = inner[key]
    inner[keys[-1]] = to
    (run / "rows.jsonl").write_text("".join([json.dumps(first) + "\n", *rows[1:]]))
    with pytest.raises(BadInputError, match=r"rows\.jsonl:1: not a row of a run"):
        runner.report(run)


def test_half_a_character_in_a_row_costs_no_page(run):
    rows = (run / "rows.jsonl").read_text().splitlines(keepends=True)
    first = json.loads(rows[0])
    first["row"]["message"] = "half \udce9 of it"
    (run / "rows.jsonl").write_text("".join([json.dumps(first) + "\n", *rows[1:]]))
    assert r"half \udce9 of it" in [result.row["message"] for result in journal.read(run / "rows.jsonl")]
    runner.report(run)


def test_escaped_pairs_stay_whole() -> None:
    assert loads(rb'["\ud83d\ude00", "\udc80", {"\ud800": 1}]') == ["\N{GRINNING FACE}", r"\udc80", {r"\ud800": 1}]


@pytest.mark.parametrize("content", [b"", b"PAR1", b"not a table", b"PAR1" + b"\0" * 60 + b"PAR1"])
def test_a_table_that_is_something_else_is_told(run, content):
    (run / "results.parquet").write_bytes(content)
    with pytest.raises(BadInputError, match="cannot be read as a table"):
        _ = open_run(run).results
    with pytest.raises(BadInputError, match="cannot be read as a table"):  # the fake flights of these tests leave text for columns
        open_run(run).series()


def test_a_recording_that_is_something_else_is_replaced_by_a_new_run(run, tmp_path):
    (run / "recordings" / "mine.rrd").write_text("text")
    fly(tmp_path, fresh=True)
    assert not (run / "recordings" / "mine.rrd").exists()


def test_a_run_that_nobody_touched_is_read(run):
    assert len(list(journal.read(run / "rows.jsonl"))) == 8
    assert manifest.load(existing(run))["flights"] == 8
