"""A client of a Dask scheduler that may be lost: nothing here waits for ever, and what goes on is said on stderr."""

import asyncio
import contextlib
import queue
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

from testbed.run.engines import EngineError

PATIENCE_S = 30.0
"""So long the scheduler may take to answer; and no workers, or silence of one, is told after so long."""

CENSUS_S = 5.0
"""So often the scheduler is asked who works for it."""


class SchedulerLostError(Exception):
    """str() says how that shows."""


class Census:
    """Who works for the scheduler; says so when nobody does, or when one falls silent."""

    def __init__(self, client: Any):
        self._client = client
        self._workers: dict[str, Any] = workers_of(client)
        self._looked = self._peopled = time.monotonic()
        self._told = 0.0
        self._heard: dict[str, tuple[float, float]] = {}
        self._silent: set[str] = set()

    @property
    def count(self) -> int:
        return len(self._workers)

    def look(self) -> None:
        """Ask, if it is time to. Raises ``SchedulerLostError``."""
        if self._client.status != "running":
            raise SchedulerLostError("is gone")
        now = time.monotonic()
        if now - self._looked < min(CENSUS_S, PATIENCE_S / 3):
            return
        self._workers = workers_of(self._client)
        self._looked = now = time.monotonic()
        if self._workers:
            if self._told:
                say(f"{self.count} Dask workers are there again")
            self._peopled, self._told = now, 0.0
        elif now - self._peopled > max(PATIENCE_S, 2 * self._told):
            self._told = now - self._peopled
            say(f"no Dask workers for {self._told:.0f} s; waiting for some")
        self._listen(now)

    def _listen(self, now: float) -> None:
        for address, about in self._workers.items():
            last, since = self._heard.get(address, (None, now))
            if about.get("last_seen") != last:
                self._heard[address] = (about.get("last_seen"), now)
                self._silent.discard(address)
            elif now - since > PATIENCE_S and address not in self._silent:
                self._silent.add(address)
                say(f"no word of the Dask worker {address} for {now - since:.0f} s; after a time of its own the scheduler gives it up")


def connected(where: dict[str, Any], patience_s: float, workers: int = 1) -> Any:
    """A client. Raises ``EngineError`` if there is no scheduler, or too few workers."""
    from distributed import Client

    try:
        client = _within(2 * patience_s, lambda: Client(**where, timeout=patience_s, set_as_default=False))
        try:
            if workers:
                client.wait_for_workers(workers, timeout=patience_s)
        except BaseException:
            close(client)
            raise
    except (OSError, ValueError, TimeoutError) as problem:
        place = where.get("scheduler_file") or where.get("address")
        raise EngineError(f"no Dask cluster with workers at {place} within {patience_s:g} s: {problem}") from None
    return client


def close(client: Any) -> None:
    """Let it go, whether or not its scheduler still answers."""
    with contextlib.suppress(Exception):  # of a client whose scheduler is lost
        _within(5.0, lambda: client.close(timeout=2))


def _within(patience_s: float, work: Callable[[], Any]) -> Any:
    """What it gives, or ``TimeoutError``. Dask's own patience does not hold for a scheduler that is stopped: it takes calls for ever."""
    done: queue.SimpleQueue[tuple[Any, Exception | None]] = queue.SimpleQueue()

    def try_it() -> None:
        try:
            done.put((work(), None))
        except Exception as problem:
            done.put((None, problem))

    threading.Thread(target=try_it, daemon=True).start()
    try:
        result, problem = done.get(timeout=patience_s)
    except queue.Empty:
        raise TimeoutError(f"no answer for {patience_s:g} s") from None
    if problem is not None:
        raise problem
    return result


def workers_of(client: Any) -> dict[str, Any]:
    """Who works, as the scheduler says now. Raises ``SchedulerLostError``."""

    async def ask() -> Any:
        return await client.scheduler.identity(n_workers=-1)

    asked = asyncio.run_coroutine_threadsafe(ask(), client.loop.asyncio_loop)
    end = time.monotonic() + PATIENCE_S
    while client.status == "running" and time.monotonic() < end:  # it can be lost while it is asked
        try:
            return dict(asked.result(timeout=0.5)["workers"])
        except TimeoutError:
            continue
        except Exception:  # a connection that closes shows itself in many ways
            break
    asked.cancel()
    raise SchedulerLostError(f"has not answered for {PATIENCE_S:g} s" if time.monotonic() >= end else "is gone")


def say(text: str) -> None:
    """On stderr, whatever shows progress there."""
    with contextlib.suppress(OSError, ValueError, AttributeError):  # a stderr that is closed
        print(text, file=sys.stderr, flush=True)
