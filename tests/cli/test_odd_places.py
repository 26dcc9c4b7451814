"""Wherever the command is run and whatever its streams are: a sentence and an exit code, never a traceback, and nothing lost."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TESTBED = Path(sys.executable).with_name("testbed")
SMALL = (ROOT / "campaigns" / "smoke.yaml").read_text().replace("recordings: all", "recordings: none").partition("sweep:")[0] + (
    "plant: {kind: kinematic}\n"
)

pytestmark = pytest.mark.slow  # the command is run as a user runs it


def shell(line, cwd, **environment):
    """A line of bash in which ``testbed`` is the command; None takes a variable away."""
    env = {name: value for name, value in (dict(os.environ) | environment).items() if value is not None}
    done = subprocess.run(["bash", "-c", f'testbed() {{ "{TESTBED}" "$@"; }}; {line}'], cwd=cwd, env=env, capture_output=True, check=False)
    done.out, done.err = (text.decode("utf-8", "backslashreplace") for text in (done.stdout, done.stderr))
    assert "Traceback" not in done.err, done.err
    assert "Exception ignored" not in done.err, done.err
    return done


@pytest.fixture
def place(tmp_path):
    (tmp_path / "c.yaml").write_text(SMALL)
    return tmp_path


@pytest.mark.parametrize("command", ["validate c.yaml", "list", "schema", "--version", "--help", "init new", "check method none"])
def test_a_stdout_that_cannot_be_written_is_exit_1_and_said(place, command):
    done = shell(f"testbed {command} > /dev/full", place)
    assert done.returncode == 1
    assert "No space left on device" in done.err


def test_a_run_whose_stderr_and_stdout_are_full_or_closed_keeps_every_row(place):
    for n, (streams, code) in enumerate([("2> /dev/full", 0), ("> /dev/full", 1), (">&- 2>&- <&-", 0)]):
        done = shell(f"testbed run c.yaml --workers 1 --out {n} {streams}", place)
        assert done.returncode == code, done.err
    results = [(place / str(n) / "results.csv").read_bytes() for n in range(3)]
    assert results[0] == results[1] == results[2]
    assert results[0].count(b"\n") == 2


def test_a_closed_stream_says_nothing_and_changes_no_exit_code(place):
    for streams in (">&-", "2>&-", ">&- 2>&-"):
        assert shell(f"testbed validate c.yaml {streams}", place).returncode == 0
        assert shell(f"testbed validate nowhere.yaml {streams}", place).returncode == 2


@pytest.mark.parametrize("environment", [{}, {"LC_ALL": "C", "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}])
def test_names_that_are_not_utf_8_are_flown_and_come_back_as_they_are(place, environment):
    name = os.fsdecode(b"caf\xe9")
    (place / f"{name}.yaml").write_text(SMALL)
    done = shell(r"testbed run $'caf\xe9.yaml' --workers 1 --out $'out\xff'", place, **environment)
    assert (done.returncode, done.stdout) == (0, b"out\xff\n"), done.err
    page = (place / os.fsdecode(b"out\xff") / "index.html").read_text(encoding="utf-8")
    assert r"caf\udce9.yaml" in page
    for line in (
        r"testbed report $'no\xff'",
        r"testbed validate $'no\xff'",
        r"testbed $'no\xff'",
        r"testbed check method none --set $'\xff=1'",
    ):
        wrong = shell(line, place, **environment)
        assert wrong.returncode == 2, line
        assert wrong.err.strip()


def test_letters_that_the_encoding_lacks_are_numbers(place):
    (place / "é.yaml").write_text(SMALL)
    done = shell("testbed validate é.yaml", place, PYTHONIOENCODING="ascii", PYTHONUTF8="1")
    assert (done.returncode, done.out) == (0, "\\xe9.yaml: 1 flight in 1 cell\n")


def test_links_to_nowhere_and_files_in_the_way_are_told(place):
    (place / "gone").symlink_to("nowhere")
    (place / "round").symlink_to("round")
    (place / "file").touch()
    commands = ["report gone", "run c.yaml --out gone", "init round", "--aircraft-path round list", "run c.yaml --out file/below"]
    for command in [*commands, "report /dev/null", "init /proc/none", "validate round"]:
        done = shell(f"testbed {command}", place)
        assert done.returncode == 2, command
        assert command.replace("/below", "").split()[-2 if command.endswith("list") else -1] in done.err


def test_without_a_home_or_a_current_folder(place):
    assert shell("testbed run c.yaml --workers 1 --out out", place, HOME=None, TMPDIR="/nowhere").returncode == 0
    gone = shell(f"mkdir gone; cd gone; rmdir ../gone; testbed run {place}/c.yaml --workers 1", place)
    assert (gone.returncode, gone.err) == (2, "the current folder was removed: change to another\n")
    assert shell("mkdir gone; cd gone; rmdir ../gone; testbed list plants", place).returncode == 0


def test_aircraft_are_looked_for_where_nothing_is(place):
    (place / "file").touch()
    done = shell("testbed validate c.yaml", place, TESTBED_AIRCRAFT_PATH=os.fsdecode(b"/no\xff:file:/dev/null"))
    assert done.returncode == 0, done.err


@pytest.mark.parametrize("how", ["testbed_python script.py", "testbed_python - < script.py", "testbed_python -m script"])
def test_a_script_without_a_main_guard_flies(place, how):
    (place / "script.py").write_text(
        "from pathlib import Path\nfrom testbed.run import runner\nfrom testbed.run.engines import LocalEngine\n"
        "print(runner.run(runner.Order(source=Path('c.yaml'), engine=LocalEngine(1), out=Path('out'))).planned)\n"
    )
    done = shell(f'testbed_python() {{ "{sys.executable}" "$@"; }}; {how}', place)
    assert (done.returncode, done.out) == (0, "1\n"), done.err


def test_a_script_whose_own_function_is_called_is_told_to_have_a_main_guard(place):
    (place / "script.py").write_text(
        "from testbed.run.engines import EngineError, LocalEngine\ndef f(x): return x\n"
        "try:\n    list(LocalEngine(1).imap(f, [1]))\nexcept EngineError as problem:\n    print(problem)\n"
    )
    done = subprocess.run([sys.executable, "script.py"], cwd=place, capture_output=True, text=True, check=False)
    assert 'put what it does under `if __name__ == "__main__":`' in done.stdout
