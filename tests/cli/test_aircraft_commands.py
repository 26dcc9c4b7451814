"""`aircraft`, `aircraft new` and `tune` as a user types them: what is wrong with an aircraft ends in words and an exit code."""

import shutil
from pathlib import Path

import pytest

from testbed.core.catalogue import AIRCRAFT_ROOT, PATH_VARIABLE
from tests.command import Done
from tests.command import testbed as said_by

SMOKE = AIRCRAFT_ROOT.parent / "campaigns" / "smoke.yaml"

pytestmark = pytest.mark.slow  # the command is called as a user types it


def testbed(*arguments: str, cwd: Path) -> Done:
    return said_by(*arguments, cwd=cwd, **{PATH_VARIABLE: ""})


testbed.__test__ = False  # type: ignore[attr-defined]  # its name begins like a test's


@pytest.fixture
def hangar(tmp_path: Path) -> Path:
    """A folder with the GTM as `mine`, and a campaign that flies it."""
    shutil.copytree(AIRCRAFT_ROOT / "gtm_t2", tmp_path / "hangar" / "mine")
    (tmp_path / "c.yaml").write_text(SMOKE.read_text().replace("aircraft: gtm_t2", "aircraft: mine"))
    assert "aircraft: mine" in (tmp_path / "c.yaml").read_text()
    return tmp_path / "hangar"


COMMANDS = ["validate c.yaml", "run c.yaml", "tune mine", "aircraft mine"]


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("bank_deg: 70", "bank_degs: 70", "hangar/mine/aircraft.yaml:8:3: limits.bank_degs: unknown key 'bank_degs'"),
        ("files: own, name: gtm_t2", "files: wheel, name: sgs126", "hangar/mine/aircraft.yaml:4:29: model.name: 'sgs126' has no engine"),
    ],
)
def test_a_broken_aircraft_is_bad_input_to_every_command(hangar: Path, command: str, old: str, new: str, message: str) -> None:
    file = hangar / "mine" / "aircraft.yaml"
    file.write_text(file.read_text().replace(old, new))
    done = testbed("--aircraft-path", "hangar", *command.split(), cwd=hangar.parent)
    assert done.returncode == 2
    assert done.stderr.startswith(message)
    assert not (hangar.parent / "reports").exists()


def test_an_aircraft_that_does_not_trim_where_it_should_is_no_traceback(hangar: Path) -> None:
    file = hangar / "mine" / "aircraft.yaml"
    before = file.read_text().replace("reference_mps: 50", "reference_mps: 15")
    file.write_text(before)
    for command in ("tune", "aircraft"):
        done = testbed("--aircraft-path", "hangar", command, "mine", cwd=hangar.parent)
        assert done.returncode == 1
        assert "no level trim at 15 m/s" in done.stderr
    assert file.read_text() == before


def test_what_the_commands_refuse(tmp_path: Path) -> None:
    for command, message in [
        ("aircraft nope", "no aircraft 'nope'; there are: c172p"),
        ("aircraft new g --wheel sgs233", "'sgs233' has no engine: gliders are not supported"),
        ("aircraft new g", "name the model: --wheel MODEL"),
        ("tune nope", "no aircraft 'nope'"),
    ]:
        done = testbed(*command.split(), cwd=tmp_path)
        assert done.returncode == 2
        assert done.stderr.startswith(message)
    assert not list(tmp_path.iterdir())


def test_the_data_sheet_has_kept_its_name(tmp_path: Path) -> None:
    """It is written, by this name, in tests/airframe/test_data_sheet.py."""
    assert "sheet" in testbed("aircraft", "--help", cwd=tmp_path).stdout


def test_a_new_aircraft_is_found_where_it_was_put(tmp_path: Path) -> None:
    done = testbed("aircraft", "new", "sport", "--wheel", "j3cub", "--speed", "30", "--out", "hangar", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "trims in level flight from 18 to" in done.stdout
    assert "sport" in testbed("--aircraft-path", "hangar", "list", "aircraft", cwd=tmp_path).stdout.split()
    (tmp_path / "c.yaml").write_text(SMOKE.read_text().replace("aircraft: gtm_t2", "aircraft: sport"))
    refused = testbed("--aircraft-path", "hangar", "validate", "c.yaml", cwd=tmp_path)
    assert refused.returncode == 2
    assert "'sport' has no gains yet" in refused.stderr
