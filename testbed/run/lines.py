"""A file of one item a line as a sequence of which nothing is held but where each line begins: files may be larger than memory."""

from array import array
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Generic, TypeVar, overload

T = TypeVar("T")


class Lines(Sequence[T], Generic[T]):
    """The items of some lines, in the order of ``starts`` (places in bytes), each read when it is asked for and then let go."""

    def __init__(self, path: Path, starts: "array[int]", read: Callable[[bytes], T]):
        self.path, self.starts, self._read = path, starts, read

    def __len__(self) -> int:
        return len(self.starts)

    def __iter__(self) -> Iterator[T]:
        if not self.starts:
            return
        with self.path.open("rb") as file:
            there = -1
            for start in self.starts:
                if start != there:
                    file.seek(start)
                line = file.readline()
                there = start + len(line)
                yield self._read(line)

    @overload
    def __getitem__(self, which: int) -> T: ...
    @overload
    def __getitem__(self, which: slice) -> list[T]: ...
    def __getitem__(self, which: Any) -> Any:
        if isinstance(which, slice):
            return list(Lines(self.path, self.starts[which], self._read))
        with self.path.open("rb") as file:
            file.seek(self.starts[which])
            return self._read(file.readline())
