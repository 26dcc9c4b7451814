"""The life of a worker process: wait for a call, answer it, and end when the driver does, however early or late that is.

This file imports only what costs nothing, because until it is imported nobody in a new worker watches whether the driver still lives.
"""

import contextlib
import os
import pickle
import signal
import socket
import struct
import sys
import threading
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing import parent_process
from pathlib import Path
from typing import Any, TypeVar

from testbed.core.utf8 import reason

Item = TypeVar("Item")
Result = TypeVar("Result")

LENGTH = struct.Struct("<Q")
"""What goes before a message: its length in bytes."""

CALL = struct.Struct("<q")
"""The head of a call: its number. The item follows, pickled."""

ANSWER = struct.Struct("<qd?")
"""The head of an answer: number of the call, seconds it took, and whether the worker should be replaced soon."""

MOST_BYTES = 64 * 2**20
"""The largest message. A flight's row has some kilobytes, with the curves of a page some hundred."""

GROWN_BYTES, GROWN_THREADS = 256 * 2**20, 400
"""A worker that has grown by so much is replaced: each recording leaves two threads and 0.5-2 MB behind in its process."""

LINE_LOST = 77
"""Exit code of a worker that cannot answer any more: a flight closed what it speaks through."""

_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG of <linux/prctl.h>


@dataclass(frozen=True)
class Died:
    """No result: the call raised, its worker died on it, or it had to be ended."""

    reason: str
    details: str = ""


def attempt(fn: Callable[[Item], Result], item: Item) -> Result | Died:
    """``fn(item)``; an exception is a ``Died``."""
    try:
        return fn(item)
    except Exception as bug:
        return _died_of(bug)


def _died_of(bug: BaseException) -> Died:
    return Died(reason(bug), traceback.format_exc()[-MOST_BYTES // 64 :])


def work(line: socket.socket, driver: int) -> None:
    """Answer the calls that come over the line. ``driver``: the process that started this one."""
    _end_with_the_driver(driver)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # where it could not be blocked from the start
    os.dup2(2, 1)  # stdout belongs to the driver, even from C++
    try:
        fn: Callable[[Any], Any] = pickle.loads(receive(line))
        _send(line, b"")  # ready
        first = None
        while True:
            call = receive(line)
            (number,) = CALL.unpack_from(call)
            start = time.perf_counter()
            answer = _answer(lambda item: fn(pickle.loads(item)), call[CALL.size :])
            first = first or _size()  # after a call: what a flight needs to be loaded at all is no growth
            _send(line, ANSWER.pack(number, time.perf_counter() - start, _has_grown(first)) + answer)
    except (EOFError, ConnectionError):
        return  # the driver is done, perhaps before this worker had started
    except OSError:
        os._exit(LINE_LOST)


def _end_with_the_driver(driver: int) -> None:
    """Nothing ends a worker when its driver is killed unless somebody watches.

    Linux does so itself, even for a worker that is stopped or deep in foreign code. Elsewhere a thread does, as well as it can.
    """
    if sys.platform == "linux":
        with contextlib.suppress(OSError, AttributeError, ImportError):
            import ctypes

            ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)
        if os.getppid() != driver:  # it was gone before Linux was told
            os._exit(1)
    threading.Thread(target=_watch, daemon=True).start()


def _watch() -> None:
    driver = parent_process()
    assert driver is not None
    driver.join()
    os._exit(1)


def _answer(fn: Callable[[Any], Any], item: Any) -> bytes:
    """The pickled result; one that cannot be pickled, or is too large to send, is a ``Died``."""
    try:
        answer = pickle.dumps(attempt(fn, item))
    except BaseException as bug:  # there is no Ctrl-C here, and nobody above to hear of it
        return pickle.dumps(_died_of(bug))
    if len(answer) + ANSWER.size > MOST_BYTES:
        return pickle.dumps(Died(f"its result has {len(answer) / 2**20:.0f} MB; at most {MOST_BYTES / 2**20:.0f} MB can be sent"))
    return answer


def _send(line: socket.socket, message: bytes) -> None:
    line.sendall(LENGTH.pack(len(message)) + message)


def receive(line: socket.socket) -> bytes:
    """The next message, waited for. Raises ``EOFError`` at the end of the line."""
    (length,) = LENGTH.unpack(_exactly(line, LENGTH.size))
    return _exactly(line, length)


def _exactly(line: socket.socket, count: int) -> bytes:
    parts = []
    while count:
        part = line.recv(min(count, 2**20))
        if not part:
            raise EOFError
        parts.append(part)
        count -= len(part)
    return b"".join(parts)


def _size() -> tuple[int, int]:
    """Bytes of memory and number of threads of this process; zeros where the system does not tell."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE"), len(os.listdir("/proc/self/task"))
    except (OSError, ValueError, AttributeError):
        return 0, 0


def _has_grown(first: tuple[int, int]) -> bool:
    memory, threads = _size()
    return memory - first[0] > GROWN_BYTES or threads - first[1] > GROWN_THREADS
