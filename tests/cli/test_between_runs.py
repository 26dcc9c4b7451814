"""Commands about runs that are there, in this process: what they print, what they refuse, and what the shell is offered."""

import json
import os
import re
from pathlib import Path

import pytest
from typer.main import get_command
from typer.testing import CliRunner

from testbed.cli import app, between
from testbed.run import runner
from testbed.run.runner import Order
from tests.run.little import CAMPAIGN, Here

SHELL = CliRunner(env={"COLUMNS": "100", "TERM": "dumb"})
OBSTACLE = """
obstacles:
  - {name: O, radius_m: 25, position_enu_m: [254, 63.6, 60.7], speed_mps: 40, direction_deg: [106, 12.4],
     when: {own_reaches_enu_m: [162, 101, 64.3]}}
sensor: {kind: truth, range_m: 100}
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """``reports/runs`` with three runs: ``plain``, ``slower``, and ``cut``, which is plain with three of its eight flights done."""
    folder = tmp_path_factory.mktemp("runs")
    (folder / "little.yaml").write_text(CAMPAIGN.replace("recordings: none", "recordings: selected") + OBSTACLE)

    def fly(name, *overrides):
        out = folder / "reports/runs" / name
        return runner.run(Order(source=folder / "little.yaml", engine=Here(), out=out, overrides=overrides)).directory

    fly("plain", "replicates=2")
    fly("slower", "replicates=2", "speed_mps=40", "recordings=none")
    cut = fly("cut", "replicates=2", "recordings=none")
    lines = (cut / "rows.jsonl").read_bytes().splitlines(keepends=True)
    (cut / "rows.jsonl").write_bytes(b"".join(lines[:3]))
    (cut / "answer.json").unlink()
    return folder


@pytest.fixture
def call(place, monkeypatch):
    """The command, in that folder, without a screen."""
    monkeypatch.chdir(place)
    for variable in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER"):
        monkeypatch.delenv(variable, raising=False)
    return lambda *words: SHELL.invoke(app, [str(word) for word in words])


def test_a_folder_without_runs_says_so(call, tmp_path):
    done = call("runs", tmp_path)
    assert (done.exit_code, done.stdout) == (0, "")
    assert f"{tmp_path}: no run lies in it" in done.stderr


def test_runs_are_listed_with_question_and_answer(call, place):
    done = call("runs", "--page")
    assert done.exit_code == 0
    for name in ("plain", "slower", "cut"):
        assert re.search(rf"^reports/runs/{name}  \d{{4}}-\d\d-\d\d \d\d:\d\d UTC$", done.stdout, re.M)
    answer = json.loads((place / "reports/runs/plain/answer.json").read_text())["lines"]
    assert all(f"  {line}\n" in done.stdout for line in answer)
    assert len(answer) == 2
    assert done.stdout.splitlines()[-1] == "reports/runs/index.html"
    assert call("runs", "nowhere").exit_code == 2


def test_two_runs_are_compared_pair_by_pair(call, place):
    done = call("compare", "plain", "reports/runs/slower", "--out", place / "page.html")
    assert done.exit_code == 0, done.stderr
    rows = [
        {
            row["flight_id"]: row
            for row in (json.loads(line)["row"] for line in (place / f"reports/runs/{name}/rows.jsonl").read_text().splitlines())
        }
        for name in ("plain", "slower")
    ]
    sides = [{(row["cell"], row["replicate"]): row for row in side.values()} for side in rows]
    changes = sorted(sides[1][key]["flight_time_s"] - sides[0][key]["flight_time_s"] for key in sides[0])
    assert len(changes) == 4
    middle = 0.5 * (changes[1] + changes[2])
    line = re.search(r"^time +s +4 .*$", done.stdout, re.M)[0]
    assert f"+{middle:.2f}" in line.split()
    assert re.search(r"^speed_mps +50.0 +40.0$", done.stdout, re.M)
    kept = [sum(row["kept_clear"] for row in side.values() if row["method"] != "none") for side in sides]
    assert re.search(
        rf"^Of 2 pairs with avoidance, .* keeps? every radius .*; {kept[0]} do in plain, {kept[1]} in slower\.$", done.stdout, re.M
    )
    assert "Left out of this: 2 pairs without avoidance." in done.stdout
    page = (place / "page.html").read_text()
    assert f"+{middle:.2f}" in page
    assert "<script" not in page
    assert done.stdout.splitlines()[-1] == str(place / "page.html")


def test_a_run_that_is_not_finished_is_compared_and_says_so(call):
    done = call("compare", "cut", "plain")
    assert done.exit_code == 0, done.stderr
    assert "note: cut is not finished: 3 of 4 flights" in done.stdout
    assert "note: without a partner, and left out: 1 of plain" in done.stdout
    assert "the same in every pair: least clearance" in done.stdout


def test_other_encounters_and_other_seeds_are_told(call, place):
    plan = (place / "reports/runs/slower/plan.json").read_text()
    assert "note: in" not in call("compare", "plain", "slower").stdout
    try:
        (place / "reports/runs/slower/plan.json").write_text(plan.replace('"radius_m":25.0', '"radius_m":26.0'))
        assert "note: in 4 of 4 pairs the two fly another route or meet other obstacles" in call("compare", "plain", "slower").stdout
    finally:
        (place / "reports/runs/slower/plan.json").write_text(plan)


@pytest.mark.parametrize(
    ("name", "header", "rows"), [("verdict.csv", "key,text,word,condition", ("a,first,holds,", "b,second,holds only if,x"))]
)
def test_words_that_changed_are_told(call, place, name, header, rows):
    files = [place / "reports/runs" / run / name for run in ("plain", "slower")]
    try:
        files[0].write_text("\n".join([header, *rows, ""]))
        files[1].write_text("\n".join([header, rows[0].replace("holds", "fails when flown"), rows[1], ""]))
        done = call("compare", "plain", "slower")
    finally:
        for file in files:
            file.unlink()
    assert "1 of 2 words of verdict.csv changed." in done.stdout
    assert re.search(r"^a +holds +fails when flown$", done.stdout, re.M)


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("plain", "plain"), "is the same run as"),
        (("plain", "nowhere"), "nowhere: no such directory"),
        (("plain", "little.yaml"), "no such directory"),
        (("plain", "slower", "--on", "wind"), "'wind' is no axis of both runs; there are: method.kind"),
    ],
)
def test_what_cannot_be_compared_is_refused(call, words, reason):
    done = call("compare", *words)
    assert done.exit_code == 2
    assert reason in done.stderr
    assert done.stdout == ""


def test_a_page_is_opened_or_its_address_is_told(call, place, monkeypatch):
    page = (place / "reports/runs/plain/index.html").resolve().as_uri()
    told = call("open", "plain")
    assert (told.exit_code, told.stdout) == (0, f"{page}\n")
    assert "no screen" in told.stderr
    opened = []
    monkeypatch.setenv("DISPLAY", ":9")
    monkeypatch.setattr(between.webbrowser, "open", lambda address: opened.append(address) or True)
    assert call("open", "reports/runs/plain").stderr == ""
    assert opened == [page]


def test_a_recording_is_opened_or_its_command_is_told(call, place, monkeypatch):
    recording = sorted((place / "reports/runs/plain/recordings").glob("*.rrd"))[0]
    told = call("open", "plain", recording.stem[:7])
    assert told.exit_code == 0, told.stderr
    assert told.stdout.endswith(f"rerun --bind 127.0.0.1 reports/runs/plain/recordings/{recording.name}\n")
    started = []
    monkeypatch.setenv("DISPLAY", ":9")
    monkeypatch.setattr(between.subprocess, "Popen", lambda command, **_: started.append(command))
    call("open", "plain", recording.stem)
    assert started[0][-1] == f"reports/runs/plain/recordings/{recording.name}"
    without = call("open", "slower", "0123")
    assert (without.exit_code, without.stdout) == (2, "")
    assert "no flight '0123'; there are" in without.stderr
    flight = json.loads((place / "reports/runs/slower/plan.json").read_text())["flights"][0]["flight_id"]
    assert f"testbed replay reports/runs/slower {flight}" in call("open", "slower", flight).stderr


def every_command(group, *before):
    for name in group.list_commands(None):
        command = group.get_command(None, name)
        yield (*before, name), command
        if hasattr(command, "list_commands"):
            yield from every_command(command, *before, name)


COMMANDS = [name for name, _ in every_command(get_command(app))]


def test_every_help_has_examples_and_no_word_of_the_library(call):
    assert {("run",), ("aircraft", "new"), ("audit",), ("compare",), ("open",), ("runs",)} <= set(COMMANDS)
    for command in [(), *COMMANDS]:
        shown = call(*command, "--help").stdout
        assert re.search(rf"Examples?:?\s+testbed {'.*'.join(command[:1])}", shown), command
        assert not re.search(r"<\w+>|int range|list\[|bool|\{\w+\}", shown), command


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        ("run x.yaml --workers 0", "'--workers': must be at least 1, not 0"),
        ("run x.yaml --workers two", "'--workers': must be a whole number, not the text 'two'"),
        ("aircraft new x --speed fast", "'--speed': must be a number, not the text 'fast'"),
        ("list engines", "'WHAT': 'engines' is not one of 'aircraft'"),
        ("run x.yaml --engine foo", "'--engine': 'foo' is not one of 'local', 'dask'."),
        ("run", "Missing argument 'FILE'."),
    ],
)
def test_a_complaint_is_in_plain_words(call, words, complaint):
    done = call(*words.split())
    assert done.exit_code == 2
    assert complaint in " ".join(done.stderr.replace("│", " ").split())


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("open ", ["reports/runs/cut", "reports/runs/plain", "reports/runs/slower"]),
        ("open pl", ["plain"]),
        ("compare plain reports/runs/s", ["reports/runs/slower"]),
        ("tune gt", ["gtm_t2"]),
        ("aircraft gt", ["gtm_t2"]),
        ("check method sco", ["scoam"]),
        ("check planner sco", []),
        ("open nowhere ", []),
        ("run --engine d", ["dask"]),
    ],
)
def test_the_shell_is_offered_what_there_is(place, monkeypatch, typed, offered):
    monkeypatch.chdir(place)
    words = f"testbed {typed}"
    done = SHELL.invoke(
        app,
        [],
        prog_name="testbed",
        env={"_TESTBED_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": str(len(words.split(" ")) - 1)},
    )
    assert done.stdout.split() == offered


def test_a_damaged_plan_is_told_in_plain_words(call, place):
    plan = place / "reports/runs/cut/plan.json"
    before = plan.read_text()
    try:
        plan.write_text(before.replace('"speed_mps":50.0', '"speed_mps":-50.0', 1))
        done = call("report", "cut")
    finally:
        plan.write_text(before)
    assert done.exit_code == 2
    assert done.stderr.endswith("not a plan of this version of testbed (speed_mps: must be more than 0 m/s, not -50.0 m/s)\n")


def test_the_flights_that_are_offered_are_those_with_a_recording(place, monkeypatch):
    monkeypatch.chdir(place)
    done = SHELL.invoke(
        app, [], prog_name="testbed", env={"_TESTBED_COMPLETE": "complete_bash", "COMP_WORDS": "testbed open plain ", "COMP_CWORD": "3"}
    )
    assert done.stdout.split() == sorted(file.stem for file in Path("reports/runs/plain/recordings").glob("*.rrd"))
    assert len(done.stdout.split()) == 2
    assert os.getcwd() == str(place)


@pytest.mark.browser
def test_its_pages_are_drawn_without_a_fault_at_any_width(call, place, browser):
    call("compare", "plain", "slower", "--out", place / "page.html")
    call("runs", "--page")
    for file in (place / "page.html", place / "reports/runs/index.html"):
        for wide, scheme in ((1400, "light"), (1000, "dark"), (400, "dark")):
            page = browser.new_page(viewport={"width": wide, "height": 900}, color_scheme=scheme)
            faults, asked = [], []
            page.on("console", lambda message, faults=faults: faults.append(message.text))
            page.on("request", lambda request, asked=asked: asked.append(request.url))
            page.goto(file.as_uri())
            assert (faults, asked) == ([], [file.as_uri()])
            assert page.evaluate("document.documentElement.scrollWidth") <= wide, (file.name, wide)
            page.close()
