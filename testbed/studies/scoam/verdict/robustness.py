"""Robustness: the same flights with what is printed varied within its rounding and what is not printed within reason."""

from collections.abc import Callable
from typing import Final

from testbed.studies.scoam.claim import Word
from testbed.studies.scoam.labels import MAIN, ROBUSTNESS, Method, Rung
from testbed.studies.scoam.verdict.flights import Flights, Row
from testbed.studies.scoam.verdict.rulings import of_one

NOMINAL: Final = 0  # replicate that is not varied

Test = Callable[[Row], bool | None]  # None: the row cannot tell


def replicates(flights: Flights, method: str, rung: str, encounter: str) -> dict[int, Row]:
    """The flights of one method by replicate; a draw in which no planner is needed is none."""
    rows = flights.pick(ROBUSTNESS, method, rung, encounter=encounter, flown_by=MAIN)
    return {int(row["replicate"]): row for row in rows if flights.is_threat(row)}


def pair_words(rails: dict[int, bool | None], flown: dict[int, bool | None]) -> tuple[Word | None, list[Word]]:
    """The nominal pair's word, and that of every draw that has both."""
    words = {n: of_one(ok, other) for n, ok in rails.items() if ok is not None and (other := flown.get(n)) is not None}
    return words.get(NOMINAL), [word for n, word in sorted(words.items()) if n != NOMINAL]


def method_words(flights: Flights, encounter: str, rails: Test, flown: Test, method: str = Method.SCOAM) -> tuple[Word | None, list[Word]]:
    """``pair_words`` of a test of one method's flights."""
    on_rails, in_air = (replicates(flights, method, rung, encounter) for rung in (Rung.KINEMATIC, Rung.JSBSIM))
    return pair_words({n: rails(row) for n, row in on_rails.items()}, {n: flown(row) for n, row in in_air.items()})
