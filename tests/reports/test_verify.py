"""``python reports/verify`` on runs that were flown here: it agrees with them, and finds what is changed in them."""

import ast
import csv
import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from scipy import stats

from reports.verify import report
from reports.verify.outcome import end_of, outcome_of
from reports.verify.raw import read_raw
from testbed.run import runner
from testbed.run.engines import LocalEngine
from testbed.run.runner import Order
from tests.command import called
from tests.here import Here

PACKAGE = Path(__file__).parents[2] / "reports" / "verify"
CAMPAIGN = """\
name: little
question: Can somebody else compute this again?
route: {start_enu_m: [0, 0, 0], goal_enu_m: [500, 200, 100], start_direction_deg: [40.87, 26.13], goal_direction_deg: [10.00, 2.84]}
recordings: none
columns: all
aircraft: gtm_t2
geometry: level
obstacles:
- {name: O, radius_m: 25, position_enu_m: [254, 63.6, 60.7], speed_mps: 40, direction_deg: [106.1, 10.4],
   when: {own_reaches_enu_m: [162, 101, 64.3]}}
sweep:
  method.kind: [none, scoam, droam_vp]
  air:
    calm: {}
    gusts: {air.wind: {kind: steady, speed_mps: 10, from_deg: 240}, air.turbulence: {kind: dryden, severity: severe}}
  rung:
    instant: {plant.kind: kinematic, replan.answer: direct}
    kinematic: {plant.kind: kinematic}
    point_mass: {plant.kind: point_mass}
"""

JUDGED = (
    CAMPAIGN[: CAMPAIGN.index("geometry")].replace("little", "judged")
    + """\
sweep:
  part: {calm: {}}
  encounter:
    single_106:
      obstacles:
      - {name: O, radius_m: 25, position_enu_m: [254, 63.6, 60.7], speed_mps: 40, direction_deg: [106, 12.4],
         when: {own_reaches_enu_m: [162, 101, 64.3]}}
  method: {none: {method.kind: none}, scoam: {method.kind: scoam}}
  flown_by: {gtm_t2: {begin.climb_at_most_deg: 18, begin.at_route_s_m: null}}
  rung: {kinematic: {plant.kind: kinematic}, jsbsim: {plant.kind: jsbsim}}
"""
)


def fly(folder: Path, engine=None, overrides: tuple[str, ...] = (), campaign: str = CAMPAIGN) -> Path:
    source = folder / "little.yaml"
    source.write_text(campaign)
    return runner.run(Order(source=source, engine=engine or Here(), out=folder / "out", overrides=overrides)).directory


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return fly(tmp_path_factory.mktemp("flown"))


@pytest.fixture
def run(flown: Path, tmp_path: Path) -> Path:
    """A copy to spoil."""
    return Path(shutil.copytree(flown, tmp_path / "out"))


def verify(directory: Path) -> tuple[int, str, str]:
    """In this process; that it stands alone is another test."""
    done = called(report.main, "verify", directory, cwd=directory.parent)
    return done.returncode, done.stdout, done.stderr


def spoil(table: Path, change: Callable[[dict[str, str]], None], row: int) -> dict[str, str]:
    """Change a row of a table; the row as it is now."""
    with table.open(newline="") as file:
        rows = list(csv.DictReader(file))
    change(rows[row])
    with table.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    return rows[row]


@pytest.mark.slow
def test_what_was_flown_is_computed_again_to_the_same_figures(flown: Path) -> None:
    code, said, _ = verify(flown)
    assert code == 0, said
    assert "18 flights checked of 18 planned, in 18 cells" in said
    compared = {line.split()[0]: int(line.split()[1]) for line in said.splitlines() if line.startswith("  ") and "quantity" not in line}
    assert compared["least_clearance_m"] == compared["path_length_m"] == 18
    assert compared["peak_deflection_deg"] >= 10
    assert 4 <= compared["avoidance_time_s"] < compared["peak_deflection_deg"], "a direction flown at once has no insertion point"


@pytest.mark.slow
@pytest.mark.parametrize("quantity", ["least_clearance_m", "path_length_m", "peak_deflection_deg", "clear_time_s", "deflection_deg"])
def test_a_figure_that_was_changed_is_named(run: Path, quantity: str) -> None:
    changed = spoil(run / "results.csv", lambda row: row.update({quantity: repr(float(row[quantity]) + 1e-4)}), row=8)
    code, said, _ = verify(run)
    assert code == 1
    (line,) = [line for line in said.splitlines() if changed["flight_id"] in line and changed["cell"] in line]
    assert quantity in line
    assert changed[quantity] in line


@pytest.mark.slow
def test_a_figure_that_was_taken_away_and_an_outcome_that_was_changed_are_named(run: Path) -> None:
    spoil(run / "results.csv", lambda row: row.update(clear_time_s=""), row=7)
    assert spoil(run / "results.csv", lambda row: row.update(outcome="no_path"), row=2)["outcome"] == "no_path"
    code, said, _ = verify(run)
    assert code == 1
    assert any("clear_time_s" in line and "nothing" in line for line in said.splitlines())
    assert any(line.split()[2:] == ["outcome", "no_path", "collided"] for line in said.splitlines())
    assert any("1 no_path" in line and "1 collided" in line for line in said.splitlines()), "the counts of the cell differ too"


@pytest.mark.slow
def test_what_cannot_be_verified_is_refused_in_a_sentence(run: Path, tmp_path: Path) -> None:
    one = json.loads((run / "plan.json").read_text())["flights"][4]["flight_id"]
    file = run / "columns" / f"{one}.parquet"
    kept = file.read_bytes()
    file.write_bytes(kept[:-100])
    assert verify(run)[0] == 2
    assert f"{one}.parquet: not the raw columns of a flight" in verify(run)[2]
    file.unlink()
    code, said, why = verify(run)
    assert (code, said) == (2, "")
    assert f"raw columns are missing: columns/{one}.parquet (of 18 flights" in why
    file.write_bytes(kept)
    (run / "results.csv").write_text((run / "results.csv").read_text().replace("least_clearance_m", "clearance", 1))
    assert "has no column least_clearance_m" in verify(run)[2]
    (run / "plan.json").write_text("{")
    assert "plan.json: damaged" in verify(run)[2]
    assert "no such directory" in verify(tmp_path / "nowhere")[2]


@pytest.mark.slow
def test_a_run_without_raw_columns_is_refused(tmp_path: Path) -> None:
    code, _, why = verify(fly(tmp_path, overrides=("columns=none", "sweep={}", "plant.kind=kinematic")))
    assert code == 2
    assert "fly it with --set columns=all" in why


@pytest.mark.slow
def test_flights_that_never_began_are_checked_too(tmp_path: Path) -> None:
    gale = ("sweep={}", "plant={kind: kinematic}", "speed_mps=30", "air={wind: {kind: steady, speed_mps: 40, from_deg: 60}}")
    folder = fly(tmp_path, overrides=gale)
    assert ",no_path," in (folder / "results.csv").read_text()
    code, said, _ = verify(folder)
    assert (code, said.splitlines()[0]) == (0, "1 flights checked of 1 planned, in 1 cells")


@pytest.mark.slow
@pytest.mark.parametrize("aircraft", ["gtm_t2", "c172p"])
def test_a_flight_that_came_down_is_told_from_one_that_ran_out_of_time(tmp_path: Path, aircraft: str) -> None:
    """A wheel, a wing or a belly touches before the centre of gravity is down."""
    route = "{start_enu_m: [0, 0, 0], goal_enu_m: [600, 0, -150], start_direction_deg: [0, -5], goal_direction_deg: [0, -20]}"
    campaign = CAMPAIGN[: CAMPAIGN.index("geometry")] + "method: {kind: none}\nplant: {kind: jsbsim}\n"
    folder = fly(tmp_path, None, (f"route={route}", "terrain_z_m=-60", f"aircraft={aircraft}"), campaign)
    assert ",hit_ground," in (folder / "results.csv").read_text()
    assert verify(folder)[0] == 0
    (file,) = (folder / "columns").iterdir()
    raw = read_raw(file)
    raw.about["longest_s"] = raw.time_s[-1]
    assert outcome_of(raw, 1.0, end_of(raw)) == "timed_out"


@pytest.mark.slow
def test_raw_columns_are_the_same_bytes_whatever_flies_them(flown: Path, tmp_path: Path) -> None:
    again = fly(tmp_path, LocalEngine(1), ("sweep.method.kind=[scoam]",))  # a third of them, in a process of its own
    kept = {file.name: file.read_bytes() for file in (again / "columns").iterdir()}
    assert kept == {name: (flown / "columns" / name).read_bytes() for name in kept}
    assert len(kept) == 6


@pytest.mark.slow
def test_a_word_that_does_not_follow_is_named(tmp_path: Path) -> None:
    """Section 5.1 with azimuth 106: 2.7 m clear on rails, 3.8 m inside when flown, so the promise fails when flown, by 0 of 1 flights."""
    directory = fly(tmp_path, campaign=JUDGED)
    with (directory / "results.csv").open(newline="") as file:
        clearance = {row["cell"]: row["least_clearance_m"] for row in csv.DictReader(file)}
    rails, flown = (float(clearance[f"calm/single_106/scoam/gtm_t2/{rung}"]) for rung in ("kinematic", "jsbsim"))
    assert rails > 0.0 > flown
    interval = stats.binomtest(0, 1).proportion_ci(0.95, method="exact")
    claim = {
        "key": "words.single.safe",
        "word": "fails when flown",
        "kinematic": f"{rails:.6g}",
        "point_mass": "",
        "flown_calm": f"{flown:.6g}",
    }
    claim |= {"flown_air_p05": "", "flown_air_median": "", "flown_air_p95": "", "flown_air_n": "0", "effect": "0"}
    claim |= {"effect_low": f"{interval.low:.6g}", "effect_high": f"{interval.high:.6g}", "effect_n": "1"}
    claim |= {"robustness_share": "", "robustness_n": "0"}
    verdict = directory / "verdict.csv"

    def write(**changes: str) -> tuple[int, str, str]:
        verdict.write_text(",".join(claim) + "\n" + ",".join((claim | changes).values()) + "\n")
        return verify(directory)

    assert write()[0] == 0
    assert "1 claims of the verdict agree" in write()[1]
    code, said, _ = write(word="holds")
    assert code == 1
    assert any("words.single.safe" in line and "fails when flown" in line and "holds" in line for line in said.splitlines())
    code, said, _ = write(effect_n="2")
    assert (code, "effect_n" in said) == (1, True)
    verdict.write_text("key,word\nwords.single.safe,holds\n")
    assert verify(directory)[0] == 2


@pytest.mark.slow
def test_a_copy_of_the_folder_says_the_same_and_so_does_the_module(flown: Path, tmp_path: Path) -> None:
    """The copy isolated (-I) and away from the sources: nothing of the testbed can be imported by accident."""
    copy = Path(shutil.copytree(PACKAGE, tmp_path / "another name", ignore=shutil.ignore_patterns("__pycache__")))
    for command, folder in (("-I", copy), flown.parent), (("-m", "reports.verify"), PACKAGE.parents[1]):
        done = subprocess.run([sys.executable, *command, flown], capture_output=True, text=True, check=False, cwd=folder)
        assert (done.returncode, done.stdout, done.stderr) == verify(flown)


def test_it_shares_no_code_with_what_it_verifies() -> None:
    imported = set()
    for file in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.Import):
                imported |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and not node.level:
                imported.add(str(node.module).split(".")[0])
    assert imported - sys.stdlib_module_names == {"numpy", "scipy", "pyarrow"}
