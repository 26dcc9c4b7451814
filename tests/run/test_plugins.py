"""Parts in a file of the user's own: flown in every process, part of what a run is, and there again for report and replay."""

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from testbed.core import plugins
from testbed.run import manifest, runner, trial
from testbed.run.dask_engine import DaskEngine
from testbed.run.directory import BadInputError, RunDirectory
from testbed.run.engines import LocalEngine
from testbed.run.manifest import provenance
from testbed.run.replay import replay
from testbed.run.runner import Order
from testbed.run.stored import plan_of
from tests.command import testbed
from tests.here import Here
from tests.run.test_dask_engine import cluster, needs_dask

__all__ = ["cluster"]

TANGENT = '''\
"""Turns by a quarter, to one side."""

from typing import Literal

from vosc.methods import Choice


def avoid(own, obstacles, side: Literal["left", "right"] = "left", share: float = 1.0):
    if not share > 0.0:
        raise ValueError(f"share: give a number above 0, got {share:g}")
    x, y, z = own.vel_mps
    sign = share if side == "left" else -share
    return Choice((x - sign * y, y + sign * x, z), "avoided")
'''
CAMPAIGN = """\
name: tangent
question: Does a stranger's planner fly?
plugins: [./tangent.py]
replicates: 2
route: {start_enu_m: [0, 0, 0], goal_enu_m: [500, 200, 100], start_direction_deg: [40.87, 26.13], goal_direction_deg: [10.00, 2.84]}
begin: {at_route_s_m: 122}
obstacles:
  - name: O
    radius_m: 25
    position_enu_m: [254, 63.6, 60.7]
    speed_mps: 40
    direction_deg: [106, 12]
    when: {own_reaches_enu_m: [162, 101, 64]}
plant: {kind: kinematic}
method: {kind: "tangent:avoid"}
recordings: none
sweep:
  method.options.side: [left, right]
"""


@pytest.fixture(autouse=True)
def _read_in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """That parts of one's own are tried in a worker first is a test of its own (test_trial.py)."""
    monkeypatch.setattr(trial, "_names_parts", lambda *_: False)


@pytest.fixture
def study(tmp_path: Path) -> Path:
    (tmp_path / "tangent.py").write_text(TANGENT)
    (tmp_path / "study.yaml").write_text(CAMPAIGN)
    return tmp_path


def fly(study: Path, engine: object = None, **settings: object) -> runner.Summary:
    order = {"source": study / "study.yaml", "out": study / "out", "engine": engine or Here()} | settings
    return runner.run(Order(**order))  # type: ignore[arg-type]


def rows(study: Path) -> dict[str, dict]:
    return {row["flight_id"]: row for row in (json.loads(line)["row"] for line in (study / "out" / "rows.jsonl").read_text().splitlines())}


@pytest.mark.slow
def test_it_flies_in_spawned_workers_and_is_known_to_report_and_replay(study: Path) -> None:
    summary = fly(study, LocalEngine(1))
    assert summary.flown_now == summary.planned == 4
    assert summary.crashed == 0
    flown = rows(study)
    assert {event["decision"] for row in flown.values() for event in row["events"]} == {"replanned"}
    assert {row["method"] for row in flown.values()} == {"tangent:avoid"}
    (study / "tangent.py").unlink()  # the run has its own
    assert runner.report(study / "out").outcomes == summary.outcomes
    again = replay(study / "out", next(iter(flown)))
    assert again.differences == []
    assert again.same_code
    done = fly(study, source=study / "out" / "campaign.yaml")
    assert done.flown_now == 0


@pytest.mark.slow
def test_changed_by_one_line_it_is_another_planner(study: Path) -> None:
    fly(study)
    before = rows(study)
    (study / "tangent.py").write_text(TANGENT.replace("x - sign * y", "x - 1.5 * sign * y"))
    with pytest.raises(BadInputError, match=r"plug-in tangent: \w{12} there, \w{12} now") as told:
        fly(study)
    assert "--fresh" in str(told.value)
    assert rows(study) == before, "nothing is lost"
    assert fly(study, fresh=True).flown_now == 4
    after = rows(study)
    assert not set(before) & set(after), "other flights, by name too"
    lost = {row["least_clearance_m"] for row in before.values()} & {row["least_clearance_m"] for row in after.values()}
    assert not lost


@needs_dask
@pytest.mark.slow
def test_it_flies_on_a_cluster_of_separate_processes(study: Path, cluster: tuple[str, list]) -> None:
    fly(study)
    local = (study / "out" / "results.csv").read_bytes()
    address, _ = cluster
    there = fly(study, DaskEngine(2, address), out=study / "dask")
    assert there.flown_now == 4
    assert there.crashed == 0
    assert (study / "dask" / "results.csv").read_bytes() == local


def test_the_page_says_which_text_of_a_plug_in_was_flown_and_which_package(study: Path) -> None:
    summary = fly(study)
    digits = hashlib.sha256(TANGENT.encode()).hexdigest()[:12]
    assert f"<dt>plug-in tangent</dt><dd>SHA-256 {digits}</dd>" in (summary.directory / "index.html").read_text()
    directory = RunDirectory(summary.directory)
    told_of = manifest.load(directory)
    told_of["identity"]["packages"] = {"their-parts": "1.2"}
    told = provenance(told_of, len(plan_of(directory)[1]), 4)
    assert (told["plug-in"], told["package with parts"]) == ({"tangent": f"SHA-256 {digits}"}, {"their-parts": "1.2"})


def test_a_run_whose_plug_in_was_tampered_with_is_refused(study: Path) -> None:
    fly(study)
    stored = study / "out" / "plugins" / "tangent.py"
    stored.write_text(TANGENT + "# more\n")
    with pytest.raises(BadInputError, match="changed since the run"):
        runner.report(study / "out")
    stored.unlink()
    with pytest.raises(BadInputError, match="the plug-in of this run is gone"):
        runner.report(study / "out")


@pytest.mark.parametrize(
    ("file", "text", "said"),
    [
        ("tangent.py", "def avoid(own, obstacles:\n", "tangent.py:1: SyntaxError"),
        ("tangent.py", "import no_such_package\n", "tangent.py:1: ModuleNotFoundError"),
        ("tangent.py", "\n1 / 0\n", "tangent.py:2: ZeroDivisionError"),
        ("tangent.py", "raise SystemExit(3)\n", "tangent.py:1: SystemExit"),
        ("tangent.py", "def other(own, obstacles): ...\n", "tangent.py has no 'avoid'; it has: other"),
        ("tangent.py", "avoid = 3\n", "cannot be used"),
        ("tangent.py", 'def avoid(own, obstacles, side: str = "left"):\n    return own.speed\n', "fails when it is tried: AttributeError"),
        ("tangent.py", "def avoid(own): ...\n", "takes 1 parameters, and is given 2"),
        ("tangent.py", "\udcff", "is not text in UTF-8"),
        ("elsewhere.py", "", "no such file"),
    ],
)
def test_what_is_wrong_with_it_is_told_at_its_line(study: Path, file: str, text: str, said: str) -> None:
    (study / "tangent.py").unlink()
    (study / file).write_bytes(text.encode("utf-8", "surrogateescape"))
    done = testbed("validate", study / "study.yaml", cwd=study)
    assert done.returncode == 2, done.stderr
    assert said in done.stderr
    assert "study.yaml:" in done.stderr


def test_two_texts_of_one_name_are_held_apart(tmp_path: Path) -> None:
    """A plan is pinned to the text it was made with, whatever was loaded after it."""
    hashes = []
    for number in (1, 2):
        file = tmp_path / "part.py"
        file.write_text(f"def number():\n    return {number}\n")
        plugins.add([plugins.read(file)])
        hashes.append(plugins.sha256_of("part"))
    assert [plugins.attribute("part", "number", sha256)() for sha256 in hashes] == [1, 2]
    assert plugins.attribute("part", "number")() == 2


def install(folder: Path, version: str) -> None:
    """A distribution as pip leaves it, with a method under an entry point."""
    (folder / "strange.py").write_text(TANGENT)
    about = folder / "strange_methods.dist-info"
    about.mkdir(exist_ok=True)
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: strange-methods\nVersion: {version}\n")
    (about / "entry_points.txt").write_text("[testbed.methods]\nstrange = strange:avoid\n")


@pytest.mark.slow
def test_a_method_of_an_installed_package_flies_under_its_own_name(tmp_path: Path) -> None:
    """Listed, checked, flown in workers; its version is part of what the run is."""
    site = tmp_path / "site"
    site.mkdir()
    install(site, "1.0")
    campaign = CAMPAIGN.replace("plugins: [./tangent.py]\n", "").replace('"tangent:avoid"', "strange")
    (tmp_path / "study.yaml").write_text(campaign)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(site), os.environ.get("PYTHONPATH", "")])}

    def testbed(*commands: str) -> subprocess.CompletedProcess[str]:
        """Commands in one process, whose exit code is the last one's."""
        code = "import sys\nfrom testbed.cli import main\nfor words in sys.argv[1:]:\n    sys.argv = words.split()\n"
        code += "    try:\n        main()\n    except SystemExit as end:\n        ended = end.code\nsys.exit(ended)"
        command = [sys.executable, "-c", code, *(f"testbed {words}" for words in commands)]
        return subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path, env=environment)

    told = testbed("list methods", "check method strange").stdout
    assert "strange" in told.partition("method 'strange'")[0].split()
    assert "method 'strange'" in told
    done = testbed("run study.yaml --out out --workers 1")
    assert done.returncode == 0, done.stderr
    assert "(4 flown now)" in done.stderr
    assert {event["decision"] for row in rows(tmp_path).values() for event in row["events"]} == {"replanned"}
    install(site, "1.1")
    again = testbed("run study.yaml --out out --workers 1")
    assert again.returncode == 2
    assert "package strange-methods: 1.0 there, 1.1 now" in again.stderr
