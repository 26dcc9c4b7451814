"""A campaign with a check is judged when it is run, and again when it is reported, from its rows alone."""

import csv
from pathlib import Path

import pytest

from testbed.run import runner
from testbed.run.engines import LocalEngine
from testbed.run.runner import Order, Summary
from tests.here import Here

CLEARANCE = Path(__file__).parents[2] / "campaigns" / "check" / "clearance.yaml"


def run(out: Path, *overrides: str, engine=None) -> Summary:
    return runner.run(Order(source=CLEARANCE, out=out, overrides=overrides, engine=engine or Here()))


def stable(directory: Path) -> dict[str, bytes]:
    return {name: (directory / name).read_bytes() for name in ("results.csv", "checks.csv", "index.html")}


def test_the_lines_are_in_the_summary_the_table_and_the_page(tmp_path):
    summary = run(tmp_path / "out")
    assert len(summary.checks) == 17
    assert all(line.passed for line in summary.checks)
    rows = list(csv.DictReader((tmp_path / "out" / "checks.csv").read_text().splitlines()))
    assert [row["quantity"] for row in rows] == [line.quantity for line in summary.checks]
    assert {row["verdict"] for row in rows} == {"passed"}
    assert float(rows[1]["truth"]) == summary.checks[1].truth
    page = (tmp_path / "out" / "index.html").read_text()
    assert "Check passed: 17 lines, each within its tolerance; the nearest to it uses " in page
    assert "checks.csv" in page


def test_a_report_judges_again_without_flying(tmp_path, monkeypatch):
    run(tmp_path / "out")
    before = stable(tmp_path / "out")
    (tmp_path / "out" / "checks.csv").unlink()
    monkeypatch.setattr("testbed.flight.fly.fly", None)
    assert all(line.passed for line in runner.report(tmp_path / "out").checks)
    assert stable(tmp_path / "out") == before


def test_a_broken_metric_is_a_missed_check_on_the_page(tmp_path, monkeypatch):
    from testbed.flight.traffic.track import least_clearance

    monkeypatch.setattr("testbed.results.quantities.least_clearance", lambda *told: least_clearance(*told)._replace(clearance_m=1.0))
    missed = [line for line in run(tmp_path / "out").checks if not line.passed]
    assert len(missed) == 6
    page = (tmp_path / "out" / "index.html").read_text()
    assert "Check missed: 6 of 17 lines out of tolerance." in page
    assert page.count('badge-bad">missed') == 6


def test_a_run_that_is_not_finished_is_a_miss(tmp_path):
    run(tmp_path / "out")
    rows = tmp_path / "out" / "rows.jsonl"
    rows.write_bytes(b"".join(rows.read_bytes().splitlines(keepends=True)[:-1]))
    assert [line.quantity for line in runner.report(tmp_path / "out").checks if not line.passed] == ["flights that can be judged"]


@pytest.mark.slow
def test_a_fresh_run_leaves_no_verdict_of_the_former_one(tmp_path):
    run(tmp_path / "out")
    runner.run(Order(source=CLEARANCE, out=tmp_path / "out", overrides=("check=null",), engine=Here(), fresh=True))
    assert not (tmp_path / "out" / "checks.csv").exists()


@pytest.mark.slow
def test_workers_do_not_show_in_the_verdict(tmp_path):
    run(tmp_path / "one")
    run(tmp_path / "two", engine=LocalEngine(2))
    assert stable(tmp_path / "one") == stable(tmp_path / "two")
