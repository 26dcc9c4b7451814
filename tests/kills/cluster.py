"""A Dask scheduler and its workers on loopback, started as a user starts them, and ended in every way."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]


class Cluster:
    """``code``: the folder in which the workers find the project before anywhere else."""

    def __init__(self, folder: Path, code: Path = ROOT, workers: int = 2, worker_ttl: str = "10 s"):
        self.file = str(folder / "scheduler.json")
        self.workers: list[subprocess.Popen] = []
        self._scheduler: subprocess.Popen | None = None
        self._folder, self._count = folder, workers
        self._environment = os.environ | {"PYTHONPATH": str(code), "DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL": worker_ttl}

    def start(self) -> None:
        """Both, with a new scheduler file."""
        Path(self.file).unlink(missing_ok=True)
        self._scheduler = self._started("dask_scheduler", "--port", "0")
        self.start_workers()
        end = time.monotonic() + 60
        while not Path(self.file).exists() and time.monotonic() < end:
            time.sleep(0.05)

    def start_workers(self) -> None:
        self.workers = [self._started("dask_worker", "--nthreads", "1", "--no-nanny") for _ in range(self._count)]

    def end_scheduler(self, how: str = "kill") -> None:
        """Kill it, or stop it: then it holds its connections and says nothing."""
        assert self._scheduler is not None
        self._scheduler.send_signal(signal.SIGSTOP if how == "stop" else signal.SIGKILL)

    def stop_a_worker(self) -> None:
        self.workers[0].send_signal(signal.SIGSTOP)

    def kill_workers(self) -> None:
        _kill(self.workers)

    def kill(self) -> None:
        """All of it."""
        _kill([*self.workers, *([self._scheduler] if self._scheduler else [])])

    def _started(self, what: str, *options: str) -> subprocess.Popen:
        command = [sys.executable, "-W", "ignore", "-m", f"distributed.cli.{what}", "--scheduler-file", self.file]
        with (self._folder / "cluster.log").open("a") as log:
            return subprocess.Popen(
                [*command, "--host", "127.0.0.1", "--no-dashboard", *options],
                stdout=log,
                stderr=log,
                stdin=subprocess.DEVNULL,
                cwd=self._folder,
                env=self._environment,
            )


def _kill(processes: list[subprocess.Popen]) -> None:
    for process in processes:
        process.kill()
    for process in processes:
        process.wait()
