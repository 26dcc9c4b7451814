"""Processes that try cases, watched from outside: one that dies, hangs or eats memory costs its case and nothing else."""

import contextlib
import multiprocessing
import os
import re
import resource
import time
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path

from testbed.run.processes import environment_of_workers

RSS_MB = 500
"""More than this held at once is a finding."""

ADDRESS_SPACE_MB = 4000
"""And more than this asked for is refused by the system: libraries reserve what they never touch, so it is not the same limit."""

CASES_PER_WORKER = 400

CPU_S = {"yaml": 5.0, "set": 5.0, "flown": 60.0, "aircraft": 60.0}
"""Processor time that a case may take: what a busy machine does to the clock on the wall is not the case's fault."""

WALL_S = 20.0
"""A case that neither ends nor works for so long, beyond its processor time, is stuck."""

Item = tuple[str, int, int]
"""Kind, seed, number."""


@dataclass(frozen=True)
class Tried:
    """What became of a case."""

    item: Item
    came_to: str
    faults: tuple[str, ...]
    cpu_s: float = 0.0
    rss_mb: float = 0.0


@dataclass
class _Hand:
    process: BaseProcess
    pipe: Connection
    folder: Path
    item: Item | None = None
    began_s: float = 0.0
    cpu_began_s: float = 0.0
    done: int = 0
    ready: bool = field(default=False)


def tried(items: Sequence[Item], folder: Path, size: int) -> Iterator[Tried]:
    """Each case, as it ends, by ``size`` processes that work below ``folder``."""
    todo = list(reversed(items))
    hands: list[_Hand] = []
    try:
        while todo or any(hand.item for hand in hands):
            while todo and len(hands) < size:
                hands.append(_hire(folder / f"worker-{len(hands)}-{len(todo)}"))
            for pipe in wait([hand.pipe for hand in hands], timeout=0.5):
                hand = next(one for one in hands if one.pipe is pipe)
                yield from _hear(hand, hands)
            for hand in [one for one in hands if one.ready and not one.item]:
                if not todo or hand.done >= CASES_PER_WORKER:
                    _dismiss(hand, hands)
                else:
                    _give(hand, todo.pop())
            for hand in [one for one in hands if one.item]:
                if how := _over(hand):
                    item = hand.item
                    _dismiss(hand, hands)
                    assert item is not None
                    yield Tried(item, "", (how,))
    finally:
        for hand in list(hands):
            _dismiss(hand, hands)


def _hear(hand: _Hand, hands: list[_Hand]) -> Iterator[Tried]:
    try:
        said = hand.pipe.recv()
    except (EOFError, OSError):
        hand.process.join(10)
        code, item = hand.process.exitcode, hand.item
        _dismiss(hand, hands)
        if item is None:
            raise RuntimeError(f"a worker of the fuzzer ended with {code} before it began") from None
        yield Tried(item, "", (f"the process ended with {code}",))
        return
    if said is None:
        hand.ready = True
        return
    came_to, faults, cpu_s, rss_mb, grown_mb = said
    item, hand.item = hand.item, None
    hand.done += 1
    assert item is not None
    if rss_mb > RSS_MB:
        if hand.done > 1 and grown_mb < 0.5 * RSS_MB:
            hand.done = CASES_PER_WORKER  # what many cases left behind is not this one's
        else:
            faults = [*faults, f"{rss_mb:.0f} MB of memory"]
            hand.done = CASES_PER_WORKER
    yield Tried(item, came_to, tuple(dict.fromkeys(faults)), cpu_s, rss_mb)


def _give(hand: _Hand, item: Item) -> None:
    hand.item, hand.began_s, hand.cpu_began_s = item, time.monotonic(), _cpu_s(hand.process.pid)
    with contextlib.suppress(OSError):  # it is dead; the end of its pipe will tell
        hand.pipe.send(item)


def _over(hand: _Hand) -> str:
    """Why the case of a worker is at its end, if it is."""
    assert hand.item is not None
    allowed_s = CPU_S[hand.item[0]]
    used_s, waited_s = _cpu_s(hand.process.pid) - hand.cpu_began_s, time.monotonic() - hand.began_s
    if used_s > allowed_s:
        return f"more than {allowed_s:g} s of processor time"
    if waited_s > WALL_S + 20.0 * allowed_s or (waited_s > WALL_S and used_s < 0.01 * waited_s):
        return f"hangs: {used_s:.1f} s of processor time in {waited_s:.0f} s"
    return ""


def _cpu_s(pid: int | None) -> float:
    try:
        words = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def _hire(folder: Path) -> _Hand:
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_work, args=(theirs, folder), daemon=True)
    with environment_of_workers():
        process.start()
    theirs.close()
    return _Hand(process, ours, folder)


def _dismiss(hand: _Hand, hands: list[_Hand]) -> None:
    hands.remove(hand)
    hand.pipe.close()
    hand.process.kill()
    hand.process.join()


def _work(pipe: Connection, folder: Path) -> None:
    from tests.fuzz.cases import attempt

    warnings.simplefilter("ignore")
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE_MB * 2**20,) * 2)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    quiet = os.open(os.devnull, os.O_WRONLY)
    os.dup2(quiet, 1)  # JSBSim talks
    os.dup2(quiet, 2)
    pipe.send(None)
    while True:
        try:
            item = pipe.recv()
        except EOFError:
            return
        before_mb, began_s = _rss_mb(), time.process_time()
        came_to, faults = attempt(*item, folder)
        pipe.send((came_to, faults, time.process_time() - began_s, _rss_mb(), _rss_mb() - before_mb))


def _rss_mb() -> float:
    """The most that this process has held. Not ``ru_maxrss``: that begins with what the process held that started it."""
    told = Path("/proc/self/status").read_text() if Path("/proc/self/status").exists() else ""
    found = re.search(r"VmHWM:\s+(\d+) kB", told)
    return int(found[1]) / 1024 if found else resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
