"""Wherever the command is run and whatever its streams are: a sentence and an exit code, never a traceback, and nothing lost."""

import io
import os
import subprocess
import sys
from pathlib import Path

import pytest

from testbed.cli import main

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


@pytest.fixture
def called(place, monkeypatch):
    """The command in this process, for what has nothing to do with its streams; gives (exit code, stderr)."""

    def call(*words, encoding="utf-8"):
        said = {name: io.TextIOWrapper(io.BytesIO(), encoding=encoding) for name in ("stdout", "stderr")}
        with monkeypatch.context() as here:
            here.chdir(place)
            here.setattr(sys, "argv", ["testbed", *words])
            for name, stream in said.items():
                here.setattr(sys, name, stream)
            with pytest.raises(SystemExit) as ended:
                main()
        err = said["stderr"].buffer.getvalue().decode("utf-8", "backslashreplace")
        assert "Traceback" not in err, err
        return ended.value.code, err

    return call


@pytest.mark.parametrize("command", ["list", "--version"])
def test_a_stdout_that_cannot_be_written_is_exit_1_and_said(place, command):
    done = shell(f"testbed {command} > /dev/full", place)
    assert done.returncode == 1
    assert "No space left on device" in done.err


def test_a_closed_stream_says_nothing_and_changes_no_exit_code(place):
    assert shell("testbed --version >&-", place).returncode == 0
    assert shell("testbed report nowhere >&- 2>&-", place).returncode == 2


def test_names_that_are_not_utf_8_and_streams_that_are_full_or_closed_cost_no_row(place):
    """The first where the encoding is ASCII too, the second without a home and without a place for temporary files."""
    environment = {"LC_ALL": "C", "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    (place / os.fsdecode(b"caf\xe9.yaml")).write_text(SMALL)
    done = shell(r"testbed run $'caf\xe9.yaml' --workers 1 --out $'out\xff'", place, **environment)
    assert (done.returncode, done.stdout) == (0, b"out\xff\n"), done.err
    out = place / os.fsdecode(b"out\xff")
    assert r"caf\udce9.yaml" in (out / "index.html").read_text(encoding="utf-8")
    done = shell("testbed run c.yaml --workers 1 --out other > /dev/full 2>&- <&-", place, HOME=None, TMPDIR="/nowhere")
    assert done.returncode == 1
    assert (out / "results.csv").read_bytes() == (place / "other" / "results.csv").read_bytes()
    assert (out / "results.csv").read_bytes().count(b"\n") == 2


def test_names_that_are_not_utf_8_and_not_there_are_told(called):
    odd = os.fsdecode(b"no\xff")
    for words in (["report", odd], ["validate", odd], [odd], ["check", "method", "none", "--set", f"{odd}=1"]):
        code, err = called(*words)
        assert code == 2, words
        assert err.strip()


def test_letters_that_the_encoding_lacks_are_numbers(called):
    code, err = called("init", "é", encoding="ascii")
    assert (code, err) == (0, "")
    code, err = called("report", "é/first.yaml", encoding="ascii")
    assert code == 2
    assert "\\xe9/first.yaml" in err


def test_links_to_nowhere_and_files_in_the_way_are_told(place, called):
    (place / "gone").symlink_to("nowhere")
    (place / "round").symlink_to("round")
    (place / "file").touch()
    commands = ["report gone", "run c.yaml --out gone", "init round", "--aircraft-path round list", "run c.yaml --out file/below"]
    for command in [*commands, "report /dev/null", "init /proc/none", "validate round"]:
        code, err = called(*command.split())
        assert code == 2, command
        assert command.replace("/below", "").split()[-2 if command.endswith("list") else -1] in err


def test_without_a_current_folder(place):
    gone = shell(f"mkdir gone; cd gone; rmdir ../gone; testbed run {place}/c.yaml --workers 1", place)
    assert (gone.returncode, gone.err) == (2, "the current folder was removed: change to another\n")


def test_aircraft_are_looked_for_where_nothing_is(monkeypatch, called):
    monkeypatch.setenv("TESTBED_AIRCRAFT_PATH", os.fsdecode(b"/no\xff:file:/dev/null"))
    code, err = called("list", "aircraft")
    assert code == 0, err


def test_a_script_without_a_main_guard_flies(place):
    (place / "script.py").write_text(
        "from pathlib import Path\nfrom testbed.run import runner\nfrom testbed.run.engines import LocalEngine\n"
        "print(runner.run(runner.Order(source=Path('c.yaml'), engine=LocalEngine(1), out=Path('out'))).planned)\n"
    )
    done = subprocess.run([sys.executable, "script.py"], cwd=place, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "1\n"), done.stderr


def test_a_script_whose_own_function_is_called_is_told_to_have_a_main_guard(place):
    (place / "script.py").write_text(
        "from testbed.run.engines import EngineError, LocalEngine\ndef f(x): return x\n"
        "try:\n    list(LocalEngine(1).imap(f, [1]))\nexcept EngineError as problem:\n    print(problem)\n"
    )
    done = subprocess.run([sys.executable, "script.py"], cwd=place, capture_output=True, text=True, check=False)
    assert 'in a script, what starts them belongs under: if __name__ == "__main__":' in done.stdout
