"""Progress of a run on stderr, with what has come of its flights so far: a bar on a terminal, now and then a plain line anywhere else."""

import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Any, Protocol

from testbed.show import words

EVERY_S = 30.0
WRITING = "writing the page..."


class Shown(Protocol):
    """What shows how far a run is: called with flights done, flights in all, and how those that are done ended."""

    def __call__(self, done: int, total: int, outcomes: Mapping[str, int]) -> None: ...
    def writing(self) -> None:
        """The flights are done; tables and page are next."""


@contextmanager
def progress() -> Iterator[Shown]:
    """A bar where somebody looks, lines otherwise."""
    if not sys.stderr.isatty():
        yield PlainLines()
        return
    bar = _Bar()
    try:
        yield bar
    finally:
        bar.stop()


class PlainLines:
    """A line when it begins and every half minute, with the time that is left at the pace so far. The end is told with the answer."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._first: tuple[float, int] | None = None
        self._last_at = 0.0

    def __call__(self, done: int, total: int, outcomes: Mapping[str, int]) -> None:
        now = self._clock()
        if self._first is None:
            self._first = now, done
        elif now - self._last_at < EVERY_S or done == total:
            return
        self._last_at = now
        began, before = self._first
        left = f"; about {words.duration((total - done) * (now - began) / (done - before))} left" if done > before else ""
        _print(f"{done} of {words.counted(total, 'flight')}{_ended(outcomes)}{left}")

    def writing(self) -> None:
        _print(WRITING)


def _ended(outcomes: Mapping[str, int]) -> str:
    return f": {told}" if (told := words.outcomes(outcomes)) else ""


def _print(text: str) -> None:
    with suppress(OSError):  # nobody reads it any more, or its disk is full; the flights go on
        print(text, file=sys.stderr, flush=True)


class _Bar:
    """A bar with the time that is left, and below it how flights ended."""

    def __init__(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
        from rich.text import Text

        class WithOutcomes(Progress):
            outcomes: Mapping[str, int] = {}

            def get_renderables(self) -> Iterable[Any]:
                yield from super().get_renderables()
                yield Text(words.outcomes(self.outcomes), style="dim")

        left = (TextColumn("flown in"), TimeElapsedColumn(), TextColumn("left"), TimeRemainingColumn())
        self._bar = WithOutcomes(BarColumn(30), MofNCompleteColumn(), TextColumn("flights,"), *left, console=Console(stderr=True))
        self._task = self._bar.add_task("", total=None)

    def __call__(self, done: int, total: int, outcomes: Mapping[str, int]) -> None:
        if not self._bar.live.is_started:
            self._bar.start()
        self._bar.outcomes = outcomes
        self._bar.update(self._task, completed=done, total=total)

    def writing(self) -> None:
        self._bar.stop()
        _print(WRITING)

    def stop(self) -> None:
        self._bar.stop()
