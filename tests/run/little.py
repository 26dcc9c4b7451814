"""A small campaign and how the tests of this folder fly it, in this process and without an aircraft."""

import pytest

from testbed.run import identity, runner
from testbed.run.engines import LocalEngine
from testbed.run.runner import Order
from tests.here import Here
from tests.run import fakes

CAMPAIGN = """\
name: little
question: Does the run directory keep what it is given?
seed: 5
replicates: 4
route: {start_enu_m: [0, 0, 0], goal_enu_m: [500, 200, 100], start_direction_deg: [40.87, 26.13], goal_direction_deg: [10.00, 2.84]}
recordings: none
plant: {kind: kinematic}
sweep:
  method.kind: [none, scoam]
"""
STABLE = ("results.csv", "results.parquet", "index.html")


@pytest.fixture(autouse=True)
def little_campaign(monkeypatch, tmp_path):
    monkeypatch.setattr("testbed.show.page.render_page", fakes.page)
    monkeypatch.setattr(identity, "code_hash", lambda: "c0de")
    monkeypatch.setenv("FLOWN", str(tmp_path / "flown"))
    (tmp_path / "little.yaml").write_text(CAMPAIGN)


def fly(folder, *, workers=None, job=fakes.fly, **settings):
    settings = {"source": folder / "little.yaml", "out": folder / "out"} | settings
    engine = LocalEngine(workers) if workers else Here()
    return runner.run(Order(engine=engine, command=("testbed", "run"), job=job, **settings))


def flown(folder):
    marks = folder / "flown"
    return marks.read_text().split() if marks.exists() else []


def contents(directory):
    return {path.relative_to(directory).as_posix(): path.read_bytes() for path in sorted(directory.rglob("*")) if path.is_file()}


def stop_after(count):
    """A progress function that presses Ctrl-C."""

    def show(done, _total, _crashed):
        if done == count:
            raise KeyboardInterrupt

    return show
