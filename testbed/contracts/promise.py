"""One promise of a part, and whether it was kept."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from testbed.core.utf8 import reason


@dataclass(frozen=True)
class Promise:
    """``what`` the part promises; ``broken`` how it breaks it, empty when it is kept; a ``note`` is no promise, but worth knowing."""

    what: str
    broken: str = ""
    note: str = ""

    @property
    def kept(self) -> bool:
        return not self.broken

    def __str__(self) -> str:
        if self.broken:
            return f"broken  {self.what}: {self.broken}"
        return f"kept    {self.what}" + (f" ({self.note})" if self.note else "")


def first_broken(what: str, cases: Iterable[tuple[str, Callable[[], str]]], note: str = "") -> Promise:
    """A promise about every case: each is its name and a call that says what is wrong, or nothing. An exception is wrong too."""
    for name, tried in cases:
        try:
            wrong = tried()
        except KeyboardInterrupt:
            raise
        except BaseException as bug:
            wrong = f"raises {reason(bug)}"
        if wrong:
            return Promise(what, f"{name}: {wrong}")
    return Promise(what, note=note)


def report(what: str, promises: Iterable[Promise]) -> Iterator[str]:
    """Lines for a terminal, the verdict last."""
    every = list(promises)
    yield from map(str, every)
    broken = sum(not promise.kept for promise in every)
    yield f"{what}: " + (f"{broken} of {len(every)} promises broken" if broken else f"all {len(every)} promises kept")
