"""A study from file to report: the same bytes however it is run, and words for what is wrong with it."""

import csv
import io
import math
from pathlib import Path

import pytest

from testbed.campaign import SpecError, expand, load_campaign
from testbed.run import runner
from testbed.run.directory import BadInputError
from testbed.run.engines import LocalEngine, attempt
from testbed.run.replay import replay
from testbed.run.runner import Order
from testbed.studies.lead_time.line import ONLY, rung_of

STUDY = """\
name: {name}
question: How early?
seed: 3
replicates: 3
speed_mps: 50
route: {{start_enu_m: [0, 0, 0], goal_enu_m: [900, 0, 0], start_direction_deg: [0, 0], goal_direction_deg: [0, 0]}}
sensor: {{range_m: 10000}}
replan: {{answer: direct, rejoin: {{when: clear}}}}
study: {{kind: lead_time, options: {{leads_s: [0.5, 1, 2], tolerance_s: 0.1, obstacle_speed_mps: [20, 50], radius_m: [25, 30]}}}}
recordings: none
rates: {{plant_hz: 60}}
sweep:
  plant.kind: [{plants}]
  replan.swell_m: [0, 8]
  method.kind: [scoam, least_deflection]
"""


def test_a_point_has_a_rung_whatever_is_ideal_of_it() -> None:
    """The gust load goes with the load factor: no limits are no limits with or without it."""
    assert {rung_of(tuple(ideal)) for ideal in ONLY} == set(ONLY.values())
    assert rung_of(("roll", "load_factor", "speed", "gust")) == rung_of(("roll", "load_factor", "speed")) == "point_ideal"
    assert rung_of(("gust",)) == "point_mass_no_gust"
    assert rung_of(("roll", "speed", "gust")) == "point_load_no_gust"


class Here:
    """An engine without processes; it gives up after so many results."""

    name, workers = "here", 1

    def __init__(self, until: int = 10**6) -> None:
        self.until = until

    def imap(self, fn, items):
        for number, item in enumerate(items):
            if number >= self.until:
                raise KeyboardInterrupt
            yield number, attempt(fn, item)


def study(folder: Path, name: str = "little", plants: str = "kinematic") -> Path:
    file = folder / f"{name}.yaml"
    file.write_text(STUDY.format(name=name, plants=plants))
    return file


def reported(folder: Path) -> tuple[bytes, bytes]:
    return (folder / "lead_time.csv").read_bytes(), (folder / "index.html").read_bytes()


def test_a_search_is_a_line_and_an_interrupted_study_goes_on(tmp_path: Path) -> None:
    file = study(tmp_path)
    runner.run(Order(file, Here(), tmp_path / "whole"))
    with pytest.raises(KeyboardInterrupt):
        runner.run(Order(file, Here(until=5), tmp_path / "torn"))
    summary = runner.run(Order(file, Here(), tmp_path / "torn"))
    assert (summary.planned, summary.flown_now, summary.crashed) == (12, 7, 0)
    assert reported(tmp_path / "torn") == reported(tmp_path / "whole")
    lines = list(csv.DictReader(io.StringIO(reported(tmp_path / "whole")[0].decode())))
    assert len(lines) == 12
    assert {(line["rung"], line["answer"], line["aircraft"]) for line in lines} == {("vo_instant", "direct", "")}
    for line in lines:
        assert float(line["waste_s"]) == pytest.approx(float(line["lead_s"]) - float(line["best_s"]), abs=1e-4)
        assert float(line["range_m"]) == pytest.approx(
            float(line["closing_mps"]) * float(line["lead_s"]) + float(line["radius_m"]), rel=1e-4
        )
        assert [pair.split(":")[0] for pair in line["grid_clearance_m"].split()] == ["0.5", "1", "2"]
    with pytest.raises(BadInputError, match="is what the study 'lead_time' flies, and cannot be replayed"):
        replay(tmp_path / "whole", _first_id(tmp_path / "whole"))


def _first_id(run: Path) -> str:
    return (run / "timings.csv").read_text().splitlines()[1].split(",")[0]


@pytest.mark.slow
def test_the_report_is_the_same_with_one_and_two_workers(tmp_path: Path) -> None:
    file = study(tmp_path, plants="kinematic, jsbsim")
    few = ("replicates=2", "sweep.method.kind=[scoam]")
    for folder, engine in (("1", Here()), ("2", LocalEngine(2))):
        runner.run(Order(file, engine, tmp_path / folder, few))
    assert reported(tmp_path / "1") == reported(tmp_path / "2")
    lines = list(csv.DictReader(io.StringIO(reported(tmp_path / "1")[0].decode())))
    by_encounter = {}
    for line in lines:
        by_encounter.setdefault(line["encounter"], set()).add((line["radius_m"], line["closing_mps"], line["miss_m"]))
    assert all(len(seen) == 1 for seen in by_encounter.values())
    for line in lines:  # whoever turns at once needs no more than an aeroplane
        if line["rung"] == "jsbsim":
            assert float(line["best_s"]) > float(line["entry_s"]) + 0.1


def test_a_search_that_the_program_fails_is_a_crash_and_no_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(plan: object) -> None:
        raise ZeroDivisionError("no encounter")

    monkeypatch.setattr("testbed.studies.lead_time.search.search", fails)
    summary = runner.run(Order(study(tmp_path), Here(), tmp_path / "out"))
    assert summary.crashed == 12
    assert len(reported(tmp_path / "out")[0].splitlines()) == 1


WRONG = [
    ("leads_s: [0.5, 1, 2]", "leads_s: [0.5, 2, 1]", "each lead must be more than the one before it"),
    ("leads_s: [0.5, 1, 2]", "leads_s: [0.5, 1, 1e300]", "must be at most 600 s, not 1e+300 s: every flight of the search lasts as long"),
    ("tolerance_s: 0.1", "tolerance_s: 1e-300", "must be at least 1e-06 s, not 1e-300 s: rounding decides about less"),
    ("tolerance_s: 0.1", "run_up_s: 1e9", "must be at most 600 s, not 1000000000.0 s"),
    ("speed_mps: [20, 50]", "speed_mps: [20, 1e200]", "must be at most 3000 m/s, not 1e+200 m/s: nothing in the air is as fast"),
    ("radius_m: [25, 30]", "radius_m: [1e-9, 30]", "must be at least 0.01 m, not 1e-09 m: less is a point, not a sphere"),
    ("radius_m: [25, 30]", "radius_m: [30, 25]", "the first is more than the second"),
    ("tolerance_s: 0.1", "run_up_s: 0.123", "needs run_up_s to be a whole number of looks of the planner, 1/60 s each"),
    ("range_m: 10000", "range_m: 100", "needs sensor.range_m of 330 m at least"),
    ("goal_enu_m: [900, 0, 0]", "goal_enu_m: [400, 0, 0]", "needs a route of 500 m at least"),
    ("goal_enu_m: [900, 0, 0]", "goal_enu_m: [900, 10, 0]", "needs a straight level route"),
    ("recordings: none", "air: {wind: {kind: steady, speed_mps: 5, from_deg: 0}}", "needs traffic.in_wind: anchored in a wind"),
    ("recordings: none", "air: {wind: {kind: power_law, speed_mps: 5, from_deg: 0}}", "goes with calm air or a steady wind"),
    (
        "recordings: none",
        "obstacles: [{name: O, radius_m: 25, position_enu_m: [1, 2, 3], speed_mps: 4, direction_deg: [5, 6]}]",
        "draws the obstacle itself: leave out obstacles",
    ),
]


@pytest.mark.parametrize(("good", "bad", "says"), WRONG, ids=[bad for _, bad, _ in WRONG])
def test_what_cannot_be_searched_is_said_where_it_stands(tmp_path: Path, good: str, bad: str, says: str) -> None:
    file = study(tmp_path)
    file.write_text(file.read_text().replace(good, bad))
    with pytest.raises(SpecError) as refused:
        load_campaign(file)
    assert says in str(refused.value)
    (problem,) = refused.value.problems
    assert problem.path.startswith("study")
    assert problem.spot.line == 9


def test_what_a_study_needs_is_said_where_it_is_not(tmp_path: Path) -> None:
    file = study(tmp_path)
    file.write_text(file.read_text().replace("leads_s: [0.5, 1, 2], ", "").replace("tolerance_s", "tolerance"))
    with pytest.raises(SpecError) as refused:
        load_campaign(file)
    told = {problem.path: (problem.spot.line, problem.message, problem.hint) for problem in refused.value.problems}
    assert told["study.options.leads_s"] == (9, "this key is missing", "")
    assert told["study.options.tolerance"][1].startswith("unknown option 'tolerance' of the study 'lead_time'")
    assert told["study.options.tolerance"][2] == "did you mean 'tolerance_s'?"
    file.write_text(STUDY.format(name="bare", plants="kinematic").partition("study:")[0] + "study: {kind: lead_time}\n")
    with pytest.raises(SpecError, match=r"little\.yaml:\d+:\d+: study\.options\.leads_s: this key is missing"):
        load_campaign(file)


def test_a_campaign_from_before_there_were_studies_is_told_what_to_write(tmp_path: Path) -> None:
    file = study(tmp_path)
    file.write_text(
        file.read_text().replace("study: {kind: lead_time, options: {", "lead_time: {").replace("30]}}", "30]}")
        + "  lead_time.run_up_s: [0, 1]\n"
    )
    with pytest.raises(SpecError) as refused:
        load_campaign(file)
    top, axis = refused.value.problems
    assert (top.path, top.spot.line, top.message) == ("lead_time", 9, "unknown key 'lead_time'")
    assert top.hint.startswith("write study: {kind: lead_time, options: {")
    assert (axis.path, axis.message) == ("sweep.lead_time.run_up_s", "unknown setting 'lead_time.run_up_s'")
    assert "study.options.<name> in parts and sweeps" in axis.hint


def test_a_part_is_a_study_and_flights_do_not_mix_with_searches(tmp_path: Path) -> None:
    head = STUDY.format(name="parted", plants="kinematic").partition("sweep:")[0] + "plant: {kind: kinematic}\n"
    file = tmp_path / "parted.yaml"
    file.write_text(f"{head}parts:\n  first: {{sweep: {{replan.swell_m: [0, 8]}}}}\n  second: {{replicates: 2}}\n")
    runner.run(Order(file, Here(), tmp_path / "out"))
    lines = list(csv.DictReader(io.StringIO(reported(tmp_path / "out")[0].decode())))
    assert [line["study"] for line in lines] == ["first"] * 6 + ["second"] * 2
    assert all(math.isfinite(float(line["best_s"])) for line in lines)
    options = file.read_text().replace("second: {", "second: {set: {study.options.tolerance_s: 1.0}, ")
    file.write_text(options)
    assert [plan.study.options["tolerance_s"] for plan in expand(load_campaign(file))] == [0.1] * 6 + [1.0] * 2
    file.write_text(options.replace("study.options.tolerance_s: 1.0", "study.kind: none"))
    with pytest.raises(SpecError, match=r"'study\.kind' belongs to the campaign as a whole, not to a flight"):
        load_campaign(file)
