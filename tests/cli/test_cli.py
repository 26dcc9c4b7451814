import fcntl
import json
import os
import re
import signal
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path

import pytest

from tests.command import testbed

ROOT = Path(__file__).parents[2]
SMOKE = ROOT / "campaigns" / "smoke.yaml"
TESTBED = Path(sys.executable).with_name("testbed")
LONG = ("--set", "replicates=200", "--set", "recordings=none")

pytestmark = pytest.mark.slow  # the command is called as a user types it, in this process but where processes are the point


def start(*arguments, cwd):
    """In a group of its own, as a shell starts it, with files for its output: pipes would stay open in workers that live on."""
    with (cwd / "stdout").open("w") as out, (cwd / "stderr").open("w") as err:
        command = [TESTBED, *map(str, arguments)]
        return subprocess.Popen(command, cwd=cwd, stdout=out, stderr=err, stdin=subprocess.DEVNULL, start_new_session=True)


def group(leader):
    """The live processes of a process group."""
    pids = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, pgrp = stat.read_text().rpartition(")")[2].split()[:3]
        except (OSError, ValueError):
            continue
        if int(pgrp) == leader and state != "Z":
            pids.append(int(stat.parent.name))
    return pids


def wait_until(condition, seconds=60):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.02)
    return False


def lines(file):
    return file.read_bytes().count(b"\n") if file.exists() else 0


@pytest.fixture(scope="module")
def smoke(tmp_path_factory):
    """The smoke campaign, flown once with one worker, by the command that a user starts."""
    folder = tmp_path_factory.mktemp("smoke")
    run = start("run", SMOKE, "--out", "one", "--workers", 1, cwd=folder)
    assert run.wait(120) == 0, (folder / "stderr").read_text()
    assert (folder / "stdout").read_text() == "one\n"
    return folder / "one"


def test_two_workers_give_the_same_bytes_as_one(smoke, tmp_path):
    done = testbed("run", SMOKE, "--out", "two", "--workers", 2, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, "two\n")
    for name in ("results.csv", "results.parquet", "index.html"):
        assert (tmp_path / "two" / name).read_bytes() == (smoke / name).read_bytes(), name
    assert len(list((tmp_path / "two" / "recordings").glob("*.rrd"))) == 4


def test_a_finished_run_is_reported_again_in_the_same_bytes(smoke):
    before = {path.name: path.read_bytes() for path in smoke.iterdir() if path.is_file()}
    done = testbed("run", SMOKE, "--out", smoke, cwd=smoke)
    assert done.returncode == 0
    assert "4 of 4 flights (0 flown now)" in done.stderr
    assert testbed("report", smoke, cwd=smoke).stdout == f"{smoke}\n"
    assert {path.name: path.read_bytes() for path in smoke.iterdir() if path.is_file()} == before


def test_a_replay_equals_its_row(smoke, tmp_path):
    for flight in json.loads((smoke / "plan.json").read_text())["flights"][1:3]:  # one of each plant
        done = testbed("replay", smoke, flight["flight_id"], "--out", "again.rrd", cwd=tmp_path)
        assert (done.returncode, done.stdout) == (0, f"{tmp_path / 'again.rrd'}\n"), done.stderr
        assert "metrics and events equal its row" in done.stderr
        assert (tmp_path / "again.rrd").stat().st_size > 10_000


def test_a_check_is_told_line_by_line_and_a_miss_is_exit_1(tmp_path):
    check = ROOT / "campaigns" / "check" / "excess_power.yaml"
    good = testbed("run", check, "--out", "good", "--workers", 1, cwd=tmp_path)
    assert (good.returncode, good.stdout) == (0, "good\n"), good.stderr
    head, *lines = good.stderr[good.stderr.index("check   quantity") :].splitlines()[:4]
    assert [line.split()[0] for line in lines] == ["passed"] * 3
    assert {line[head.index("unit") :] for line in lines} == {"", "m/s"}  # the columns stand below each other
    bad = testbed("run", check, "--out", "bad", "--workers", 1, "--set", "check.steepest_climb_deg=21", cwd=tmp_path)
    assert (bad.returncode, bad.stdout) == (1, "bad\n")
    assert "\nmissed  jsbsim gtm_t2: specific excess power" in bad.stderr
    assert "1 of 3 checks missed" in bad.stderr
    assert testbed("report", "bad", cwd=tmp_path).returncode == 1


def test_a_crash_says_why_and_whose_fault_it_may_be(tmp_path):
    text = (ROOT / "docs/plugins/holder.py").read_text()
    (tmp_path / "holder.py").write_text(
        text.replace("def step(", "def step(self, *told):\n        raise ZeroDivisionError('at tick')\n\n    def was(")
    )
    campaign = SMOKE.read_text().partition("sweep:")[0] + "plugins: [./holder.py]\nplant: {kind: kinematic}\n"
    (tmp_path / "mine.yaml").write_text(campaign + 'planner: {kind: "holder:Planner"}\n')
    done = testbed("run", "mine.yaml", "--out", "out", "--workers", 1, cwd=tmp_path)
    (row,) = [json.loads(line)["row"] for line in (tmp_path / "out" / "rows.jsonl").read_text().splitlines()]
    assert done.returncode == 1
    assert f"1 crashed: {row['flight_id']}: ZeroDivisionError: at tick; see 'traceback' in out/rows.jsonl\n" in done.stderr
    assert "the fault may be in a file of the campaign's plug-ins: ./holder.py\n" in done.stderr
    assert "1 of 1 flight (1 flown now): 1 failed to run\n" in done.stderr


def test_a_changed_plan_is_refused_with_what_differs(smoke):
    done = testbed("run", SMOKE, "--out", smoke, "--set", "speed_mps=51", cwd=smoke)
    assert done.returncode == 2
    assert "speed_mps: 50.0 there, 51.0 now" in done.stderr
    assert done.stdout == ""


def test_a_directory_in_use_is_refused(smoke):
    with (smoke / ".lock").open() as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        done = testbed("run", SMOKE, "--out", smoke, cwd=smoke)
    assert done.returncode == 2
    assert "another run is writing here" in done.stderr


def test_every_problem_of_a_bad_campaign_has_its_place(tmp_path):
    (tmp_path / "bad.yaml").write_text("name: x\nsead: 3\nspeed_mps: fast\n")
    for command in ("run", "validate"):
        done = testbed(command, "bad.yaml", cwd=tmp_path)
        assert done.returncode == 2
        assert "bad.yaml:2:1: sead: unknown key" in done.stderr
        assert "bad.yaml:3:12: speed_mps: " in done.stderr
        assert done.stdout == ""
    assert [path.name for path in tmp_path.iterdir()] == ["bad.yaml"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("run", "nowhere.yaml"), "nowhere.yaml"),
        (("run", "."), "."),
        (("run", SMOKE, "--set", "nonsense"), "nonsense"),
        (("run", SMOKE, "--set", "speed_mps=-3"), "speed_mps"),
        (("run", SMOKE, "--workers", 0), "--workers"),
        (("run", SMOKE, "--scheduler", "here"), "--scheduler goes with --engine dask"),
        (("run", SMOKE, "--out", "file"), "file: not a directory"),
        (("run", SMOKE, "--out", "file/below"), "file"),
        (("run", SMOKE, "--out", "full"), "not of a run (notes.txt)"),
        (("report", "nowhere"), "no such directory"),
        (("report", "full"), "not a run directory"),
        (("replay", "full", "x"), "not a run directory"),
        (("list", "engines"), "engines"),
        (("fly",), "fly"),
    ],
)
def test_bad_input_is_exit_2_and_one_message(tmp_path, arguments, message):
    (tmp_path / "file").touch()
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "notes.txt").touch()
    done = testbed(*arguments, cwd=tmp_path)
    assert done.returncode == 2, done
    assert message in done.stderr
    assert done.stdout == ""


def test_validate_names_every_bad_file_and_counts_the_flights_of_good_ones(tmp_path):
    (tmp_path / "bad.yaml").write_text("- 1\n")
    done = testbed("validate", "--no-estimate", "bad.yaml", SMOKE, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stdout == f"{SMOKE}: 4 flights in 4 cells\n"
    assert "bad.yaml" in done.stderr


def test_validate_counts_the_flights_of_each_part(tmp_path):
    text = Path(SMOKE).read_text().partition("sweep:")[0] + "parts:\n  a: {replicates: 3, sweep: {replan.k: [1, 2]}}\n  b: {}\n"
    (tmp_path / "parts.yaml").write_text(text)
    done = testbed("validate", "--no-estimate", "parts.yaml", cwd=tmp_path)
    assert done.stdout == "parts.yaml: 7 flights in 3 cells\n  a: 6 flights in 2 cells\n  b: 1 flight in 1 cell\n"


def test_validate_takes_the_settings_that_run_takes(tmp_path):
    more = testbed("validate", "--no-estimate", SMOKE, "--set", "replicates=3", "--set", "sweep.plant.kind=[kinematic]", cwd=tmp_path)
    assert (more.returncode, more.stdout) == (0, f"{SMOKE}: 6 flights in 2 cells\n")
    bad = testbed("validate", SMOKE, SMOKE, "--set", "speed_mps=90", cwd=tmp_path)
    assert (bad.returncode, bad.stdout) == (2, "")
    assert bad.stderr.count("--set speed_mps=90: speed_mps: gtm_t2 holds") == 2


def test_validate_says_what_the_run_will_take(tmp_path):
    more = testbed("validate", SMOKE, "--workers", "3", "--set", "replicates=200", "--set", "recordings=none", cwd=tmp_path)
    count, disk, wait = more.stdout.splitlines()
    assert count == f"{SMOKE}: 800 flights in 4 cells"
    told = re.fullmatch(r"  on disk about ([\d.]+) kB a flight, ([\d.]+) MB in all \((.*)\), and a page of at most 5 MB", disk)
    assert told, disk
    assert float(told[1]) * 0.8 == pytest.approx(float(told[2]), rel=0.05)
    assert [part.split()[0] for part in told[3].split(", ")] == "plan.json rows.jsonl timings.csv results.csv results.parquet".split()
    assert re.fullmatch(r"  about [\d.]+ (s|min|h) with 3 workers, by \d flights? flown to see", wait), wait
    assert list(tmp_path.iterdir()) == []


def test_what_there_is_to_choose_from(tmp_path):
    assert {"gtm_t2", "c172p"} <= set(testbed("list", "aircraft", cwd=tmp_path).stdout.split())
    assert {"none", "scoam"} <= set(testbed("list", "methods", cwd=tmp_path).stdout.split())
    assert {"kinematic", "jsbsim"} <= set(testbed("list", "plants", cwd=tmp_path).stdout.split())
    assert "look_ahead" in testbed("list", "guidance", cwd=tmp_path).stdout.splitlines()
    everything = testbed("list", cwd=tmp_path).stdout
    assert all(word in everything for word in ("gtm_t2", "scoam", "kinematic", "look_ahead"))


def test_schema_and_version(tmp_path):
    assert "sweep" in json.loads(testbed("schema", cwd=tmp_path).stdout)["properties"]
    assert testbed("--version", cwd=tmp_path).stdout == f"testbed {version('vosc-testbed')}\n"


@pytest.mark.parametrize(
    "command", ["schema", "list", "run smoke.yaml --workers 1 --set recordings=none --set sweep.plant.kind=[kinematic]"]
)
def test_a_reader_that_goes_away_is_no_error(tmp_path, command):
    (tmp_path / "smoke.yaml").write_bytes(SMOKE.read_bytes())
    shell = f"set -o pipefail; '{TESTBED}' {command} 2>&1 | true"
    done = subprocess.run(["bash", "-c", shell], cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_ctrl_c_keeps_what_was_flown_and_says_how_to_go_on(tmp_path):
    run = start("run", SMOKE, "--out", "cut", "--fresh", *LONG, cwd=tmp_path)
    rows = tmp_path / "cut" / "rows.jsonl"
    assert wait_until(lambda: lines(rows) >= 5), (tmp_path / "stderr").read_text()
    os.killpg(run.pid, signal.SIGINT)  # a terminal sends it to the workers too
    assert run.wait(timeout=30) == 130
    said = (tmp_path / "stderr").read_text()
    assert "Traceback" not in said
    assert (tmp_path / "stdout").read_text() == ""
    assert wait_until(lambda: group(run.pid) == [], 10)
    kept = lines(rows)
    resume = said.splitlines()[-1].split()
    assert "--fresh" not in resume
    assert resume[:4] == ["testbed", "run", str(SMOKE), "--out"]
    again = start(*resume[1:], cwd=tmp_path)
    assert wait_until(lambda: lines(rows) > kept)
    os.killpg(again.pid, signal.SIGINT)
    assert again.wait(timeout=30) == 130
    assert lines(rows) > kept


def test_a_killed_run_leaves_no_process_and_ends_in_the_same_bytes_when_it_is_continued(tmp_path):
    """Killed while its workers fly; at any other moment: `make kills`."""
    short = ("--set", "replicates=6", "--set", "recordings=none")
    run = start("run", SMOKE, "--out", "cut", *short, cwd=tmp_path)
    rows = tmp_path / "cut" / "rows.jsonl"
    assert wait_until(lambda: lines(rows) >= 5), (tmp_path / "stderr").read_text()
    assert len(group(run.pid)) > 1
    run.kill()
    run.wait()
    assert wait_until(lambda: group(run.pid) == [], 20)
    kept = rows.read_bytes()
    whole = kept[: kept.rindex(b"\n") + 1]
    assert lines(rows) < 24
    assert testbed("run", SMOKE, "--out", "cut", *short, cwd=tmp_path).returncode == 0
    assert rows.read_bytes().startswith(whole)
    assert testbed("run", SMOKE, "--out", "whole", "--workers", 1, *short, cwd=tmp_path).returncode == 0
    assert (tmp_path / "cut" / "results.csv").read_bytes() == (tmp_path / "whole" / "results.csv").read_bytes()
