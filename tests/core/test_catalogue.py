"""Aircraft are found in the project and wherever the user points; every process of a run sees the same ones."""

import os
import shutil
from pathlib import Path

import pytest

from testbed import fly
from testbed.core.catalogue import AIRCRAFT_ROOT, PATH_VARIABLE, add_aircraft_path, aircraft_beside, aircraft_folders
from testbed.flight.plants.aircraft import load_aircraft
from testbed.run.identity import code_hash, guests
from tests.command import Done
from tests.command import testbed as command
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


def test_what_is_named_goes_before_what_lies_beside_the_study(hangar: Path, tmp_path: Path) -> None:
    beside = tmp_path / "aircraft"
    shutil.copytree(hangar / "mine", beside / "mine")
    shutil.copytree(hangar / "mine", beside / "another")
    with aircraft_beside(tmp_path):
        assert aircraft_folders()["mine"] == beside / "mine"
        add_aircraft_path(hangar)
        assert aircraft_folders()["mine"] == hangar / "mine"
        assert aircraft_folders()["another"] == beside / "another"
    assert not {"mine", "another"} & set(aircraft_folders())
    with aircraft_beside(AIRCRAFT_ROOT.parent), aircraft_beside(tmp_path / "nowhere"):
        assert os.environ[PATH_VARIABLE] == "", "nothing new to look at"


def test_the_command_looks_beside_the_campaign_and_where_it_is_typed(hangar: Path, tmp_path: Path) -> None:
    study = tmp_path / "study"
    study.mkdir()
    hangar.rename(study / "aircraft")
    text = (AIRCRAFT_ROOT.parent / "campaigns" / "smoke.yaml").read_text()
    (study / "mine.yaml").write_text(text.replace("aircraft: gtm_t2", "aircraft: mine"))

    def testbed(*arguments: str, cwd: Path) -> Done:
        return command(*arguments, cwd=cwd, **{PATH_VARIABLE: ""})

    assert testbed("validate", "--no-estimate", "study/mine.yaml", cwd=tmp_path).stdout == "study/mine.yaml: 4 flights in 4 cells\n"
    assert "mine" in testbed("list", "aircraft", cwd=study).stdout.split()
    assert "mine" not in testbed("list", "aircraft", cwd=tmp_path).stdout.split()
    unknown = testbed("aircraft", "mine", cwd=tmp_path)
    assert (unknown.returncode, unknown.stdout) == (2, "")
    assert "no aircraft 'mine'; there are: c172p, " in unknown.stderr
    assert "--aircraft-path" in unknown.stderr


def test_the_command_takes_the_path(hangar: Path) -> None:
    done = command("--aircraft-path", hangar, "list", "aircraft", cwd=hangar, **{PATH_VARIABLE: ""})
    assert done.returncode == 0
    assert "mine" in done.stdout.split()
    wrong = command("--aircraft-path", hangar / "mine", "list", cwd=hangar, **{PATH_VARIABLE: ""})
    assert wrong.returncode == 2
    assert "no folder with an aircraft.yaml" in wrong.stderr
