"""A campaign that asks for detect and avoid, from its file to its tables and page; and the same one that does not ask."""

import csv
import re
import shutil
from pathlib import Path

import pandas as pd
import pyarrow.parquet as pq
import pytest

from testbed import open_run
from testbed.campaign import load_campaign
from testbed.results.daa.columns import daa_columns
from testbed.run import runner
from testbed.run.compared import compared
from testbed.run.replay import replay
from tests.here import Here

CAMPAIGN = """\
name: met
question: Does avoidance lower the risk?
seed: 3
replicates: 6
plant: {kind: kinematic}
route: {start_enu_m: [0, 0, 0], goal_enu_m: [700, 0, 0], start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}
sensor: {range_m: 200}
replan: {answer: direct, swell_m: 8}
encounters:
  own_at_enu_m: [150, 0, 0]
  own_direction_deg: [0, 0]
  trigger: {range_m: 200}
  obstacle_speed_mps: [20, 50]
  radius_m: [25, 30]
  longest_s: 8
recordings: none
sweep: {method.kind: [none, orca]}
"""
DAA = "daa: {standards: [nmac], volumes: {ball: {shape: sphere, radius_m: 24}}}\n"


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    made = {}
    for name, text in (("plain", CAMPAIGN), ("daa", CAMPAIGN + DAA)):
        folder = tmp_path_factory.mktemp(name)
        (folder / "met.yaml").write_text(text)
        made[name] = runner.run(runner.Order(source=folder / "met.yaml", engine=Here(), out=folder / "out", command=())).directory
    return made


def table(run: Path, name: str = "results.csv") -> list[dict[str, str]]:
    return list(csv.DictReader((run / name).read_text().splitlines()))


def test_the_columns_stand_beside_the_others_and_change_none(runs: dict[str, Path]) -> None:
    plain, daa = (table(runs[name]) for name in ("plain", "daa"))
    more = daa_columns(load_campaign(runs["daa"] / "campaign.yaml").daa)
    names = [column.name for column in more]
    assert [name for name in daa[0] if name not in plain[0]] == names
    assert list(daa[0])[-1] == "label.method.kind"
    assert [{key: row[key] for key in plain[0]} for row in daa] == plain  # the same ids, the same numbers
    schema = pq.read_schema(runs["daa"] / "results.parquet")
    assert {schema.field(column.name).metadata[b"definition"].decode() for column in more} == {column.definition for column in more}
    assert not (runs["plain"] / "risk.csv").exists()
    assert 'id="risk"' not in (runs["plain"] / "index.html").read_text()


def test_what_the_columns_say_is_what_the_others_say(runs: dict[str, Path]) -> None:
    """Of one sphere the slant miss is the clearance and the radius; a ball is entered where that is below its radius."""
    results = open_run(runs["daa"]).results
    assert (results["slant_miss_m"] - results["least_clearance_m"] - results["encounter_radius_m"]).abs().max() < 1e-9
    assert results["entered_ball"].dtype == pd.BooleanDtype()
    assert (results["entered_ball"] == (results["slant_miss_m"] < 24.0)).all()
    assert (results["severity_ball"] - (1.0 - results["slant_miss_m"] / 24.0).clip(lower=0.0)).abs().max() < 1e-9
    assert results["manoeuvre_needed"].all()  # that is the class of these encounters
    assert (results["missed_manoeuvre"] == (results["method"] == "none")).all()
    risk = {row["volume"]: row for row in table(runs["daa"], "risk.csv")}
    assert list(risk) == ["sphere", "nmac", "ball"]
    without = results[results["method"] == "none"].set_index("replicate")["entered_ball"]
    with_ = results[results["method"] == "orca"].set_index("replicate")["entered_ball"]
    counts = [int((a & b).sum()) for a, b in ((without, with_), (without, ~with_), (~without, with_))]
    assert [int(risk["ball"][name]) for name in ("unresolved", "resolved", "induced")] == counts
    assert counts[1] > 0


@pytest.mark.slow
def test_a_flight_is_replayed_with_its_columns(runs: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("testbed.run.replay.LocalEngine", lambda _workers: Here())
    first = table(runs["daa"])[-1]["flight_id"]
    assert replay(runs["daa"], first, tmp_path / "again.rrd").differences == []
    rows = runs["daa"] / "rows.jsonl"
    was = rows.read_text()
    try:
        rows.write_text(was.replace('"entered_nmac":true', '"entered_nmac":false'))
        assert any("entered_nmac" in line for line in replay(runs["daa"], first, tmp_path / "again.rrd").differences)
    finally:
        rows.write_text(was)


def test_two_runs_are_compared_by_these_columns_too(runs: dict[str, Path], tmp_path: Path) -> None:
    """The second has every slant miss 2 m larger; a run that did not ask has none to compare."""
    second = tmp_path / "second"
    shutil.copytree(runs["daa"], second)
    rows = second / "rows.jsonl"
    rows.write_text(re.sub(r'"slant_miss_m":([\d.]+)', lambda found: f'"slant_miss_m":{float(found[1]) + 2.0!r}', rows.read_text()))
    both = {one.column.name: one for one in compared(runs["daa"], second).compared.differences}
    assert both["slant_miss_m"].effect.value == pytest.approx(2.0, abs=1e-9)
    assert both["horizontal_miss_m"].effect.value == 0.0
    assert "slant_miss_m" not in {one.column.name for one in compared(runs["plain"], second).compared.differences}


def test_a_journal_of_anybodys_makes_no_report_fail(runs: dict[str, Path]) -> None:
    rows = runs["daa"] / "rows.jsonl"
    was = rows.read_text()
    try:
        rows.write_text(was.replace('"entered_nmac":true', '"entered_nmac":"<b>"').replace('"slant_miss_m":', '"slant_mist_m":'))
        runner.report(runs["daa"])
        assert {row["entered_nmac"] for row in table(runs["daa"])} <= {"", "false"}
        assert {row["slant_miss_m"] for row in table(runs["daa"])} == {""}
    finally:
        rows.write_text(was)
        runner.report(runs["daa"])


def test_the_page_shows_ratios_matrices_misses_and_limits(runs: dict[str, Path]) -> None:
    page = (runs["daa"] / "index.html").read_text()
    part = page.split('<section id="risk">', 1)[1].split("</section>", 1)[0]
    assert part.count('<table class="matrix">') == 3
    assert part.count("<circle") == 12 - sum(
        int(text.split(" beyond")[0].rpartition(">")[2]) for text in part.split("</text>") if " beyond" in text
    )
    assert part.count('class="volume"') == 2  # the ball in both panels; the NMAC is far larger than the misses
    assert "horizontal &lt; 152.4 m (500 ft), vertical &lt; 30.48 m (100 ft)" in part
    assert "intervals are wider than" in part or "intervals is wider than" in part
    assert page == (runner.report(runs["daa"]).directory / "index.html").read_text()
    assert "<code>entered_ball</code>" in page  # in the glossary
