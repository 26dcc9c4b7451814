"""The rules that turn evidence into one of the five words: ``docs/verdict.md``, section Words, and nothing else.

Pure: counts, intervals and shares go in, a ruling comes out.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from testbed.results.statistics import Effect
from testbed.studies.scoam.claim import FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN, HOLDS, HOLDS_ONLY_IF, NOT_DETERMINED, Word
from testbed.studies.scoam.verdict.csv_words import percent

SHARE: Final = 0.95  # of flights, and of draws, that "holds" needs
MAJORITY: Final = 0.5  # of draws, below which a failure is put down to what the paper does not print
AS_TAKEN: Final = "what the paper does not print is as taken here"


@dataclass(frozen=True)
class Ruling:
    """A word, what completes ``holds only if``, and the reason where the figures do not speak for themselves."""

    word: Word
    condition: str = ""
    reason: str = ""


@dataclass(frozen=True)
class Agreement:
    """Share of the robustness draws that say the same, and how many there are; NaN and 0 without draws."""

    share: float = math.nan
    n: int = 0


def of_one(rails: bool, flown: bool) -> Word:
    """The word of one pair of flights, on rails and flown."""
    if not rails:
        return FAILS_KINEMATICALLY
    return HOLDS if flown else FAILS_WHEN_FLOWN


def agreement(word: Word, nominal: Word | None, draws: Sequence[Word]) -> Agreement:
    """How many draws say the word; where it is not one that a single draw can say, how many say what the nominal flight says."""
    target = word if word in (FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN, HOLDS) else nominal
    if not draws or target is None:
        return Agreement()
    return Agreement(sum(draw == target for draw in draws) / len(draws), len(draws))


def robust(ruling: Ruling, found: Agreement) -> Ruling:
    """The ruling after the draws: ``holds`` needs 95 % of them, a failure half of them."""
    if ruling.word == HOLDS and found.n == 0:
        return Ruling(NOT_DETERMINED, reason="what the paper does not print was not varied")
    if ruling.word == HOLDS and found.share < SHARE:
        return Ruling(HOLDS_ONLY_IF, AS_TAKEN, f"only {percent(found.share)} of the draws say so")
    if ruling.word in (FAILS_KINEMATICALLY, FAILS_WHEN_FLOWN) and found.n and found.share < MAJORITY:
        return Ruling(NOT_DETERMINED, reason=f"only {percent(found.share)} of the draws fail like that: it depends on what is not printed")
    return ruling


@dataclass(frozen=True)
class PromiseEvidence:
    """What a promise for every flight rests on. Cells are pairs of encounter and aircraft; the air is that of cells that pass on rails.

    ``conditions`` completes "holds only if" for the cells and the air in which every flight passes.
    """

    rails: tuple[bool, ...]
    flown: tuple[bool, ...]  # calm, of the cells that pass on rails
    air: tuple[bool, ...]
    share: Effect  # of the flown flights, calm and in air
    conditions: str


def promise(found: PromiseEvidence) -> Ruling:
    """Safe, flyable, within the overload: said of every flight."""
    if not found.rails:
        return Ruling(NOT_DETERMINED, reason="no flight on rails")
    if not any(found.rails):
        return Ruling(FAILS_KINEMATICALLY)
    if not found.flown:
        return Ruling(NOT_DETERMINED, reason="no flight of an aircraft in calm air")
    if not any(found.flown):
        return Ruling(FAILS_WHEN_FLOWN)
    return _partly(found)


def _partly(found: PromiseEvidence) -> Ruling:
    """A promise that is kept in calm air, by some flights or by all."""
    if not (all(found.rails) and all(found.flown)):
        return Ruling(HOLDS_ONLY_IF, found.conditions)
    if not found.air:
        return Ruling(HOLDS_ONLY_IF, found.conditions, "no wind and no turbulence was flown")
    if found.share.low >= SHARE:
        return Ruling(HOLDS)
    if not all(found.air):
        return Ruling(HOLDS_ONLY_IF, found.conditions)
    return Ruling(NOT_DETERMINED, reason=f"{found.share.n} flights without failure show no more than {percent(found.share.low)}")


BETTER: Final = "better"
TYPICAL: Final = "typical"
WORSE: Final = "worse"
OPEN: Final = "open"


def side(difference: Effect, margin: float, least: Effect) -> str:
    """Where a median of paired differences lies: rival minus SCOAM, so that positive favours the claim; equal counts as least.

    ``better``: the interval is at or above ``-margin`` and SCOAM is least in at least 95 % (interval wholly); ``typical``: only the first.
    """
    if not math.isfinite(difference.low):
        return OPEN
    if difference.high < -margin:
        return WORSE
    if difference.low < -margin:
        return OPEN
    return BETTER if least.low >= SHARE else TYPICAL


def comparison(rails: str, flown: str, share: float) -> Ruling:
    """The word of "least" and "shortest" from the two rungs' sides; ``share``: of encounters in which SCOAM is least, when flown."""
    if rails == WORSE:
        return Ruling(FAILS_KINEMATICALLY)
    if rails == OPEN:
        return Ruling(NOT_DETERMINED, reason="on rails the interval lies on both sides of nothing, or there are too few pairs")
    if flown == WORSE:
        return Ruling(FAILS_WHEN_FLOWN)
    if flown == OPEN:
        return Ruling(NOT_DETERMINED, reason="when flown the interval lies on both sides of nothing, or there are too few pairs")
    if TYPICAL in (rails, flown):
        return Ruling(HOLDS_ONLY_IF, f"the typical encounter is meant: SCOAM is least in {percent(share)} of them")
    return Ruling(HOLDS)
