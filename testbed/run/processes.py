"""Processes for workers: how they are started, what they inherit, and what the system tells of them."""

import contextlib
import multiprocessing
import multiprocessing.process
import os
import signal
import socket
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from multiprocessing import resource_tracker
from multiprocessing.process import BaseProcess
from pathlib import Path
from types import ModuleType
from typing import Any

from testbed.core import one_thread
from testbed.run import worker
from testbed.run.worker import LINE_LOST


def usable_cores() -> int:
    """Cores that this process may use, which can be fewer than the machine has, where the system tells."""
    if sys.version_info >= (3, 13):
        return os.process_cpu_count() or 1
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@cache
def keeper(_pid: int) -> ThreadPoolExecutor:
    """The thread that starts processes and lives as long as this process: to Linux a worker's parent is a thread, and ends with it."""
    return ThreadPoolExecutor(1, "starts-workers")


def start(line: socket.socket, fn: bytes) -> BaseProcess:
    """A process that works for this one over the line. ``fn``: what it will be told to call, pickled."""
    process = multiprocessing.get_context("spawn").Process(target=worker.work, args=(line, os.getpid()), daemon=True)
    with environment_of_workers(), _main_hidden(unless=b"__main__" in fn), _may_have_children():
        process.start()
    return process


@contextlib.contextmanager
def _main_hidden(unless: bool) -> Iterator[None]:
    """A worker would first run the script that started the driver: time lost, and an endless loop where it has no main guard."""
    main = sys.modules["__main__"]
    if not unless:
        sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


@contextlib.contextmanager
def _may_have_children() -> Iterator[None]:
    """A Dask worker is the daemon of its nanny, and daemons are not allowed processes of their own; ours end with it."""
    config: dict[str, Any] = getattr(multiprocessing.process.current_process(), "_config", {})
    daemon = config.pop("daemon", None)
    try:
        yield
    finally:
        if daemon is not None:
            config["daemon"] = daemon


def how_it_ended(process: BaseProcess) -> str:
    """Of a process that is dead, as the end of a sentence about it."""
    code = process.exitcode or 0
    if code == LINE_LOST:
        return "closed its line to the driver"
    if code >= 0:
        return f"ended with exit code {code}"
    return f"was killed by {signal.Signals(-code).name}" if -code in set(signal.Signals) else f"was killed by signal {-code}"


def processor_s(process: BaseProcess) -> float:
    """Processor seconds of a process so far; 0 where the system does not tell."""
    try:
        fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    except (OSError, ValueError, IndexError, AttributeError):
        return 0.0


@contextlib.contextmanager
def environment_of_workers() -> Iterator[None]:
    """What a process started inside inherits: one thread for linear algebra, and no Ctrl-C (the driver's alone to handle)."""
    before = {name: os.environ.get(name) for name in one_thread.SETTINGS}
    os.environ.update(one_thread.SETTINGS)
    try:
        with _ctrl_c_blocked():
            yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextlib.contextmanager
def _ctrl_c_blocked() -> Iterator[None]:
    """Processes that are started inside begin deaf to Ctrl-C, where a system can block signals; on Windows see ``worker.work``."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # now, because starting it later would unblock Ctrl-C again
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
