"""The wheel holds what a stranger needs, and flies where there is no repository."""

import csv
import json
import os
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
    assert packed == sources("testbed") | sources("vosc") | carried
    for name in ("aircraft/gtm_t2/Engines/p70.xml", "campaigns/smoke.yaml", "campaigns/campaign.schema.json", "study/first.yaml"):
        assert f"testbed/data/{name}" in packed
    assert "testbed/show/templates/index.html.j2" in packed


def test_the_source_distribution_makes_the_same_wheel(installed: Installed) -> None:
    assert installed.of_sdist == installed.of_repository


def test_a_study_begins_validates_and_flies_outside_the_repository(installed: Installed) -> None:
    where = installed.run(sys.executable, "-P", "-c", "import testbed, vosc; print(testbed.__file__, vosc.__file__)").stdout.split()
    assert [Path(file).parents[1] for file in where] == [installed.site] * 2
    listed = installed.run(*TESTBED, "list", "aircraft")
    assert listed.stdout.split() == list(aircraft_folders()), listed.stderr
    begun = installed.run(*TESTBED, "init", "study", "--examples")
    assert "study/first.yaml" in begun.stdout.split(), begun.stderr
    again = installed.run(*TESTBED, "init", "study")
    assert (again.returncode, again.stdout) == (2, "")
    assert "nothing is written over" in again.stderr
    checked = installed.run(*TESTBED, "validate", "study/first.yaml", "study/examples/smoke.yaml")
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


def test_the_installed_aircraft_are_not_written_to(installed: Installed) -> None:
    done = installed.run(*TESTBED, "tune", "gtm_t2")
    assert (done.returncode, done.stdout) == (2, "")
    assert "copy " in done.stderr
    assert "Traceback" not in done.stderr
