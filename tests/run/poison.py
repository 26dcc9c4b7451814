"""Flights that do to their process whatever a flight must never do. This file imports little, so that its workers start at once."""

import contextlib
import ctypes
import os
import re
import resource
import signal
import socket
import stat
import struct
import sys
import threading
import time
from pathlib import Path

LONG_S = 600
"""Longer than any test waits: what sleeps so long, hangs."""


def square(x):
    return x * x


def segfault():
    ctypes.string_at(0)


def kill():
    os.kill(os.getpid(), signal.SIGKILL)


def leave():
    os._exit(7)


def leave_politely():
    sys.exit(3)


def ctrl_c():
    raise KeyboardInterrupt


def memory():
    """Of a limit, so that the machine need not run out of it."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    now = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (now + 2**27, before[1]))
    hoard = []
    try:
        while True:
            hoard.append(bytearray(2**25))
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


def recursion():
    return recursion()


def spin():
    while True:
        pass


def spin_in_c():
    """Python's lock is never let go of, so that no thread of this process gets a word in."""
    return re.match(r"(a+)+$", "a" * 60 + "b")


def hang():
    time.sleep(LONG_S)


def deadlock():
    lock = threading.Lock()
    lock.acquire()
    lock.acquire()


def stop():
    os.kill(os.getpid(), signal.SIGSTOP)


def _lines():
    """The sockets of this process: the line to the driver is one of them."""
    for fd in range(3, 256):
        with contextlib.suppress(OSError):
            if stat.S_ISSOCK(os.fstat(fd).st_mode):
                yield fd


def stop_in_the_middle_of_a_message():
    for fd in _lines():
        os.write(fd, struct.pack("<Q", 1000) + b"the first of it")
    stop()


def rubbish():
    for fd in _lines():
        os.write(fd, b"\xff" * 64)
    time.sleep(LONG_S)


def false_answer():
    for fd in _lines():
        os.write(fd, struct.pack("<Q", 30) + b"\x00" * 30)
    time.sleep(LONG_S)


def hang_up():
    for fd in _lines():
        socket.socket(fileno=fd).shutdown(socket.SHUT_RDWR)
    time.sleep(LONG_S)


def close_all():
    os.closerange(3, 256)


def close_all_and_hang():
    os.closerange(0, 256)
    time.sleep(LONG_S)


def leave_a_child():
    """Which holds the line open when its parent is gone."""
    if os.fork():
        os._exit(5)
    time.sleep(8)
    os._exit(0)


def giant():
    return bytes(70 * 2**20)


def unpicklable():
    return lambda: 0


class _Unreadable:
    def __reduce__(self):
        return int, ("no number",)


def unreadable():
    return _Unreadable()


class _WordlessError(Exception):
    def __str__(self):
        raise ValueError("and this one cannot even be told")


def wordless():
    raise _WordlessError


TWICE = "the worker process {}, twice"
TOO_LONG = "ended after 2 s of wall-clock time"
NO_LINE = TWICE.format("closed its line to the driver")

KINDS = {
    "segfault": TWICE.format("was killed by SIGSEGV"),
    "abort": TWICE.format("was killed by SIGABRT"),
    "kill": TWICE.format("was killed by SIGKILL"),
    "leave": TWICE.format("ended with exit code 7"),
    "leave_politely": "SystemExit: 3",
    "ctrl_c": "KeyboardInterrupt: ",
    "memory": "MemoryError: ",
    "recursion": "RecursionError: maximum recursion depth exceeded",
    "spin": TOO_LONG,
    "spin_in_c": TOO_LONG,
    "hang": TOO_LONG,
    "deadlock": TOO_LONG,
    "stop": TOO_LONG,
    "stop_in_the_middle_of_a_message": TOO_LONG,
    "rubbish": TWICE.format("sent what is no answer"),
    "false_answer": TWICE.format("sent what is no answer"),
    "hang_up": NO_LINE,
    "close_all": NO_LINE,
    "close_all_and_hang": "the worker process ",
    "leave_a_child": TWICE.format("ended with exit code 5"),
    "giant": "its result has 70 MB; at most 64 MB can be sent",
    "unpicklable": "Can't pickle local object",
    "unreadable": "its result cannot be read: ValueError",
    "wordless": "_WordlessError: its text cannot be read (ValueError)",
}
"""Each poison, and what its row says."""


def abort():
    os.abort()


def fly(item):
    """A number is squared; a word is done."""
    return globals()[item]() if isinstance(item, str) else item * item
