"""A broken aircraft.yaml, a model that is not there, a speed that the aircraft cannot hold: said when the campaign is read."""

import shutil
from pathlib import Path

import pytest

from testbed.campaign import SpecError, load_campaign
from testbed.campaign.reading.aircraft import read_aircraft
from testbed.core.catalogue import AIRCRAFT_ROOT, PATH_VARIABLE, add_aircraft_path
from testbed.core.model_files import wheel_root

CAMPAIGN = """\
name: c
question: Is its aircraft fit to fly?
speed_mps: 50
aircraft: mine
route: {start_enu_m: [0, 0, 0], start_direction_deg: [0, 0], shape: {kind: racetrack, straight_m: 500, radius_m: 300}}
method: {kind: none}
"""

BROKEN = [  # what to replace in the aircraft's file, by what, its complaint after the name of the file
    ("bank_deg: 70", "bank_degs: 70", "8:3: limits.bank_degs: unknown key 'bank_degs'\n", "did you mean 'bank_deg'?"),
    ("bank_deg: 70", "bank_deg: .nan", "8:13: limits.bank_deg: must be a finite number, not .nan", ""),
    ("bank_deg: 70", "bank_deg: '70'", "8:13: limits.bank_deg: must be a number, not the text '70'", ""),
    ("speed_max_mps: 80", "speed_max_mps: 30", "7:18: limits.speed_max_mps: must be more than speed_min_mps, 34.4 m/s", ""),
    ("  bank_deg: 70\n", "", "5:1: limits.bank_deg: this key is missing", ""),
    ("files: own, name: gtm_t2}", "files: own, name: gtm_t2", "this '{' is not closed", ""),
    ("name: gtm_t2}", "name: gtm_t3}", "4:27: model.name: there is no gtm_t3.xml beside aircraft.yaml", "without .xml"),
    ("files: own, name: gtm_t2}", "files: wheel, name: c31}", "JSBSim's wheel has no aircraft 'c31'", "did you mean 'c310'?"),
    ("files: own, name: gtm_t2}", "files: wheel, name: sgs233}", "'sgs233' has no engine: gliders are not supported", ""),
    (
        "bank_deg: 70",
        "bank_deg: 1e-300",
        "8:13: limits.bank_deg: must be at least 1e-06 deg, not 1e-300 deg: nothing that flies has such a figure",
        "",
    ),
    ("alpha_max_1g_mps: ", "alpha_max_1g_mps: 1e-200 #", "limits.alpha_max_1g_mps: must be at least 0.1 m/s, not 1e-200 m/s", ""),
    ("elevator_i_1ps: ", "elevator_i_1ps: 1e300 #", "autopilot.elevator_i_1ps: must be at most 1e+06, not 1e+300", ""),
    ("title:", "folder: .\ntitle:", "1:1: folder: unknown key 'folder'", ""),
]


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The GTM in a folder of another name; the campaign is beside it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(PATH_VARIABLE, "")
    folder = tmp_path / "hangar" / "mine"
    shutil.copytree(AIRCRAFT_ROOT / "gtm_t2", folder)
    add_aircraft_path(folder.parent)
    Path("c.yaml").write_text(CAMPAIGN)
    return folder


def complaint(*overrides: str) -> str:
    with pytest.raises(SpecError) as caught:
        load_campaign("c.yaml", overrides)
    return str(caught.value)


def change(folder: Path, old: str, new: str) -> None:
    text = (folder / "aircraft.yaml").read_text()
    assert old in text
    (folder / "aircraft.yaml").write_text(text.replace(old, new, 1))


@pytest.mark.parametrize(("old", "new", "message", "hint"), BROKEN)
def test_a_broken_file_is_named_with_its_line(mine: Path, old: str, new: str, message: str, hint: str) -> None:
    load_campaign("c.yaml")
    change(mine, old, new)
    said = complaint()
    assert said.startswith("hangar/mine/aircraft.yaml:")
    assert message in said
    assert hint in said
    assert complaint("plant.kind=kinematic") == said, "whatever the plant: limits are asked for the metrics too"


def test_an_engine_that_is_missing_is_named(mine: Path) -> None:
    (mine / "Engines" / "direct.xml").unlink()
    assert "the thruster file 'direct' that gtm_t2.xml names is not there" in complaint()


def test_a_model_that_is_no_xml(mine: Path) -> None:
    (mine / "gtm_t2.xml").write_text("<fdm_config>")
    assert "gtm_t2.xml is no XML that can be read" in complaint()


def test_every_fault_at_once(mine: Path) -> None:
    change(mine, "bank_deg: 70", "bank_deg: .nan")
    change(mine, "name: gtm_t2}", "name: gtm_t3}")
    said = complaint()
    assert "4:27" in said
    assert "8:13" in said


@pytest.mark.slow
def test_folder_and_model_may_have_different_names(mine: Path) -> None:
    from testbed import fly
    from testbed.campaign import expand
    from testbed.flight.record import Outcome

    assert read_aircraft(mine).model.name == "gtm_t2"
    short = "route.shape={kind: racetrack, straight_m: 60, radius_m: 300}"
    (plan,) = expand(load_campaign("c.yaml", [short, "air.turbulence={kind: dryden, severity: light}"]))
    twin = plan.model_copy(update={"aircraft": "gtm_t2"})
    assert fly(plan).outcome is Outcome.REACHED
    assert (fly(plan).columns["own.pos_enu_m"] == fly(twin).columns["own.pos_enu_m"]).all()


@pytest.mark.parametrize("files", ["own", "wheel"])
def test_the_models_of_this_project_lack_nothing(files: str) -> None:
    from testbed.core.model_files import engines, missing_files, read_xml

    file = AIRCRAFT_ROOT / "gtm_t2" / "gtm_t2.xml" if files == "own" else wheel_root() / "aircraft" / "c310" / "c310.xml"
    xml = read_xml(file)
    assert not missing_files(xml, file)
    assert engines(xml, file) == 2


HOLDS = "speed_mps: mine holds 34.4 to 80 m/s, not"


@pytest.mark.usefixtures("mine")
def test_a_speed_that_the_aircraft_cannot_hold_is_said_where_it_is_written() -> None:
    assert complaint("speed_mps=30").startswith(f"--set speed_mps=30: {HOLDS} 30 m/s")
    Path("c.yaml").write_text(CAMPAIGN.replace("speed_mps: 50", "speed_mps: 90"))
    assert complaint().startswith(f"c.yaml:3:12: {HOLDS} 90 m/s")
    load_campaign("c.yaml", ["plant.kind=kinematic"])
    load_campaign("c.yaml", ["plant={kind: point_mass, ideal: [speed]}"])
    assert HOLDS in complaint("plant={kind: point_mass, ideal: [load_factor]}")
    Path("c.yaml").write_text(CAMPAIGN + "sweep:\n  speed_mps: [40, 90]\n")
    assert complaint().startswith("c.yaml:8:19: sweep.speed_mps[1]: mine holds 34.4 to 80 m/s, not 90 m/s (in the cell '90')")
    Path("c.yaml").write_text(CAMPAIGN.replace("50", "40", 1) + "sweep:\n  aircraft: [mine, t37]\n")
    assert complaint().startswith("c.yaml:3:12: speed_mps: t37 holds 49.1 to 144 m/s, not 40 m/s (in the cell 't37')")
    Path("c.yaml").write_text(CAMPAIGN + "replicates: 3\ndraw: {speed_mps: {within: 45}}\n")
    assert HOLDS.removeprefix("speed_mps: ") in complaint()


def test_an_aircraft_without_gains_does_not_fly(mine: Path) -> None:
    change(mine, "gains_found_by: testbed tune gtm_t2", "gains_found_by: ''")
    assert complaint().startswith("c.yaml:4:11: aircraft: 'mine' has no gains yet")
    load_campaign("c.yaml", ["plant.kind=kinematic"])


@pytest.mark.parametrize(
    ("name", "text", "why"),
    [
        ("Engines/p70.xml", b"", "no element found"),
        ("Engines/p70.xml", b"<turbine_engine name='x'>", "no element found"),
        ("Engines/direct.xml", b"</?xml version='1.0'?>\n<direct/>", "not well-formed"),
        ("Engines/direct.xml", b"\xff\xfe\x00", "unclosed token"),
    ],
)
def test_a_part_of_the_model_that_is_no_xml_is_told_with_its_name(tmp_path: Path, name: str, text: bytes, why: str) -> None:
    folder = tmp_path / "gtm_t2"
    shutil.copytree(AIRCRAFT_ROOT / "gtm_t2", folder)
    (folder / name).write_bytes(text)
    with pytest.raises(SpecError, match=rf"{Path(name).name} is no XML that can be read: {why}"):
        read_aircraft(folder)
