"""What a process has worked out and need not work out again: bounded, and the same to the bit as worked out anew.

A key holds everything that the answer depends on, so that a flight cannot tell what was kept from what was made for it. What is kept
is never changed by who gets it.
"""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Any, Generic, TypeVar
from weakref import WeakSet

Value = TypeVar("Value")
_everything: "WeakSet[Kept[Any]]" = WeakSet()


class Kept(Generic[Value]):
    """The latest answers of one kind by their keys, as many as ``most`` of them; or, with ``size``, as large as that together."""

    def __init__(self, most: float, size: Callable[[Value], float] = lambda _: 1.0) -> None:
        self._most, self._size = most, size
        self._found: OrderedDict[Hashable, Value] = OrderedDict()
        self._full = 0.0
        _everything.add(self)

    def get(self, key: Hashable, make: Callable[[], Value]) -> Value:
        """What is kept under that key; else what ``make`` makes, which is kept then if it is not too large. An exception is not."""
        found = self._found
        if key in found:
            found.move_to_end(key)
            return found[key]
        value = make()
        if self._size(value) <= self._most:
            found[key] = value
            self._full += self._size(value)
            while self._full > self._most:
                self._full -= self._size(found.popitem(last=False)[1])
        return value

    def __len__(self) -> int:
        return len(self._found)

    def forget(self) -> None:
        """As in a fresh process."""
        self._found.clear()
        self._full = 0.0


def forget_everything() -> None:
    """Nothing is kept any more: for who compares with, or times, a fresh process."""
    for kept in list(_everything):
        kept.forget()
