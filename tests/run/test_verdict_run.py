"""A campaign that judges the paper, from the YAML to verdict.csv and the page, in small: some cells of the shipped one."""

import csv
import subprocess
import sys
from pathlib import Path

import pytest

from testbed.campaign import load_campaign
from testbed.run import runner
from testbed.run.engines import LocalEngine
from testbed.run.runner import Order
from tests.here import Here

ROOT = Path(__file__).parents[2]
SHIPPED = ROOT / "campaigns" / "paper.yaml"
SMALL = (
    "parts.calm.sweep.flown_by={gtm_t2: {aircraft: gtm_t2}}",
    "parts.calm.sweep.rung={vo_instant: {plant.kind: kinematic, replan.answer: direct}, kinematic: {plant.kind: kinematic},"
    " jsbsim: {plant.kind: jsbsim}}",
    "parts.calm.skip=[{method: none, rung: vo_instant}, {method: [droam_hp_left, droam_hp_right, droam_vp_up, droam_vp_down]},"
    " {encounter: [single_106_10, multi_as_printed]}]",
)


def small(folder: Path) -> Path:
    """The shipped campaign without the parts that take long."""
    text = SHIPPED.read_text()
    wind = text.index("  # Both wind designs")
    (folder / "paper.yaml").write_text(text[:wind])
    return folder / "paper.yaml"


@pytest.mark.slow
def test_verdict_and_page_are_the_same_bytes_with_one_and_two_workers_and_verify_agrees(tmp_path: Path) -> None:
    file = small(tmp_path)
    for folder, engine in (("1", Here()), ("2", LocalEngine(2))):
        summary = runner.run(Order(file, engine, tmp_path / folder, overrides=SMALL))
        assert (summary.planned, summary.crashed) == (24, 0)
    for name in ("verdict.csv", "index.html", "results.csv"):
        assert (tmp_path / "1" / name).read_bytes() == (tmp_path / "2" / name).read_bytes(), name
    with (tmp_path / "1" / "verdict.csv").open(newline="") as table:
        words = {row["key"]: row["word"] for row in csv.DictReader(table)}
    assert words["words.single.safe"] == "fails when flown"
    assert words["words.multi.safe"] == "fails kinematically"
    assert words["words.superior"] == "not determined"  # no population
    stored = sorted(path.stem for path in (tmp_path / "1" / "recordings").glob("*.rrd"))
    assert len(stored) == 3  # the flights of the pictures
    page = (tmp_path / "1" / "index.html").read_text()
    assert page.index('id="verdict"') < page.index("<details")
    done = subprocess.run(
        [sys.executable, str(ROOT / "reports" / "verify"), str(tmp_path / "2")], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "everything agrees" in done.stdout


def test_the_shipped_campaign_flies_what_the_verdict_asks_for() -> None:
    """Every label that docs/verdict.md names for a part is there, and nothing else; both wind designs, three speeds, eight directions."""
    campaign = load_campaign(SHIPPED)
    assert campaign.study.kind == "scoam"
    wind = campaign.parts["wind"].sweep
    assert [len(wind[axis]) for axis in ("design", "wind_mps", "wind_from")] == [2, 3, 8]
    assert set(campaign.parts["calm"].sweep["encounter"]) == {
        *("single_as_printed", "single_106", "single_106_10", "multi_as_printed", "multi_o2_up")
    }
    assert campaign.parts["turbulence"].replicates == 20
    assert set(campaign.parts["controls"].sweep["encounter"]) == {"gentle", "gentle_no_margin", "impossible"}
