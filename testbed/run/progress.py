"""Progress of a run on stderr: a bar on a terminal, now and then a plain line anywhere else."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from testbed.run.runner import Progress
from testbed.show.words import counted

EVERY_S = 10.0
EVERY_SHARE = 0.05
LEAST_S = 1.0


@contextmanager
def progress() -> Iterator[Progress]:
    """A function that shows how far the run is."""
    if not sys.stderr.isatty():
        yield PlainLines()
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (BarColumn(), MofNCompleteColumn(), TextColumn("flights{task.fields[note]}"), TimeElapsedColumn(), TimeRemainingColumn())
    with Bar(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task("", total=None, note="")

        def show(done: int, total: int, crashed: int) -> None:
            bar.update(task, completed=done, total=total, note=f", {crashed} crashed" if crashed else "")

        yield show


class PlainLines:
    """A line every 10 s or 5 % of the flights, whichever comes first, but no more than one a second; and one at the end."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._last_at = -EVERY_S
        self._last_done = 0

    def __call__(self, done: int, total: int, crashed: int) -> None:
        now = self._clock()
        waited, gained = now - self._last_at, done - self._last_done
        if done < total and (waited < LEAST_S or (waited < EVERY_S and gained < EVERY_SHARE * total)):
            return
        self._last_at, self._last_done = now, done
        note = f", {crashed} crashed" if crashed else ""
        with suppress(OSError):  # nobody reads it any more, or its disk is full; the flights go on
            print(f"{done} of {counted(total, 'flight')}{note}", file=sys.stderr, flush=True)
