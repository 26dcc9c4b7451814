"""What a Dask worker does for us: check that it is of the same code, and hand flights to a worker process of its own.

That process is one of ours (crew.py), so a flight that crashes, hangs, stops or spins ends alone, is known by its number and becomes the
same row as on one machine; the Dask worker stays, with its connection to the scheduler.
"""

import functools
import pickle
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from testbed.run import identity
from testbed.run.crew import Crew, Numbered
from testbed.run.engines import CALLS_PER_WORKER, answers

TASK_S = 5.0
"""A task takes no more calls after so long, and gives back those that are left."""

_crews: dict[tuple[bytes, float], Crew] = {}
"""The one crew of this Dask worker, by its function and limit. It stays from task to task."""


@dataclass(frozen=True)
class Work:
    """A task's answers, how long they took, and why it refused to fly."""

    answers: list[Numbered]
    took_s: float = 0.0
    refusal: tuple[str, ...] = ()


def call_all(fn: Callable[[Any], Any], calls: list[Numbered], wall_limit_s: float, wanted: dict[str, Any]) -> Work:
    """Answer these calls, or the first of them. ``wanted``: the driver's ``fingerprint``, for this worker may have come late."""
    wrong = _refusals(wanted)
    if wrong:
        return Work([], refusal=tuple(wrong))
    start = time.monotonic()

    def for_a_while() -> Iterator[Numbered]:
        for call in calls:
            if time.monotonic() - start > TASK_S:
                return
            yield call

    answered = list(answers(_crew(fn, wall_limit_s), for_a_while()))
    return Work(answered, time.monotonic() - start)


def _crew(fn: Callable[[Any], Any], wall_limit_s: float) -> Crew:
    key = (pickle.dumps(fn), wall_limit_s)
    if key not in _crews:
        for other in _crews.values():
            other.dismiss()
        _crews.clear()
        _crews[key] = Crew(fn, 1, CALLS_PER_WORKER, wall_limit_s)
    return _crews[key]


def fingerprint() -> dict[str, Any]:
    """The code and the versions that this process flies with."""
    return {"code": identity.code_hash(), "versions": identity.versions()}


@functools.cache
def _own_fingerprint() -> dict[str, Any]:
    return fingerprint()


def _refusals(wanted: dict[str, Any]) -> list[str]:
    """Why this worker must not fly: something else would come out, or several flights would share what is made for one."""
    from distributed import get_worker

    worker = get_worker()
    wrong = identity.differences(_own_fingerprint(), wanted)
    if worker.state.nthreads > 1:
        wrong.append(f"runs {worker.state.nthreads} threads; start it with --nthreads 1")
    return [f"{worker.address}: {line}" for line in wrong]
