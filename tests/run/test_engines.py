import multiprocessing
import multiprocessing.resource_tracker
import os
import signal
import socket
import subprocess
import sys
import threading
import time

import pytest

from testbed.run import crew
from testbed.run.crew import MOST_AHEAD
from testbed.run.engines import Died, EngineError, LocalEngine, limited, usable_cores
from testbed.run.worker import GROWN_THREADS, work
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
    items = (pulled.append(k) or k for k in range(1000))
    for count, (number, result) in enumerate(LocalEngine(2).imap(fakes.dies_on_3, items), 1):
        ahead.append(len(pulled) - count)
        assert isinstance(result, Died) if number == 3 else result == number
    assert len(ahead) == 1000
    assert max(ahead[:3]) <= 10, "before it is known how small they are"
    assert max(ahead) <= 2 * 2 * (1 + MOST_AHEAD) + 1, "what two workers hold, as much seen coming, and the one to try again"


def test_no_items_need_no_worker():
    assert results(LocalEngine(2), fakes.square, []) == []


def test_the_work_is_shared_and_workers_are_replaced():
    assert len(set(results(LocalEngine(2), fakes.slow_square, list(range(2))))) == 2
    pids = results(LocalEngine(1, calls_per_worker=4), fakes.pid, list(range(10)))
    assert [pids.count(pid) for pid in dict.fromkeys(pids)] == [4, 4, 2]


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
    ours, theirs = socket.socketpair()
    worker = multiprocessing.get_context("spawn").Process(target=work, args=(theirs, os.getpid()))
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


DRIVER = """\
import sys
sys.path.append({folder!r})
import stuck
from testbed.run.engines import LocalEngine
if __name__ == "__main__":
    sys.argv.remove("driver")
    list(LocalEngine(2).imap(stuck.fly, ["a", "b"]))
"""
STUCK = {"while it starts": "imports_slowly", "while it is stopped": "stop", "deep in foreign code": "spin_in_c"}


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere a worker that cannot run a thread of its own lives on")
@pytest.mark.parametrize("when", STUCK)
def test_a_killed_driver_leaves_no_worker_however_early_or_stuck(tmp_path, when):
    """Also when its own thread, which watches the driver, has not begun or cannot run."""
    pids = tmp_path / "pids"
    pids.mkdir()
    mark = f"open({str(pids)!r} + '/' + str(os.getpid()), 'w').close()"
    if when == "while it starts":  # the driver itself must get by the import
        module = f"import os, sys, time\nif 'driver' not in sys.argv:\n    {mark}\n    time.sleep(90)\ndef fly(_): pass\n"
    else:
        module = f"import os\nfrom tests.run import poison\ndef fly(_):\n    {mark}\n    poison.{STUCK[when]}()\n"
    (tmp_path / "stuck.py").write_text(module)
    script = tmp_path / "driver.py"
    script.write_text(DRIVER.format(folder=str(tmp_path)))
    with (tmp_path / "log").open("w") as log:
        driver = subprocess.Popen([sys.executable, script, "driver"], stdout=log, stderr=log, stdin=subprocess.DEVNULL)
        try:
            assert wait_until(lambda: len(list(pids.iterdir())) == 2, 60), (tmp_path / "log").read_text()
        finally:
            driver.kill()
            driver.wait()
    assert wait_until(lambda: not any(alive(int(path.name)) for path in pids.iterdir()), 5)


def run_script(folder, text):
    (folder / "script.py").write_text(text)
    return subprocess.run([sys.executable, folder / "script.py"], capture_output=True, text=True, timeout=120, check=False)


def test_a_script_without_a_main_guard_works_because_workers_do_not_run_it(tmp_path):
    done = run_script(
        tmp_path,
        "from testbed.run.engines import LocalEngine\nfrom tests.run import fakes\n"
        "print('once'); print(sorted(LocalEngine(2).imap(fakes.square, [1, 2, 3])))\n",
    )
    assert (done.stdout, done.returncode) == ("once\n[(0, 1), (1, 4), (2, 9)]\n", 0), done.stderr


def test_a_script_that_gives_a_function_of_its_own_is_told_to_guard_itself(tmp_path):
    text = "from testbed.run.engines import LocalEngine\ndef own(x): return -x\n{guard}print(dict(LocalEngine(1).imap(own, [1, 2])))\n"
    assert run_script(tmp_path, text.format(guard="if __name__ == '__main__': ")).stdout == "{0: -1, 1: -2}\n"
    unguarded = run_script(tmp_path, text.format(guard=""))
    assert unguarded.returncode == 1
    assert 'belongs under: if __name__ == "__main__":' in unguarded.stderr


def test_a_worker_that_has_grown_is_replaced():
    pids = results(LocalEngine(1), fakes.leaves_threads, [0, GROWN_THREADS + 10, 0, 0, 0])
    assert len(set(pids)) == 2
    assert pids[0] == pids[1] != pids[-1]


def test_a_driver_that_was_stopped_has_no_worker_to_blame_for_it(monkeypatch):
    now = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    clock = crew.Clock()
    for step_s in (0.5, 3600.0, 0.5):
        now[0] += step_s
        clock.tick()
    assert clock.now == 0.5 + 4 * crew.BEAT_S + 0.5


def test_the_limit_of_a_campaign_is_given_to_engines_that_can_keep_it():
    assert limited(LocalEngine(3), 7.0) == LocalEngine(3, wall_limit_s=7.0)
    engine = object()
    assert limited(engine, 7.0) is engine


def test_a_worker_that_never_is_ready_is_a_failed_start(monkeypatch):
    monkeypatch.setattr(crew, "START_LIMIT_S", 0.0)
    monkeypatch.setattr(crew, "BEAT_S", 0.01)
    with pytest.raises(EngineError, match=r"3 worker processes in a row .* was not ready after"):
        results(LocalEngine(1), fakes.square, [1])


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
