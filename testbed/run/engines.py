"""Spread independent calls over processes. One interface: ``imap(fn, items)`` yields ``(number of the item, result or Died)``.

The pool is our own because those of the standard library give up on every outstanding call when one worker dies, and cannot
say which call killed it. Here each worker has a pipe of its own and answers in order, so the oldest unanswered call is the suspect.
"""

import contextlib
import multiprocessing
import os
import pickle
import signal
import sys
import threading
import traceback
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass, field
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, Protocol, TypeVar

from testbed.run import main_script

Item = TypeVar("Item")
Result = TypeVar("Result")
Numbered = tuple[int, Any]

AHEAD = 2
"""Calls a worker holds at a time, so that it need not wait for the driver: the one it works on and the next."""

CALLS_PER_WORKER = 250
"""A worker is replaced after so many calls: each recording leaves two threads and 0.5-2 MB behind in the process that wrote it."""

FAILED_STARTS = 3
"""So many workers in a row that die before they are ready are a broken installation, not bad luck."""

_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


class EngineError(Exception):
    """The engine cannot do any work; str() says why."""


@dataclass(frozen=True)
class Died:
    """No result: the call raised, or its worker died on it twice."""

    reason: str
    details: str = ""


class Engine(Protocol):
    """What the runner needs to know of an engine."""

    @property
    def name(self) -> str: ...

    @property
    def workers(self) -> int | None:
        """How many; None if somebody else decides."""
        ...

    def imap(self, fn: Callable[[Item], Result], items: Sequence[Item]) -> Generator[tuple[int, Result | Died], None, None]:
        """Call ``fn`` on each item; results come as they are ready."""
        ...


@dataclass(frozen=True)
class LocalEngine:
    """Spawned processes on this machine, also when it is only one: a crash of a flight must not end the driver."""

    workers: int
    calls_per_worker: int = CALLS_PER_WORKER
    name: str = "local"

    def imap(self, fn: Callable[[Item], Result], items: Sequence[Item]) -> Generator[tuple[int, Result | Died], None, None]:
        """Call ``fn``, which a spawned process must be able to import, on each item."""
        suspects: list[Numbered] = []
        for number, result in _Crew(fn, self.workers, self.calls_per_worker).work_off(deque(enumerate(items))):
            if isinstance(result, _Lost):
                suspects.append((number, items[number]))
            else:
                yield number, result
        for suspect in suspects:  # alone, so that nobody else's memory or bug can be to blame
            for number, result in _Crew(fn, 1, 1).work_off(deque([suspect])):
                yield number, Died(f"the worker process {result.how}, twice") if isinstance(result, _Lost) else result


@dataclass(frozen=True)
class _Lost:
    """The worker died on this call."""

    how: str


@dataclass
class _Hand:
    """A worker, as the driver sees it."""

    process: BaseProcess
    pipe: Connection
    given: int = 0
    ready: bool = False
    outstanding: deque[Numbered] = field(default_factory=deque)


@dataclass
class _Crew:
    """The workers of one queue of calls."""

    fn: Callable[[Any], Any]
    size: int
    calls_per_worker: int
    hands: list[_Hand] = field(default_factory=list)
    failed_starts: int = 0

    def work_off(self, todo: deque[Numbered]) -> Iterator[tuple[int, Any]]:
        """Yield the result, or ``_Lost``, of each call, until the queue is empty."""
        try:
            while todo or any(hand.outstanding for hand in self.hands):
                while len(self.hands) < min(self.size, len(todo) + len(self.hands)):
                    self.hands.append(_hire(self.fn))
                for hand in self.hands:
                    self._feed(hand, todo)
                by_pipe = {id(hand.pipe): hand for hand in self.hands}
                for pipe in wait([hand.pipe for hand in self.hands]):
                    yield from self._hear(by_pipe[id(pipe)], todo)
        finally:
            for hand in list(self.hands):
                self._dismiss(hand)

    def _feed(self, hand: _Hand, todo: deque[Numbered]) -> None:
        """Keep a worker busy, but near the end of the queue leave the calls to whoever is free first."""
        while todo and len(hand.outstanding) < (AHEAD if len(todo) > self.size else 1) and hand.given < self.calls_per_worker:
            hand.outstanding.append(todo.popleft())
            hand.given += 1
            with contextlib.suppress(OSError):  # it is dead; the end of its pipe will tell
                hand.pipe.send(hand.outstanding[-1])

    def _hear(self, hand: _Hand, todo: deque[Numbered]) -> Iterator[tuple[int, Any]]:
        """Take one message of a worker, or notice its end."""
        try:
            message = hand.pipe.recv()
        except (EOFError, OSError):
            yield from self._bury(hand, todo)
            return
        if message is None:
            hand.ready, self.failed_starts = True, 0
            return
        hand.outstanding.popleft()
        if hand.given >= self.calls_per_worker and not hand.outstanding:
            self._dismiss(hand)
        yield message

    def _bury(self, hand: _Hand, todo: deque[Numbered]) -> Iterator[tuple[int, Any]]:
        """The oldest call of a dead worker is lost; the others go back to the front of the queue."""
        hand.process.join(timeout=5)  # its pipe is closed, so it is on its way out: let it say how
        self._dismiss(hand)
        how = _how_it_ended(hand.process)
        lost = 1 if hand.ready else 0
        todo.extendleft(reversed(list(hand.outstanding)[lost:]))
        if not hand.ready:
            self.failed_starts += 1
            if self.failed_starts >= FAILED_STARTS:
                raise EngineError(
                    f"{FAILED_STARTS} worker processes in a row ended before they could start; the last one {how}; {main_script.GUARD}"
                )
        elif hand.outstanding:
            yield hand.outstanding[0][0], _Lost(how)

    def _dismiss(self, hand: _Hand) -> None:
        """End a worker, whatever it is doing. What it has not answered is not wanted of it any more."""
        self.hands.remove(hand)
        hand.pipe.close()
        hand.process.join(timeout=0 if hand.outstanding else 0.2)
        hand.process.kill()
        hand.process.join()


def usable_cores() -> int:
    """Cores that this process may use, which can be fewer than the machine has, where the system tells."""
    if sys.version_info >= (3, 13):
        return os.process_cpu_count() or 1
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _hire(fn: Callable) -> _Hand:
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_work, args=(theirs, fn), daemon=True)
    with environment_of_workers(), main_script.left_out(fn):
        process.start()
    theirs.close()
    return _Hand(process, ours)


def _how_it_ended(process: BaseProcess) -> str:
    code = process.exitcode or 0
    return f"was killed by {signal.Signals(-code).name}" if code < 0 else f"ended with exit code {code}"


@contextlib.contextmanager
def environment_of_workers() -> Iterator[None]:
    """What a process started inside inherits: one thread for linear algebra, and no Ctrl-C (the driver's alone to handle)."""
    before = {name: os.environ.get(name) for name in _ONE_THREAD}
    os.environ.update(_ONE_THREAD)
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
    """Processes that are started inside begin deaf to Ctrl-C, where a system can block signals; on Windows see ``_work``."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # now, because starting it later would unblock Ctrl-C again
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def _work(pipe: Connection, fn: Callable[[Any], Any]) -> None:
    """The life of a worker."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # where it could not be blocked from the start
    threading.Thread(target=_end_with_the_driver, daemon=True).start()
    os.dup2(2, 1)  # stdout belongs to the driver, even from C++
    with contextlib.suppress(EOFError, ConnectionError):  # the driver may be done before this worker has started
        pipe.send(None)
        while True:
            number, item = pipe.recv()
            pipe.send_bytes(_answer(fn, number, item))


def _answer(fn: Callable[[Any], Any], number: int, item: Any) -> bytes:
    """The pickled result; a result that cannot be pickled is a ``Died``."""
    try:
        return pickle.dumps((number, attempt(fn, item)))
    except Exception as bug:
        return pickle.dumps((number, _died_of(bug)))


def attempt(fn: Callable[[Item], Result], item: Item) -> Result | Died:
    """``fn(item)``; an exception is a ``Died``."""
    try:
        return fn(item)
    except Exception as bug:
        return _died_of(bug)


def _died_of(bug: Exception) -> Died:
    return Died(f"{type(bug).__name__}: {bug}", traceback.format_exc())


def _end_with_the_driver() -> None:
    """A spawned worker outlives a driver that was killed unless somebody watches."""
    driver = multiprocessing.parent_process()
    assert driver is not None
    driver.join()
    os._exit(1)
