import contextlib
import importlib.util
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from testbed.run import dask_engine, identity
from testbed.run.dask_engine import DaskEngine
from testbed.run.engines import Died, EngineError
from tests.run import fakes

pytestmark = pytest.mark.slow

needs_dask = pytest.mark.skipif(importlib.util.find_spec("distributed") is None, reason="the extra 'dask' is not installed")
ROOT = Path(__file__).parents[2]


@pytest.fixture
def cluster(tmp_path):
    with started_cluster(tmp_path, ROOT) as started:
        yield started


@contextlib.contextmanager
def started_cluster(tmp_path, code):
    """A scheduler and two workers on loopback, started as a user starts them; yields (address, worker processes).

    ``code``: the folder in which they find the project before anywhere else.
    """
    address_file = tmp_path / "scheduler.json"
    dask = (
        [sys.executable, "-W", "ignore", "-m", "distributed.cli.dask_scheduler"],
        [sys.executable, "-W", "ignore", "-m", "distributed.cli.dask_worker"],
    )
    environment = os.environ | {"PYTHONPATH": str(code)}
    with (tmp_path / "log").open("w") as log:
        common = {"stdout": log, "stderr": log, "stdin": subprocess.DEVNULL, "cwd": tmp_path, "env": environment}
        where = ["--scheduler-file", str(address_file)]
        scheduler = subprocess.Popen([*dask[0], *where, "--host", "127.0.0.1", "--port", "0", "--no-dashboard"], **common)
        workers = [
            subprocess.Popen([*dask[1], *where, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1"], **common)
            for _ in range(2)
        ]
        end = time.monotonic() + 30
        while not address_file.exists() and time.monotonic() < end:
            time.sleep(0.05)
        yield str(address_file), workers
        for process in [*workers, scheduler]:
            process.kill()
            process.wait()


def results(engine, fn, items):
    out = dict(engine.imap(fn, items))
    assert sorted(out) == list(range(len(items)))
    return [out[n] for n in range(len(items))]


def test_without_the_package_the_message_says_what_to_install(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: None)
    with pytest.raises(EngineError, match=r"pip install 'vosc-testbed\[dask\]'"):
        DaskEngine(2)


@needs_dask
def test_a_cluster_of_this_machine_answers_every_item_and_isolates_faults():
    assert results(DaskEngine(2, chunk=3), fakes.square, list(range(40))) == [x * x for x in range(40)]
    out = results(DaskEngine(1, chunk=3), fakes.raises_on_3, list(range(8)))
    assert out[:3] + out[4:] == [0, 1, 2, 4, 5, 6, 7]
    assert out[3].reason == "ValueError: three is too much"


@needs_dask
def test_a_call_that_kills_its_worker_costs_one_item_only():
    out = results(DaskEngine(2, chunk=3), fakes.dies_on_3, list(range(12)))
    assert out[:3] + out[4:] == [0, 1, 2, *range(4, 12)]
    assert isinstance(out[3], Died)


@needs_dask
def test_a_killed_worker_of_a_cluster_costs_nothing(cluster):
    address, workers = cluster
    out = {}
    for number, result in DaskEngine(0, address, chunk=2).imap(fakes.slow_square, list(range(60))):
        out[number] = result
        if len(out) == 10:
            workers[0].kill()
    assert out == {x: x * x for x in range(60)}


@needs_dask
def test_workers_with_other_versions_are_refused(cluster, monkeypatch):
    ours = identity.versions()
    monkeypatch.setattr(identity, "versions", lambda: ours | {"numpy": "0.1"})
    with pytest.raises(EngineError, match=r'versions\.numpy: ".*" there, "0\.1" now'):
        results(DaskEngine(0, cluster[0]), fakes.square, [1])


@needs_dask
def test_a_scheduler_that_does_not_answer_is_bad_input(monkeypatch):
    monkeypatch.setattr(dask_engine, "PATIENCE_S", 1)
    with pytest.raises(EngineError, match="no Dask cluster with workers at"):
        results(DaskEngine(0, "tcp://127.0.0.1:9"), fakes.square, [1])
