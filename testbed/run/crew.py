"""The driver's side of its workers: hire them, feed them, hear them, and end those that die, hang, stop or spin.

The driver waits for no single worker: its wires never block (wire.py), and every wait has an end.
"""

import os
import pickle
import selectors
import socket
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import islice
from multiprocessing.process import BaseProcess
from typing import Any

from testbed.core.utf8 import reason
from testbed.run.processes import how_it_ended, keeper, processor_s, start
from testbed.run.wire import NoMessageError, Wire
from testbed.run.worker import ANSWER, CALL, Died

Numbered = tuple[int, Any]

BEAT_S = 0.25
"""So often workers are looked after that say nothing."""

AHEAD_S, MOST_AHEAD = 0.1, 64
"""Work that a worker holds beside the call it works on, so that it need not wait for the driver: in seconds, and in calls."""

NAP_S = 0.02
"""Answers to small calls are fetched so seldom: each time the driver wakes costs both it and a worker, and the next calls lie ready."""

START_LIMIT_S = 300.0
"""A worker that is not ready after so long has failed to start."""

FAILED_STARTS, KILLED_STARTS = 3, 15
"""So many workers in a row that die before they are ready are a broken installation, not bad luck; more if somebody kills them."""

_SLOW = f"was not ready after {START_LIMIT_S:g} s"


class EngineError(Exception):
    """The engine cannot do any work; str() says why."""


class EngineLostError(EngineError):
    """The engine was lost while it worked; what it answered is kept, and the rest can be done later."""


@dataclass(frozen=True)
class Lost:
    """The worker died on this call, or had to be ended."""

    item: Any
    how: str
    in_time: bool = True
    """False if it was ended because it took too long."""
    had_its_share: bool = False
    """Whether it had the processor for most of that time: then it was the call's own doing."""


class Todo:
    """Calls that wait: those given back come first, then the rest, pulled as they are needed."""

    def __init__(self, calls: Iterable[Numbered]):
        self._rest = iter(calls)
        self._next: deque[Numbered] = deque()

    def ready(self, count: int) -> int:
        """How many of the next ``count`` there are."""
        self._next.extend(islice(self._rest, max(0, count - len(self._next))))
        return min(count, len(self._next))

    def take(self) -> Numbered:
        return self._next.popleft()

    def give_back(self, calls: Iterable[Numbered]) -> None:
        self._next.extendleft(reversed(list(calls)))


@dataclass
class Hand:
    """A worker, as the driver sees it."""

    process: BaseProcess
    wire: Wire
    since: float
    """When it began what it is at: to start, or its oldest call; by the clock of its crew."""
    given: int = 0
    ready: bool = False
    is_spent: bool = False
    outstanding: deque[Numbered] = field(default_factory=deque)
    processor: tuple[int, float] = (-1, 0.0)
    """Number of the call, and processor seconds of the process near its beginning."""


class Clock:
    """Seconds in which the driver was awake: one that was stopped for an hour has no worker to blame for it."""

    def __init__(self) -> None:
        self._seen, self.now = time.monotonic(), 0.0

    def tick(self) -> float:
        seen = time.monotonic()
        self.now += min(seen - self._seen, 4 * BEAT_S)
        self._seen = seen
        return self.now


class Crew:
    """The workers that work off calls of one function. They stay for the next calls until ``dismiss``."""

    def __init__(self, fn: Callable[[Any], Any], size: int, calls_per_worker: int, wall_limit_s: float):
        self.fn, self.size, self.calls_per_worker, self.wall_limit_s = fn, size, calls_per_worker, wall_limit_s
        self._fn = pickle.dumps(fn)
        self._hands: list[Hand] = []
        self._failed_starts = 0
        self._pace_s = BEAT_S  # of a call, so far as is known
        self._clock = Clock()
        self._beat = 0.0

    def work_off(self, calls: Iterable[Numbered]) -> Iterator[tuple[int, Any]]:
        """Yield the result, or ``Lost``, of each call, until there is none left."""
        todo = Todo(calls)
        with selectors.DefaultSelector() as selector:
            while todo.ready(1) or any(hand.outstanding for hand in self._hands):
                while len(self._hands) < min(self.size, len(self._hands) + todo.ready(self.size)):
                    self._hands.append(_hire(self._fn, self._clock.tick()))
                for hand in self._hands:
                    self._feed(hand, todo)
                for hand in self._heard(selector):
                    yield from self._hear(hand, todo)
                if self._clock.tick() - self._beat > BEAT_S:
                    self._beat = self._clock.now
                    for hand in list(self._hands):
                        yield from self._look_after(hand, todo)

    def alike(self, size: int) -> "Crew":
        """Another crew for the same, with a fresh worker for each call."""
        return Crew(self.fn, size, 1, self.wall_limit_s)

    def dismiss(self) -> None:
        """End all workers, whatever they are doing."""
        for hand in self._hands:
            hand.wire.close()  # all of them first: they end at the same time
        for hand in list(self._hands):
            self._dismiss(hand)

    def _feed(self, hand: Hand, todo: Todo) -> None:
        """Keep a worker busy, but near the end leave the calls to whoever is free first."""
        ahead = 1 + max(1, min(MOST_AHEAD, int(AHEAD_S / self._pace_s)))
        while len(hand.outstanding) < ahead and hand.given < self.calls_per_worker and not hand.is_spent:
            waiting = todo.ready(self.size * ahead)
            if not waiting or len(hand.outstanding) >= max(1, waiting // self.size):
                return
            if hand.ready and not hand.outstanding:
                hand.since = self._clock.now
            hand.outstanding.append(todo.take())
            hand.given += 1
            number, item = hand.outstanding[-1]
            hand.wire.send(CALL.pack(number) + pickle.dumps(item))

    def _heard(self, selector: selectors.BaseSelector) -> list[Hand]:
        """The workers that have said something."""
        if all(hand.ready for hand in self._hands):
            lying_ready = min(len(hand.outstanding) for hand in self._hands) * self._pace_s
            if self._pace_s < NAP_S < lying_ready:
                time.sleep(NAP_S)
        hands = {hand.wire.line: hand for hand in self._hands}
        for key in list(selector.get_map().values()):
            if key.fileobj not in hands:
                selector.unregister(key.fileobj)
        for line, hand in hands.items():
            events = selectors.EVENT_READ | (selectors.EVENT_WRITE if hand.wire.is_waiting else 0)
            if line not in selector.get_map():
                selector.register(line, events)
            elif selector.get_key(line).events != events:
                selector.modify(line, events)
        heard = []
        for key, events in selector.select(BEAT_S):
            hand = hands[key.fileobj]  # type: ignore[index]
            if events & selectors.EVENT_WRITE:
                hand.wire.flush()
            if events & selectors.EVENT_READ:
                heard.append(hand)
        return heard

    def _hear(self, hand: Hand, todo: Todo) -> Iterator[tuple[int, Any]]:
        """Take the messages of a worker, or notice its end."""
        try:
            while messages := hand.wire.receive():
                for message in messages:
                    yield from self._answered(hand, message)
        except EOFError:
            yield from self._bury(hand, todo)
            return
        except NoMessageError:
            yield from self._end(hand, todo, "sent what is no answer")
            return
        if (hand.is_spent or hand.given >= self.calls_per_worker) and not hand.outstanding:
            self._dismiss(hand)

    def _answered(self, hand: Hand, message: bytes) -> Iterator[tuple[int, Any]]:
        hand.since = self._clock.now
        if not hand.ready:
            hand.ready, self._failed_starts = True, 0
            return
        number, took_s, has_grown = ANSWER.unpack_from(message) if len(message) > ANSWER.size else (-1, 0.0, False)
        if not hand.outstanding or number != hand.outstanding[0][0]:
            raise NoMessageError
        hand.outstanding.popleft()
        hand.is_spent |= has_grown
        self._pace_s += 0.1 * (max(took_s, 1e-4) - self._pace_s)
        yield number, _read(message[ANSWER.size :])

    def _look_after(self, hand: Hand, todo: Todo) -> Iterator[tuple[int, Any]]:
        """End a worker whose time is up, and bury one whose wire does not tell that it is dead: a child of it may hold the other end."""
        if not hand.process.is_alive():
            yield from self._hear(hand, todo)
            if hand in self._hands and not hand.process.is_alive():
                yield from self._bury(hand, todo)
            return
        spent_s = self._clock.now - hand.since
        if not hand.ready:
            if spent_s > START_LIMIT_S:
                yield from self._end(hand, todo, _SLOW)
        elif hand.outstanding:
            if hand.processor[0] != hand.outstanding[0][0]:
                hand.processor = (hand.outstanding[0][0], processor_s(hand.process))
            if spent_s > self.wall_limit_s:
                share = processor_s(hand.process) - hand.processor[1] > 0.5 * self.wall_limit_s
                yield from self._end(hand, todo, f"ended after {self.wall_limit_s:g} s of wall-clock time", False, share)

    def _bury(self, hand: Hand, todo: Todo) -> Iterator[tuple[int, Any]]:
        """Of a worker whose line is closed."""
        hand.process.join(timeout=1)  # on its way out, as a rule: let it say how
        yield from self._end(hand, todo, "closed its line to the driver" if hand.process.is_alive() else how_it_ended(hand.process))

    def _end(self, hand: Hand, todo: Todo, how: str, in_time: bool = True, had_its_share: bool = False) -> Iterator[tuple[int, Any]]:
        """The oldest call of a worker that is dead, or is ended here, is lost; the others go back to the front of the queue."""
        self._dismiss(hand)
        lost = 1 if hand.ready else 0
        calls = list(hand.outstanding)
        todo.give_back(calls[lost:])
        if not hand.ready:
            self._failed_starts += 1
            if self._failed_starts >= (KILLED_STARTS if how.endswith("SIGKILL") else FAILED_STARTS):
                raise EngineError(self._never_started(how))
        elif calls:
            yield calls[0][0], Lost(calls[0][1], how, in_time, had_its_share)

    def _never_started(self, how: str) -> str:
        said = f"{self._failed_starts} worker processes in a row ended before they could start; the last one {how}"
        return said + '; in a script, what starts them belongs under: if __name__ == "__main__":' * (b"__main__" in self._fn)

    def _dismiss(self, hand: Hand) -> None:
        """End a worker, whatever it is doing. What it has not answered is not wanted of it any more."""
        self._hands.remove(hand)
        hand.wire.close()
        hand.process.join(timeout=0 if hand.outstanding or not hand.ready else 0.2)
        hand.process.kill()  # also one that is stopped
        hand.process.join(timeout=5)  # longer only if the system does not let it go; it ends with it then


def _hire(fn: bytes, now: float) -> Hand:
    ours, theirs = socket.socketpair()
    hand = Hand(keeper(os.getpid()).submit(start, theirs, fn).result(), Wire(ours), now)
    theirs.close()
    hand.wire.send(fn)
    return hand


def _read(answer: bytes) -> Any:
    try:
        return pickle.loads(answer)
    except Exception as bug:
        return Died(f"its result cannot be read: {reason(bug)}")
