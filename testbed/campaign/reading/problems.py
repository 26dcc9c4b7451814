"""What is wrong with a campaign, and where: problems are collected and shown all at once."""

import difflib
from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

LINE_WIDTH = 120
"""Characters of a source line that are shown around the column of a problem."""

MOST_SHOWN = 20
"""Problems that are printed; who has more wants to mend these first."""

TAB = "\t"


def _printable(text: str, keep: str = "") -> str:
    """Text of one line that a terminal can be trusted with: the end of a line is a space."""
    return "".join(_shown(character) if character not in keep else character for character in text)


def _shown(character: str) -> str:
    if character.isprintable():
        return character
    return " " if character.isspace() else "\ufffd"


@dataclass(frozen=True)
class Source:
    """A text and what it is called in messages; ``is_file`` decides whether a position in it means anything to a reader."""

    label: str
    text: str = field(repr=False, default="")
    is_file: bool = True
    starts: Sequence[int] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        starts = [0, *(index + 1 for index, character in enumerate(self.text) if character == "\n")]
        object.__setattr__(self, "starts", starts)

    def at(self, index: int) -> "Spot":
        """The spot of a character offset."""
        line = bisect_right(self.starts, index)
        return Spot(self, line, index - self.starts[line - 1] + 1)


@dataclass(frozen=True)
class Spot:
    """A place in a source; line and column count from 1, line 0 is the source as a whole."""

    source: Source
    line: int = 0
    column: int = 0

    @property
    def is_position(self) -> bool:
        return self.source.is_file and self.line > 0

    @property
    def where(self) -> str:
        return f"{self.source.label}:{self.line}:{self.column}" if self.is_position else self.source.label

    @property
    def order(self) -> tuple[bool, int, int]:
        """Places in the file come first, from top to bottom."""
        return not self.source.is_file, self.line, self.column

    def excerpt(self, hint: str) -> str:
        """The source line with a caret under the column, and the hint beside the caret."""
        start = self.source.starts[self.line - 1]
        text = self.source.text[start:].partition("\n")[0]
        cut = max(0, self.column - LINE_WIDTH // 2) if len(text) > LINE_WIDTH else 0
        shown = text[cut : cut + LINE_WIDTH]
        # A tab is as wide as the terminal likes: repeat it, so that the caret stays below its column.
        indent = "".join(TAB if character == TAB else " " for character in shown[: self.column - 1 - cut])
        return f"{self.line:>6} | {_printable(shown, keep=TAB)}".rstrip() + f"\n{'':>6} | {indent}^ {hint}".rstrip()


NOWHERE = Spot(Source("", is_file=False))


@dataclass(frozen=True)
class Problem:
    """One fault: where, in which setting, what, and what may help."""

    spot: Spot
    path: str
    message: str
    hint: str = ""

    def __str__(self) -> str:
        head = ": ".join(_printable(part) for part in (self.spot.where, self.path, self.message) if part)
        if self.spot.is_position:
            return f"{head}\n{self.spot.excerpt(_printable(self.hint))}"
        return f"{head} ({_printable(self.hint)})" if self.hint else head


class SpecError(Exception):
    """A campaign that cannot be used, with all its problems in the order of the file."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        unique: dict[tuple[str, str, str], Problem] = {}
        for problem in problems:
            # One faulty value that an alias puts in two places is one fault.
            path = "" if problem.spot.is_position else problem.path
            unique.setdefault((problem.spot.where, path, problem.message), problem)
        self.problems = tuple(sorted(unique.values(), key=lambda problem: problem.spot.order))
        super().__init__(self.problems)

    def __str__(self) -> str:
        more = len(self.problems) - MOST_SHOWN
        told = [str(problem) for problem in self.problems[:MOST_SHOWN]]
        return "\n".join([*told, f"and {more:,} more"] if more > 0 else told)


def did_you_mean(word: str, known: Iterable[str], prefix: str = "", suffix: str = "") -> str:
    """``did you mean 'clearance'?`` or an empty text when nothing is near."""
    near = difflib.get_close_matches(word.lower(), list(known), n=1, cutoff=0.6)
    return f"did you mean '{prefix}{near[0]}{suffix}'?" if near else ""
