"""A study is a folder, or a file of the user's own: a third one, in twenty lines, does all that the two that come with the project do."""

import ast
import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from testbed.campaign import SpecError, expand, load_campaign
from testbed.cli import app
from testbed.core import registry
from testbed.run import runner, trial
from testbed.run.directory import BadInputError
from testbed.run.engines import LocalEngine
from testbed.run.replay import replay
from testbed.run.runner import Order
from testbed.studies.study import Study
from tests.here import Here

TESTBED = Path(__file__).parents[2] / "testbed"
STUDIES = ("scoam", "lead_time", "arena")

TALLY = """\
from markupsafe import Markup

from testbed.show.assets import PageHead
from testbed.studies.study import Run, Study, Written


class Tally(Study):
    labels = {"": {"method": ("none", "scoam")}}

    def __init__(self, least_m: float = 0.0):
        self.least_m = least_m

    def unfit(self, settings):
        return None if settings.get("obstacles") else "needs an obstacle"

    def pictures(self, plan):
        return plan.labels["method"] == "scoam" and plan.replicate == 1

    def write(self, run: Run) -> Written:
        kept = sum(row.get("least_clearance_m", 0.0) >= self.least_m for row in run.rows)
        head = PageHead(Markup(f'<h2 id="tally">{kept} of {len(run.rows)} keep the radius</h2>'), Markup(), Markup(), (("tally", "Tally"),))
        return Written({"tally.csv": f"kept,flights\\n{kept},{len(run.rows)}\\n".encode()}, head)
"""
CAMPAIGN = """\
name: tally
question: How often is the radius kept?
plugins: [./tally.py]
seed: 1
replicates: 2
route: {start_enu_m: [0, 0, 0], goal_enu_m: [500, 0, 0], start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}
obstacles: [{name: O, radius_m: 25, position_enu_m: [250, 5, 0], speed_mps: 40, direction_deg: [90, 0], when: {time_s: 5}}]
sensor: {range_m: 400}
replan: {swell_m: 8}
plant: {kind: kinematic}
rates: {plant_hz: 60}
study: {kind: "tally:Tally"}
sweep:
  method:
    none: {method.kind: none}
    scoam: {method.kind: scoam}
"""


@pytest.fixture(autouse=True)
def _read_in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """That parts of one's own are tried in a worker first is a test of its own (tests/run/test_trial.py)."""
    monkeypatch.setattr(trial, "_names_parts", lambda *_: False)


def tally(folder: Path, campaign: str = CAMPAIGN, plugin: str = TALLY) -> Path:
    (folder / "tally.py").write_text(plugin)
    (folder / "tally.yaml").write_text(campaign)
    return folder / "tally.yaml"


def test_a_third_study_is_flown_kept_and_written_like_the_others(tmp_path: Path) -> None:
    summary = runner.run(Order(tally(tmp_path), LocalEngine(1), tmp_path / "out"))
    out = summary.directory
    assert (summary.planned, summary.crashed) == (4, 0)
    assert (out / "tally.csv").read_text() == "kept,flights\n2,4\n"
    page = (out / "index.html").read_text()
    assert '<h2 id="tally">2 of 4 keep the radius</h2>' in page
    assert 'href="#tally"' in page
    rows = [json.loads(line) for line in (out / "rows.jsonl").read_text().splitlines()]
    recorded = {(line["row"]["method"], line["row"]["replicate"]) for line in rows if line["row"]["recording"]}
    assert recorded == {("scoam", 1)}  # the flight that it pictures, and `recordings: selected` means no other
    assert len(list((out / "recordings").iterdir())) == 1
    before = {file.name: file.read_bytes() for file in out.iterdir() if file.is_file()}
    runner.report(out)
    assert {file.name: file.read_bytes() for file in out.iterdir() if file.is_file()} == before
    (out / "mine.txt").write_text("not of the run")
    without = CAMPAIGN.replace('study: {kind: "tally:Tally"}\n', "")
    runner.run(Order(tally(tmp_path, without), Here(), out, fresh=True))
    assert not (out / "tally.csv").exists()
    assert (out / "mine.txt").exists()


def test_options_of_a_study_are_typed_and_told_with_their_place(tmp_path: Path) -> None:
    file = tally(tmp_path, CAMPAIGN.replace('"tally:Tally"', '"tally:Tally", options: {least_m: 3}'))
    runner.run(Order(file, Here(), tmp_path / "out"))
    assert (tmp_path / "out" / "tally.csv").read_text() == "kept,flights\n2,4\n"
    tally(tmp_path, CAMPAIGN.replace('"tally:Tally"', '"tally:Tally", options: {least_m: lots}'))
    with pytest.raises(SpecError, match=r"tally\.yaml:12:49: study\.options\.least_m: must be a number"):
        load_campaign(file)


def test_a_study_without_options_is_its_name(tmp_path: Path) -> None:
    file = tally(tmp_path, CAMPAIGN.replace('{kind: "tally:Tally"}', '"tally:Tally"'))
    assert load_campaign(file) == load_campaign(tally(tmp_path))
    file = tally(tmp_path, CAMPAIGN.replace('{kind: "tally:Tally"}', '"tally:Tally"'))
    assert load_campaign(file, ["study.options.least_m=3"]).study.model_dump() == {"kind": "tally:Tally", "options": {"least_m": 3.0}}
    assert load_campaign(file, ["study=none"]).study.kind == "none"
    with pytest.raises(SpecError, match=r"--set study=nope: study\.kind: no study 'nope'; there are: none, scoam, lead_time, arena"):
        load_campaign(file, ["study=nope"])
    file.write_text(CAMPAIGN.replace('{kind: "tally:Tally"}', "scaom"))
    with pytest.raises(SpecError, match=r"tally\.yaml:12:8: study\.kind: no study 'scaom'; there are: none, scoam, lead_time, arena"):
        load_campaign(file)


def test_the_example_of_the_docs_judges_and_judges_anew(tmp_path: Path) -> None:
    text = (TESTBED.parent / "docs/plugins/tally.py").read_text()
    campaign = CAMPAIGN.replace('"tally:Tally"', '"tally:Tally", options: {least_m: 1.5}')
    out = tmp_path / "out"
    for file, kept, flown_now in ((text, 2, 4), (text.replace(">= self.least_m", ">= -1e9"), 4, 0)):
        summary = runner.run(Order(tally(tmp_path, campaign, file), Here(), out))
        assert (summary.planned, summary.crashed, summary.flown_now) == (4, 0, flown_now)
        assert (out / "tally.csv").read_text() == f"kept,flights\n{kept},4\n"
        assert f'<h2 id="tally">{kept} of 4 flights stay 1.5 m clear</h2>' in (out / "index.html").read_text()
    tally(tmp_path, CAMPAIGN.replace("obstacles: [", "#"), text)
    with pytest.raises(SpecError, match="the study 'tally:Tally' needs an obstacle"):
        load_campaign(tmp_path / "tally.yaml")


def test_studies_are_listed_with_what_else_a_campaign_can_name() -> None:
    assert CliRunner().invoke(app, ["list", "studies"]).stdout.split()[:4] == ["none", *STUDIES]
    assert "studies:   none, scoam, lead_time, arena" in CliRunner().invoke(app, ["list"]).stdout


def test_flights_are_the_same_whoever_judges_them(tmp_path: Path) -> None:
    """Neither the study, nor its options, nor the text of its file is part of what a flight is."""

    def ids(campaign: str, plugin: str = TALLY) -> list[str]:
        return [plan.flight_id for plan in expand(load_campaign(tally(tmp_path, campaign, plugin)))]

    bare = ids(CAMPAIGN.replace('study: {kind: "tally:Tally"}\n', ""))
    assert ids(CAMPAIGN) == bare
    assert ids(CAMPAIGN.replace('"tally:Tally"', '"tally:Tally", options: {least_m: 3}')) == bare
    assert ids(CAMPAIGN, TALLY + "# another text\n") == bare
    flies = TALLY.replace("    labels =", "    flies = True\n    labels =")
    assert set(ids(CAMPAIGN, flies)).isdisjoint(bare)
    assert ids(CAMPAIGN, flies) != ids(CAMPAIGN, flies + "# another text\n")


NO = "the study 'tally:Tally' knows no"
WRONG_LABELS = [
    ("    scoam: {", "    scaom: {", f"tally.yaml:16:5: sweep.method: {NO} method 'scaom'", "did you mean 'scoam'?"),
    ("  method:\n", "  metod:\n", f"tally.yaml:14:3: sweep.metod: {NO} axis 'metod'", "did you mean 'method'?"),
    ("  method:\n", "  metod:\n", "tally.yaml:13:1: sweep: the sweep has no axis 'method', which the study 'tally:Tally' needs", ""),
    ("replan: {swell_m: 8}\n", "", "", ""),
]


@pytest.mark.parametrize(("good", "bad", "says", "hint"), WRONG_LABELS, ids=["label", "axis", "needed", "nothing"])
def test_a_campaign_is_held_against_the_labels_of_its_study(tmp_path: Path, good: str, bad: str, says: str, hint: str) -> None:
    file = tally(tmp_path, CAMPAIGN.replace(good, bad))
    done = CliRunner().invoke(app, ["validate", "--no-estimate", str(file)])
    assert done.exit_code == (2 if says else 0)
    assert says in done.stderr
    assert hint in done.stderr


def test_a_study_that_flies_gives_rows_and_a_page_of_its_own(tmp_path: Path) -> None:
    plugin = """\
from testbed.flight.fly import fly
from testbed.studies.study import Study, Written


class Twice(Study):
    flies = True

    def fly(self, plan):
        ends = [float(fly(plan.model_copy(update={"speed_mps": v})).columns["time_s"][-1]) for v in (40.0, 50.0)]
        return "done", {"flight_time_s": ends, "shortest_s": min(ends), "never_s": float("inf")}

    def write(self, run):
        lines = [f"{row['found']['shortest_s']:.3f} {row['found']['never_s']}" for row in run.rows if "found" in row]
        return Written({"twice.txt": "\\n".join(lines).encode()}, page="<!doctype html><title>Twice</title>")
"""
    file = tally(tmp_path, CAMPAIGN.replace("tally:Tally", "tally:Twice").replace("replicates: 2", "replicates: 1"), plugin)
    summary = runner.run(Order(file, Here(), tmp_path / "out"))
    out = summary.directory
    assert (summary.outcomes, summary.crashed) == ({"done": 2}, 0)
    lines = (out / "twice.txt").read_text().splitlines()
    assert [line.split()[1] for line in lines] == ["inf", "inf"]
    assert 9.0 < float(lines[0].split()[0]) < 11.0
    assert (out / "index.html").read_text() == "<!doctype html><title>Twice</title>"
    assert not (out / "results.csv").exists()
    with pytest.raises(BadInputError, match="what the study 'tally:Twice' flies, and cannot be replayed"):
        replay(out, json.loads((out / "rows.jsonl").read_text().splitlines()[0])["row"]["flight_id"])


FLIES = "    flies = True\n    fly = lambda self, plan: ('done', {'least_clearance_m': 1.0})\n"
FAULTY = [
    ("kept = sum(", "kept = missing(", r"'tally:Tally' fails to write: NameError: name 'missing' is not defined; the flights are kept"),
    ("return Written({", "return {}, ({", r"the study 'tally:Tally' writes tuple, and no testbed\.studies\.study\.Written"),
    ('"tally.csv"', '"../tally.csv"', r"cannot write files of these names: \.\./tally\.csv"),
    ('"tally.csv"', '"results.csv"', r"cannot write files of these names: results\.csv"),
    ("    labels =", f"{FLIES}    labels =", "has to write a page of its own"),
]


@pytest.mark.parametrize(("good", "bad", "says"), FAULTY, ids=["raises", "type", "outside", "ours", "page"])
def test_a_study_that_writes_wrongly_is_told_in_a_sentence_and_the_flights_are_kept(tmp_path: Path, good: str, bad: str, says: str) -> None:
    file = tally(tmp_path, plugin=TALLY.replace(good, bad))
    with pytest.raises(BadInputError, match=says):
        runner.run(Order(file, Here(), tmp_path / "out"))
    assert len((tmp_path / "out" / "rows.jsonl").read_text().splitlines()) == 4
    assert not (tmp_path / "tally.csv").exists()
    if "flies" in bad:
        return
    summary = runner.run(Order(tally(tmp_path), Here(), tmp_path / "out"))  # mended: the flights are as they were
    assert summary.flown_now == 0
    assert (tmp_path / "out" / "tally.csv").exists()
    runner.report(tmp_path / "out")


def test_what_is_no_study_is_refused_at_its_place(tmp_path: Path) -> None:
    file = tally(tmp_path, plugin="def Tally(least_m: float = 0.0): ...\n")
    with pytest.raises(SpecError, match=r"tally\.yaml:12:.*is no study: derive it from testbed\.studies\.study\.Study"):
        load_campaign(file)
    tally(tmp_path, CAMPAIGN.replace("obstacles: [", "x: [").replace("x: [", "#"))
    with pytest.raises(SpecError, match=r"tally\.yaml:12:1: study: the study 'tally:Tally' needs an obstacle"):
        load_campaign(file)


def test_commands_are_plugged_in_and_the_command_line_knows_none_by_name() -> None:
    assert "audit" in registry.names("command")
    told = CliRunner().invoke(app, ["--help"]).stdout
    assert "Put every number that the paper prints to the test" in told
    assert CliRunner().invoke(app, ["audit", "--help"]).exit_code == 0
    unknown = CliRunner().invoke(app, ["no-such-command"])
    assert (unknown.exit_code, "No such command" in unknown.stderr) == (2, True)


def test_no_file_outside_the_folder_of_studies_names_one() -> None:
    """Neither by an import, nor as a kind; a method has the name of one of them, and one key of old plans that of the other."""
    outside = [file for file in TESTBED.rglob("*.py") if file.relative_to(TESTBED).parts[0] != "studies"]
    assert len(outside) > 100
    named = []
    for file in outside:
        for node in ast.walk(ast.parse(file.read_text())):
            modules = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            modules += [alias.name for alias in node.names] if isinstance(node, ast.Import | ast.ImportFrom) else []
            text = node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""
            if any(f"studies.{study}" in name for study in STUDIES for name in [*modules, text]):
                named.append((file.name, node.lineno))
            if isinstance(node, ast.Constant) and text in ("lead_time", "verdict.csv", "lead_time.csv", "audit"):
                named.append((file.name, text))
    assert named == []
    for kind in STUDIES:
        assert issubclass(registry.part("study", kind), Study)
        for other in (TESTBED / "studies" / kind).rglob("*.py"):
            elsewhere = [study for study in STUDIES if study != kind]
            assert not any(f"studies.{study}" in other.read_text() for study in elsewhere), other
