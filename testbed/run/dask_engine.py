"""The same interface on a Dask cluster, for campaigns too large for one machine.

With a scheduler's address, workers started with ``dask worker ADDRESS --nthreads 1`` fly; without one, a cluster of this machine
does. Workers need the same code and versions, and the folder of the recordings on a disk they share.
"""

import contextlib
import importlib.util
import itertools
import logging
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from testbed.run import identity
from testbed.run.engines import Died, EngineError, Item, Numbered, Result, attempt, environment_of_workers

CHUNK = 16
"""Flights in a task: a task costs the scheduler milliseconds, as much as a short flight."""

CHUNKS_AHEAD = 3
"""Tasks handed out for each worker."""

PATIENCE_S = 30


@dataclass(frozen=True)
class DaskEngine:
    """A cluster; its scheduler decides who flies what."""

    size: int
    scheduler: str | None = None
    chunk: int = CHUNK
    name: str = "dask"

    def __post_init__(self) -> None:
        if importlib.util.find_spec("distributed") is None:
            raise EngineError("--engine dask needs a package that is not installed: pip install 'vosc-testbed[dask]'")

    @property
    def workers(self) -> int | None:
        return None if self.scheduler else self.size

    def imap(self, fn: Callable[[Item], Result], items: Iterable[Item]) -> Generator[tuple[int, Result | Died], None, None]:
        """Call ``fn``, which the workers must be able to import, on each item."""
        with self._client() as client:
            _check_workers(client)
            suspects: list[Numbered] = []
            for numbered, answers in self._drain(client, fn, enumerate(items)):
                if answers is None:
                    suspects += numbered
                else:
                    yield from answers
            for suspect in suspects:  # alone: a scheduler blames every task that a dead worker had
                future = client.submit(_call_all, fn, [suspect], pure=False)
                problem = future.exception() if not future.cancelled() else None
                yield future.result()[0] if future.status == "finished" else (suspect[0], Died(f"its worker died, twice ({problem!r})"))

    def _drain(self, client: Any, fn: Callable, items: Iterator[Numbered]) -> Iterator[tuple[list[Numbered], list[Numbered] | None]]:
        """Yield (items, their answers, or None if the task was lost) for each task as it ends."""
        from distributed import as_completed

        tasks = iter(lambda: list(itertools.islice(items, self.chunk)), [])  # pulled as they are handed out
        given: dict[str, list[Numbered]] = {}
        running = as_completed(loop=client.loop)

        def give(count: int) -> None:
            for numbered in itertools.islice(tasks, count):
                future = client.submit(_call_all, fn, numbered, pure=False)
                given[future.key] = numbered
                running.add(future)

        give(CHUNKS_AHEAD * len(client.scheduler_info(n_workers=-1)["workers"]))
        for future in running:
            yield given.pop(future.key), future.result() if future.status == "finished" else None
            give(1)

    @contextlib.contextmanager
    def _client(self) -> Iterator[Any]:
        import dask
        from distributed import Client, LocalCluster

        with contextlib.ExitStack() as stack:
            if self.scheduler is None:
                stack.enter_context(dask.config.set({"distributed.scheduler.allowed-failures": 0}))
                with environment_of_workers():  # its threads inherit that, and the workers that they start
                    cluster = LocalCluster(
                        n_workers=self.size,
                        threads_per_worker=1,
                        host="127.0.0.1",
                        dashboard_address=None,
                        silence_logs=logging.CRITICAL,
                    )
                where: dict[str, Any] = {"address": stack.enter_context(cluster)}
            else:
                is_file = Path(self.scheduler).is_file()
                where = {"scheduler_file" if is_file else "address": self.scheduler}
            try:
                client = stack.enter_context(Client(**where, timeout=PATIENCE_S, set_as_default=False))
                client.wait_for_workers(1, timeout=PATIENCE_S)
            except (OSError, ValueError, TimeoutError) as problem:
                raise EngineError(f"no Dask cluster with workers at {self.scheduler}: {problem}") from None
            yield client


def _call_all(fn: Callable[[Any], Any], numbered: list[Numbered]) -> list[Numbered]:
    return [(number, attempt(fn, item)) for number, item in numbered]


def _fingerprint() -> dict[str, Any]:
    return {"code": identity.code_hash(), "versions": identity.versions()}


def _check_workers(client: Any) -> None:
    """Refuse workers that would fly something else, or several flights in one process."""
    try:
        theirs = client.run(_fingerprint)
    except Exception as problem:  # whatever a worker raises when it cannot import us
        raise EngineError(f"the Dask workers cannot run this project: {type(problem).__name__}: {problem}") from None
    ours = _fingerprint()
    wrong = [f"  {worker}: {line}" for worker, its in theirs.items() for line in identity.differences(its, ours)]
    wrong += [
        f"  {worker}: runs {threads} threads; start it with --nthreads 1" for worker, threads in client.nthreads().items() if threads > 1
    ]
    if wrong:
        raise EngineError("the Dask workers differ from this installation:\n" + "\n".join(wrong[:10]))
