"""The same interface on a Dask cluster, for campaigns too large for one machine.

With a scheduler's address, workers started with ``dask worker ADDRESS --nthreads 1`` fly; without one, a cluster of this machine
does. Workers need the same code and versions, and the folder of the recordings on a disk they share. docs/clusters.md has recipes.
"""

import contextlib
import importlib.util
import logging
import queue
import time
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from testbed.run import dask_client, dask_worker
from testbed.run.crew import Todo
from testbed.run.dask_client import Census, SchedulerLostError, close, connected, say, workers_of
from testbed.run.dask_worker import Work
from testbed.run.engines import WALL_LIMIT_S, Died, EngineError, EngineLostError, Item, Numbered, Result
from testbed.run.processes import environment_of_workers

CHUNK = 64
"""The most flights in a task."""

CHUNK_S = 0.5
"""Work in a task: the scheduler, its worker and the driver spend some milliseconds on each."""

TASKS_AHEAD = 3
"""Tasks handed out for each worker."""

RECONNECT_S = 60.0
"""So long a scheduler that is lost, or another at its address or in its file, may take to come."""

STALL_S = 600.0
"""Without any answer for so long, and twice the limit of a call, nobody is at work; a scheduler gives up a silent worker after 300 s."""


LOST_IN_A_ROW = 100
"""So many tasks that are nobody's fault, with no answer between them, are a cluster that does not work."""


@dataclass(frozen=True)
class DaskEngine:
    """A cluster; its scheduler decides who flies what."""

    size: int
    scheduler: str | None = None
    chunk: int = CHUNK
    name: str = "dask"
    wall_limit_s: float = WALL_LIMIT_S

    def __post_init__(self) -> None:
        if importlib.util.find_spec("distributed") is None:
            raise EngineError("--engine dask needs a package that is not installed: pip install 'vosc-testbed[dask]'")

    @property
    def workers(self) -> int | None:
        return None if self.scheduler else self.size

    def imap(self, fn: Callable[[Item], Result], items: Iterable[Item]) -> Generator[tuple[int, Result | Died], None, None]:
        """Call ``fn``, which the workers must be able to import, on each item."""
        logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what is lost is told here, in a sentence
        todo = Todo(enumerate(items))
        suspects: set[int] = set()
        with contextlib.ExitStack() as stack:
            where = self._where(stack)
            client = connected(where, dask_client.PATIENCE_S)
            try:
                while True:
                    shift = _Shift(self, client, fn, todo, suspects)
                    try:
                        yield from shift.work_off()
                        return
                    except SchedulerLostError as how:
                        shift.give_all_back()
                        close(client)
                        client = self._reconnected(where, str(how))
            finally:
                close(client)

    def _where(self, stack: contextlib.ExitStack) -> dict[str, Any]:
        """What a client needs to find the scheduler; without one, a cluster of this machine, until the stack is left."""
        if self.scheduler is not None:
            is_file = Path(self.scheduler).is_file()
            return {"scheduler_file" if is_file else "address": self.scheduler}
        import dask
        from distributed import LocalCluster

        stack.enter_context(
            dask.config.set({"distributed.scheduler.allowed-failures": 0, "distributed.scheduler.worker-ttl": "60 seconds"})
        )
        with environment_of_workers():  # its threads inherit that, and the workers that they start
            cluster = LocalCluster(
                n_workers=self.size,
                threads_per_worker=1,
                host="127.0.0.1",
                dashboard_address="127.0.0.1:0",  # none at all would take, or warn of, the usual port
                silence_logs=logging.CRITICAL,
            )
        return {"address": stack.enter_context(cluster)}

    def _reconnected(self, where: dict[str, Any], how: str) -> Any:
        """A client of the scheduler that is back, or of another in its place."""
        place = self.scheduler or "this machine"
        say(f"the Dask scheduler at {place} {how}; waiting up to {RECONNECT_S:g} s for it, or for another in its place")
        end = time.monotonic() + RECONNECT_S
        while time.monotonic() < end:
            with contextlib.suppress(EngineError):
                client = connected(where, min(5.0, RECONNECT_S), workers=0)
                say("a Dask scheduler is there; going on")
                return client
            time.sleep(0.5)
        raise EngineLostError(f"the Dask scheduler at {place} {how}, and none came in its place for {RECONNECT_S:g} s")


@dataclass
class _Shift:
    """The time with one scheduler."""

    engine: DaskEngine
    client: Any
    fn: Callable[[Any], Any]
    todo: Todo
    suspects: set[int]
    """Calls whose task was lost with its Dask worker: they go out alone."""
    given: dict[str, tuple[Any, list[Numbered]]] = field(default_factory=dict)
    ended: queue.SimpleQueue[Any] = field(default_factory=queue.SimpleQueue)
    pace_s: float = 0.1
    """Of a call, so far as is known."""
    lost_in_a_row: int = 0

    def work_off(self) -> Iterator[Numbered]:
        """Yield the result of each call, until there is none left."""
        wanted = dask_worker.fingerprint()
        census = Census(self.client)
        last_end = time.monotonic()
        while self.todo.ready(1) or self.given:
            while self.todo.ready(1) and len(self.given) < TASKS_AHEAD * max(1, census.count):
                self._give(census.count, wanted)
            with contextlib.suppress(queue.Empty):
                future = self.ended.get(timeout=1.0)
                last_end = time.monotonic()
                yield from self._take(future)
            census.look()
            if not census.count:
                last_end = time.monotonic()
            if time.monotonic() - last_end > 2 * self.engine.wall_limit_s + STALL_S:
                raise EngineLostError(f"no Dask worker has answered for {time.monotonic() - last_end:.0f} s")

    def give_all_back(self) -> None:
        """Nobody is to blame for a task that the scheduler took with it."""
        for _, calls in self.given.values():
            self.todo.give_back(calls)
        self.given.clear()

    def _give(self, workers: int, wanted: dict[str, Any]) -> None:
        most = max(1, min(self.engine.chunk, int(CHUNK_S / self.pace_s)))
        waiting = self.todo.ready(2 * most * max(1, workers))
        calls = [self.todo.take() for _ in range(min(most, -(-waiting // (2 * max(1, workers)))))]
        alone = next((place for place, (number, _) in enumerate(calls) if number in self.suspects), None)
        if alone is not None:
            keep = max(1, alone)
            self.todo.give_back(calls[keep:])
            calls = calls[:keep]
        future = self.client.submit(dask_worker.call_all, self.fn, calls, self.engine.wall_limit_s, wanted, pure=False)
        self.given[future.key] = (future, calls)
        future.add_done_callback(self.ended.put)

    def _take(self, future: Any) -> Iterator[Numbered]:
        """What came of a task: answers, and calls to give again."""
        if future.key not in self.given:
            return
        work: Work | None = None
        problem: BaseException | None = None
        try:
            work = future.result(timeout=dask_client.PATIENCE_S)
        except Exception as lost:  # whatever Dask raises for a task that is lost
            problem = lost
        _, calls = self.given.pop(future.key)
        if work is None:
            yield from self._lost(calls, future, problem)
            return
        if work.refusal:
            raise EngineError("the Dask workers differ from this installation:\n" + "\n".join(f"  {line}" for line in work.refusal[:10]))
        self.lost_in_a_row = 0
        answered = {number for number, _ in work.answers}
        self.todo.give_back(call for call in calls if call[0] not in answered)
        if answered:
            self.pace_s += 0.3 * (max(work.took_s / len(answered), 1e-4) - self.pace_s)
        yield from work.answers

    def _lost(self, calls: list[Numbered], future: Any, problem: BaseException | None) -> Iterator[Numbered]:
        """Of a task without an answer.

        It is nobody's fault if it went with the scheduler or on the way here. If its workers died, as often as the scheduler allows, the
        calls go out alone, and the one that is lost again so is not tried any more.
        """
        from distributed import KilledWorker

        blamed = future.status == "error"
        try:
            workers_of(self.client)
        except SchedulerLostError:
            self.todo.give_back(calls)
            raise
        said = f"{type(problem).__name__}: {problem}"
        if blamed and not isinstance(problem, KilledWorker):  # what a flight raises is an answer; this is raised before it
            raise EngineError(f"the Dask workers cannot run this project: {said}")
        if blamed and len(calls) == 1 and calls[0][0] in self.suspects:
            yield calls[0][0], Died(f"its Dask worker died on it, twice ({said})")
            return
        self.lost_in_a_row += not blamed
        if self.lost_in_a_row > LOST_IN_A_ROW:
            raise EngineLostError(f"{LOST_IN_A_ROW} Dask tasks in a row were lost on their way; the last one: {said}")
        if blamed:
            self.suspects.update(number for number, _ in calls)
        self.todo.give_back(calls)
