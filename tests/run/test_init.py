"""A study begins with files that hold what they promise, and nothing of the user's is written over."""

import shutil
from pathlib import Path

import pytest

from testbed.campaign import expand, load_campaign, schema
from testbed.core.catalogue import CAMPAIGN_ROOT
from testbed.flight.fly import fly
from testbed.results.metrics import measure
from testbed.run.directory import BadInputError
from testbed.run.init import KIT, begin_study


def test_a_study_is_the_kit_and_the_schema(tmp_path: Path) -> None:
    study = tmp_path / "deep" / "study"
    written = begin_study(study)
    assert sorted(study.rglob("*")) == written
    assert {"README.md", "first.yaml", "campaign.schema.json"} <= {file.name for file in written}
    assert (study / "campaign.schema.json").read_text() == schema()
    assert (study / "first.yaml").read_text().startswith("# yaml-language-server: $schema=campaign.schema.json\n")


def test_its_first_campaign_shows_what_its_comments_say() -> None:
    plans = {plan.cell: plan for plan in expand(load_campaign(KIT / "first.yaml"))}
    assert len(plans) == 6
    clearance = {cell: measure(fly(plan)).least_clearance_m for cell, plan in plans.items()}
    assert clearance["kinematic/none"] == pytest.approx(-25.0, abs=1e-6), "left alone, they meet"
    assert clearance["kinematic/scoam"] > 0 > clearance["jsbsim/scoam"], "too sharp for an aeroplane"
    assert clearance["jsbsim/scoam_with_margin"] > 0


def test_its_readme_names_the_run_directory_of_its_first_campaign() -> None:
    text = (KIT / "README.md").read_text()
    assert "testbed run first.yaml" in text
    assert f"reports/runs/{load_campaign(KIT / 'first.yaml').name}/index.html" in text


def test_examples_are_the_project_s_campaigns_with_their_schema(tmp_path: Path) -> None:
    begin_study(tmp_path / "study", examples=True)
    copied = tmp_path / "study" / "examples"
    names = sorted(file.relative_to(CAMPAIGN_ROOT) for file in CAMPAIGN_ROOT.rglob("*") if file.is_file())
    assert sorted(file.relative_to(copied) for file in copied.rglob("*") if file.is_file()) == names
    assert load_campaign(copied / "check" / "steady_turn.yaml") == load_campaign(CAMPAIGN_ROOT / "check" / "steady_turn.yaml")


def test_nothing_is_written_over(tmp_path: Path) -> None:
    (tmp_path / "first.yaml").write_text("mine")
    (tmp_path / "notes.txt").write_text("mine too")
    with pytest.raises(BadInputError, match=r"has first\.yaml already, and nothing is written over"):
        begin_study(tmp_path)
    assert {file.name: file.read_text() for file in tmp_path.iterdir()} == {"first.yaml": "mine", "notes.txt": "mine too"}
    (tmp_path / "first.yaml").unlink()
    assert len(begin_study(tmp_path)) > 2, "a folder with other things in it will do"
    with pytest.raises(BadInputError, match="not a directory"):
        begin_study(tmp_path / "notes.txt")


def test_what_python_and_editors_leave_behind_is_not_handed_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kit = Path(shutil.copytree(KIT, tmp_path / "kit"))
    (kit / "__pycache__").mkdir()
    (kit / "__pycache__" / "x.pyc").touch()
    (kit / ".first.yaml.swp").touch()
    monkeypatch.setattr("testbed.run.init.KIT", kit)
    assert {file.name for file in begin_study(tmp_path / "study")} == {file.name for file in begin_study(tmp_path / "again")}
    assert not {".first.yaml.swp", "__pycache__"} & {file.name for file in (tmp_path / "study").rglob("*")}
