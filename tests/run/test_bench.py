"""What `testbed bench` promises, and the history that shows drift."""

import csv
from pathlib import Path

import pytest
from typer.testing import CliRunner

from testbed.cli import app
from testbed.run import bench
from testbed.run.bench_history import WHO, append, beside, read, today


def line(revision: str, **figures: float) -> dict[str, str]:
    return {**today(figures), "revision": revision, "machine": "here"}


def test_what_is_more_than_promised_is_marked() -> None:
    assert bench.mark("jsbsim, calm", "whole", 2.1) == "*"
    assert bench.mark("jsbsim, calm", "whole", 2.0) == " "
    assert bench.mark("jsbsim c172p, wind", "loop", 1.6) == "*"
    assert bench.mark("kinematic, calm", "loop", 9.0) == " ", "nothing is promised of the loop of a point"
    assert bench.mark("kinematic, calm", "of jsbsim", 0.51) == "*"
    assert bench.mark("jsbsim, calm", "of jsbsim", 1.0) == " "
    assert bench.mark("point_mass, shear", "log ms", 2.5) == "*"


def test_every_plant_meets_every_air() -> None:
    cases = {case: (plan, beside) for case, plan, beside in bench.plans()}
    for air in bench.AIRS:
        for flyer, aircraft in bench.FLYERS.items():
            plan, other = cases[f"{flyer}, {air}"]
            assert (plan.plant.kind, plan.aircraft) == (flyer.split()[0], aircraft)
            assert other.plant.kind == "jsbsim"
            assert other.air == plan.air
            assert other.aircraft == plan.aircraft


def test_history_grows_by_a_line_a_run_and_by_a_column_a_figure(tmp_path: Path) -> None:
    file = tmp_path / "deep" / "history.csv"
    assert read(file) == []
    append(file, line("a", loop=1.5))
    append(file, line("b", loop=1.6, whole=1.9))
    rows = list(csv.DictReader(file.read_text().splitlines()))
    assert [row["revision"] for row in rows] == ["a", "b"]
    assert [row["whole"] for row in rows] == ["", "1.900"]
    assert list(rows[0])[:4] == list(WHO)
    assert read(file) == rows
    assert [path.name for path in file.parent.iterdir()] == ["history.csv"]


def test_a_file_that_is_no_history_is_left_alone(tmp_path: Path) -> None:
    file = tmp_path / "mine.csv"
    file.write_text("a,b\n1,2\n")
    with pytest.raises(ValueError, match=r"mine\.csv: not a history"):
        read(file)
    result = CliRunner().invoke(app, ["bench", "--history", str(file)])
    assert result.exit_code == 2
    assert file.read_text() == "a,b\n1,2\n"


def test_drift_is_said_of_a_figure_that_left_the_last_runs_on_this_machine() -> None:
    former = [
        line(name, loop=value, whole=1.9) for name, value in (("a", 9.0), ("b", 1.5), ("c", 1.52), ("d", 1.48), ("e", 1.5), ("f", 1.5))
    ]
    elsewhere = [{**line("x", loop=4.0), "machine": "there"}]
    steady = beside([*former, *elsewhere], line("now", loop=1.6, whole=1.95))
    assert "nothing has drifted" in steady
    assert "9.000" not in steady, "only the last five count"
    dearer = beside(former, line("now", loop=1.8, whole=1.95))
    assert "drifted: loop is 1.800, the median of those was 1.500 (+20 %)" in dearer
    assert "whole is" not in dearer
    assert "drifted: whole is 1.200" in beside(former, line("now", loop=1.5, whole=1.2)), "cheaper is news too"
    assert beside(elsewhere, line("now", loop=1.0)) == "history: no former run on this machine"


@pytest.mark.slow
def test_it_measures_and_remembers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench, "AIRS", {"calm": {}})
    monkeypatch.setattr(bench, "FLYERS", {"jsbsim": "gtm_t2", "kinematic": "gtm_t2"})
    file = tmp_path / "history.csv"
    append(file, today({"jsbsim, calm, loop": 1.5}))
    result = CliRunner().invoke(app, ["bench", "--pairs", "2", "--history", str(file)])
    assert result.exit_code == 0, result.output
    assert "history: the last 1 on this machine" in result.output
    _, run = read(file)
    figures = {name: float(value) for name, value in run.items() if name not in WHO}
    assert {"jsbsim, calm, whole", "kinematic, calm, of jsbsim", "kinematic, racetrack, log ms"} <= figures.keys()
    assert all(value > 0.0 for value in figures.values())
    assert figures["jsbsim, calm, loop"] > 1.0, "a loop costs more than its steps"
    assert figures["kinematic, calm, of jsbsim"] < 1.0
