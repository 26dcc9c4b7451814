import subprocess

import pytest

from testbed.core.canonical import canonical, cut
from testbed.run import identity


@pytest.fixture
def aircraft(tmp_path, monkeypatch):
    """A folder in the place of aircraft/."""
    folder = tmp_path / "aircraft"
    (folder / "glider").mkdir(parents=True)
    (folder / "glider" / "aircraft.yaml").write_text("span_m: 15\n")
    monkeypatch.setattr(identity, "AIRCRAFT_ROOT", folder)
    return folder


def test_the_code_hash_stays_while_nothing_changes(aircraft):
    before = identity.code_hash()
    (aircraft / "glider" / "__pycache__").mkdir()
    (aircraft / "glider" / "__pycache__" / "make.pyc").touch()
    (aircraft / "glider" / ".aircraft.yaml.swp").touch()
    assert identity.code_hash() == before


@pytest.mark.parametrize("change", ["edit", "add", "rename", "move content"])
def test_the_code_hash_notices(aircraft, change):
    before = identity.code_hash()
    file = aircraft / "glider" / "aircraft.yaml"
    if change == "edit":
        file.write_text("span_m: 18\n")
    elif change == "add":
        (aircraft / "glider" / "empty.xml").touch()
    elif change == "rename":
        file.rename(aircraft / "glider" / "other.yaml")
    else:
        file.rename(aircraft / "aircraft.yaml")
    assert identity.code_hash() != before


def test_the_revision_is_that_of_the_projects_own_repository_only(tmp_path, aircraft):
    assert identity.revision() == {"revision": None, "dirty": None}, "no repository"
    git = ["git", "-C", str(tmp_path), "-c", "user.name=n", "-c", "user.email=e"]
    subprocess.run([*git, "init", "-q"], check=True)
    subprocess.run([*git, "commit", "-q", "--allow-empty", "-m", "someone else's"], check=True)
    assert identity.revision() == {"revision": None, "dirty": None}, "somebody else's repository"
    (tmp_path / "testbed").mkdir()
    (tmp_path / "testbed" / "__init__.py").touch()
    subprocess.run([*git, "add", "."], check=True)
    subprocess.run([*git, "commit", "-q", "-m", "ours"], check=True)
    clean = identity.revision()
    assert clean["dirty"] is False
    assert len(clean["revision"]) == 40
    (aircraft / "new.yaml").touch()
    assert identity.revision() == clean | {"dirty": True}


def test_without_git_there_is_no_revision(monkeypatch):
    monkeypatch.setenv("PATH", "")
    assert identity.revision() == {"revision": None, "dirty": None}


def test_versions_hold_what_the_results_depend_on():
    versions = identity.versions()
    assert {"python", "numpy", "scipy", "jsbsim"} <= set(versions)
    assert not {"pytest", "ruff"} & set(versions), "tools of the developers do not decide results"


def test_differences_name_the_leaf():
    there = {"seed": 1, "obstacles": [{"name": "O", "radius_m": 25, "at": [0, 1]}], "sweep": {}}
    now = {"seed": 1, "obstacles": [{"name": "O", "radius_m": 30, "at": [0, 2]}, {"name": "P"}], "sweep": {"a": [1]}}
    assert identity.differences(there, there) == []
    assert identity.differences(there, now) == [
        "obstacles.O.radius_m: 25 there, 30 now",
        "obstacles.O.at: [0, 1] there, [0, 2] now",
        "sweep: {} there, nothing now",
        'obstacles.P.name: nothing there, "P" now',
        "sweep.a: nothing there, [1] now",
    ]


def test_a_plan_hash_depends_on_values_not_on_the_order_of_keys():
    assert canonical({"a": 1, "b": 2.5}) == canonical({"b": 2.5, "a": 1})
    assert canonical({"a": 1}) != canonical({"a": 2})


def test_data_that_differ_in_few_keys_are_written_once_and_read_the_same():
    data = {"z": 0, "b": {"y": [1, 2.5], "x": None}, "a": "first", "c": 3}
    for holes in (("a", "z"), ("b",), ("b", "c"), tuple(sorted(data))):
        pieces = cut(data, *holes)
        assert b"".join(piece + canonical(data[hole]) for piece, hole in zip(pieces, holes, strict=False)) + pieces[-1] == canonical(data)
