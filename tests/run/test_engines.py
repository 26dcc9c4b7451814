import multiprocessing
import multiprocessing.resource_tracker
import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from testbed.run.engines import Died, EngineError, LocalEngine, _work, usable_cores
from tests.run import fakes

pytestmark = pytest.mark.slow  # every test spawns processes


def results(engine, fn, items):
    out = dict(engine.imap(fn, items))
    assert sorted(out) == list(range(len(items))), "every item is answered exactly once"
    return [out[n] for n in range(len(items))]


def alive(pid):
    try:
        with open(f"/proc/{pid}/stat") as stat:
            return stat.read().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def wait_until(condition, seconds=20):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.02)
    return False


@pytest.mark.parametrize("workers", [1, 3])
def test_every_item_is_answered(workers):
    assert results(LocalEngine(workers), fakes.square, list(range(40))) == [x * x for x in range(40)]


def test_items_are_pulled_as_workers_get_free_and_not_all_at_once():
    pulled, ahead = [], []
    items = (pulled.append(k) or k for k in range(60))
    for count, (number, result) in enumerate(LocalEngine(2).imap(fakes.dies_on_3, items), 1):
        ahead.append(len(pulled) - count)
        assert isinstance(result, Died) if number == 3 else result == number
    assert len(ahead) == 60
    assert max(ahead) <= 8  # two workers with two calls each, three that are seen coming, and the one that is to be tried again


def test_no_items_need_no_worker():
    assert results(LocalEngine(2), fakes.square, []) == []


def test_the_work_is_shared_and_workers_are_replaced():
    assert len(set(results(LocalEngine(2), fakes.slow_square, list(range(2))))) == 2
    pids = results(LocalEngine(1, calls_per_worker=4), fakes.pid, list(range(10)))
    assert [pids.count(pid) for pid in dict.fromkeys(pids)] == [4, 4, 2]


def test_what_leaves_little_behind_wears_a_worker_little():
    items = [fakes.Worn(1.0 if k % 4 == 0 else 0.0) for k in range(12)]
    pids = results(LocalEngine(1, calls_per_worker=2), fakes.pid, items)
    assert [pids.count(pid) for pid in dict.fromkeys(pids)] == [5, 7]  # with the call that wears it out, the second of those that do


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="this system cannot give a process fewer cores")
def test_cores_that_a_process_may_not_use_do_not_count():
    alone = "import os; os.sched_setaffinity(0, {min(os.sched_getaffinity(0))}); from testbed.run.engines import usable_cores as cores"
    assert subprocess.run([sys.executable, "-c", f"{alone}; print(cores())"], capture_output=True, text=True, check=True).stdout == "1\n"


def test_where_the_system_does_not_tell_all_cores_count(monkeypatch):
    for teller in ("sched_getaffinity", "process_cpu_count"):
        monkeypatch.delattr(os, teller, raising=False)
    monkeypatch.setattr(sys, "version_info", (3, 12))
    assert usable_cores() == os.cpu_count()


def test_where_signals_cannot_be_blocked_workers_ignore_ctrl_c(monkeypatch):
    multiprocessing.resource_tracker.ensure_running()  # which would miss what is taken away here
    monkeypatch.delattr(signal, "pthread_sigmask")
    assert results(LocalEngine(1), fakes.ignores_ctrl_c, [0]) == [True]


def test_workers_use_one_thread_and_the_driver_keeps_its_own_settings(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    assert results(LocalEngine(1), fakes.threads, [0]) == [("1", "1")]
    assert os.environ["OMP_NUM_THREADS"] == "2"
    assert "OPENBLAS_NUM_THREADS" not in os.environ


def test_stdout_stays_the_drivers(capfd):
    assert results(LocalEngine(1), fakes.chatter, [1]) == [1]
    out, err = capfd.readouterr()
    assert out == ""
    assert "noise from below" in err


def test_an_exception_costs_one_item_only():
    out = results(LocalEngine(2), fakes.raises_on_3, list(range(8)))
    assert out[:3] + out[4:] == [0, 1, 2, 4, 5, 6, 7]
    assert out[3].reason == "ValueError: three is too much"
    assert "raises_on_3" in out[3].details


def test_a_result_that_cannot_travel_costs_one_item_only():
    out = results(LocalEngine(1), fakes.unpicklable_on_3, list(range(6)))
    assert out[:3] + out[4:] == [0, 1, 2, 4, 5]
    assert isinstance(out[3], Died)


@pytest.mark.parametrize(("fn", "how"), [(fakes.dies_on_3, "was killed by SIGKILL"), (fakes.exits_on_3, "ended with exit code 7")])
@pytest.mark.parametrize("workers", [1, 2])
def test_a_call_that_kills_its_worker_costs_one_item_only(fn, how, workers):
    out = results(LocalEngine(workers), fn, list(range(20)))
    assert out[:3] + out[4:] == [*range(3), *range(4, 20)]
    assert out[3] == Died(f"the worker process {how}, twice")


def test_a_call_whose_worker_died_once_is_called_again(tmp_path):
    items = [(tmp_path / "died", x) for x in range(6)]
    assert results(LocalEngine(2), fakes.dies_once, items) == list(range(6))
    assert (tmp_path / "died").exists()


def test_a_worker_killed_from_outside_costs_nothing():
    def items_with_a_killing():
        for number, result in LocalEngine(1).imap(fakes.slow_square, list(range(10))):
            if number == 2:
                (worker,) = multiprocessing.active_children()
                worker.kill()
            yield number, result

    assert dict(items_with_a_killing()) == {x: x * x for x in range(10)}


def test_leaving_early_ends_the_workers(tmp_path):
    outcome = LocalEngine(2).imap(fakes.sleeps, [(tmp_path, x) for x in range(2)])
    thread = threading.Thread(
        target=lambda: wait_until(lambda: len(list(tmp_path.iterdir())) == 2, 60) and os.kill(os.getpid(), signal.SIGINT)
    )
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        next(outcome)
    thread.join()
    pids = [int(path.name) for path in tmp_path.iterdir()]
    assert len(pids) == 2
    assert not any(map(alive, pids))


def test_a_worker_that_starts_when_all_is_done_ends_in_silence(capfd):
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    worker = context.Process(target=_work, args=(theirs, fakes.square))
    worker.start()
    ours.close()
    theirs.close()
    worker.join(60)
    assert (worker.exitcode, capfd.readouterr().err) == (0, "")


def test_workers_that_cannot_start_are_an_error_not_an_endless_loop(tmp_path, monkeypatch, capfd):
    (tmp_path / "only_here.py").write_text("import os\nif os.environ.get('BREAK'): raise SystemExit(5)\ndef f(x): return x\n")
    monkeypatch.syspath_prepend(tmp_path)
    from only_here import f  # type: ignore[import-not-found]

    monkeypatch.setenv("BREAK", "1")
    with pytest.raises(EngineError, match=r"3 worker processes in a row .* exit code 5"):
        results(LocalEngine(1), f, [1, 2])
    capfd.readouterr()


def test_a_killed_driver_leaves_no_worker(tmp_path):
    pids, script = tmp_path / "pids", tmp_path / "driver.py"
    pids.mkdir()
    script.write_text(
        "import pathlib, sys\nfrom testbed.run.engines import LocalEngine\nfrom tests.run import fakes\n"
        "if __name__ == '__main__':\n    list(LocalEngine(2).imap(fakes.sleeps, [(pathlib.Path(sys.argv[1]), x) for x in range(2)]))\n"
    )
    with (tmp_path / "log").open("w") as log:  # a pipe would stay open in the workers and hide that they live
        driver = subprocess.Popen([sys.executable, script, pids], stdout=log, stderr=log, stdin=subprocess.DEVNULL)
        assert wait_until(lambda: len(list(pids.iterdir())) == 2), (tmp_path / "log").read_text()
        workers = [int(path.name) for path in pids.iterdir()]
        assert all(map(alive, workers))
        driver.kill()
        driver.wait()
    assert wait_until(lambda: not any(map(alive, workers)))


def test_ctrl_c_reaches_no_worker_not_even_the_first_of_a_process(tmp_path):
    script = tmp_path / "driver.py"
    script.write_text(
        "import signal\nfrom testbed.run.engines import LocalEngine\nfrom tests.run import fakes\n"
        "if __name__ == '__main__':\n"
        "    print(dict(LocalEngine(1, calls_per_worker=1).imap(fakes.deaf_to_ctrl_c, [0, 1])))\n"
        "    print(signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, []))\n"
    )
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout == "{0: True, 1: True}\nFalse\n"
