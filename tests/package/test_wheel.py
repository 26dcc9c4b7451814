"""The wheel holds what a stranger needs, and flies where there is no repository."""

import csv
import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import NamedTuple

import pytest

from testbed.core.catalogue import PATH_VARIABLE, aircraft_folders
from testbed.run.identity import code_hash

ROOT = Path(__file__).parents[2]
PIP = (sys.executable, "-m", "pip", "--disable-pip-version-check", "--quiet", "--no-input")
TESTBED = (sys.executable, "-P", "-c", "from testbed.cli import main; main()")
ONE_FLIGHT = ("--set", "sweep={plant.kind: [kinematic], method.kind: [scoam]}", "--set", "recordings=none", "--workers", "1")

pytestmark = pytest.mark.slow


class Installed(NamedTuple):
    """The names in the wheel of the repository and in that of its sdist, which is unpacked into a folder of its own."""

    of_repository: set[str]
    of_sdist: set[str]
    site: Path
    elsewhere: Path

    def run(self, *command: str) -> subprocess.CompletedProcess[str]:
        """A command outside the repository, which finds the project in the wheel's folder before anywhere else."""
        environment = os.environ | {"PYTHONPATH": str(self.site), PATH_VARIABLE: ""}
        return subprocess.run(command, cwd=self.elsewhere, env=environment, capture_output=True, text=True, timeout=120, check=False)


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Installed:
    built, again, site, elsewhere = (tmp_path_factory.mktemp(name) for name in ("built", "again", "site", "elsewhere"))
    subprocess.run([sys.executable, "-m", "hatchling", "build", "-t", "sdist", "-t", "wheel", "-d", built], cwd=ROOT, check=True)
    (sdist,) = built.glob("*.tar.gz")
    subprocess.run([*PIP, "wheel", "--no-index", "--no-deps", "--no-build-isolation", "-w", again, sdist], check=True)
    (wheel,), (same,) = built.glob("*.whl"), again.glob("*.whl")
    subprocess.run([*PIP, "install", "--no-index", "--no-deps", "--no-compile", "--target", site, same], check=True)
    return Installed(names_in(wheel), names_in(same), site, elsewhere)


def names_in(wheel: Path) -> set[str]:
    with zipfile.ZipFile(wheel) as archive:
        return set(archive.namelist())


def sources(folder: str) -> set[str]:
    files = (file for file in (ROOT / folder).rglob("*") if file.is_file() and "__pycache__" not in file.parts)
    return {file.relative_to(ROOT).as_posix() for file in files}


def test_it_holds_the_packages_and_what_they_carry_and_nothing_else(installed: Installed) -> None:
    packed = {name for name in installed.of_repository if ".dist-info/" not in name}
    carried = {f"testbed/data/{name}" for name in sources("aircraft") | sources("campaigns")}
    carried.add("testbed/data/reference/verdict.csv")  # with which a run on the paper is compared
    assert packed == sources("testbed") | sources("vosc") | carried
    for name in ("aircraft/gtm_t2/Engines/p70.xml", "campaigns/smoke.yaml", "campaigns/campaign.schema.json", "study/first.yaml"):
        assert f"testbed/data/{name}" in packed
    assert "testbed/show/templates/index.html.j2" in packed


def test_the_source_distribution_makes_the_same_wheel(installed: Installed) -> None:
    assert installed.of_sdist == installed.of_repository


def test_a_study_begins_validates_and_flies_outside_the_repository(installed: Installed) -> None:
    asked = "import testbed, vosc; from testbed.core.catalogue import aircraft_folders as known"
    told = installed.run(sys.executable, "-P", "-c", f"{asked}; print(testbed.__file__, vosc.__file__, *known())").stdout.split()
    assert [Path(file).parents[1] for file in told[:2]] == [installed.site] * 2
    assert told[2:] == list(aircraft_folders())
    begun = installed.run(*TESTBED, "init", "study", "--examples")
    assert "study/first.yaml" in begun.stdout.split(), begun.stderr
    again = installed.run(*TESTBED, "init", "study")
    assert (again.returncode, again.stdout) == (2, "")
    assert "nothing is written over" in again.stderr
    checked = installed.run(*TESTBED, "validate", "--no-estimate", "study/first.yaml", "study/examples/smoke.yaml")
    assert checked.returncode == 0, checked.stderr
    flown = installed.run(*TESTBED, "run", "study/first.yaml", *ONE_FLIGHT)
    assert (flown.returncode, flown.stdout) == (0, "reports/runs/first\n"), flown.stderr
    run = installed.elsewhere / "reports" / "runs" / "first"
    with (run / "results.csv").open(encoding="utf-8", newline="") as file:
        assert [row["outcome"] for row in csv.DictReader(file)] == ["reached"]
    assert "</html>" in (run / "index.html").read_text(encoding="utf-8")
    manifest = json.loads((run / "manifest.json").read_text(encoding="utf-8"))
    assert manifest["identity"]["code"] == code_hash(), "the same code is the same, installed or in the repository"
    assert (manifest["revision"], manifest["dirty"]) == (None, None)


PARTS = {  # a file of docs/plugins: how a campaign asks for it, and one line of it, changed
    "holder.py": ('planner: {kind: "holder:Planner"}', "2.0 * self.hold_s", "2.5 * self.hold_s"),
    "pure_pursuit.py": (
        'guidance: {kind: "pure_pursuit:Pursuit", options: {ahead_s: 1.5}}',
        " = ahead_s, setting",
        " = 1.2 * ahead_s, setting",
    ),
    "noisy.py": ('sensor: {kind: "noisy:Noisy", range_m: 180, options: {late_s: 0.1}}', "normal(size=6)", "uniform(size=6)"),
}
OWN = """
name: own
question: Do a planner, a guidance law and a sensor of one's own fly from the wheel?
replicates: 2
route: {start_enu_m: [0, 0, 0], goal_enu_m: [900, 0, 0], start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}
obstacles: [{name: O, radius_m: 25, position_enu_m: [420, 6, 4], speed_mps: 20, direction_deg: [180, 0]}]
plant: {kind: point_mass}
recordings: none
"""


def first_row(run: Path) -> dict[str, str]:
    with (run / "results.csv").open(encoding="utf-8", newline="") as file:
        return next(csv.DictReader(file))


def test_a_planner_a_law_and_a_sensor_of_one_s_own_fly_from_the_wheel(installed: Installed) -> None:
    """In a local worker; changed by one line each is another part; without its files the run can still be flown again.

    On a cluster, and what a changed part flies: ``tests/run/test_plugins.py``.
    """
    study = installed.elsewhere / "own"
    study.mkdir()
    for file in PARTS:
        shutil.copy(ROOT / "docs" / "plugins" / file, study)
    asked = "\n".join(asked for asked, _, _ in PARTS.values())
    (study / "own.yaml").write_text(f"{OWN}plugins: [{', '.join(f'./{file}' for file in PARTS)}]\n{asked}\n")
    local, again = study / "local", [*TESTBED, "run", "own/own.yaml", "--out", "own/local", "--workers", "1"]
    done = installed.run(*again)
    assert done.returncode == 0, done.stderr
    assert "2 of 2 flights (2 flown now)" in done.stderr
    results, row = (local / "results.csv").read_bytes(), first_row(local)
    assert float(row["replans"]) >= 1.0, "the planner acted"
    assert "</html>" in (local / "index.html").read_text(encoding="utf-8")
    for file, (_, line, changed) in PARTS.items():
        text = (study / file).read_text()
        assert text.count(line) == 1
        (study / file).write_text(text.replace(line, changed))
    refused = installed.run(*again)
    assert refused.returncode == 2
    assert all(f"plug-in {file.removesuffix('.py')}: " in refused.stderr for file in PARTS)
    assert (local / "results.csv").read_bytes() == results, "nothing is lost"
    for file in PARTS:
        (study / file).unlink()  # the run has its own
    replayed = installed.run(*TESTBED, "replay", "own/local", row["flight_id"])
    assert replayed.returncode == 0, replayed.stderr
    assert "equal its row" in replayed.stderr


def test_the_installed_aircraft_are_not_written_to(installed: Installed) -> None:
    done = installed.run(*TESTBED, "tune", "gtm_t2")
    assert (done.returncode, done.stdout) == (2, "")
    assert "copy " in done.stderr
    assert "Traceback" not in done.stderr
