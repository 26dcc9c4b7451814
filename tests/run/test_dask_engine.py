import collections
import contextlib
import importlib.util
import threading
import time
from pathlib import Path

import pytest

from testbed.run import dask_client, dask_engine, identity
from testbed.run.dask_engine import DaskEngine
from testbed.run.engines import EngineError, EngineLostError
from tests.kills.cluster import Cluster
from tests.run import fakes

pytestmark = pytest.mark.slow

needs_dask = pytest.mark.skipif(importlib.util.find_spec("distributed") is None, reason="the extra 'dask' is not installed")
ROOT = Path(__file__).parents[2]


@pytest.fixture
def cluster(tmp_path):
    with started_cluster(tmp_path, ROOT) as started:
        yield started.file, started.workers


@contextlib.contextmanager
def started_cluster(tmp_path, code):
    """A scheduler and two workers on loopback, started as a user starts them, for as long as the block lasts."""
    cluster = Cluster(tmp_path, code)
    try:
        cluster.start()
        yield cluster
    finally:
        cluster.kill()


def wait_until(condition, seconds=30):
    end = time.monotonic() + seconds
    while not condition() and time.monotonic() < end:
        time.sleep(0.05)
    return condition()


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
    """What kills its worker: test_poison.py."""
    out = results(DaskEngine(2, chunk=3), fakes.raises_on_3, list(range(40)))
    assert out[:3] + out[4:] == [0, 1, 2, *range(4, 40)]
    assert out[3].reason == "ValueError: three is too much"


@needs_dask
def test_workers_with_other_versions_are_refused_and_one_that_is_killed_costs_nothing(cluster, monkeypatch):
    address, workers = cluster
    ours = identity.versions()
    with monkeypatch.context() as other:
        other.setattr(identity, "versions", lambda: ours | {"numpy": "0.1"})
        with pytest.raises(EngineError, match=r'versions\.numpy: ".*" there, "0\.1" now'):
            results(DaskEngine(0, address), fakes.square, [1])
    out = {}
    for number, result in DaskEngine(0, address, chunk=2).imap(fakes.slow_square, list(range(60))):
        out[number] = result
        if len(out) == 10:
            workers[0].kill()
    assert out == {x: x * x for x in range(60)}


@needs_dask
def test_another_scheduler_in_the_place_of_a_lost_one_is_found_and_all_is_answered(tmp_path, capfd):
    with started_cluster(tmp_path, ROOT) as cluster:
        out = {}
        for number, result in DaskEngine(0, cluster.file, chunk=2).imap(fakes.slow_square, list(range(60))):
            out[number] = result
            if len(out) == 10:
                cluster.kill()
                cluster.start()
    assert out == {x: x * x for x in range(60)}
    said = capfd.readouterr().err
    assert "the Dask scheduler at" in said
    assert "a Dask scheduler is there; going on" in said


@needs_dask
@pytest.mark.parametrize("how", ["kill", "stop"])
def test_a_scheduler_that_is_lost_for_good_ends_the_run_with_what_is_kept(tmp_path, monkeypatch, capfd, how):
    monkeypatch.setattr(dask_engine, "RECONNECT_S", 1.0)
    monkeypatch.setattr(dask_client, "PATIENCE_S", 20.0)
    with started_cluster(tmp_path, ROOT) as cluster:
        out, calls = {}, DaskEngine(0, cluster.file, chunk=2).imap(fakes.slow_square, list(range(400)))

        def answer(number, result):
            out[number] = result
            if len(out) == 10:
                monkeypatch.setattr(dask_client, "PATIENCE_S", 2.0)
                cluster.end_scheduler(how)

        with pytest.raises(EngineLostError, match="none came in its place for 1 s"):
            collections.deque((answer(*call) for call in calls), maxlen=0)
    assert 10 <= len(out) < 400
    assert all(result == number * number for number, result in out.items()), "no flight is blamed for it"


@needs_dask
def test_that_there_are_no_workers_is_said_and_new_ones_are_welcome(tmp_path, monkeypatch, capfd):
    monkeypatch.setattr(dask_client, "CENSUS_S", 0.2)
    with started_cluster(tmp_path, ROOT) as cluster:
        out, calls = {}, DaskEngine(0, cluster.file, chunk=2).imap(fakes.slow_square, list(range(60)))
        for number, result in calls:
            out[number] = result
            if len(out) == 10:
                monkeypatch.setattr(dask_client, "PATIENCE_S", 1.0)
                cluster.kill_workers()
                threading.Timer(6.0, cluster.start_workers).start()
        assert out == {x: x * x for x in range(60)}
        said = capfd.readouterr().err
        assert "no Dask workers for" in said
        assert "Dask workers are there again" in said


@needs_dask
def test_a_dask_worker_that_is_stopped_is_told_and_its_flights_are_flown_by_others(tmp_path, monkeypatch, capfd):
    monkeypatch.setattr(dask_client, "CENSUS_S", 0.5)
    with started_cluster(tmp_path, ROOT) as cluster:
        out, calls = {}, DaskEngine(0, cluster.file, chunk=2).imap(fakes.slow_square, list(range(60)))
        for number, result in calls:
            out[number] = result
            if len(out) == 10:
                monkeypatch.setattr(dask_client, "PATIENCE_S", 3.0)
                cluster.stop_a_worker()
    assert out == {x: x * x for x in range(60)}
    assert "no word of the Dask worker tcp://127.0.0.1" in capfd.readouterr().err


@needs_dask
def test_a_scheduler_that_does_not_answer_is_bad_input(monkeypatch):
    monkeypatch.setattr(dask_client, "PATIENCE_S", 1)
    with pytest.raises(EngineError, match="no Dask cluster with workers at"):
        results(DaskEngine(0, "tcp://127.0.0.1:9"), fakes.square, [1])
