"""Spread independent calls over processes. One interface: ``imap(fn, items)`` yields ``(number of the item, result or Died)``.

The pool is our own (crew.py, worker.py) because those of the standard library give up on every outstanding call when one worker dies,
cannot say which call killed it, and wait for ever for one that hangs. Here each worker has a line of its own and answers in order, so
the oldest unanswered call is the suspect.
"""

from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any, Protocol

from testbed.run.crew import Crew, EngineError, EngineLostError, Lost, Numbered
from testbed.run.processes import usable_cores
from testbed.run.worker import Died, Item, Result, attempt

__all__ = ["Died", "Engine", "EngineError", "EngineLostError", "LocalEngine", "Numbered", "attempt", "limited", "usable_cores"]

CALLS_PER_WORKER = 20_000
"""A worker is replaced after so many calls, whatever it says of its own growth (worker.py)."""

WALL_LIMIT_S = 300.0
"""A call that takes longer is ended. A flight takes tenths of a second; a study's unit of work, some seconds."""


class Engine(Protocol):
    """What the runner needs to know of an engine."""

    @property
    def name(self) -> str: ...

    @property
    def workers(self) -> int | None:
        """How many; None if somebody else decides."""
        ...

    def imap(self, fn: Callable[[Item], Result], items: Iterable[Item]) -> Generator[tuple[int, Result | Died], None, None]:
        """Call ``fn`` on each item; results come as they are ready. Items are pulled a little before they are needed."""
        ...


@dataclass(frozen=True)
class LocalEngine:
    """Spawned processes on this machine, also when it is only one: a crash of a flight must not end the driver."""

    workers: int
    calls_per_worker: int = CALLS_PER_WORKER
    name: str = "local"
    wall_limit_s: float = WALL_LIMIT_S

    def imap(self, fn: Callable[[Item], Result], items: Iterable[Item]) -> Generator[tuple[int, Result | Died], None, None]:
        """Call ``fn``, which a spawned process must be able to import, on each item."""
        with _dismissed(Crew(fn, self.workers, self.calls_per_worker, self.wall_limit_s)) as crew:
            yield from answers(crew, enumerate(items))


def limited(engine: Engine, wall_limit_s: float) -> Engine:
    """The engine, with the limit that a campaign sets; one without processes of its own can end nothing and stays as it is."""
    return replace(engine, wall_limit_s=wall_limit_s) if hasattr(engine, "wall_limit_s") else engine  # type: ignore[type-var]


def answers(crew: Crew, calls: Iterable[Numbered]) -> Generator[tuple[int, Any], None, None]:
    """The result or ``Died`` of each call; one that died in its worker is tried once more, because it may not have been its fault.

    A call that was ended for its time is tried again only if it had not the processor for half of that: it was stopped, or waited. One
    that computed all the while would only do so again.
    """
    died: list[Numbered] = []
    waited: list[Numbered] = []
    for number, result in crew.work_off(calls):
        if not isinstance(result, Lost):
            yield number, result
        elif result.in_time:
            died.append((number, result.item))
        elif result.had_its_share:
            yield number, Died(result.how)
        else:
            waited.append((number, result.item))
    if not (died or waited):
        return
    crew.dismiss()
    for suspect in died:  # alone, so that nobody else's memory or bug can be to blame
        yield from _again(crew.alike(1), [suspect])
    yield from _again(crew.alike(crew.size), waited)


def _again(crew: Crew, calls: Iterable[Numbered]) -> Generator[tuple[int, Any], None, None]:
    with _dismissed(crew):
        for number, result in crew.work_off(calls):
            if isinstance(result, Lost):
                yield number, Died(f"the worker process {result.how}, twice" if result.in_time else result.how)
            else:
                yield number, result


@contextmanager
def _dismissed(crew: Crew) -> Iterator[Crew]:
    """The crew, sent home in the end."""
    try:
        yield crew
    finally:
        crew.dismiss()
