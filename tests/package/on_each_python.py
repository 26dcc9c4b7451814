"""What a stranger does, on each Python there is: install the wheel with what it needs into an empty environment, and fly a study.

``python tests/package/on_each_python.py [INTERPRETER...]``; without any, python3.11, python3.12 and python3.13 of the PATH. The project's
own environment must have hatchling; the packages come from where pip is told to get them. Exit code 1 when a step fails.
"""

import csv
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]
WANTED = ("python3.11", "python3.12", "python3.13")
AIRCRAFT = {"c172p", "gtm_t2", "t37"}


def main(interpreters: list[str]) -> int:
    """Try each; returns the exit code."""
    failed, tried = [], 0
    with tempfile.TemporaryDirectory() as folder:
        wheel = build(Path(folder))
        for name in interpreters or WANTED:
            interpreter = shutil.which(name)
            if interpreter is None or subprocess.run([interpreter, "--version"], capture_output=True, check=False).returncode:
                print(f"{name}: not found, left out")
                continue
            tried += 1
            try:
                print(f"{name}: {install_and_fly(interpreter, wheel, Path(folder) / f'try{tried}')}", flush=True)
            except (subprocess.CalledProcessError, AssertionError) as problem:
                failed.append(name)
                print(f"{name}: FAILED: {problem}\n{getattr(problem, 'stdout', '')}{getattr(problem, 'stderr', '')}", flush=True)
    return 1 if failed or not tried else 0


def build(folder: Path) -> Path:
    """The wheel of this checkout."""
    say(Path.cwd(), sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", str(folder), str(ROOT))
    (wheel,) = folder.glob("*.whl")
    return wheel


def install_and_fly(interpreter: str, wheel: Path, folder: Path) -> str:
    """Do it all in ``folder``; returns what was resolved and how long it took."""
    folder.mkdir()
    began = time.monotonic()
    say(folder, interpreter, "-m", "venv", "env")
    python, testbed = str(folder / "env" / "bin" / "python"), str(folder / "env" / "bin" / "testbed")
    say(folder, python, "-m", "pip", "install", "-q", str(wheel))
    say(folder, python, "-m", "pip", "check")
    installed = time.monotonic()
    assert say(folder, testbed, "--version").startswith("testbed ")
    assert set(say(folder, testbed, "list", "aircraft").split()) == AIRCRAFT
    say(folder, testbed, "init", "study")
    assert "6 flights in 6 cells" in say(folder, testbed, "validate", "study/first.yaml")
    (run,) = say(folder, testbed, "run", "study/first.yaml").split()
    with (folder / run / "results.csv").open(encoding="utf-8", newline="") as file:
        rows = {row["cell"]: row for row in csv.DictReader(file)}
    assert rows["kinematic/scoam"]["outcome"] == rows["jsbsim/scoam_with_margin"]["outcome"] == "reached", rows
    assert (folder / run / "index.html").stat().st_size > 10_000
    assert len(list((folder / run / "recordings").glob("*.rrd"))) == 6
    flight_id = rows["jsbsim/scoam"]["flight_id"]
    say(folder, testbed, "replay", run, flight_id)
    assert Path(folder, say(folder, testbed, "aircraft", "c172p").strip()).stat().st_size > 10_000
    flown = time.monotonic()
    versions = " ".join(say(folder, python, "-m", "pip", "list", "--format=freeze").split())
    return f"installed in {installed - began:.0f} s, all steps in {flown - installed:.0f} s, with {versions}"


def say(folder: Path, *command: str) -> str:
    """Run a command in ``folder``, with nothing of this checkout in its way; returns its stdout."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "TESTBED", "VIRTUAL_ENV"))}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=True, timeout=900).stdout


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
