"""Kill drivers, workers and schedulers at random moments, and see that nothing comes of it: ``make kills``.

A run that is killed and continued must end with the bytes of one that was left alone, leave no process behind and never hang. The
campaign is small and kinematic, but flown by the command as a user gives it. Moments are drawn from the seed; what a machine does
at such a moment is its own affair, so a failure is told with the number of the kill, and the run directory is kept.
Commit nothing meanwhile: a page says of what commit its run is.

    python -m tests.kills.kills --drivers 100 --workers 50 --schedulers 20 --seed 1
"""

import argparse
import contextlib
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
import uuid
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from tests.kills.cluster import ROOT, Cluster

CAMPAIGN = """\
name: kills
question: Does a run that is killed end like one that is not?
seed: 7
replicates: {replicates}
route: {{start_enu_m: [0, 0, 0], goal_enu_m: [500, 200, 100], start_direction_deg: [40.87, 26.13], goal_direction_deg: [10.00, 2.84]}}
obstacles:
  - name: O
    radius_m: 25
    position_enu_m: [254, 63.6, 60.7]
    speed_mps: 40
    direction_deg: [106, 12.4]
    when: {{own_reaches_enu_m: [162, 101, 64.3]}}
recordings: none
plant: {{kind: kinematic}}
sweep:
  method.kind: [none, scoam]
"""
STABLE = ("results.csv", "results.parquet", "index.html")
DRIVER = "import testbed.run.dask_engine as e; e.RECONNECT_S = {reconnect_s}; from testbed.cli import main; main()"
MARK = "KILLS_MARK"
GONE_S = 5.0
HANG_S = 900.0
"""Also on a machine that has other things to do."""
INTERRUPTED, BAD_INPUT, CRASHED = 130, 2, 1


class FaultError(Exception):
    """What must not be; str() says what."""


@dataclass
class Count:
    """What was done, and how it went."""

    kills: int = 0
    resumed: int = 0
    orphans_s: list[float] = field(default_factory=list)
    """How long after its driver the last process of each run was gone."""
    again: int = 0
    """Flights hit twice by kills from outside: a `crashed` row, flown again by the next run."""
    faults: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        slowest = max(self.orphans_s, default=0.0)
        return (
            f"{self.kills} kills, {self.resumed} continued runs, last process gone at most {slowest:.2f} s after its driver, "
            f"{self.again} runs with a flight that was hit twice, {len(self.faults)} faults"
        )


class Study:
    """The campaign in a folder, and the bytes of a run that is left alone."""

    def __init__(self, folder: Path, replicates: int):
        self.folder = folder
        self.campaign = folder / "kills.yaml"
        self.campaign.write_text(CAMPAIGN.format(replicates=replicates))
        start = time.monotonic()
        self.run_to_the_end(folder / "alone")
        self.takes_s = time.monotonic() - start
        self.wanted = self.bytes_of(folder / "alone")

    def bytes_of(self, out: Path) -> dict[str, bytes]:
        return {name: (out / name).read_bytes() for name in STABLE}

    @contextlib.contextmanager
    def started(self, out: Path, *options: str, reconnect_s: float = 60.0) -> Iterator["Run"]:
        """The command, as a user gives it."""
        run = Run(out, [str(self.campaign), "--out", str(out), *(options or ("--workers", "2"))], reconnect_s)
        try:
            yield run
        finally:
            run.driver.kill()
            run.driver.wait()

    def run_to_the_end(self, out: Path, *options: str) -> int:
        """Fly what is left; how often that took another run because a flight was hit twice."""
        for again in range(4):
            with self.started(out, *options) as run:
                code = run.wait()
            if code == 0:
                return again
            if code != CRASHED:
                raise FaultError(f"exit code {code}: {run.said()[-600:]}")
        raise FaultError("a flight crashed in every run")

    def check(self, out: Path) -> None:
        for name, wanted in self.wanted.items():
            if (out / name).read_bytes() != wanted:
                raise FaultError(f"{name} has other bytes than that of a run that was left alone")


class Run:
    """A driver, and all processes that come of it: they inherit a mark."""

    def __init__(self, out: Path, arguments: list[str], reconnect_s: float):
        self._mark = f"{MARK}={uuid.uuid4().hex}"
        self._log = out.parent / f"{out.name}.log"
        self.born = time.monotonic()
        with self._log.open("ab") as log:
            self.driver = subprocess.Popen(
                [sys.executable, "-c", DRIVER.format(reconnect_s=reconnect_s), "run", *arguments],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                cwd=out.parent,
                env=os.environ | {"PYTHONPATH": str(ROOT)} | dict([self._mark.split("=")]),
            )

    def said(self) -> str:
        return self._log.read_text(errors="replace")

    def wait(self) -> int:
        try:
            return self.driver.wait(timeout=HANG_S)
        except subprocess.TimeoutExpired:
            raise FaultError(f"hangs: nothing after {HANG_S:g} s; {self.said()[-600:]}") from None

    def wait_until(self, moment_s: float) -> bool:
        """Until so long after its birth; False if it ended before."""
        while time.monotonic() - self.born < moment_s:
            if self.driver.poll() is not None:
                return False
            time.sleep(0.002)
        return self.driver.poll() is None

    def others(self) -> list[int]:
        """Its processes that live, apart from the driver."""
        found = []
        for entry in Path("/proc").iterdir():
            if entry.name.isdigit() and int(entry.name) != self.driver.pid:
                with contextlib.suppress(OSError):
                    if self._mark.encode() in (entry / "environ").read_bytes():
                        found.append(int(entry.name))
        return found

    def workers(self) -> list[int]:
        found = []
        for pid in self.others():
            with contextlib.suppress(OSError):
                if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes():
                    found.append(pid)
        return found

    def gone_after(self) -> float:
        """Seconds until its last process is gone. One that is not after a while is a fault, and is killed."""
        start = time.monotonic()
        while left := self.others():
            if time.monotonic() - start > GONE_S:
                for pid in left:
                    with contextlib.suppress(ProcessLookupError):
                        os.kill(pid, signal.SIGKILL)
                raise FaultError(f"{len(left)} processes lived {GONE_S:g} s after their driver")
            time.sleep(0.01)
        return time.monotonic() - start


def moment(draw: random.Random, whole_s: float) -> float:
    """From the first milliseconds on: half of them uniform, half crowded at the start, where a run has most to set up."""
    return whole_s * (draw.random() if draw.random() < 0.5 else 10 ** draw.uniform(-3.0, 0.0))


def kill_drivers(study: Study, count: int, draw: random.Random) -> Count:
    """Each run is killed once to thrice, and then continued to its end."""
    told = Count()
    number = 0
    while told.kills < count:
        number += 1
        out = study.folder / f"driver-{number}"
        with _told(told, f"driver {number}"):
            for _ in range(min(draw.randint(1, 3), count - told.kills)):
                with study.started(out) as run:
                    run.wait_until(moment(draw, study.takes_s))
                    run.driver.kill()
                    run.driver.wait()
                    told.kills += 1
                    told.orphans_s.append(run.gone_after())
            told.again += study.run_to_the_end(out)
            told.resumed += 1
            study.check(out)
    return told


def kill_workers(study: Study, count: int, draw: random.Random) -> Count:
    """Workers of runs that go on: five kills a run."""
    told = Count()
    number = 0
    while told.kills < count and number < count:
        number += 1
        out = study.folder / f"workers-{number}"
        with _told(told, f"workers {number}"):
            with study.started(out) as run:
                for _ in range(min(5, count - told.kills)):
                    while run.driver.poll() is None and not run.workers():
                        time.sleep(0.01)
                    time.sleep(draw.random() * 0.5)
                    workers = run.workers()
                    if run.driver.poll() is None and workers:
                        with contextlib.suppress(ProcessLookupError):
                            os.kill(draw.choice(workers), signal.SIGKILL)
                            told.kills += 1
                code = run.wait()
                told.orphans_s.append(run.gone_after())
            if code not in (0, CRASHED):
                raise FaultError(f"exit code {code}: {run.said()[-600:]}")
            if code == CRASHED:
                told.again += 1
                study.run_to_the_end(out)
            study.check(out)
    return told


def kill_schedulers(study: Study, count: int, draw: random.Random) -> Count:
    """With its workers, as when a cluster is taken down. Every second time another one comes in its place, and the run must find it."""
    told = Count()
    for number in range(1, count + 1):
        out, folder = study.folder / f"scheduler-{number}", study.folder / f"cluster-{number}"
        folder.mkdir()
        cluster = Cluster(folder)
        another_comes = number % 2 == 0
        options = ("--engine", "dask", "--scheduler", cluster.file)
        with _told(told, f"scheduler {number}"):
            try:
                cluster.start()
                with study.started(out, *options, reconnect_s=60.0 if another_comes else 1.0) as run:
                    run.wait_until(moment(draw, 1.5 * study.takes_s))
                    cluster.kill()
                    told.kills += 1
                    if another_comes:
                        cluster.start()
                    code = run.wait()
                    told.orphans_s.append(run.gone_after())
                if code not in (0, INTERRUPTED, BAD_INPUT) or (code == INTERRUPTED and "To go on:\n  testbed run" not in run.said()):
                    raise FaultError(f"exit code {code}: {run.said()[-600:]}")
                if code:
                    if not another_comes:
                        cluster.start()
                    study.run_to_the_end(out, *options)
                    told.resumed += 1
                if b'"crashed"' in (out / "rows.jsonl").read_bytes():
                    raise FaultError("a flight that was lost with its scheduler is a crashed row")
                study.check(out)
            finally:
                cluster.kill()
    return told


@contextlib.contextmanager
def _told(told: Count, what: str) -> Iterator[None]:
    try:
        yield
    except FaultError as fault:
        told.faults.append(f"{what}: {fault}")
        print(f"FAULT {told.faults[-1]}", flush=True)
    print(f"  {what}: {told}", flush=True)


KINDS: dict[str, tuple[Callable[[Study, int, random.Random], Count], int]] = {
    "drivers": (kill_drivers, 10),
    "workers": (kill_workers, 50),
    "schedulers": (kill_schedulers, 25),
}
"""What is killed, and replicates of the campaign: a run must last long enough to be hit."""


def kill(kind: str, count: int, seed: int, folder: Path) -> Count:
    """Kill so many of a kind."""
    killer, replicates = KINDS[kind]
    folder.mkdir()
    return killer(Study(folder, replicates), count, random.Random(seed))


def one_of_each(seed: int, folder: Path, kinds: Iterable[str]) -> dict[str, Count]:
    """One kill of each kind, of runs of the same study."""
    study, draw = Study(folder, 12), random.Random(seed)
    return {kind: KINDS[kind][0](study, 1, draw) for kind in kinds}


def main() -> None:
    """Kill as many of each kind as is asked for, and say how it went."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for kind, default in (("drivers", 100), ("workers", 50), ("schedulers", 20)):
        parser.add_argument(f"--{kind}", type=int, default=default)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="kills-"))
    faults = 0
    for kind in KINDS:
        if getattr(asked, kind):
            start = time.monotonic()
            told = kill(kind, getattr(asked, kind), asked.seed, folder / kind)
            faults += len(told.faults)
            print(f"{kind}: {told} ({time.monotonic() - start:.0f} s)", flush=True)
    print(f"seed {asked.seed}; runs are in {folder}")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
