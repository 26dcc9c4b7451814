"""Aircraft are found in the project and wherever the user points; every process of a run sees the same ones."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from testbed import fly
from testbed.core.catalogue import AIRCRAFT_ROOT, PATH_VARIABLE, add_aircraft_path, aircraft_folders
from testbed.flight.aircraft import load_aircraft
from testbed.run.identity import code_hash, guests
from tests.plans import plan


@pytest.fixture
def hangar(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder elsewhere with the GTM under another name."""
    monkeypatch.setenv(PATH_VARIABLE, "")
    folder = tmp_path / "hangar" / "mine"
    shutil.copytree(AIRCRAFT_ROOT / "gtm_t2", folder)
    (folder / "gtm_t2.xml").rename(folder / "mine.xml")
    text = (folder / "aircraft.yaml").read_text()
    assert "name: gtm_t2" in text
    (folder / "aircraft.yaml").write_text(text.replace("name: gtm_t2", "name: mine"))
    return folder.parent


def test_the_project_s_own_are_always_there() -> None:
    assert {"gtm_t2", "c172p"} <= set(aircraft_folders())


def test_an_aircraft_from_elsewhere_flies_like_its_twin(hangar: Path) -> None:
    before = code_hash()
    add_aircraft_path(hangar)
    assert load_aircraft("mine").folder == hangar / "mine"
    case = {"begin": {"climb_at_most_deg": 18}}
    mine, twin = (fly(plan(aircraft=name, **case)).columns["own.pos_enu_m"] for name in ("mine", "gtm_t2"))
    assert (mine == twin).all()
    assert code_hash() == before
    (mine,) = guests(["mine", "gtm_t2"]).items()
    assert mine[0] == "mine"
    (hangar / "mine" / "aircraft.yaml").write_text((hangar / "mine" / "aircraft.yaml").read_text() + "# another\n")
    assert guests(["mine"])["mine"] != mine[1], "a run is of the aircraft it flew"


def test_the_command_takes_the_path(hangar: Path) -> None:
    command = [sys.executable, "-c", "from testbed.cli import main; main()"]
    environment = {**os.environ, PATH_VARIABLE: ""}
    done = subprocess.run(
        [*command, "--aircraft-path", str(hangar), "list", "aircraft"], capture_output=True, text=True, env=environment, check=True
    )
    assert "mine" in done.stdout.split()
    wrong = subprocess.run(
        [*command, "--aircraft-path", str(hangar / "mine"), "list"], capture_output=True, text=True, env=environment, check=False
    )
    assert wrong.returncode == 2
    assert "no folder with an aircraft.yaml" in wrong.stderr
    assert "Traceback" not in wrong.stderr
