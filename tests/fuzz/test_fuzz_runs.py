"""A short run of the fuzzer, what it has found before, and whether it would notice."""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from testbed.results import empty
from testbed.run.job import JobResult
from tests.fuzz import campaigns, cases, judge, run, texts, workers
from tests.fuzz.cases import Case, attempt
from tests.run.fakes import metrics_row

FOUND = sorted((Path(__file__).parent / "found").glob("*.yaml"))


@pytest.mark.slow
def test_a_short_run_finds_nothing(tmp_path: Path) -> None:
    fell = [run.told(one) for one in workers.tried(run.items(run.SHORT, run.SEED), tmp_path, 1) if one.faults]
    assert not fell, "\n".join(fell)


@pytest.mark.slow
@pytest.mark.parametrize("file", FOUND, ids=[file.stem for file in FOUND])
def test_what_was_found_once_stays_mended(file: Path, tmp_path: Path) -> None:
    case = Case("found", 0, 0, tmp_path / "work")
    case.fly(case.write(file.read_bytes()))
    assert case.came_to
    assert not case.faults


@pytest.mark.parametrize("kind", sorted(cases.KINDS))
def test_a_case_is_the_same_each_time(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of its files; nothing is flown for that."""
    monkeypatch.setattr(Case, "fly", Case.read)
    written = []
    for n in range(2):
        attempt(kind, 7, 3, tmp_path / str(n))
        written.append({path.name: path.read_bytes() for path in sorted((tmp_path / str(n)).rglob("*")) if path.is_file()})
    assert written[0] == written[1] != {}


def test_numbers_are_other_cases_and_every_sort_of_change_is_made() -> None:
    assert len({texts.mutated(random.Random(n)) for n in range(50)}) == 50
    drawn = [campaigns.mutated(random.Random(n), 8) for n in range(400)]
    for path in campaigns.SETTINGS:
        name = {"ideal": "plant"}.get(path, path).partition(".")[0]
        assert any(one.get(name) != campaigns.plain().get(name) for one in drawn), path


# Jobs of the workers that misbehave, by their number: spawned processes find them through the kind.
def misbehave(case: Case) -> None:
    number = int(os.environ["FUZZ_MISBEHAVES"])
    if number == 0:
        os.kill(os.getpid(), signal.SIGSEGV)
    elif number == 1:
        raise ZeroDivisionError("a bug")
    elif number == 2:
        while True:
            pass
    elif number == 3:
        time.sleep(3600)
    elif number == 4:
        bytearray(700_000_000)
    elif number == 5:
        bytearray(9_000_000_000)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "told"),
    [
        (0, "the process ended with -11"),
        (1, "ZeroDivisionError: a bug test_fuzz_runs.py"),
        (2, "more than 1 s of processor time"),
        (3, "hangs"),
        (4, "MB of memory"),
        (5, "MemoryError"),
    ],
)
def test_it_notices(number: int, told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FUZZ_MISBEHAVES", str(number))
    monkeypatch.setenv("FUZZ_KIND", "tests.fuzz.test_fuzz_runs:misbehave")
    monkeypatch.setitem(workers.CPU_S, "of_a_test", 1.0 if number == 2 else 20.0)
    monkeypatch.setattr(workers, "WALL_S", 2.0)
    (one,) = workers.tried([("of_a_test", 0, 0)], tmp_path, 1)
    assert any(told in fault for fault in one.faults), one


def test_rows_are_judged() -> None:
    def faults(**changes: object) -> list[str]:
        row = metrics_row("a") | {"nearest_obstacle": "O", "events": [], "replans": 0} | changes
        return judge.row_faults(JobResult(row, None, {}))

    missing = float("nan")
    assert faults() == []
    assert faults(path_length_m=missing) == ["path_length_m is missing (reached)"]
    assert faults(least_clearance_m=missing) == ["least_clearance_m is missing (reached)"]
    assert faults(least_clearance_m=missing, nearest_obstacle="") == []
    nothing = dict.fromkeys(["flight_time_s", "path_length_m", "max_airspeed_mps", "max_load_factor"], missing)
    assert faults(**nothing, outcome="hit_ground", message="the start is in the ground") == []
    assert len(faults(**nothing, outcome="hit_ground")) == len(faults(**nothing, message="why")) == 4
    assert faults(rejoin_time_s=missing) == []
    assert faults(rejoin_time_s=float("inf")) == ["rejoin_time_s is inf (reached)"]
    assert faults(outcome="crashed", message="x", traceback='File "/a/testbed/b.py", line 3, in f') == ["crashed: x b.py:3, in f"]
    assert judge.text_faults("a.yaml:1:1: name: this key is missing") == []
    assert [judge.text_faults(text)[0][:14] for text in ("", "a\x1b[31m", "x" * 99_999, "\ud800")] == [
        "an empty messa",
        "a message with",
        "a message of 9",
        "a message with",
    ]


def test_every_number_that_may_be_missing_is_a_column() -> None:
    assert all(reason.columns <= empty.NUMBERS and reason.words for reason in empty.REASONS)


@pytest.mark.slow
def test_one_case_is_tried_again_by_its_number(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tests.fuzz.run", "--kind", "set", "--only", "3", "--folder", str(tmp_path / "case")]
    done = subprocess.run(command, cwd=Path(__file__).parents[2], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.startswith("set 3 of seed 1: ")
    assert (tmp_path / "case" / "overrides.json").is_file()
